//! Wrench to rotor thrusts. What cannot be had is given up in order: yaw first, then thrust, roll and pitch last.
//!
//! For w = (T, tau) and rotors f_min <= f <= f_max with w = B f (see [`super`]):
//!
//! 1. f = B+ w ([`MinimumNorm`]). If every rotor is within its range, done: every tick of a certified flight ends here.
//! 2. Otherwise three projections, each onto exactly what the one before leaves (see `attainable.rs`):
//!    - (tau_x, tau_y) to the nearest point of the roll-pitch polygon;
//!    - T to the range it has at that roll and pitch, yaw being free;
//!    - tau_z to the range it has at that roll, pitch and thrust.
//!
//!    Each leaves a wrench alone that can be had. So for a wrench in the polytope all three do nothing, and outside it
//!    the result has the least roll-pitch error of all attainable wrenches, among these the least thrust error, and
//!    among these the least yaw error.
//! 3. The wrench can now be had; find thrusts that deliver it. Four rotors: f = B^-1 w. With more, B+ w may leave a
//!    rotor's range although other thrusts give the same wrench. The rotors beyond four are set one after another, each
//!    as near to its share of B+ w as lets the rotors after it deliver the rest (a range, again by slabs); the
//!    last four follow from the inverse of their part of B. No iteration, and the thrusts depend continuously on w.
//!
//! **Never worse than clipping, in roll and pitch.** Clipping each rotor of B+ w gives thrusts within their ranges,
//! hence a point of the roll-pitch polygon; step 2 takes the polygon's nearest point. All this holds up to rounding,
//! which [`Mixer::wrench`] shows.
//!
//! It does not know the rotors' lag, nor what they delivered last tick. A certified flight whose vehicle matches its
//! scenario never comes to step 2 ([`crate::certificate`]); a sagging battery or a failed rotor can lead there.

use super::attainable::{Polygon, ROTOR_PAIRS_MAX, Slabs, generators};
use super::collected;
use super::geometry::{ROTORS_MAX, ROTORS_MIN, Rotors, normal};
use super::minimum_norm::{Delivered, MinimumNorm, Thrusts, components};
use crate::error::InputError;
use crate::state::Wrench;
use core::hint::cold_path;
use heapless::Vec;
use nalgebra::{Vector2, Vector4};

/// Triples of eight rotors.
const ROTOR_TRIPLES_MAX: usize = 56;
/// Triples of the seven rotors after the first.
const ROTOR_TRIPLES_AFTER_FIRST_MAX: usize = 35;

/// The rotors' command, and the wrench it delivers.
#[derive(Debug, Clone, PartialEq)]
pub struct Allocation {
    /// Thrust of each rotor, N, within its range.
    pub thrusts: Thrusts,
    /// Roll or pitch torque was reduced: the rotors cannot deliver that pair at any thrust and yaw.
    pub roll_pitch_limited: bool,
    /// Thrust was changed to what roll and pitch leave.
    pub thrust_limited: bool,
    /// Yaw torque was changed to what roll, pitch and thrust leave.
    pub yaw_limited: bool,
}

impl Allocation {
    /// Whether the delivered wrench is the commanded one (to rounding).
    pub fn is_exact(&self) -> bool {
        !(self.roll_pitch_limited || self.thrust_limited || self.yaw_limited)
    }
}

/// A rotor beyond the four that carry the wrench, with the ranges the rotors after it leave.
#[derive(Debug, Clone, PartialEq)]
struct Spare {
    rotor: usize,
    after: Slabs<ROTOR_TRIPLES_AFTER_FIRST_MAX>,
}

/// One of the four rotors that carry the rest: its row of the inverse of their columns.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Carrier {
    rotor: usize,
    row: Vector4<f32>,
}

/// Everything about one set of rotors that a tick needs, worked out once. About 6 KB.
#[derive(Debug, Clone, PartialEq)]
pub struct Mixer {
    minimum_norm: MinimumNorm,
    roll_pitch: Polygon,
    thrust: Slabs<ROTOR_PAIRS_MAX>,
    yaw: Slabs<ROTOR_TRIPLES_MAX>,
    spares: Vec<Spare, { ROTORS_MAX - ROTORS_MIN }>,
    carriers: Vec<Carrier, ROTORS_MIN>,
}

impl Mixer {
    /// Of no rotors.
    pub const NONE: Self = Self {
        minimum_norm: MinimumNorm::NONE,
        roll_pitch: Polygon::NONE,
        thrust: Slabs::NONE,
        yaw: Slabs::NONE,
        spares: Vec::new(),
        carriers: Vec::new(),
    };

    /// A mixer for `rotors`; configuration time.
    pub fn new(rotors: &Rotors) -> Self {
        let mut mixer = Self::NONE;
        mixer.prepare(rotors);
        mixer
    }

