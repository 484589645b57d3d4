//! The vehicle's own limit in three scenes: what rotors and inertia leave possible, whatever the law.
//!
//! An estimate by bang-bang control: nothing but full torque one way, full torque the other way, and full thrust. It is
//! no bound that is proven: a law that thrusts while it turns may come a little below it.
//!
//! *A turn* through an angle phi about body x or y, whichever is quicker: the rotors of one side at their greatest
//! thrust and the others at their least, then the other way round, so that it ends at rest,
//!
//! ```text
//! J phi'' = tau,   tau = sum b_i f_i within the file's limit,   f_i = k_eta w_i^2,   w_i' = (w_c - w_i) / lag
//! ```
//!
//! from rotors that hover. The time of the change is found by bisection.
//!
//! *Upside down*: a turn by half a revolution in free fall (what its rotors push down while they point down, they push
//! up later), then full thrust until the fall has ended:
//!
//! ```text
//! z' = v,  v' = -g,   then  v' = F / m - g  with the rotors' lag      lost: -z where v = 0
//! ```
//!
//! *A step* by d across, arriving within r = 0.1 m: a turn by the tilt theta, acceleration a = g tan(theta) at the
//! thrust that holds height, a turn by 2 theta, and the same deceleration, so late that the vehicle stops r behind the
//! goal.
//! With t(phi) the time of a turn, in which it coasts, and the speed v between,
//!
//! ```text
//! v^2 / a + v t(2 theta) = d + r       until within r: t(theta) + v / a + t(2 theta) + (v - sqrt(4 a r)) / a
//! ```
//!
//! or less where it is within r before it brakes. The quickest of tilts up to that at which full thrust holds height.
//! Drag, and the climb of a far step, are left out: both take longer.

use controller_core::allocation::{Rotor, Rotors};
use nalgebra::Vector4;
use scenario::Scenario;
use std::f64::consts::PI;

/// The figure of a scene whose task is to come to its reference.
pub const ARRIVAL_FIGURE: &str = "within 0.1 m for good after";

/// r: as in the scenes.
const ARRIVAL_DISTANCE_M: f64 = 0.1;
const INTEGRATION_STEP_S: f64 = 1e-4;
/// Halvings of the time at which the torque changes.
const HALVINGS_MAX: u32 = 40;
/// No rotation takes longer.
const ROTATION_MAX_S: f64 = 10.0;
/// Tilts that are tried.
const TILT_COUNT: u32 = 20;

/// A rotor in a turn.
#[derive(Debug, Clone, Copy)]
struct Side {
    /// b, N m per N.
    lever: f64,
    /// Root of the thrust, which a speed is proportional to: least, in hover, greatest.
    roots: [f64; 3],
}

/// A vehicle that turns about one of its axes.
#[derive(Debug, Clone)]
struct Turning {
    sides: Vec<Side>,
    /// kg m^2.
    inertia: f64,
    /// Greatest torque, N m.
    limit: f64,
    /// The share of a speed error that remains after [`INTEGRATION_STEP_S`].
    left: f64,
}

/// The end of a turn.
#[derive(Debug, Clone)]
struct Turned {
    /// s.
    time: f64,
    /// Roots of the rotors' thrusts.
    roots: Vec<f64>,
}

impl Turning {
    fn new(scenario: &Scenario, axis: usize) -> Self {
        let configuration = &scenario.configuration;
        let (vehicle, limit) = (configuration.vehicle(), f64::from(configuration.limits().torque_max[axis]));
        let hover = f64::from(vehicle.mass * vehicle.gravity);
        let lagging = |lag: f64| if lag > 0.0 { (-INTEGRATION_STEP_S / lag).exp() } else { 0.0 };
        let (sides, left) = match configuration.rotors() {
            None => {
                let side = |lever| Side { lever, roots: [0.0, 0.0, limit.sqrt()] };
                ([1.0, -1.0].map(side).to_vec(), 0.0)
            }
            Some(rotors) => {
                let rows = rotors.iter().zip(rotors.effectiveness()).zip(rotors.pseudo_inverse());
                let side = |((rotor, column), row): ((&Rotor, &Vector4<f64>), &Vector4<f64>)| {
                    let (least, most) = (f64::from(rotor.thrust_min), f64::from(rotor.thrust_max));
                    let roots = [least, (row.x * hover).clamp(least, most), most].map(f64::sqrt);
                    Side { lever: column[1 + axis], roots }
                };
                (rows.map(side).collect(), lagging(scenario.rotor_lag))
            }
        };
        Self { sides, inertia: f64::from(vehicle.inertia[axis]), limit, left }
    }

    /// A turn whose torque changes its sign at `change`, s, until it stands still; and how far it has come, rad.
    fn until_still(&self, change: f64) -> (f64, Turned) {
        let mut roots: Vec<f64> = self.sides.iter().map(|side| side.roots[1]).collect();
        let (mut angle, mut rate, mut time) = (0.0, 0.0, 0.0);
        while (rate > 0.0 || time <= change) && time < ROTATION_MAX_S {
            let forward = time < change;
            let mut torque = 0.0;
            for (root, side) in roots.iter_mut().zip(&self.sides) {
                let wanted = side.roots[if (side.lever > 0.0) == forward { 2 } else { 0 }];
                *root = wanted + (*root - wanted) * self.left;
                torque += side.lever * *root * *root;
            }
            rate += torque.clamp(-self.limit, self.limit) / self.inertia * INTEGRATION_STEP_S;
            angle += rate * INTEGRATION_STEP_S;
            time += INTEGRATION_STEP_S;
        }
        (angle, Turned { time, roots })
    }

