//! Wrench to the rotors that are left, where one has failed or lost a part of its thrust.
//!
//! With less than four rotors, or a range that ends early, most wrenches cannot be had. The thrusts f are those of
//!
//! ```text
//! minimise |f - f_0|^2 + (w - B f)' C^-1 (w - B f)   over   f_min <= f <= f_max
//! ```
//!
//! w in newtons: torques about the tilt's axes over the longest arm, torque about z over the greatest k_m / k_eta. C is
//! diagonal: how readily each part of the wrench gives way. Roll and pitch give way last, then thrust, then yaw. f_0
//! shares the weight equally. So every rotor stays within what it has, whatever is asked: a bound is part of the
//! problem, and every step of its solution keeps to it.
//!
//! Solved by an active set: the rotors at a bound stay there, the others take B' (C + B B')^-1 (the rest); where one of
//! them meets its bound it stays there; where none does, the rotor at a bound that pulls away from it most is let go.
//! The inverse is built up column by column (Sherman and Morrison). At most three rounds for each rotor; the thrusts
//! keep to their ranges after any number of them.
//!
//! Then the whole is drawn back towards the least thrusts as far as the user's limits of thrust and torque ask: of what
//! is delivered, and of what would be if no rotor had lost anything.
//!
//! Method: O. Härkegård, *Efficient active set algorithms for solving constrained least squares problems in aircraft
//! control allocation*, CDC 2002. Which of a multirotor's torques to give up first: E. J. J. Smeur, D. Höppener, C. de
//! Wagter, *Prioritized control allocation for quadrotors subject to saturation*, IMAV 2017.

use super::collected;
use super::geometry::{ROTORS_MAX, Rotors};
use super::minimum_norm::Thrusts;
use crate::math;
use crate::state::Wrench;
use crate::vehicle::Limits;
use heapless::Vec;
use nalgebra::{Matrix4, Vector3, Vector4};

/// The diagonal of C: thrust, roll, pitch, yaw.
const WRENCH_COMPLIANCE: Vector4<f32> = Vector4::new(0.02, 1e-3, 1e-3, 1.0);

/// Rounds for each rotor.
const ROUNDS_PER_ROTOR: usize = 3;

/// The part of a limit that is left unused: more than the rounding of a wrench.
const UNUSED_LIMIT_SHARE: f32 = 1e-5;

/// How strongly a rotor has to pull away from its bound to be let go, N.
const RELEASE_PULL_MIN_N: f32 = 1e-4;

/// What a rotor has left of its commanded thrust, from 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LostRotor {
    /// Which one, counted from 0.
    pub rotor: usize,
    /// The delivered share of its commanded thrust.
    pub left: f32,
}

/// A rotor with its column of B in newtons, and the thrust that it can deliver, N.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Remaining {
    column: Vector4<f32>,
    min: f32,
    max: f32,
    preferred: f32,
    /// The range of its command, N.
    commanded: [f32; 2],
    /// The delivered share of its commanded thrust.
    left: f32,
}

impl Remaining {
    fn new(column: Vector4<f32>, commanded: [f32; 2], left: f32, share: f32) -> Self {
        let [min, max] = commanded.map(|thrust| thrust * left);
        Self { column, min, max, preferred: math::clamp(share, min, max), commanded, left }
    }

    fn within(&self, thrust: f32) -> f32 {
        math::clamp(thrust, self.min, self.max)
    }
}

/// Where a rotor's thrust is in a round.
#[derive(Debug, Clone, Copy)]
struct Place {
    thrust: f32,
    is_free: bool,
}

/// The rotors of which one has failed.
#[derive(Debug, Clone, PartialEq)]
pub struct RemainingRotors {
    rotors: Vec<Remaining, ROTORS_MAX>,
    /// Newtons per N or N m.
    newtons: Vector4<f32>,
    /// The limits, in newtons.
    limits: Vector4<f32>,
    /// Delivered over commanded thrust.
    scale: f32,
    /// A rotor's share of the weight, N.
    share: f32,
}

