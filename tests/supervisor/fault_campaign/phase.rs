//! Where in a flight it fails, and what an operator says to get there.

use controller_core::governor::{HeadingSetpoint, Motion, Setpoint};
use flight::{Inputs, Mode, MotorTest, Request};
use nalgebra::Vector3;

/// A phase of a flight.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// The first tick.
    Boot,
    /// Nothing that can be certified to fly.
    Locked,
    Checks,
    Ready,
    MotorTest,
    Idling,
    /// Taking off, the rotors on their way up, on the ground.
    Spooling,
    /// Taking off, in the air.
    Climbing,
    /// At a setpoint that is a point.
    AtPoint,
    /// On setpoints that move.
    Moving,
    Holding,
    Landing,
    /// Without poses, going down by the IMU.
    Descending,
    /// Stopped in the air by the kill switch, and fallen.
    Stopped,
}

impl Phase {
    pub const ALL: [Self; 14] = [
        Self::Boot,
        Self::Locked,
        Self::Checks,
        Self::Ready,
        Self::MotorTest,
        Self::Idling,
        Self::Spooling,
        Self::Climbing,
        Self::AtPoint,
        Self::Moving,
        Self::Holding,
        Self::Landing,
        Self::Descending,
        Self::Stopped,
    ];
}

/// What an operator knows of the flight before a tick.
#[derive(Debug, Clone, Copy)]
pub struct Sight {
    /// Ticks since boot.
    pub tick: u64,
    pub mode: Mode,
    /// Ticks since the mode began.
    pub lasts: u64,
    /// How high the vehicle is, and is to fly, m.
    pub height: f64,
    pub asked: f32,
    /// us.
    pub now: u64,
}

/// Between heartbeats, and between setpoints.
const HEARTBEAT_TICKS: u64 = 100;
const SETPOINT_TICKS: u64 = 20;

/// When the operator arms, and gives the next command, since boot.
const ARM_TICK: u64 = 200;
const GO_TICK: u64 = 260;

impl Phase {
    /// Whether it has been reached, and what is to fail now fails.
    pub fn is_reached(self, sight: &Sight) -> bool {
        let Sight { tick, mode, lasts, height, asked, .. } = *sight;
        match self {
            Self::Boot => true,
            Self::Locked => mode == Mode::Locked && tick >= 100,
            Self::Checks => mode == Mode::Checks && tick >= 60,
            Self::Ready => mode == Mode::Ready && lasts >= 40,
            Self::MotorTest => mode == Mode::MotorTest && lasts >= 50,
            Self::Idling => mode == Mode::Idling && lasts >= 50,
            Self::Spooling => mode == Mode::TakingOff && lasts >= 50,
            Self::Climbing => mode == Mode::TakingOff && height > 0.5 * f64::from(asked),
            Self::AtPoint => mode == Mode::Flying && lasts >= 900,
            Self::Moving => mode == Mode::Flying && lasts >= 1_000,
            Self::Holding => mode == Mode::Holding && lasts >= 50,
            Self::Landing => mode == Mode::Landing && lasts >= 100,
            Self::Descending => mode == Mode::Descending && lasts >= 130,
            Self::Stopped => mode == Mode::Stopped && lasts >= 150,
        }
    }

    /// What the operator says in this tick, with nothing failed.
    pub fn given(self, sight: &Sight) -> Inputs<'static> {
        let Sight { tick, mode, lasts, asked, now, .. } = *sight;
        let request = match (self, tick) {
            (Self::MotorTest, ARM_TICK) => {
                Some(Request::MotorTest(MotorTest { rotor: 1, level: 0.1, duration: 2_000_000 }))
            }
            (Self::Boot | Self::Locked | Self::Checks | Self::Ready | Self::MotorTest, _) => None,
            (_, ARM_TICK) => Some(Request::Arm),
            (Self::Idling, _) => None,
            (Self::AtPoint | Self::Moving, GO_TICK) => Some(Request::FlySetpoints),
            (_, GO_TICK) => Some(Request::TakeOff(Some(asked))),
            (Self::Landing, _) if mode == Mode::Holding && lasts == 50 => Some(Request::Land),
            _ => None,
        };
        let flies = matches!(self, Self::AtPoint | Self::Moving) && tick.is_multiple_of(SETPOINT_TICKS);
        Inputs {
            request,
            ground_station: Some(now - tick % HEARTBEAT_TICKS * 10_000),
            setpoint: flies.then(|| self.setpoint(sight)),
            killed: self == Self::Stopped && mode == Mode::Holding && lasts == 50,
            ..Inputs::default()
        }
    }

    /// Whether the phase itself takes the poses away: there is no other way into it.
    pub fn loses_poses(self, sight: &Sight) -> bool {
        self == Self::Descending && sight.mode == Mode::Holding && sight.lasts == 50
    }

    /// Up to a point, and then, where setpoints move, once round in 12 s on a circle of 1 m.
    fn setpoint(self, sight: &Sight) -> Setpoint {
        let circling = self == Self::Moving && sight.mode == Mode::Flying && sight.lasts >= 800;
        let motion = if circling {
            let (sine, cosine) = (0.5 * (sight.lasts - 800) as f32 * 0.01).sin_cos();
            Motion::Velocity(Vector3::new(-sine, cosine, 0.0) * 0.5)
        } else {
            Motion::Position(Vector3::new(0.0, 0.0, sight.asked))
        };
        Setpoint { motion, turn: HeadingSetpoint::Keep }
    }
}
