//! What fails, and how it shows: in the sensors, in the air, in what is said to the vehicle.

use estimation::estimator::PoseMeasurement;
use flight::{Battery, ImuSample, Inputs, Pose, Stamped, Velocity};
use host_sim::vehicle::reality::RealVehicle;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use scenario::body::BodyState;
use std::f64::consts::{FRAC_PI_4, PI};
use verification::piloted::{Meddler, PilotedVehicle};

/// One thing that fails. Without another word it lasts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Failure {
    /// No pose comes any more.
    PoseLost,
    /// No pose comes for a second and a half.
    PoseOutage,
    /// Poses are 3 m, -2 m, 1 m from where the vehicle is.
    PoseJumps,
    /// Poses turn by 30 degrees about the vertical.
    PoseTurns,
    /// The same pose comes over and over, with new times.
    PoseFreezes,
    /// Poses drift away at 0.7 m/s.
    PoseDrifts,
    /// The sender's frame moves by 3 m, -2 m, 1 m, and it says so.
    FrameMoves,
    /// The sender says that its poses are good to 5 m and 1 rad.
    PoseVague,
    /// Setpoints cease.
    SetpointsLost,
    /// The ground station falls silent.
    StationLost,
    BatteryLow,
    BatteryCritical,
    /// The battery is low and, under load, critical, by turns of half a second.
    BatteryWavers,
    /// A gust pushes it out of the fence.
    Gust,
    /// An updraft lifts it over the fence.
    Updraft,
    /// An updraft that the law holds against, with poses and without.
    Thermal,
    /// Wind that blows the vehicle out of its place before the law leans into it, for 12 s.
    Wind,
    /// A rotor gives 80 % of its command.
    RotorWeak,
    /// A rotor gives nothing.
    RotorLost,
    ImuLost,
    /// The IMU says the same over and over.
    ImuFreezes,
    /// The gyro is off by 0.8 rad/s about body x.
    GyroLies,
    /// The accelerometer is off by 5 m/s^2 along body z.
    AccelerometerLies,
    /// Control is late with every tick.
    Overrun,
    /// Hands turn it on its back, within half a second, where it is.
    Tipped,
    /// The same, by 45 degrees.
    Leaned,
    /// The kill switch.
    Killed,
    /// Something holds down what stands on the ground: of one phase, so not among [`Self::ALL`].
    HeldDown,
}

impl Failure {
    pub const ALL: [Self; 27] = [
        Self::PoseLost,
        Self::PoseOutage,
        Self::PoseJumps,
        Self::PoseTurns,
        Self::PoseFreezes,
        Self::PoseDrifts,
        Self::FrameMoves,
        Self::PoseVague,
        Self::SetpointsLost,
        Self::StationLost,
        Self::BatteryLow,
        Self::BatteryCritical,
        Self::BatteryWavers,
        Self::Gust,
        Self::Updraft,
        Self::Thermal,
        Self::Wind,
        Self::RotorWeak,
        Self::RotorLost,
        Self::ImuLost,
        Self::ImuFreezes,
        Self::GyroLies,
        Self::AccelerometerLies,
        Self::Overrun,
        Self::Tipped,
        Self::Leaned,
        Self::Killed,
    ];
}

/// How far poses and frames jump.
const JUMP_M: Vector3<f32> = Vector3::new(3.0, -2.0, 1.0);

/// The time in which the vehicle is tipped over.
const TIPPING_S: f64 = 0.5;

/// The time in which hands stop what they take hold of.
const GRASPING_S: f64 = 0.05;

/// Accelerations of gust, updrafts and wind, m/s^2, and for how long they last, s. The study holds 27.5 m/s^2 across,
/// beyond which it is carried away, and has 6.2 m/s^2 downwards.
const GUST_M_PER_S2_AND_S: (f64, f64) = (32.0, 2.5);
const UPDRAFT_M_PER_S2_AND_S: (f64, f64) = (7.2, 5.0);
const THERMAL_M_PER_S2_AND_S: (f64, f64) = (2.8, 5.0);
const WIND_M_PER_S2_AND_S: (f64, f64) = (28.0, 12.0);

/// What holds a vehicle down, m/s^2: more than its thrust.
const HELD_DOWN: f64 = 30.0;

/// What has failed so far, and since when, us.
#[derive(Debug, Default)]
pub struct Failures {
    failed: Vec<(Failure, u64)>,
    frozen_pose: Option<Pose>,
    frozen_sample: Option<ImuSample>,
    /// Where it was picked up.
    held: Option<BodyState>,
    mass: f64,
}

impl Failures {
    pub fn none(mass: f32) -> Self {
        Self { mass: mass.into(), ..Self::default() }
    }

    /// This fails now.
    pub fn strike(&mut self, failure: Failure, vehicle: &mut PilotedVehicle) {
        self.failed.push((failure, vehicle.now()));
        match failure {
            Failure::RotorWeak => vehicle.weaken(2, 0.8),
            Failure::RotorLost => vehicle.weaken(0, 0.0),
            Failure::Tipped | Failure::Leaned => self.held = Some(*vehicle.vehicle().state()),
            _ => {}
        }
    }

