//! One closed loop in samples with what comes to it from outside: a force on the vehicle, an error of its actuator, and
//! whatever a law that saturates does otherwise than the linear one.
//!
//! ```text
//! x+ = A x + sum over j of the integral of k_j(t) u_j(t) over the tick,   |signals| <= |C x| + D |u|
//! ```
//!
//! t is the time that is left of the tick. What the law does otherwise is held over a tick; a force and an error of the
//! actuator may be anything in between ([`columns`]). Everything in samples, as in [`super::law`].

mod columns;

use super::balance;
use super::chain::SampledLoop;
use super::lag::INTEGRATORS_MAX;
use super::law::{Added, Law, Signals};
pub use columns::Stretch;
use columns::{actuator, force, place, turned, uneven, unseen};
use nalgebra::{DMatrix, DVector, RowDVector};

/// What comes from outside.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Input {
    /// A force, as an acceleration along the axis; laterally over g.
    Force,
    /// What the actuator follows beside its command.
    Actuator,
    /// ubar beside the linear one.
    Feedback,
    /// The command beside the linear one.
    Command,
    /// The force that an interval shows beside the linear one.
    Estimate,
    /// A force that the estimate does not see, because it knows the thrust that makes it: its mean over a tick, of
    /// which it is never more than twice as much.
    Unseen,
    /// The same in one tick, and taken back in the next.
    Shaken,
    /// How the desired tilt bends beside c'', the mean over a tick: fed forward, and missing in how the tilt turns,
    /// both counted from c. The torque bias does not see it.
    Bend,
    /// What is fed forward beside that in one tick, and taken back in the next.
    Late,
    /// What is fed forward beside both.
    Stray,
    /// How far the bend, or along the vertical an unseen force, changes within a tick.
    Uneven,
}

impl Input {
    /// All of them.
    pub const ALL: [Self; 11] = [
        Self::Force,
        Self::Actuator,
        Self::Feedback,
        Self::Command,
        Self::Estimate,
        Self::Unseen,
        Self::Shaken,
        Self::Bend,
        Self::Late,
        Self::Stray,
        Self::Uneven,
    ];
}

/// What is bounded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Signal {
    /// Of the vehicle, laterally over g.
    Position,
    Velocity,
    /// How fast the tilt turns faster than c'' lets it, as a tick begins: by what the actuator delivers, and by what it
    /// follows before and after the next command arrives. In between it delivers something between these.
    BentActual,
    BentOlder,
    BentNewer,
    /// What the actuator delivers.
    Actual,
    /// What the actuator follows less what it delivers, as a tick begins.
    BehindAtTick,
    /// The same as the next command arrives.
    BehindAtArrival,
    Z1,
    Z2,
    /// k_p z_1 + k_v z_2.
    Wanted,
    /// d.
    Force,
    /// c; along the vertical y.
    Desired,
    /// c'.
    DesiredRate,
    /// c''.
    DesiredAcceleration,
    /// How far c'' jumps at the next tick.
    Jump,
    /// The tilt less c.
    Error,
    /// How fast it turns less c'.
    ErrorRate,
    /// The tilt's error, projected.
    Angle,
    /// Its rate, projected.
    Rate,
    /// The torque bias.
    Bias,
    /// w.
    Command,
}

impl Signal {
    /// All of them, in the order of [`DisturbedLoop::signals`].
    pub const ALL: [Self; 22] = [
        Self::Position,
        Self::Velocity,
        Self::BentActual,
        Self::BentOlder,
        Self::BentNewer,
        Self::Actual,
        Self::BehindAtTick,
        Self::BehindAtArrival,
        Self::Z1,
        Self::Z2,
        Self::Wanted,
        Self::Force,
        Self::Desired,
        Self::DesiredRate,
        Self::DesiredAcceleration,
        Self::Jump,
        Self::Error,
        Self::ErrorRate,
        Self::Angle,
        Self::Rate,
        Self::Bias,
        Self::Command,
    ];
}

/// The loop.
#[derive(Debug, Clone, PartialEq)]
pub struct DisturbedLoop {
    /// A.
    pub transition: DMatrix<f64>,
    /// The stretches of each of [`Input::ALL`].
    pub inputs: [Vec<Stretch>; Input::ALL.len()],
    /// C, a row for each of [`Signal::ALL`].
    pub signals: Vec<RowDVector<f64>>,
    /// |D|: what a unit of an input changes at once.
    pub direct: Vec<[f64; Input::ALL.len()]>,
}

