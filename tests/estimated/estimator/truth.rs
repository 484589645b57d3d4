//! What really happens: flights recorded every millisecond.

use controller_core::certificate::certified::Certified;
use controller_core::law::Law;
use host_sim::flight::tasks::recovery;
use host_sim::vehicle::SimulatedVehicle;
use host_sim::vehicle::actuators::ActuatorDemand;
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use scenario::Scenario;
use scenario::body::BodyState;
use std::path::Path;

const GRAVITY_M_PER_S2: f64 = 9.81;

/// A vehicle at an instant.
#[derive(Debug, Clone, Copy)]
pub struct Moment {
    pub position: Vector3<f64>,
    pub velocity: Vector3<f64>,
    pub attitude: UnitQuaternion<f64>,
    /// rad/s, body.
    pub rate: Vector3<f64>,
    /// Specific force, m/s^2, body.
    pub force: Vector3<f64>,
}

/// A flight, one moment a millisecond.
pub struct Truth {
    pub name: &'static str,
    pub moments: Vec<Moment>,
    /// From here on errors count, ms.
    pub counts_from: usize,
}

impl Truth {
    /// In one place for 22 s.
    pub fn hover() -> Self {
        Self::along("hover", 22_000, |_| Vector3::new(1.0, -2.0, 1.5))
    }

    /// 1 m in radius, once in 4 s, for 22 s; tilted as its accelerations need, turning slowly to and fro.
    pub fn circle() -> Self {
        let omega = std::f64::consts::FRAC_PI_2;
        Self::along("circle", 22_000, move |t| Vector3::new((omega * t).cos(), (omega * t).sin(), 1.5))
    }

    /// A path, four times differentiable, flown with the thrust along its acceleration and gravity.
    fn along(name: &'static str, milliseconds: usize, path: impl Fn(f64) -> Vector3<f64>) -> Self {
        let h = 1e-3;
        let acceleration = |t: f64| (path(t + h) - path(t) * 2.0 + path(t - h)) / (h * h);
        let attitude = |t: f64| {
            let heading = 0.5 * t.sin();
            let up = (acceleration(t) + Vector3::z() * GRAVITY_M_PER_S2).normalize();
            let left = up.cross(&Vector3::new(heading.cos(), heading.sin(), 0.0)).normalize();
            let axes = Matrix3::from_columns(&[left.cross(&up), left, up]);
            UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes))
        };
        let moment = |n: usize| {
            let t = n as f64 * 1e-3;
            let attitude_now = attitude(t);
            let force = attitude_now.inverse_transform_vector(&(acceleration(t) + Vector3::z() * GRAVITY_M_PER_S2));
            Moment {
                position: path(t),
                velocity: (path(t + h) - path(t - h)) / (2.0 * h),
                attitude: attitude_now,
                rate: (attitude(t - h).inverse() * attitude(t + h)).scaled_axis() / (2.0 * h),
                force,
            }
        };
        Self { name, moments: (0..=milliseconds).map(moment).collect(), counts_from: 2_000 }
    }

    /// The certified Hummingbird, drag and rotor lag on: held upside down for 3 s, then let go, upright and at rest
    /// again after a few seconds. The plant moves in steps of 1 ms, the law ticks every 10.
    pub fn recovery() -> Self {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../vehicles");
        let file = Scenario::load(&folder.join("hummingbird.toml")).unwrap();
        let scenario = recovery(&file, 12.0).unwrap();
        let certified = Certified::new(scenario.configuration.clone()).unwrap();
        let mut law = Law::new(&certified, scenario.timing.period() as f32).unwrap();
        let mut vehicle = SimulatedVehicle::new(&scenario, certified.configuration());
        assert_eq!((scenario.timing.period_us, scenario.timing.steps_per_tick), (10_000, 10));
        let mut states = vec![scenario.initial];
        for tick in 0..1_200 {
            let reference = scenario.trajectory.at(tick * 10_000);
            let (wrench, _) = law.step(&vehicle.state().measured(), &reference).unwrap();
            let commanded = wrench.scaled(1.0 / law.thrust_scale());
            let mut clipped = false;
            for _ in 0..10 {
                clipped |= vehicle.hold(&ActuatorDemand::Wrench(commanded), 1).unwrap().0;
                states.push(*vehicle.state());
            }
            if clipped {
                law.hold_estimates();
            }
        }
        let last = states.last().unwrap();
        assert!(last.attitude.as_vector().z.abs() + last.velocity.norm() < 0.1, "no recovery: {last:?}");
        let held = std::iter::repeat_n(states[0], 3_000);
        let states: Vec<BodyState> = held.chain(states).collect();
        let moments = (0..states.len()).map(|n| moment(&states, n)).collect();
        Self { name: "recovery", moments, counts_from: 2_500 }
    }

    /// The same on a vehicle whose rotors shake the sensor: a gyro by 0.5 rad/s and an accelerometer by 5 m/s^2 on each
    /// axis, at 97 Hz, which the law's ticks fold to 3 Hz.
    pub fn shaken(self) -> Self {
        let mut moments = self.moments;
        for (n, moment) in moments.iter_mut().enumerate() {
            let phase = std::f64::consts::TAU * 97.0 * n as f64 * 1e-3;
            let shake = Vector3::new(phase.sin(), (phase + 2.0).sin(), (phase + 4.0).sin());
            moment.rate += shake * 0.5;
            moment.force += Vector3::new(shake.z, shake.x, shake.y) * 5.0;
        }
        Self { name: "shaken", moments, ..self }
    }

    /// How long it lasts, ms.
    pub fn milliseconds(&self) -> usize {
        self.moments.len() - 1
    }
}

/// A recorded state with the force that its velocities show.
fn moment(states: &[BodyState], n: usize) -> Moment {
    let (before, after) = (n.saturating_sub(1), (n + 1).min(states.len() - 1));
    let seconds = (after - before) as f64 * 1e-3;
    let acceleration = (states[after].velocity - states[before].velocity) / seconds;
    let BodyState { position, velocity, attitude, angular_velocity: rate } = states[n];
    let attitude = UnitQuaternion::new_normalize(attitude);
    let force = attitude.inverse_transform_vector(&(acceleration + Vector3::z() * GRAVITY_M_PER_S2));
    Moment { position, velocity, attitude, rate, force }
}