    /// For how long a failure has been there at `now`, s.
    pub fn since(&self, failure: Failure, now: u64) -> Option<f64> {
        let (_, since) = self.failed.iter().find(|(failed, _)| *failed == failure)?;
        Some(now.saturating_sub(*since) as f64 * 1e-6)
    }

    pub fn has(&self, failure: Failure) -> bool {
        self.failed.iter().any(|(failed, _)| *failed == failure)
    }

    /// The pilot's inputs besides its sensors, from those without a failure.
    pub fn spoil(&self, mut given: Inputs<'static>, heartbeat: &mut Option<u64>) -> Inputs<'static> {
        if !self.has(Failure::StationLost) {
            *heartbeat = given.ground_station;
        }
        given.ground_station = *heartbeat;
        if self.has(Failure::SetpointsLost) {
            given.setpoint = None;
        }
        let half_seconds = self.since(Failure::BatteryWavers, given.now).map(|since| (2.0 * since) as u64);
        if self.has(Failure::BatteryLow) || half_seconds.is_some() {
            given.battery = Battery::Low;
        }
        if self.has(Failure::BatteryCritical) || half_seconds.is_some_and(|count| count % 2 == 1) {
            given.battery = Battery::Critical;
        }
        given.is_late = self.has(Failure::Overrun);
        given.killed |= self.has(Failure::Killed);
        given
    }
}

impl Meddler for Failures {
    /// What hands and air do to the vehicle.
    fn act(&mut self, vehicle: &mut RealVehicle, now: u64) {
        let blows = |failure, (acceleration, lasts): (f64, f64)| match self.since(failure, now) {
            Some(since) if since < lasts => acceleration,
            _ => 0.0,
        };
        // What stands is in the lee of the ground.
        let in_the_air = if vehicle.stands() { 0.0 } else { 1.0 };
        let across =
            (blows(Failure::Gust, GUST_M_PER_S2_AND_S) + blows(Failure::Wind, WIND_M_PER_S2_AND_S)) * in_the_air;
        let upwards = blows(Failure::Updraft, UPDRAFT_M_PER_S2_AND_S) + blows(Failure::Thermal, THERMAL_M_PER_S2_AND_S);
        let downwards = if self.has(Failure::HeldDown) { HELD_DOWN } else { 0.0 };
        vehicle.push(Vector3::new(across, 0.0, upwards - downwards) * self.mass, Vector3::zeros());
        for (failure, angle) in [(Failure::Tipped, PI), (Failure::Leaned, FRAC_PI_4)] {
            let (Some(since), Some(held)) = (self.since(failure, now), &self.held) else { continue };
            if since > TIPPING_S {
                continue;
            }
            let rate = if since < TIPPING_S { angle / TIPPING_S } else { 0.0 };
            let turned = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), since / TIPPING_S * angle);
            let attitude = UnitQuaternion::new_normalize(held.attitude) * turned;
            let grasped = (since / GRASPING_S).min(1.0);
            vehicle.place(&BodyState {
                position: held.position + held.velocity * (GRASPING_S * grasped * (1.0 - 0.5 * grasped)),
                velocity: held.velocity * (1.0 - grasped),
                attitude: attitude.into_inner(),
                angular_velocity: Vector3::new(rate, 0.0, 0.0),
            });
        }
    }

    fn sample(&mut self, sample: ImuSample, _: u64) -> Option<ImuSample> {
        let mut sample = sample;
        if self.has(Failure::GyroLies) {
            sample.angular_velocity.x += 0.8;
        }
        if self.has(Failure::AccelerometerLies) {
            sample.specific_force.z += 5.0;
        }
        if self.has(Failure::ImuFreezes) {
            sample = *self.frozen_sample.get_or_insert(sample);
        }
        (!self.has(Failure::ImuLost)).then_some(sample)
    }

    fn pose(&mut self, pose: Stamped<Pose>, now: u64) -> Option<Stamped<PoseMeasurement>> {
        let Stamped { value: mut pose, time } = pose;
        if self.has(Failure::PoseLost) || self.since(Failure::PoseOutage, now).is_some_and(|since| since < 1.5) {
            return None;
        }
        if self.has(Failure::PoseFreezes) {
            pose = *self.frozen_pose.get_or_insert(pose);
        }
        let (mut position, mut attitude) = (pose.position(), pose.attitude());
        if self.has(Failure::PoseJumps) {
            position += JUMP_M;
        }
        if self.has(Failure::FrameMoves) {
            position += JUMP_M;
        }
        if let Some(since) = self.since(Failure::PoseDrifts, now) {
            position.x += 0.7 * since as f32;
        }
        if self.has(Failure::PoseTurns) {
            attitude = Quaternion::new(0.25_f32.cos(), 0.0, 0.0, 0.25_f32.sin()) * attitude;
        }
        let value = PoseMeasurement::new(&Pose::new(position, Velocity::World(Vector3::zeros()), attitude).unwrap());
        let value = if self.has(Failure::PoseVague) { value.deviations(5.0, 1.0) } else { value };
        Some(Stamped { value: value.reset_counter(u8::from(self.has(Failure::FrameMoves))), time })
    }
}
