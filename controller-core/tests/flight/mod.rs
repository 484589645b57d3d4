//! A pilot with a Hummingbird around it: rigid body, sensors and ground station that can be taken away.

// Every test crate that includes this module uses a part of it.
#![allow(dead_code)]

#[path = "../../../tests/support/body.rs"]
mod body;

pub use body::Body;
use controller_core::allocation::{Mixer, QuadX, Rotors};
use controller_core::certificate::certified::Certified;
use controller_core::certificate::configuration::Configuration;
use controller_core::flight::{
    ImuSample, Inputs, Memory, Outcome, Output, PERIOD, Pilot, Pose, Reason, Request, Stamped, Velocity,
};
use controller_core::governor::{GovernorLimits, Motion, Setpoint, Turn};
use controller_core::prelude::*;
use controller_core::state::Wrench;
use std::sync::LazyLock;

/// The vehicle, limits, gains and bounds of `vehicles/hummingbird.toml`, without rotors and without projection.
pub fn configuration() -> Configuration {
    let inertia = Vector3::new(3.65e-3, 3.68e-3, 7.03e-3);
    let vehicle = Vehicle::new(VehicleParameters { mass: 0.5, inertia, gravity: 9.81 }).unwrap();
    let torque_max = Vector3::new(1.0, 1.0, 0.2);
    let limits = Limits::new(LimitParameters { thrust_max: 20.0, torque_max }, &vehicle).unwrap();
    let gains = GainParameters {
        k_p: 21.867805,
        k_v: 98.16072,
        k_f: 1.6758983,
        k_s: 1.0240563,
        k_theta: 4.7553053,
        k_omega: 0.015616302,
        m_p: 1.5820053,
        m_theta: 0.056425318,
        m_omega: 0.015607581,
        delta: 0.02,
        alpha: 0.25,
    };
    let bounds = ReferenceBounds {
        horizontal_speed: 5.0,
        horizontal_acceleration: 2.4675,
        vertical_acceleration: 0.1755,
        jerk: 3.876,
        snap: 6.089,
        heading_rate: 1.316,
        heading_second_derivative: 1.7318,
    };
    Configuration::new(vehicle, limits, Gains::new(gains, &vehicle).unwrap(), bounds).unwrap()
}

pub fn rotors() -> Rotors {
    let quad =
        QuadX { arm: 0.17, thrust_coefficient: 5.57e-6, drag_coefficient: 1.36e-7, speed_min: 0.0, speed_max: 1500.0 };
    Rotors::quad_x(quad).unwrap()
}

pub fn certified() -> Certified {
    Certified::new(configuration().with_rotors(rotors()).unwrap()).unwrap()
}

/// Memory for one pilot.
pub fn memory() -> &'static mut Memory {
    Box::leak(Box::new(Memory::EMPTY))
}

/// A new pilot; certified once for all, since that takes longer than most flights here.
pub fn pilot() -> Pilot<'static> {
    static CERTIFIED: LazyLock<Certified> = LazyLock::new(certified);
    Pilot::new(Ok(&CERTIFIED), &GovernorLimits::default(), memory())
}

/// A pose as sources give it, velocity in the world.
pub fn pose(position: Vector3<f32>, velocity: Vector3<f32>, attitude: Quaternion<f32>) -> Pose {
    Pose::new(position, Velocity::World(velocity), attitude).unwrap()
}

/// Everything as it should be for a vehicle at rest and level at the origin.
pub fn at_rest(now: u64) -> Inputs {
    let imu = ImuSample { angular_velocity: Vector3::zeros(), specific_force: Vector3::new(0.0, 0.0, 9.81) };
    let pose = pose(Vector3::zeros(), Vector3::zeros(), Quaternion::new(1.0, 0.0, 0.0, 0.0));
    Inputs {
        now,
        imu: Some(Stamped { value: imu, time: now }),
        pose: Some(Stamped { value: pose, time: now }),
        ground_station: Some(now),
        ..Inputs::default()
    }
}

pub fn go_to(x: f32, y: f32, z: f32) -> Setpoint {
    Setpoint { motion: Motion::Position(Vector3::new(x, y, z)), turn: Turn::Keep }
}