    /// Prepares the mixer for `rotors` where it lies: built apart and moved here, it would take its size on the stack
    /// again.
    pub fn prepare(&mut self, rotors: &Rotors) {
        let carriers = carriers(rotors);
        let carrying = || carriers.iter().map(|carrier| carrier.rotor);
        let spare = (0..rotors.len()).filter(|index| !carrying().any(|carrier| carrier == *index));
        let order: Vec<usize, ROTORS_MAX> = collected(spare.chain(carrying()));
        self.spares.clear();
        for (place, rotor) in order.iter().enumerate().take(rotors.len().saturating_sub(ROTORS_MIN)) {
            if let Some(column) = rotors.effectiveness().get(*rotor) {
                let rest = generators(rotors, order.iter().skip(place + 1));
                let after = Slabs::new(rotors, &rest, None, *column);
                // At most four spares beyond four carriers.
                let _ = self.spares.push(Spare { rotor: *rotor, after });
            }
        }
        let all = generators(rotors, order.iter());
        self.minimum_norm = MinimumNorm::new(rotors);
        self.roll_pitch = Polygon::new(rotors);
        self.thrust = Slabs::new(rotors, &all, Some(Vector4::w()), -Vector4::x());
        self.yaw = Slabs::new(rotors, &all, None, -Vector4::w());
        self.carriers = carriers;
    }

    /// Thrusts for `wrench`, N and N m, body frame.
    ///
    /// # Errors
    /// Refuses a wrench that is not finite or beyond [`STATE_RANGE`](crate::state::STATE_RANGE); the law's own never
    /// are.
    pub fn allocate(&self, wrench: &Wrench) -> Result<Allocation, InputError> {
        let Delivered { thrusts, clipped } = self.minimum_norm.allocate(wrench)?;
        if !clipped {
            let (roll_pitch_limited, thrust_limited, yaw_limited) = (false, false, false);
            return Ok(Allocation { thrusts, roll_pitch_limited, thrust_limited, yaw_limited });
        }
        cold_path();
        let asked = components(wrench);
        let given = self.attainable(&asked);
        let thrusts = self.deliver(&given);
        Ok(Allocation {
            thrusts,
            roll_pitch_limited: asked.y != given.y || asked.z != given.z,
            thrust_limited: asked.x != given.x,
            yaw_limited: asked.w != given.w,
        })
    }

    /// B times the thrusts, N, in the rotors' order: the wrench they act on the body with.
    pub fn wrench(&self, thrusts: &[f32]) -> Wrench {
        self.minimum_norm.wrench(thrusts)
    }

    /// Step 2: the attainable wrench that stands in for `asked`.
    fn attainable(&self, asked: &Vector4<f32>) -> Vector4<f32> {
        let torque = self.roll_pitch.nearest(&Vector2::new(asked.y, asked.z));
        let thrust = within(asked.x, self.thrust.range(&Vector4::new(0.0, torque.x, torque.y, 0.0)));
        let yaw = within(asked.w, self.yaw.range(&Vector4::new(thrust, torque.x, torque.y, 0.0)));
        Vector4::new(thrust, torque.x, torque.y, yaw)
    }

    /// Step 3: thrusts within their ranges for an attainable `wrench`.
    fn deliver(&self, wrench: &Vector4<f32>) -> Thrusts {
        let mut thrusts = self.minimum_norm.preferred(wrench);
        let mut rest = *wrench;
        for spare in &self.spares {
            let range = spare.after.range(&rest);
            let actuator = self.minimum_norm.actuators().get(spare.rotor);
            if let (Some(thrust), Some(actuator)) = (thrusts.get_mut(spare.rotor), actuator) {
                *thrust = actuator.clip(within(*thrust, range));
                rest -= actuator.column * *thrust;
            }
        }
        for carrier in &self.carriers {
            if let Some(thrust) = thrusts.get_mut(carrier.rotor) {
                *thrust = carrier.row.dot(&rest);
            }
        }
        self.minimum_norm.clip(&mut thrusts);
        // Rounding so far is of the size of the commanded wrench; what remains is of the size of the error.
        let missing = wrench - self.minimum_norm.sum(&thrusts);
        for (thrust, correction) in thrusts.iter_mut().zip(&self.minimum_norm.preferred(&missing)) {
            *thrust += correction;
        }
        self.minimum_norm.clip(&mut thrusts);
        thrusts
    }
}

/// `value` moved into a range.
fn within(value: f32, (min, max): (f32, f32)) -> f32 {
    value.max(min).min(max)
}

/// The four rotors whose (scaled) columns span the largest volume, and the inverse of these columns, row by row.
///
/// With the largest volume, every other rotor's column is a combination of the four with coefficients of at most one,
/// so handing its thrust over to them never magnifies an error.
fn carriers(rotors: &Rotors) -> Vec<Carrier, ROTORS_MIN> {
    let (mut best, mut largest) = (Vec::new(), 0.0);
    for choice in 0_u32..1 << rotors.len() {
        let chosen = |index: &usize| choice >> index & 1 == 1;
        let columns = rotors.effectiveness().iter().enumerate().filter(|(index, _)| chosen(index));
        let columns: Vec<Vector4<f64>, ROTORS_MAX> =
            collected(columns.map(|(_, column)| column.component_mul(&rotors.scale())));
        if let [a, b, c, d] = columns.as_slice() {
            let volume = normal(b, c, d).dot(a).abs();
            if volume > largest {
                // The inverse's row for one column is normal to the other three.
                let rows = [(a, normal(b, c, d)), (b, normal(a, c, d)), (c, normal(a, b, d)), (d, normal(a, b, c))];
                let row = |(column, normal): &(&Vector4<f64>, Vector4<f64>)| {
                    (normal / normal.dot(column)).component_mul(&rotors.scale()).map(|x| x as f32)
                };
                let indices = (0..rotors.len()).filter(chosen);
                best = collected(indices.zip(rows.iter().map(row)).map(|(rotor, row)| Carrier { rotor, row }));
                largest = volume;
            }
        }
    }
    best
}
