//! The sticks' setpoint for the governor: a velocity ahead, to the right and up, and a rate of turn.
//!
//! Near their centre is a dead zone; beyond it the setpoint grows from zero in proportion.

use crate::link::setpoint::Here;
use controller_core::governor::{HeadingSetpoint, Motion, Setpoint};
use controller_core::state::State;
use nalgebra::Vector3;

/// The part of its way that a stick may be from its rest and still be there.
const DEAD_BAND: f32 = 0.06;

/// The greatest speeds of the sticks' setpoint, across and up or down; and the greatest rate of turn, rad/s.
const SPEED_MAX_M_PER_S: f32 = 3.0;
const CLIMB_MAX_M_PER_S: f32 = 1.0;
const YAW_RATE_MAX_RAD_PER_S: f32 = 1.0;

/// How far up a stick begins a flight, and how far down it requests a landing.
const TAKE_OFF_STICK_MIN: f32 = 0.3;
const LANDING_STICK_MAX: f32 = -0.95;

/// Sticks, each from -1 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sticks {
    /// Pushed forward.
    pub forward: f32,
    /// Pushed to the right.
    pub right: f32,
    /// Pushed up.
    pub up: f32,
    /// Turned to the right.
    pub yaw: f32,
}

/// How far sticks are pushed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Push {
    /// All of them are in the dead zone.
    None,
    /// One of them is not: they take a flight over.
    Any,
    /// Up: they begin a flight, too.
    Up,
    /// All the way down: they request a landing.
    Down,
}

impl Sticks {
    /// What they request beside a velocity.
    pub fn vertical_push(&self) -> Push {
        match self.up {
            up if up < LANDING_STICK_MAX => Push::Down,
            up if up > TAKE_OFF_STICK_MIN => Push::Up,
            _ if [self.forward, self.right, self.up, self.yaw].iter().all(|stick| live(*stick) == 0.0) => Push::None,
            _ => Push::Any,
        }
    }

    /// Their setpoint for a vehicle in this state; none where it points straight up or down.
    pub fn setpoint(&self, state: &State) -> Option<Setpoint> {
        // Ahead, left, up.
        let velocity = Vector3::new(live(self.forward), -live(self.right), 0.0) * SPEED_MAX_M_PER_S;
        let velocity = Here::at(state)?.turned(&velocity) + Vector3::z() * (live(self.up) * CLIMB_MAX_M_PER_S);
        // To the right is clockwise from above.
        Some(Setpoint {
            motion: Motion::Velocity(velocity),
            turn: HeadingSetpoint::Rate(-live(self.yaw) * YAW_RATE_MAX_RAD_PER_S),
        })
    }
}

/// A stick's way beyond its rest, -1 to 1.
fn live(stick: f32) -> f32 {
    let beyond = (stick.abs() - DEAD_BAND).max(0.0) / (1.0 - DEAD_BAND);
    if stick < 0.0 { -beyond } else { beyond }
}