impl RemainingRotors {
    /// The `rotors` of a vehicle of so much `weight`, N, with these `limits`, without what is `lost`, all at a thrust
    /// `scale`: delivered over commanded.
    pub fn new(rotors: &Rotors, limits: &Limits, lost: &LostRotor, scale: f32, weight: f32) -> Self {
        let columns = || rotors.effectiveness().iter().map(|column| column.map(|x| x as f32));
        let drag = columns().map(|column| column.w.abs()).fold(f32::MIN_POSITIVE, math::max);
        let arm = rotors.max_arm();
        let newtons = Vector4::new(1.0, 1.0 / arm, 1.0 / arm, 1.0 / drag);
        let share = weight / rotors.len() as f32;
        let all = rotors.iter().zip(columns()).enumerate().map(|(index, (rotor, column))| {
            let left = scale * if index == lost.rotor { math::clamp(lost.left, 0.0, 1.0) } else { 1.0 };
            Remaining::new(column.component_mul(&newtons), [rotor.thrust_min, rotor.thrust_max], left, share)
        });
        let torque = &limits.torque_max;
        let limits = Vector4::new(limits.thrust_max, torque.x, torque.y, torque.z) * (1.0 - UNUSED_LIMIT_SHARE);
        Self { rotors: collected(all), newtons, limits: limits.component_mul(&newtons), scale, share }
    }

    /// Changes what the failed rotor has left.
    pub fn set_left(&mut self, lost: &LostRotor) {
        if let Some(rotor) = self.rotors.get_mut(lost.rotor) {
            *rotor = Remaining::new(rotor.column, rotor.commanded, self.scale * lost.left, self.share);
        }
    }

    /// A rotor's share of the weight, N.
    pub fn share(&self) -> f32 {
        self.share
    }

    /// The thrusts that the rotors are to deliver, N.
    pub fn allocate(&self, wanted: &Wrench) -> Thrusts {
        let Wrench { thrust, torque } = wanted;
        let mut wanted = Vector4::new(*thrust, torque.x, torque.y, torque.z).component_mul(&self.newtons);
        // More would bend the tilt for a yaw that is not to be had.
        wanted.w = math::saturate(wanted.w, self.share);
        let mut places: Vec<Place, ROTORS_MAX> = collected(
            self.rotors.iter().map(|rotor| Place { thrust: rotor.preferred, is_free: rotor.max > rotor.min }),
        );
        for _ in 0..ROUNDS_PER_ROTOR * self.rotors.len() {
            let pull = self.pull(&wanted, &places);
            if !self.approach(&pull, &mut places) && !self.let_go(&pull, &mut places) {
                break;
            }
        }
        let share = self.share_within_limits(&places);
        let drawn_back =
            |(rotor, place): (&Remaining, &Place)| rotor.within(rotor.min + (place.thrust - rotor.min) * share);
        collected(self.rotors.iter().zip(&places).map(drawn_back))
    }

    /// How far from their least thrusts the rotors may go towards those of `places`.
    fn share_within_limits(&self, places: &[Place]) -> f32 {
        let mut sums = [[Vector4::zeros(); 2]; 2];
        for (rotor, place) in self.rotors.iter().zip(places) {
            let [min, _] = rotor.commanded;
            let as_if_whole = |thrust: f32| thrust * self.scale / rotor.left;
            let whole = [min * self.scale, as_if_whole(place.thrust)];
            let commanded = if rotor.left > 0.0 { whole } else { [0.0; 2] };
            for (sum, thrusts) in sums.iter_mut().zip([[rotor.min, place.thrust], commanded]) {
                for (sum, thrust) in sum.iter_mut().zip(thrusts) {
                    *sum += rotor.column * thrust;
                }
            }
        }
        let mut share = 1.0;
        for [min, wanted] in &sums {
            for ((from, to), limit) in min.iter().zip(wanted).zip(&self.limits) {
                if to.abs() > *limit {
                    let end = if *to > 0.0 { *limit } else { -limit };
                    share = math::min(share, math::clamp((end - from) / (to - from), 0.0, 1.0));
                }
            }
        }
        share
    }

