//! The sharp bound over its cells: `SharpCells.v`, `SharpCover.v`, `Partition.v`.
//!
//! Which formula of a cell stands where is read from `covered` of `SharpCover.v`. Every part of it grows with the cell,
//! so the formula of a coarser cell is above those of the cells in it: what lies below the greatest found so far is not
//! looked into.

use super::alike;
use super::bounds::{Given, bounded};
use crate::support::Random;
use crate::support::coq::{Proofs, Value};
use crate::support::hummingbird;
use controller_core::certificate::sharp::{self, ANGLE_CELLS, HEADING_CELLS, SPLIT_CELLS, TILT_CELLS};
use controller_core::reference::ReferenceBounds;
use nalgebra::Vector3;

/// So many times cells are cut into finer ones.
const CUTS: usize = 4;

/// How many cells there are after so many cuts of the whole range.
fn cells_after(cuts: usize, finest: usize) -> usize {
    assert_eq!(finest % (1 << (CUTS - 1)), 0, "{finest} cells are not cut in halves");
    if cuts == 0 { 1 } else { finest >> (CUTS - cuts) }
}

/// Looks into the cells of N ranges, down to the finest. `of` is a cell's bound, for how many cells each range has, and
/// the cell's number in each. `raises` says whether a bound is above the greatest found so far; its second argument
/// says that the bound is a finest cell's, which counts as found.
fn look_into<const N: usize>(
    finest: [usize; N],
    of: &impl Fn([usize; N], [usize; N]) -> f64,
    raises: &mut impl FnMut(f64, bool) -> bool,
) {
    if raises(of([1; N], [0; N]), false) {
        look_within((0, [0; N]), finest, of, raises);
    }
}

fn look_within<const N: usize>(
    (cuts, cell): (usize, [usize; N]),
    finest: [usize; N],
    of: &impl Fn([usize; N], [usize; N]) -> f64,
    raises: &mut impl FnMut(f64, bool) -> bool,
) {
    let cuts = cuts + 1;
    let cells = finest.map(|finest| cells_after(cuts, finest));
    let parts = finest.map(|finest| cells_after(cuts, finest) / cells_after(cuts - 1, finest));
    let finer = (0..parts.iter().product()).map(|mut place| {
        let mut part = cell;
        for (part, parts) in part.iter_mut().zip(parts) {
            (*part, place) = (*part * parts + place % parts, place / parts);
        }
        (of(cells, part), part)
    });
    let mut finer: Vec<(f64, [usize; N])> = finer.collect();
    // The greatest first.
    finer.sort_by(|a, b| b.0.total_cmp(&a.0));
    for (bound, cell) in finer {
        if raises(bound, cuts == CUTS) && cuts < CUTS {
            look_within((cuts, cell), finest, of, raises);
        }
    }
}

/// One cell of the tilt, in the proofs.
struct Tilt {
    proofs: Proofs,
    /// What p is at most.
    longest: f64,
}

impl Tilt {
    fn new(given: &Given, cell: usize) -> Self {
        let reach = given.reach();
        let proofs = Proofs::read("SharpCover")
            .with(&[
                ("vertical_least", reach.vertical_min),
                ("horizontal", reach.horizontal),
                ("jerk", reach.jerk),
                ("horizontal_jerk", reach.horizontal_jerk),
                ("vertical_jerk", reach.vertical_jerk),
                ("horizontal_snap", reach.horizontal_snap),
                ("vertical_snap", reach.vertical_snap),
                ("heading_rate", f64::from(given.bounds.heading_rate)),
                ("heading_second", f64::from(given.bounds.heading_second_derivative)),
                ("tilts", TILT_CELLS as f64),
                ("i", cell as f64),
                ("q", 0.0),
            ])
            .with_value("omega", bounded())
            .with_value("omega_1", bounded());
        let tilt = Self { proofs, longest: f64::NAN };
        let longest = tilt.of_directions(|at, _| at.sides("covered", "q <= length i k")[1]).min(reach.jerk);
        Self { proofs: tilt.proofs.with_value("longest", Value::Number(longest).moving()), longest }
    }

    /// In a cell of the direction, of the share of u', and of the heading.
    fn at(&self, [angles, splits, headings]: [usize; 3], [k, l, j]: [usize; 3]) -> Proofs {
        let cells = [("angles", angles), ("splits", splits), ("headings", headings), ("k", k), ("l", l), ("j", j)];
        self.proofs.clone().with(&cells.map(|(name, number)| (name, number as f64)))
    }

    /// The greatest over the directions.
    fn of_directions(&self, of: impl Fn(&Proofs, f64) -> f64) -> f64 {
        let at = |k| self.at([ANGLE_CELLS, SPLIT_CELLS, HEADING_CELLS], [k, 0, 0]);
        (0..ANGLE_CELLS).map(|k| of(&at(k), k as f64)).fold(0.0, f64::max)
    }

    fn velocity(&self) -> f64 {
        self.of_directions(|at, _| at.sides("covered", "square omega <=")[1]).sqrt()
    }

    fn acceleration_in(&self, cells: [usize; 3], cell: [usize; 3]) -> f64 {
        self.at(cells, cell).sides("covered", "square omega_1 <=")[1].sqrt()
    }
}

