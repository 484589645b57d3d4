//! A pilot with a Hummingbird around it: rigid body, sensors and ground station that can be taken away, or lie.
//!
//! The IMU's increments are exact: from attitude and velocity at both ends of each 5 ms. Poses come every tick, exact
//! and on time.

// Every test crate that includes this module uses a part of it.
#![allow(dead_code)]

#[path = "../../../tests/support/body.rs"]
mod body;
#[path = "../../../controller-core/tests/support/hummingbird.rs"]
mod hummingbird;
pub mod outputs;

pub use body::Body;
use controller_core::allocation::Mixer;
use controller_core::certificate::certified::Certified;
use controller_core::governor::{GovernorLimits, HeadingSetpoint, Motion, Setpoint};
use controller_core::prelude::*;
use controller_core::state::Wrench;
use estimation::estimator::{Clipped, Estimator, Increment, PoseMeasurement, Settings};
use estimation::imu::ImuFault;
use flight::{
    Aboard, Battery, FlightSettings, Inputs, Memory, MissionItem, NoPolicy, Outcome, Output, Pilot, Pose, Reason,
    Refusal, Request, Stamped, Stored, Velocity,
};
pub use hummingbird::{certified, paper_law as configuration, rotors};
use nalgebra::UnitQuaternion;
use std::sync::LazyLock;

/// The time between ticks.
pub const PERIOD_US: u64 = 10_000;

/// Memory for one pilot.
pub fn memory() -> &'static mut Memory {
    Box::leak(Box::new(Memory::EMPTY))
}

/// An estimator for one pilot.
pub fn estimator() -> &'static mut Estimator {
    Box::leak(Box::new(Estimator::new(&Settings::bmi088(configuration().vehicle()))))
}

/// A new pilot; certified once for all, since that takes longer than most flights here.
pub fn pilot() -> Pilot<'static> {
    static CERTIFIED: LazyLock<Certified> = LazyLock::new(certified);
    Pilot::new(Ok(&CERTIFIED), &GovernorLimits::default(), &FlightSettings::DEFAULT, PERIOD_US, estimator(), memory())
}

/// A pose as sources give it, at rest.
pub fn pose(position: Vector3<f32>, attitude: Quaternion<f32>) -> PoseMeasurement {
    PoseMeasurement::new(&Pose::new(position, Velocity::World(Vector3::zeros()), attitude).unwrap())
}

/// What a tick is handed.
#[derive(Debug, Clone, Default)]
pub struct Handed {
    pub now: u64,
    pub increments: Vec<Increment>,
    pub under_way: Option<Increment>,
    pub body_rate: Option<Stamped<Vector3<f32>>>,
    pub specific_force: Option<Stamped<Vector3<f32>>>,
    pub imu_fault: Option<ImuFault>,
    pub poses: Vec<Stamped<PoseMeasurement>>,
    pub ground_station: Option<u64>,
    pub request: Option<Request>,
    pub disarm: bool,
    pub killed: bool,
    pub is_busy: bool,
    pub lost: Option<Stored>,
    pub is_clock_doubtful: bool,
    pub motors_fail: bool,
    pub battery: Battery,
    pub is_late: bool,
    pub setpoint: Option<Setpoint>,
    pub mission_item: Option<MissionItem>,
}

impl Handed {
    pub fn to<P: Aboard>(&self, pilot: &mut Pilot<'_, P>) -> Outcome {
        let Self {
            now,
            increments,
            under_way,
            body_rate,
            specific_force,
            imu_fault,
            poses,
            ground_station,
            request,
            disarm,
            killed,
            is_busy,
            lost,
            is_clock_doubtful,
            motors_fail,
            battery,
            is_late,
            setpoint,
            mission_item,
        } = self;
        pilot.tick(&Inputs {
            now: *now,
            increments,
            under_way: *under_way,
            body_rate: *body_rate,
            specific_force: *specific_force,
            rotor_speeds: None,
            imu_fault: *imu_fault,
            poses,
            ground_station: *ground_station,
            request: *request,
            disarm: *disarm,
            killed: *killed,
            is_busy: *is_busy,
            lost: *lost,
            is_clock_doubtful: *is_clock_doubtful,
            motors_fail: *motors_fail,
            battery: *battery,
            is_late: *is_late,
            setpoint_late: 0.0,
            setpoint: *setpoint,
            mission_item: *mission_item,
        })
    }
}

/// What an IMU does that rests with `attitude`.
pub fn resting_imu(start: u64, end: u64, attitude: &Quaternion<f32>) -> Increment {
    let up = UnitQuaternion::new_normalize(*attitude).inverse_transform_vector(&Vector3::z());
    let delta_velocity = up * (9.81 * (end - start) as f32 * 1e-6);
    Increment { start, end, delta_angle: Vector3::zeros(), delta_velocity, clipped: Clipped::NEITHER }
}

