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
//! Solved by an active set: the rotors at a bound stay there, the others take B' (C + B B')^-1 (the rest); where
//! one of them meets its bound it stays there; where none does, the rotor at a bound that pulls away from it most is let
//! go. C + B B' is inverted column by column (Sherman and Morrison). At most three rounds for each rotor; the thrusts
//! keep to their ranges after any number of them.
//!
//! Method: O. Härkegård, *Efficient active set algorithms for solving constrained least squares problems in aircraft
//! control allocation*, CDC 2002. Which of a multirotor's torques to give up first: E. J. J. Smeur, D. Höppener, C. de
//! Wagter, *Prioritized control allocation for quadrotors subject to saturation*, IMAV 2017.

use super::collected;
use super::geometry::{ROTORS_MAX, Rotors};
use super::minimum_norm::Thrusts;
use crate::math;
use crate::state::Wrench;
use heapless::Vec;
use nalgebra::{Matrix4, Vector3, Vector4};

/// The diagonal of C: thrust, roll, pitch, yaw.
const GIVING_WAY: Vector4<f32> = Vector4::new(0.02, 1e-3, 1e-3, 1.0);

/// Rounds for each rotor.
const ROUNDS: usize = 3;

/// How strongly a rotor has to pull away from its bound to be let go, N.
const LEAST_PULL: f32 = 1e-4;

/// What a rotor has left of its commanded thrust, from 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lost {
    /// Which one, counted from 0.
    pub rotor: usize,
    /// The delivered share of its commanded thrust.
    pub left: f32,
}

/// A rotor with its column of B in newtons, and the thrust that it can deliver, N.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Remaining {
    column: Vector4<f32>,
    least: f32,
    greatest: f32,
    preferred: f32,
    /// The range of its command, N.
    commanded: [f32; 2],
    /// The delivered share of its commanded thrust.
    left: f32,
}

impl Remaining {
    fn new(column: Vector4<f32>, commanded: [f32; 2], left: f32, share: f32) -> Self {
        let [least, greatest] = commanded.map(|thrust| thrust * left);
        Self { column, least, greatest, preferred: math::between(share, least, greatest), commanded, left }
    }

    fn within(&self, thrust: f32) -> f32 {
        math::between(thrust, self.least, self.greatest)
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
    /// Delivered over commanded thrust.
    scale: f32,
    /// A rotor's share of the weight, N.
    share: f32,
}

impl RemainingRotors {
    /// The `rotors` of a vehicle of so much `weight`, N, without what is `lost`, all at a thrust `scale`: delivered over
    /// commanded.
    #[must_use]
    pub fn new(rotors: &Rotors, lost: &Lost, scale: f32, weight: f32) -> Self {
        let columns = || rotors.effectiveness().iter().map(|column| column.map(|x| x as f32));
        let arm = columns().map(|column| column.yz().norm_squared()).fold(f32::MIN_POSITIVE, math::greater);
        let drag = columns().map(|column| column.w.abs()).fold(f32::MIN_POSITIVE, math::greater);
        let arm = math::sqrt(arm);
        let newtons = Vector4::new(1.0, 1.0 / arm, 1.0 / arm, 1.0 / drag);
        let share = weight / rotors.len() as f32;
        let all = rotors.iter().zip(columns()).enumerate().map(|(index, (rotor, column))| {
            let left = scale * if index == lost.rotor { math::between(lost.left, 0.0, 1.0) } else { 1.0 };
            Remaining::new(column.component_mul(&newtons), [rotor.thrust_min, rotor.thrust_max], left, share)
        });
        Self { rotors: collected(all), newtons, scale, share }
    }

    /// Other knowledge of what is lost.
    pub fn set_left(&mut self, lost: &Lost) {
        if let Some(rotor) = self.rotors.get_mut(lost.rotor) {
            *rotor = Remaining::new(rotor.column, rotor.commanded, self.scale * lost.left, self.share);
        }
    }

    /// A rotor's share of the weight, N.
    #[must_use]
    pub fn share(&self) -> f32 {
        self.share
    }

    /// The thrusts that the rotors are to deliver, N.
    #[must_use]
    pub fn allocate(&self, wanted: &Wrench) -> Thrusts {
        let Wrench { thrust, torque } = wanted;
        let wanted = Vector4::new(*thrust, torque.x, torque.y, torque.z).component_mul(&self.newtons);
        let mut places: Vec<Place, ROTORS_MAX> = collected(
            self.rotors.iter().map(|rotor| Place { thrust: rotor.preferred, is_free: rotor.greatest > rotor.least }),
        );
        for _ in 0..ROUNDS * self.rotors.len() {
            let pull = self.pull(&wanted, &places);
            if !self.approach(&pull, &mut places) && !self.let_go(&pull, &mut places) {
                break;
            }
        }
        collected(self.rotors.iter().zip(&places).map(|(rotor, place)| rotor.within(place.thrust)))
    }

    /// What to command of each, N, for the rotors to deliver `delivered`, within what they may be commanded; nothing of
    /// one that is gone.
    #[must_use]
    pub fn commands(&self, delivered: &Thrusts) -> Thrusts {
        let command = |(rotor, thrust): (&Remaining, &f32)| {
            let [least, most] = rotor.commanded;
            if rotor.left > 0.0 { math::between(thrust / rotor.left, least, most) } else { 0.0 }
        };
        collected(self.rotors.iter().zip(delivered).map(command))
    }

    /// B times thrusts, N and N m.
    #[must_use]
    pub fn wrench(&self, thrusts: &Thrusts) -> Wrench {
        let sum: Vector4<f32> = self.rotors.iter().zip(thrusts).map(|(rotor, thrust)| rotor.column * *thrust).sum();
        let sum = sum.component_div(&self.newtons);
        Wrench { thrust: sum.x, torque: Vector3::new(sum.y, sum.z, sum.w) }
    }

    /// (C + B B')^-1 (w - B f), with f_0 for the free rotors and B B' of these alone: how strongly each part of the
    /// wrench pulls at the thrusts.
    fn pull(&self, wanted: &Vector4<f32>, places: &[Place]) -> Vector4<f32> {
        let mut inverse = Matrix4::from_diagonal(&GIVING_WAY.map(|way| 1.0 / way));
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
                    (share, first) = (math::lesser(reached, share), Some((index, bound)));
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
        let (mut strongest, mut which) = (LEAST_PULL, None);
        for (rotor, place) in self.rotors.iter().zip(places) {
            let inwards = rotor.preferred + rotor.column.dot(pull) - place.thrust;
            let inwards = if place.thrust > rotor.least { -inwards } else { inwards };
            if !place.is_free && rotor.greatest > rotor.least && inwards > strongest {
                (strongest, which) = (inwards, Some(place));
            }
        }
        which.map(|place| place.is_free = true).is_some()
    }
}

#[cfg(test)]
mod tests;