impl DisturbedLoop {
    /// `law` through an actuator of this lag and delay that makes `gain` times its commands.
    pub(super) fn new(law: &Law, lag: f64, delay: f64, gain: f64) -> Self {
        let compensator = law.compensator();
        let chain = SampledLoop::new(&compensator, law.integrators(), lag, delay).with_gain(gain);
        let transition = chain.closed_loop();
        let size = transition.nrows();
        let none = Added::default();
        let [feedback, command] = [Added { feedback: 1.0, ..none }, Added { command: 1.0, ..none }];
        let [estimate, bend] = [Added { force: 1.0, ..none }, Added { bend: 1.0, bias: 1.0, ..none }];
        let column = |added: &Added| added_column(law, &chain, size, added);
        let held = |added: &Added| vec![Stretch::held(column(added))];
        let fed = column(&Added { bend: 1.0, ..none });
        let unseen = unseen(law, column(&Added { unseen: 1.0, ..none }));
        let returning = |column: &DVector<f64>| {
            vec![Stretch { once: true, ..Stretch::held(column.clone()) }, Stretch::held(&transition * column - column)]
        };
        let inputs = [
            force(law, size),
            actuator(law, lag, size),
            held(&feedback),
            held(&command),
            held(&estimate),
            vec![unseen.clone()],
            returning(&unseen.column),
            vec![Stretch::held(column(&bend) - turned(law, size))],
            returning(&fed),
            vec![Stretch::held(fed)],
            uneven(law, size),
        ];

        let kept = if lag > 0.0 { (-delay.fract() / lag).exp() } else { 0.0 };
        let actuation = Actuation { gain, kept };
        let columns: Vec<_> = (0..size).map(|state| at_unit(law, &chain, &actuation, size, state)).collect();
        let mut signals: Vec<RowDVector<f64>> = (0..Signal::ALL.len())
            .map(|signal| RowDVector::from_iterator(size, columns.iter().map(|column| column[signal])))
            .collect();
        let changed = [none, none, feedback, command, estimate, none, none, bend, bend, bend, none].map(|added| {
            let mut states = vec![0.0; law.size()];
            listed(law, &law.tick_of_states(&mut states, &[0.0; INTEGRATORS_MAX], &added))
        });
        let mut direct: Vec<_> =
            (0..Signal::ALL.len()).map(|signal| changed.map(|listed| listed[signal].abs())).collect();
        // What is taken back in the next tick may add to what comes then.
        for direct in &mut direct {
            direct[Input::Late as usize] *= 2.0;
        }
        let arrives = if chain.arrival().whole_delay == 0 { gain } else { 0.0 };
        let bends = direct[Signal::DesiredAcceleration as usize];
        let told = direct[Signal::Command as usize].map(|command| arrives * command);
        direct[Signal::BentActual as usize] = bends;
        direct[Signal::BentOlder as usize] = bends;
        direct[Signal::BentNewer as usize] = core::array::from_fn(|input| bends[input] + told[input]);
        direct[Signal::BehindAtArrival as usize] = told;
        // c'' of the next tick less what this one's comes to until then.
        if let Some(gains) = law.position() {
            let kept = (-gains.k_f).exp();
            let bending = signals[Signal::DesiredAcceleration as usize].clone();
            let at_once = direct[Signal::DesiredAcceleration as usize];
            direct[Signal::Jump as usize] = core::array::from_fn(|input| {
                let through: f64 = inputs[input].iter().map(|stretch| stretch.seen(&bending)).sum();
                through + (1.0 + kept) * at_once[input]
            });
            signals[Signal::Jump as usize] = &bending * &transition - bending * kept;
        }
        Self { transition, inputs, signals, direct }
    }

    /// The same with its states counted in units that make them about as large as each other: powers of two, so nothing
    /// is rounded.
    pub fn balanced(mut self) -> Self {
        let factors = DVector::from_vec(balance(&mut self.transition));
        for row in &mut self.signals {
            row.component_mul_assign(&factors.transpose());
        }
        for stretch in self.inputs.iter_mut().flatten() {
            stretch.column.component_div_assign(&factors);
            for (place, most) in &mut stretch.swing {
                *most /= factors[*place];
            }
        }
        self
    }
}

