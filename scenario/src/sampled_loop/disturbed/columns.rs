//! What a unit of each input does to a loop's state in a tick.
//!
//! Of a force and of an error of the actuator, per unit and per time t that is left of the tick:
//!
//! | | a | y_1 ... |
//! |---|---|---|
//! | a force, as the change of the velocity per sample | | 1 in the velocity, t in the position |
//! | an error beside the actuator's command | forced_0' = e^(-t/lag) / lag | forced_m' = forced_(m-1) |
//!
//! with `forced` as in [`LagResponse`]. The time of a tick is cut into [`Stretch`]es: in each a kernel is its mean and
//! at most `swing` beside it, as its entries are monotone.

use crate::sampled_loop::lag::{INVERSE_FACTORIAL, LagResponse};
use crate::sampled_loop::law::Law;
use nalgebra::{DVector, RowDVector};

/// Stretches of a tick.
pub(super) const STRETCH_COUNT: usize = 8;

/// A part of a tick in which a unit of an input moves the state by `column` at most in all, and by no more than `swing`
/// beside that: entries for a and y_m.
#[derive(Debug, Clone, PartialEq)]
pub struct Stretch {
    pub column: DVector<f64>,
    pub swing: Vec<(usize, f64)>,
    /// Seen by the next tick alone.
    pub once: bool,
}

impl Stretch {
    /// The same in the whole tick.
    pub(super) fn held(column: DVector<f64>) -> Self {
        Self { column, swing: Vec::new(), once: false }
    }

    /// At most what `row` shows of it.
    pub(super) fn seen(&self, row: &RowDVector<f64>) -> f64 {
        self.swing.iter().fold(row.tr_dot(&self.column).abs(), |sum, (place, most)| sum + row[*place].abs() * most)
    }
}

/// Where y_m stands, and a = y_0 behind them.
pub(super) fn place(m: usize, actuator: usize) -> usize {
    if m == 0 { actuator } else { m - 1 }
}

/// How far a unit of acceleration, held for a tick, moves y_1 and what follows it.
pub(super) fn turned(law: &Law, size: usize) -> DVector<f64> {
    let mut column = DVector::zeros(size);
    for m in 1..=law.integrators() {
        column[m - 1] = INVERSE_FACTORIAL[m];
    }
    column
}

/// What the change of an acceleration within a tick adds beside its mean: nothing to y_1; to y_m at most the integral
/// of |t^(m-1) - 1/m| / (m-1)!, t from 0 to 1, times half of the change, for it is at most so far from its mean.
pub(super) fn uneven(law: &Law, size: usize) -> Vec<Stretch> {
    let swing = (2..=law.integrators()).map(|m| (m - 1, 0.25 * INVERSE_FACTORIAL[m - 1])).collect();
    vec![Stretch { swing, ..Stretch::held(DVector::zeros(size)) }]
}

/// The ends of the stretches, in time that is left.
fn ends() -> impl Iterator<Item = [f64; 2]> {
    (0..STRETCH_COUNT).map(|stretch| [stretch, stretch + 1].map(|end| end as f64 / STRETCH_COUNT as f64))
}

/// A force whose mean over a tick is one, and at most two, moves the velocity by that, and the position by half of it,
/// with at most a quarter of the greatest beside; `besides` is what it does in the law.
pub(super) fn unseen(law: &Law, mut besides: DVector<f64>) -> Stretch {
    let [velocity, position] = [law.integrators() - 2, law.integrators() - 1];
    besides[velocity] += 1.0;
    besides[position] += 0.5;
    Stretch { swing: vec![(position, 0.5)], ..Stretch::held(besides) }
}

/// A force moves the velocity, y_(M-1), and with it the position, y_M.
pub(super) fn force(law: &Law, size: usize) -> Vec<Stretch> {
    let [velocity, position] = [law.integrators() - 2, law.integrators() - 1];
    ends()
        .map(|[from, to]| {
            let mut column = DVector::zeros(size);
            column[velocity] = to - from;
            column[position] = 0.5 * (to * to - from * from);
            Stretch { column, swing: vec![(position, (to - from) * (to - from))], once: false }
        })
        .collect()
}

/// What the actuator follows besides.
pub(super) fn actuator(law: &Law, lag: f64, size: usize) -> Vec<Stretch> {
    let last = law.integrators();
    // The kernel of each y_m: forced_m', the slope of `forced`.
    let slope = |time: f64, forced: &[f64], m: usize| match m {
        0 if lag > 0.0 => (-time / lag).exp() / lag,
        0 => 0.0,
        _ => forced[m - 1],
    };
    ends()
        .map(|[from, to]| {
            let [before, after] = [from, to].map(|time| LagResponse::over(time, lag).forced);
            let mut column = DVector::zeros(size);
            let mut swing = Vec::new();
            for m in 0..=last {
                let place = place(m, last);
                column[place] = after[m] - before[m];
                swing.push((place, (to - from) * (slope(to, &after, m) - slope(from, &before, m)).abs()));
            }
            Stretch { column, swing, once: false }
        })
        .collect()
}