    /// The quickest turn by `angle`, rad, from rest to rest.
    fn by(&self, angle: f64) -> Turned {
        let (mut early, mut late) = (0.0, ROTATION_MAX_S);
        for _ in 0..HALVINGS_MAX {
            let middle = 0.5 * (early + late);
            if self.until_still(middle).0 < angle { early = middle } else { late = middle }
        }
        self.until_still(late).1
    }
}

/// The vehicle's limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit {
    /// Height lost from upside down, m.
    pub height_lost: f64,
    /// From upside down until within 0.1 m for good, s.
    pub recovered: f64,
    /// Steps of 1 m and of 10 m until within 0.1 m for good, s.
    pub steps: [f64; 2],
}

/// Of the step, and of the far step's level part: as in the scenes.
const STEP_DISTANCES_M: [f64; 2] = [1.0, 8.485];

impl Limit {
    /// Of the vehicle of `scenario`.
    #[must_use]
    pub fn new(scenario: &Scenario) -> Self {
        let configuration = &scenario.configuration;
        let (mass, gravity) = (f64::from(configuration.vehicle().mass), f64::from(configuration.vehicle().gravity));
        let thrust_max = f64::from(configuration.limits().thrust_max);
        let together = |rotors: &Rotors| rotors.iter().map(|rotor| f64::from(rotor.thrust_max)).sum::<f64>();
        let thrust = configuration.rotors().map_or(thrust_max, |rotors| together(rotors).min(thrust_max));
        let quicker = |angle: f64| {
            let [roll, pitch] = [0, 1].map(|axis| Turning::new(scenario, axis));
            let [one, other] = [roll.by(angle), pitch.by(angle)];
            if one.time <= other.time { (roll, one) } else { (pitch, other) }
        };

        let (turning, mut turned) = quicker(PI);
        let (mut height, mut speed, mut time) =
            (-0.5 * gravity * turned.time * turned.time, -gravity * turned.time, turned.time);
        while speed < 0.0 && time < ROTATION_MAX_S {
            let mut lift = 0.0;
            for (root, side) in turned.roots.iter_mut().zip(&turning.sides) {
                *root = side.roots[2] + (*root - side.roots[2]) * turning.left;
                lift += *root * *root;
            }
            let lift = if configuration.rotors().is_some() { lift.min(thrust_max) } else { thrust };
            speed += (lift / mass - gravity) * INTEGRATION_STEP_S;
            height += speed * INTEGRATION_STEP_S;
            time += INTEGRATION_STEP_S;
        }
        let height_lost = -height;
        let recovered = time + climb(height_lost - ARRIVAL_DISTANCE_M, thrust / mass - gravity, gravity);

        let steepest = (mass * gravity / thrust).acos();
        let tilts = (1..=TILT_COUNT).map(|part| steepest * f64::from(part) / f64::from(TILT_COUNT));
        let turns: Vec<[f64; 3]> =
            tilts.map(|tilt| [gravity * tilt.tan(), quicker(tilt).1.time, quicker(2.0 * tilt).1.time]).collect();
        let step = |way: f64| turns.iter().map(|turns| step_time(way, turns)).fold(f64::INFINITY, f64::min);
        Self { height_lost, recovered, steps: STEP_DISTANCES_M.map(step) }
    }

    /// In the row of `figure` of `scene`; none where nothing is worked out.
    #[must_use]
    pub fn in_row(&self, scene: &str, figure: &str) -> Option<f64> {
        match (scene, figure) {
            ("upside down", "height lost") => Some(self.height_lost),
            ("upside down", ARRIVAL_FIGURE) => Some(self.recovered),
            ("step", ARRIVAL_FIGURE) => Some(self.steps[0]),
            ("far step", ARRIVAL_FIGURE) => Some(self.steps[1]),
            _ => None,
        }
    }
}

/// The time in which a vehicle at rest climbs by `way`, m, accelerated at `up` and braked by `gravity`, m/s^2, so late
/// that it stops 2 r above, s.
fn climb(way: f64, up: f64, gravity: f64) -> f64 {
    let end_squared = 4.0 * gravity * ARRIVAL_DISTANCE_M;
    if 2.0 * up * way <= end_squared {
        return (2.0 * way.max(0.0) / up).sqrt();
    }
    let speed = ((2.0 * gravity * way + end_squared) * up / (up + gravity)).sqrt();
    speed / up + (speed - end_squared.sqrt()) / gravity
}

/// The time of a step by `way`, m, s, with the acceleration a, m/s^2, and the times of the two turns, s.
fn step_time(way: f64, [acceleration, first, second]: &[f64; 3]) -> f64 {
    // v^2 / a + v t = d + r.
    let half = 0.5 * second * acceleration;
    let speed = (half * half + acceleration * (way + ARRIVAL_DISTANCE_M)).sqrt() - half;
    let (to_go, pushed) = (way - ARRIVAL_DISTANCE_M, 0.5 * speed * speed / acceleration);
    first
        + if to_go <= pushed {
            (2.0 * to_go / acceleration).sqrt()
        } else if to_go <= pushed + speed * second {
            speed / acceleration + (to_go - pushed) / speed
        } else {
            speed / acceleration + second + (speed - (4.0 * acceleration * ARRIVAL_DISTANCE_M).sqrt()) / acceleration
        }
}

#[cfg(test)]
mod tests;
