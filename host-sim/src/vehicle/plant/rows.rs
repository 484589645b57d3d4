//! Many bodies that move at the same time, in the widest registers that the processor has.
//!
//! The numbers of each kind stand side by side in a row, one of each body. A register takes as many neighbours as it
//! holds: eight with AVX-512, four with AVX2, found out at run time. Those left over at the end of a row, and all of
//! them on any other processor, go one by one. The equations are written once ([`super::motion`]), so the bits are
//! always the same.

use super::body::Body;
use super::lanes::{Lanes, Vectors};
use super::motion::BodyMotion;
use nalgebra::{Quaternion, Vector3};
use pulp::{Arch, Scalar, Simd, WithSimd};
use scenario::body::BodyState;

/// Numbers of a state: position, velocity, attitude, angular velocity.
const STATE_NUMBERS: usize = 13;
/// Numbers of a command: thrust, torque.
const COMMAND_NUMBERS: usize = 4;

/// States and commands of many bodies.
#[derive(Debug, Clone)]
pub struct Rows {
    processor: Arch,
    states: [Vec<f64>; STATE_NUMBERS],
    commands: [Vec<f64>; COMMAND_NUMBERS],
}

impl Rows {
    /// Room for so many bodies, on the best registers of `processor`.
    #[must_use]
    pub fn new(processor: Arch, bodies: usize) -> Self {
        let row = |_| vec![0.0; bodies];
        Self { processor, states: std::array::from_fn(row), commands: std::array::from_fn(row) }
    }

    /// Puts a body at `state`.
    pub fn place(&mut self, body: usize, state: &BodyState) {
        let BodyState { position: p, velocity: v, attitude: q, angular_velocity: w } = state;
        let state = [p.x, p.y, p.z, v.x, v.y, v.z, q.i, q.j, q.k, q.w, w.x, w.y, w.z];
        for (row, number) in self.states.iter_mut().zip(state) {
            row[body] = number;
        }
    }

    /// Puts a body under thrust, N, and torque, N m.
    #[inline]
    pub fn command(&mut self, body: usize, thrust: f64, torque: &Vector3<f64>) {
        for (row, number) in self.commands.iter_mut().zip([thrust, torque.x, torque.y, torque.z]) {
            row[body] = number;
        }
    }

    /// The state of a body.
    #[inline]
    #[must_use]
    pub fn state(&self, body: usize) -> BodyState {
        let number = |row: usize| self.states[row][body];
        BodyState {
            position: Vector3::new(number(0), number(1), number(2)),
            velocity: Vector3::new(number(3), number(4), number(5)),
            attitude: Quaternion::new(number(9), number(6), number(7), number(8)),
            angular_velocity: Vector3::new(number(10), number(11), number(12)),
        }
    }

    /// All of them after so many steps, each a `body` like the others.
    pub fn advance(&mut self, body: &Body, steps: u32) {
        let states = self.states.each_mut().map(Vec::as_mut_slice);
        let commands = self.commands.each_ref().map(Vec::as_slice);
        self.processor.dispatch(Advance { body, steps, states, commands });
    }
}

/// One advance of all rows, for whatever registers.
struct Advance<'a> {
    body: &'a Body,
    steps: u32,
    states: [&'a mut [f64]; STATE_NUMBERS],
    commands: [&'a [f64]; COMMAND_NUMBERS],
}

impl WithSimd for Advance<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, unit: S) {
        let Self { body, steps, states, commands } = self;
        let mut states = states.map(|row| S::as_mut_simd_f64s(row));
        let commands = commands.map(|row| S::as_simd_f64s(row));
        advance(unit, body, steps, states.each_mut().map(|(registers, _)| &mut **registers), commands.map(|row| row.0));
        advance(Scalar, body, steps, states.each_mut().map(|(_, left)| &mut **left), commands.map(|row| row.1));
    }
}

#[inline(always)]
fn advance<S: Simd>(
    unit: S,
    body: &Body,
    steps: u32,
    states: [&mut [S::f64s]; STATE_NUMBERS],
    commands: [&[S::f64s]; COMMAND_NUMBERS],
) {
    for register in 0..commands[0].len() {
        let number = |row: usize| Lanes::new(unit, states[row][register]);
        let commanded = |row: usize| Lanes::new(unit, commands[row][register]);
        let moving = BodyMotion {
            position: Vectors([number(0), number(1), number(2)]),
            velocity: Vectors([number(3), number(4), number(5)]),
            attitude: Vectors([number(6), number(7), number(8), number(9)]),
            angular_velocity: Vectors([number(10), number(11), number(12)]),
        };
        let moved =
            moving.advanced(unit, body, commanded(0), Vectors([commanded(1), commanded(2), commanded(3)]), steps);
        for axis in 0..3 {
            states[axis][register] = moved.position[axis].numbers();
            states[3 + axis][register] = moved.velocity[axis].numbers();
            states[10 + axis][register] = moved.angular_velocity[axis].numbers();
        }
        for component in 0..4 {
            states[6 + component][register] = moved.attitude[component].numbers();
        }
    }
}

#[cfg(test)]
mod tests;