/// What arrives from outside.
#[derive(Clone, Copy)]
pub struct Present {
    pub imu: bool,
    pub pose: bool,
    pub ground_station: bool,
}

/// A flight in the making.
pub struct Flight {
    pub pilot: Pilot<'static>,
    pub body: Body,
    pub present: Present,
    /// The next tick's requests; handed over once.
    pub inputs: Inputs,
    mixer: Mixer,
    certified: Certified,
    newest: Inputs,
}

impl Flight {
    /// A disarmed vehicle held at rest, level, 1 m up, heading along x.
    pub fn new() -> Self {
        let body = Body::resting(Vector3::new(0.0, 0.0, 1.0), Quaternion::new(1.0, 0.0, 0.0, 0.0));
        Self {
            pilot: pilot(),
            body,
            present: Present { imu: true, pose: true, ground_station: true },
            inputs: Inputs { now: 1_000_000, ..Inputs::default() },
            mixer: Mixer::new(&rotors()),
            certified: certified(),
            newest: Inputs::default(),
        }
    }

    /// The same, armed and let go.
    pub fn armed() -> Self {
        let mut flight = Self::new();
        flight.inputs.request = Some(Request::Arm);
        assert_eq!(flight.tick().answer, Some(Ok(())));
        flight
    }

    /// One tick and the motion until the next. Whatever the mode, the wrench is within the certificate.
    pub fn tick(&mut self) -> Outcome {
        let (state, now) = (self.body.state(), self.inputs.now);
        let imu = ImuSample { angular_velocity: state.angular_velocity, specific_force: Vector3::zeros() };
        let pose = pose(state.position, state.velocity, state.attitude);
        if self.present.imu {
            self.newest.imu = Some(Stamped { value: imu, time: now });
        }
        if self.present.pose {
            self.newest.pose = Some(Stamped { value: pose, time: now });
        }
        if self.present.ground_station {
            self.newest.ground_station = Some(now);
        }
        let Inputs { imu, pose, ground_station, .. } = self.newest;
        let outcome = self.pilot.tick(&Inputs { imu, pose, ground_station, ..self.inputs });
        self.inputs = Inputs { now: now + PERIOD, ..Inputs::default() };

        let wrench = match &outcome.output {
            Output::Thrusts(thrusts) => self.mixer.wrench(thrusts),
            Output::Stop | Output::Test { .. } => Wrench { thrust: 0.0, torque: Vector3::zeros() },
        };
        if let Some(Ok(flown)) = &outcome.flown {
            let proven = self.certified.certificate().paper().unwrap().sharp;
            assert!(f64::from(flown.wrench.thrust) <= proven.thrust.greatest, "{flown:?}");
            assert!(f64::from(flown.wrench.thrust) >= proven.thrust.least, "{flown:?}");
            let torque = flown.wrench.torque.map(|torque| f64::from(torque.abs()));
            assert!(torque.x <= proven.torque.x && torque.y <= proven.torque.y && torque.z <= proven.torque.z);
        }
        self.body.advance(self.certified.configuration().vehicle(), &wrench, PERIOD as f64 * 1e-6, 10);
        outcome
    }

    /// As many ticks; the last one's outcome.
    pub fn ticks(&mut self, count: u64) -> Outcome {
        (1..count).for_each(|_| drop(self.tick()));
        self.tick()
    }

    /// Ticks until a transition, which must be for `reason`, within `most` ticks; how many it took, and its outcome.
    pub fn until(&mut self, reason: Reason, most: u64) -> (u64, Outcome) {
        for count in 1..=most {
            let outcome = self.tick();
            if let Some(transition) = outcome.transition {
                assert_eq!(transition.reason, reason);
                return (count, outcome);
            }
        }
        panic!("no transition in {most} ticks");
    }

    /// The angle between body z and up, rad.
    pub fn tilt(&self) -> f64 {
        let q = self.body.attitude;
        2.0 * q.i.hypot(q.j).min(1.0).asin()
    }

    /// Which way body x points, rad.
    pub fn yaw(&self) -> f64 {
        let q = self.body.attitude;
        (2.0 * (q.i * q.j + q.w * q.k)).atan2(1.0 - 2.0 * (q.j * q.j + q.k * q.k))
    }
}