fn some_vehicles() -> Vec<Given> {
    let configuration = hummingbird::paper_law();
    let gains = configuration.gains().unwrap();
    let [k_f, k_s, m_p, gravity] = [gains.k_f, gains.k_s, gains.m_p, configuration.vehicle().gravity].map(f64::from);
    let given = Given { k_f, k_s, m_p, gravity, bounds: *configuration.bounds() };
    // Its reference at rest, and with a heading that K_nu'' alone limits.
    let resting = Given { bounds: ReferenceBounds::REST, ..given };
    let limited = Given { bounds: ReferenceBounds { heading_rate: 5.0, ..given.bounds }, ..given };
    // With a snap so great, and u' so little, that an even split of u' decides.
    let even = Given { m_p: 0.0, bounds: ReferenceBounds { jerk: 0.5, snap: 100.0, ..ReferenceBounds::REST }, ..given };
    let mut random = Random(20);
    [given, resting, limited, even].into_iter().chain([0; 2].map(|_| Given::random(&mut random))).collect()
}

/// The cells of the tilt, the steepest first; without a tilt they are all the same.
fn tilts(given: &Given) -> impl Iterator<Item = usize> {
    let cells = if given.reach().horizontal > 0.0 { TILT_CELLS } else { 1 };
    (0..cells).rev()
}

#[test]
pub(super) fn the_sharp_bound_is_the_greatest_of_the_proofs_cells() {
    let inertia = hummingbird::vehicle().inertia.map(f64::from);
    let torque = |velocity: f64, acceleration: f64| {
        let axis = |axis: usize| {
            let [j, next, last] = [0, 1, 2].map(|turn| inertia[(axis + turn) % 3]);
            Proofs::read("Torque").number("torque_max", &[j, next, last, velocity, acceleration, 0.0, 0.0, 0.0])
        };
        Vector3::from_fn(|place, _| axis(place))
    };
    for given in some_vehicles() {
        let (mut velocity, mut acceleration, mut torques) = (0.0_f64, 0.0_f64, Vector3::zeros());
        for cell in tilts(&given) {
            let tilt = Tilt::new(&given, cell);
            let fastest = tilt.velocity();
            velocity = velocity.max(fastest);
            let of = |cells, cell| tilt.acceleration_in(cells, cell);
            look_into([ANGLE_CELLS, SPLIT_CELLS, HEADING_CELLS], &of, &mut |bound, is_found| {
                let torque = torque(fastest, bound);
                let raises = bound > acceleration || torque.iter().zip(&torques).any(|(torque, most)| torque > most);
                if is_found && raises {
                    (acceleration, torques) = (acceleration.max(bound), torques.sup(&torque));
                }
                raises
            });
        }
        let found = sharp::desired_rates(&given.reach(), &given.bounds, &inertia);
        alike(found.angular_velocity, velocity, "U_omega");
        alike(found.angular_acceleration, acceleration, "U_omega'");
        found.feedforward_torque.iter().zip(&torques).for_each(|(found, proven)| alike(*found, *proven, "torque"));
    }
}

#[test]
pub(super) fn the_bounds_on_the_third_axis_are_the_greatest_of_the_proofs_cells() {
    for given in some_vehicles() {
        let reach = given.reach();
        let (mut rate, mut acceleration) = (0.0_f64, 0.0_f64);
        for cell in tilts(&given) {
            let tilt = Tilt::new(&given, cell);
            let all = &tilt.proofs;
            let [near, far] = ["near", "far"].map(|end| all.bound_of("covered", end, &[cell as f64]));
            let mixed = |horizontal: f64, vertical: f64| {
                tilt.of_directions(|at, k| at.bound_of("covered", "mixed", &[cell as f64, k, horizontal, vertical]))
            };
            let jerk = mixed(reach.horizontal_jerk, reach.vertical_jerk);
            let snap = mixed(reach.horizontal_snap, reach.vertical_snap);
            let fastest = all.number("fastest", &[]);
            rate = rate.max(all.number("velocity_square", &[far, 0.0, jerk, fastest]).sqrt());

            let of = |[splits, headings]: [usize; 2], [l, j]: [usize; 2]| {
                let end = |greatest, cells: usize, k: usize| all.number("end_of", &[greatest, cells as f64, k as f64]);
                let [least, most] = [l, l + 1].map(|k| end(tilt.longest, splits, k));
                let [slow, fast] = [j, j + 1].map(|k| end(fastest, headings, k));
                let heading_second = f64::from(given.bounds.heading_second_derivative);
                let turning = all.number("heading_acceleration", &[heading_second, slow]);
                let shares = [fast, turning, reach.jerk, reach.horizontal_jerk, least, most];
                let cell = [&[near, far, reach.vertical_min, f64::NAN, snap], &shares[..]].concat();
                // What turns about the third axis, without u'' and with it.
                ["yawing_bound", "far * snap_mixed"]
                    .map(|part| all.part("acceleration_square", &cell, part))
                    .iter()
                    .sum()
            };
            look_into([SPLIT_CELLS, HEADING_CELLS], &of, &mut |bound, is_found| {
                let raises = bound > acceleration;
                if is_found && raises {
                    acceleration = bound;
                }
                raises
            });
        }
        let [found_rate, found_acceleration] = sharp::turning_rates(&given.reach(), &given.bounds);
        alike(found_rate, rate, "|omega_d3|");
        alike(found_acceleration, acceleration, "|omega_d3'|");
    }
}