    /// What to command of each, N, for the rotors to deliver `delivered`, within what they may be commanded; nothing of
    /// one that is gone.
    pub fn commands(&self, delivered: &Thrusts) -> Thrusts {
        let command = |(rotor, thrust): (&Remaining, &f32)| {
            let [min, max] = rotor.commanded;
            if rotor.left > 0.0 { math::clamp(thrust / rotor.left, min, max) } else { 0.0 }
        };
        collected(self.rotors.iter().zip(delivered).map(command))
    }

    /// B times thrusts, N and N m.
    pub fn wrench(&self, thrusts: &Thrusts) -> Wrench {
        let sum: Vector4<f32> = self.rotors.iter().zip(thrusts).map(|(rotor, thrust)| rotor.column * *thrust).sum();
        let sum = sum.component_div(&self.newtons);
        Wrench { thrust: sum.x, torque: Vector3::new(sum.y, sum.z, sum.w) }
    }

    /// (C + B B')^-1 (w - B f), with f_0 for the free rotors and B B' of these alone: how strongly each part of the
    /// wrench pulls at the thrusts.
    fn pull(&self, wanted: &Vector4<f32>, places: &[Place]) -> Vector4<f32> {
        let mut inverse = Matrix4::from_diagonal(&WRENCH_COMPLIANCE.map(|way| 1.0 / way));
        let mut rest = *wanted;
        for (rotor, place) in self.rotors.iter().zip(places) {
            if place.is_free {
                let along = inverse * rotor.column;
                inverse -= along * along.transpose() / (1.0 + rotor.column.dot(&along));
                rest -= rotor.column * rotor.preferred;
            } else {
                rest -= rotor.column * place.thrust;
            }
        }
        inverse * rest
    }

    /// Moves the free rotors to where `pull` has them, or as far as the first of them goes; whether one of them ended
    /// at its bound.
    fn approach(&self, pull: &Vector4<f32>, places: &mut [Place]) -> bool {
        let free = |place: &&mut Place| place.is_free;
        let goal = |rotor: &Remaining| rotor.preferred + rotor.column.dot(pull);
        let (mut share, mut first) = (1.0, None);
        for (index, (rotor, place)) in self.rotors.iter().zip(places.iter()).enumerate() {
            let (goal, bound) = (goal(rotor), rotor.within(goal(rotor)));
            if place.is_free && bound != goal {
                let reached = (bound - place.thrust) / (goal - place.thrust);
                if reached < share || first.is_none() {
                    (share, first) = (math::min(reached, share), Some((index, bound)));
                }
            }
        }
        for (rotor, place) in self.rotors.iter().zip(places.iter_mut()).filter(|(_, place)| free(place)) {
            place.thrust = rotor.within(place.thrust + (goal(rotor) - place.thrust) * share);
        }
        let Some(place) = first.and_then(|(index, _)| places.get_mut(index)) else { return false };
        *place = Place { thrust: first.map_or(place.thrust, |(_, bound)| bound), is_free: false };
        true
    }

    /// Lets the rotor go that pulls away from its bound most; whether one does.
    fn let_go(&self, pull: &Vector4<f32>, places: &mut [Place]) -> bool {
        let (mut strongest, mut which) = (RELEASE_PULL_MIN_N, None);
        for (rotor, place) in self.rotors.iter().zip(places) {
            let inwards = rotor.preferred + rotor.column.dot(pull) - place.thrust;
            let inwards = if place.thrust > rotor.min { -inwards } else { inwards };
            if !place.is_free && rotor.max > rotor.min && inwards > strongest {
                (strongest, which) = (inwards, Some(place));
            }
        }
        which.map(|place| place.is_free = true).is_some()
    }
}

#[cfg(test)]
mod tests;