/// Everything as it should be for a vehicle at rest at the origin with `attitude`, after a period.
pub fn at_rest_with(attitude: &Quaternion<f32>, now: u64) -> Handed {
    let halves = [(now - PERIOD_US, now - PERIOD_US / 2), (now - PERIOD_US / 2, now)];
    Handed {
        now,
        increments: halves.iter().map(|&(start, end)| resting_imu(start, end, attitude)).collect(),
        body_rate: Some(Stamped { value: Vector3::zeros(), time: now }),
        poses: vec![Stamped { value: pose(Vector3::zeros(), *attitude), time: now }],
        ground_station: Some(now),
        ..Handed::default()
    }
}

/// The same, level.
pub fn at_rest(now: u64) -> Handed {
    at_rest_with(&Quaternion::new(1.0, 0.0, 0.0, 0.0), now)
}

/// A pilot that has been at rest for as long as arming needs, up to `now`.
pub fn settled(now: u64) -> Pilot<'static> {
    let mut pilot = pilot();
    for tick in (0..SETTLING_TICKS).rev() {
        at_rest(now - tick * PERIOD_US).to(&mut pilot);
    }
    pilot
}

/// Where flights start.
pub const GROUND_HEIGHT_M: f64 = 0.9;

/// Ticks from idling to the law's thrusts.
pub const SPOOLING_TICKS: u64 = 100;

/// Ticks after which a vehicle at rest may be armed: half a second for the estimate to begin, and a second.
pub const SETTLING_TICKS: u64 = 160;

pub fn go_to(x: f32, y: f32, z: f32) -> Setpoint {
    Setpoint { motion: Motion::Position(Vector3::new(x, y, z)), turn: HeadingSetpoint::Keep }
}

/// What arrives from outside.
#[derive(Clone, Copy)]
pub struct Present {
    pub imu: bool,
    pub pose: bool,
    pub ground_station: bool,
}

/// The pose of the body that is sent at a time, us.
pub type PoseSource = Box<dyn FnMut(&Body, u64) -> Stamped<PoseMeasurement>>;

/// The truth, displaced by `offset` (m, world) and turned by `turn` on the left.
pub fn displaced(body: &Body, time: u64, offset: &Vector3<f64>, turn: &Vector3<f64>) -> Stamped<PoseMeasurement> {
    let attitude = UnitQuaternion::from_scaled_axis(*turn).into_inner() * body.attitude;
    Stamped { value: pose((body.position + offset).cast(), attitude.cast()), time }
}

/// A flight in the making.
pub struct Flight<P = NoPolicy> {
    pub pilot: Pilot<'static, P>,
    pub body: Body,
    pub present: Present,
    /// The next tick's requests; handed over once.
    pub inputs: Handed,
    /// The source of poses; the truth, at first.
    pub source: PoseSource,
    /// What becomes of the IMU's increments.
    pub imu: Box<dyn FnMut(&mut Increment)>,
    /// What the gyro shows beside the truth, rad/s.
    pub gyro_bias: Vector3<f32>,
    /// Where the ground is, m: a body there does not fall, slide or tilt.
    pub ground: f64,
    /// Whether something carries its weight.
    pub weightless: bool,
    /// The mission's items.
    pub mission: Vec<MissionItem>,
    mixer: Mixer,
    certified: Certified,
    ground_station: Option<u64>,
    body_rate: Option<Stamped<Vector3<f32>>>,
    increments: Vec<Increment>,
}

impl Flight {
    /// A disarmed vehicle at rest, level, on ground that is 0.9 m up, heading along x.
    pub fn new() -> Self {
        Self::with_pilot(pilot(), certified())
    }

    /// The same after two seconds: as long as the estimate takes to begin and to prove itself.
    pub fn settled() -> Self {
        Self::new().settle()
    }

    /// The same, armed and idling.
    pub fn idling() -> Self {
        Self::settled().idle()
    }

    /// The same, flying setpoints, at the first of which it rests, 1 m up; the ground gone from under it.
    pub fn armed() -> Self {
        Self::idling().fly()
    }
}

impl<P: Aboard> Flight<P> {
    /// The same of a vehicle under the extended law that carries `policy`.
    pub fn carrying(policy: P) -> Self {
        let certified = Certified::new(hummingbird::extended_law()).unwrap();
        let (limits, settings) = (GovernorLimits::default(), FlightSettings::DEFAULT);
        let pilot = Pilot::carrying(Ok(&certified), &limits, &settings, PERIOD_US, estimator(), memory(), policy);
        Self::with_pilot(pilot, certified)
    }

    fn with_pilot(pilot: Pilot<'static, P>, certified: Certified) -> Self {
        let body = Body::resting(Vector3::new(0.0, 0.0, GROUND_HEIGHT_M), Quaternion::new(1.0, 0.0, 0.0, 0.0));
        let inputs = Handed { now: 1_000_000, ..Handed::default() };
        Self {
            pilot,
            body,
            present: Present { imu: true, pose: true, ground_station: true },
            inputs,
            source: Box::new(|body, time| displaced(body, time, &Vector3::zeros(), &Vector3::zeros())),
            imu: Box::new(|_| {}),
            gyro_bias: Vector3::zeros(),
            ground: GROUND_HEIGHT_M,
            weightless: false,
            mission: Vec::new(),
            mixer: Mixer::new(&rotors()),
            certified,
            ground_station: None,
            body_rate: None,
            increments: Vec::new(),
        }
    }