/// What a tick's state becomes by what is added in it alone.
fn added_column(law: &Law, chain: &SampledLoop<'_>, size: usize, added: &Added) -> DVector<f64> {
    let mut states = vec![0.0; law.size()];
    let command = law.tick_of_states(&mut states, &[0.0; INTEGRATORS_MAX], added).command;
    let [actuator, first, held] = chain.places();
    let mut column = DVector::zeros(size);
    column.rows_mut(first, states.len()).copy_from_slice(&states);
    if chain.arrival().whole_delay == 0 {
        for m in 0..=law.integrators() {
            column[place(m, actuator)] += chain.arrival().newer[m] * command;
        }
    }
    if held < size {
        column[held] = command;
    }
    column
}

/// How the actuator answers.
struct Actuation {
    gain: f64,
    /// What it keeps of a difference until the tick's command arrives.
    kept: f64,
}

/// The signals of a state that is one in one place.
fn at_unit(
    law: &Law,
    chain: &SampledLoop<'_>,
    actuation: &Actuation,
    size: usize,
    state: usize,
) -> [f64; Signal::ALL.len()] {
    let [actuator, first, held] = chain.places();
    let unit = |place: usize| f64::from(u8::from(place == state));
    let measured: [f64; INTEGRATORS_MAX] = core::array::from_fn(|m| if m < actuator { unit(m) } else { 0.0 });
    let mut states: Vec<f64> = (first..held).map(unit).collect();
    let signals = law.tick_of_states(&mut states, &measured, &Added::default());
    let mut listed = listed(law, &signals);

    let arrival = chain.arrival();
    let command = |age: usize| match age {
        0 => signals.command,
        _ if held + age - 1 < size => unit(held + age - 1),
        _ => 0.0,
    };
    // What arrives later in the tick, and what was there as it began.
    let [newer, older] = [command(arrival.whole_delay), command(arrival.whole_delay + 1)];
    let actual = unit(actuator);
    let at_arrival = actuation.kept * actual + (1.0 - actuation.kept) * actuation.gain * older;
    listed[Signal::Position as usize] = measured[law.integrators() - 1];
    listed[Signal::Velocity as usize] = measured[law.integrators() - 2];
    if law.integrators() == INTEGRATORS_MAX {
        let [rate, tilt, ..] = measured;
        listed[Signal::Error as usize] = tilt - signals.desired[0];
        listed[Signal::ErrorRate as usize] = rate - signals.desired[1];
        for (signal, turned) in [
            (Signal::BentActual, actual),
            (Signal::BentOlder, actuation.gain * older),
            (Signal::BentNewer, actuation.gain * newer),
        ] {
            listed[signal as usize] = turned - signals.desired[2];
        }
    }
    listed[Signal::Actual as usize] = actual;
    listed[Signal::BehindAtTick as usize] = actuation.gain * older - actual;
    listed[Signal::BehindAtArrival as usize] = actuation.gain * newer - at_arrival;
    listed
}

/// The law's signals, in the order of [`Signal::ALL`]; the vehicle's are zero.
fn listed(law: &Law, signals: &Signals) -> [f64; Signal::ALL.len()] {
    let Signals { errors: [z_1, z_2], force, desired: [c, rate, acceleration], projected: [angle, turning], .. } =
        *signals;
    let wanted = law.position().map_or(0.0, |gains| gains.feedback([z_1, z_2]));
    let Signals { bias, command, .. } = *signals;
    let mut listed = [0.0; Signal::ALL.len()];
    for (signal, value) in [
        (Signal::Z1, z_1),
        (Signal::Z2, z_2),
        (Signal::Wanted, wanted),
        (Signal::Force, force),
        (Signal::Desired, c),
        (Signal::DesiredRate, rate),
        (Signal::DesiredAcceleration, acceleration),
        (Signal::Angle, angle),
        (Signal::Rate, turning),
        (Signal::Bias, bias),
        (Signal::Command, command),
    ] {
        listed[signal as usize] = value;
    }
    listed
}

#[cfg(test)]
mod tests;