    pub fn settle(mut self) -> Self {
        self.ticks(200);
        self
    }

    pub fn idle(mut self) -> Self {
        self.inputs.request = Some(Request::Arm);
        assert_eq!(self.tick().answer, Some(Ok(())));
        self
    }

    pub fn fly(mut self) -> Self {
        self.inputs.request = Some(Request::FlySetpoints);
        self.inputs.setpoint = Some(go_to(0.0, 0.0, 1.0));
        self.until(Reason::SetpointsCommanded, 1);
        self.ticks(SPOOLING_TICKS + 1_000);
        self.ground = f64::NEG_INFINITY;
        self
    }

    /// One tick and the motion until the next. Whatever the mode, the wrench is within the certificate.
    pub fn tick(&mut self) -> Outcome {
        let now = self.inputs.now;
        let mut increments = std::mem::take(&mut self.increments);
        increments.iter_mut().for_each(|imu| imu.delta_angle += self.gyro_bias * imu.seconds());
        increments.iter_mut().for_each(&mut self.imu);
        if self.present.imu {
            self.inputs.increments = increments;
            let body_rate = self.body.angular_velocity.cast() + self.gyro_bias;
            self.body_rate = Some(Stamped { value: body_rate, time: now });
        }
        self.inputs.body_rate = self.body_rate;
        if self.present.pose {
            self.inputs.poses = vec![(self.source)(&self.body, now)];
        }
        if self.present.ground_station {
            self.ground_station = Some(now);
        }
        self.inputs.ground_station = self.ground_station;
        let item = self.pilot.mission_item(self.inputs.request.as_ref());
        self.inputs.mission_item = item.and_then(|item| self.mission.get(usize::from(item)).copied());
        let outcome = self.inputs.to(&mut self.pilot);
        self.inputs = Handed { now: now + PERIOD_US, ..Handed::default() };

        let wrench = match &outcome.output {
            Output::Thrusts(thrusts) => self.mixer.wrench(thrusts),
            Output::Stop | Output::Idle | Output::Test { .. } | Output::Word { .. } => {
                Wrench { thrust: 0.0, torque: Vector3::zeros() }
            }
        };
        if let Some(Ok(flown)) = &outcome.flown {
            let certificate = self.certified.certificate();
            let (thrust, most) = (certificate.thrust(), certificate.torque());
            assert!(f64::from(flown.wrench.thrust) <= thrust.max, "{flown:?}");
            assert!(f64::from(flown.wrench.thrust) >= thrust.min, "{flown:?}");
            let torque = flown.wrench.torque.map(|torque| f64::from(torque.abs()));
            assert!(torque.x <= most.x && torque.y <= most.y && torque.z <= most.z);
        }
        for start in [now, now + PERIOD_US / 2] {
            let increment = self.move_on(&wrench, start, start + PERIOD_US / 2);
            self.increments.push(increment);
        }
        outcome
    }

    /// The motion between two times, us, and the IMU's increments of it.
    fn move_on(&mut self, wrench: &Wrench, start: u64, end: u64) -> Increment {
        let vehicle = *self.certified.configuration().vehicle();
        let (before, seconds) = (self.body, (end - start) as f64 * 1e-6);
        if self.weightless {
            self.body.position += self.body.velocity * seconds;
        } else {
            self.body.advance(&vehicle, wrench, seconds, 5);
            self.stay_above_ground(&before);
        }
        let attitude = UnitQuaternion::new_normalize(before.attitude);
        let gravity = Vector3::new(0.0, 0.0, f64::from(vehicle.gravity));
        let gained = self.body.velocity - before.velocity + gravity * seconds;
        let turned = attitude.inverse() * UnitQuaternion::new_normalize(self.body.attitude);
        Increment {
            start,
            end,
            delta_angle: turned.scaled_axis().cast(),
            delta_velocity: attitude.inverse_transform_vector(&gained).cast(),
            clipped: Clipped::NEITHER,
        }
    }

    /// What the ground holds up stays as it was `before`, but for a height at which it comes down.
    fn stay_above_ground(&mut self, before: &Body) {
        if self.body.position.z <= self.ground {
            let place = Vector3::new(before.position.x, before.position.y, self.ground);
            self.body = Body::resting(place, before.attitude);
        }
    }

    /// The answer to a request, a tick later.
    pub fn answer(&mut self, request: Request) -> Result<(), Refusal> {
        self.inputs.request = Some(request);
        self.tick().answer.unwrap()
    }

    /// As many ticks; the last one's outcome.
    pub fn ticks(&mut self, count: u64) -> Outcome {
        (1..count).for_each(|_| {
            self.tick();
        });
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
