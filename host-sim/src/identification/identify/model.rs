//! The rigid body that is fitted to a log, and its residuals.
//!
//! A flight shows accelerations, never forces: thrust scale c, mass m and inertia J appear as c/m and c/J_i only. With
//! f and tau the thrust and torque of the model's rotors ([`super::impulses`]), r_c the centre of mass (x, y), V = v -
//! w the velocity in an air that moves steadily with w across:
//!
//! ```text
//! v_c' = ((c/m) f + l) R e3 - g e3 - R diag(D/m) R' V + b             v_c = v + R (omega x r_c)
//! omega_i' = (c/J_i) (tau + a - r_c x h)_i + ((J_j - J_k)/J_i) omega_j omega_k - beta_i omega_i + e_i
//! h = (m/c) R' (v_c' + g e3)                                           all forces act at the body's origin
//! A = R' b - diag(D/m) R' V                                            but what the air does, for which a makes up
//! ```
//!
//! b is what gusts add, as the filter of [`super::noise`] knows it. So v_c' + g e3 is known from the log, whatever
//! share of it drag has: in h it is held while the unknowns move, since torques show no more of drag or thrust than
//! forces do. beta, and e about z alone, are what rotors in the air and unequal rotors may add: found, not reported. So
//! are l and a, lift and torque by the air at the hubs ([`super::hubs`]). A steady torque about x or y is a centre of
//! mass beside the origin: the two are not observable apart near hover. A steady vertical force is thrust: none is
//! supposed.
//!
//! Both sides are integrated from tick to tick, never differentiated. The residual is the measured state less the
//! integral.

use super::flight_log::{FlightLog, Moment};
use super::hubs::{Hubs, Layout};
use super::impulses::{Commands, Impulse};
use super::low_passes::LowPasses;
use controller_core::configuration::Configuration;
use nalgebra::{SVector, Vector3};

pub(crate) const UNKNOWN_COUNT: usize = 20;

/// Where they stand: ln (c m_0 / m); ln (c J_0i / J_i); S, s; u, s^2; r_c, m; D/m, 1/s; w, m/s; beta, 1/s; e_z,
/// rad/s^2; kappa_z, kappa_d; lambda, 1/m.
pub const STRENGTH_INDEX: usize = 0;
/// About x; y and z follow.
pub const INERTIA_STRENGTH_INDEX: usize = 1;
/// The whole delay, with that of the measured rates.
pub const WHOLE_DELAY_INDEX: usize = 4;
/// The squared lag.
pub const SQUARED_LAG_INDEX: usize = 5;
/// Along x; y follows.
pub const CENTRE_INDEX: usize = 6;
/// Along x; y and z follow.
pub const DRAG_INDEX: usize = 8;
const WIND_INDEX: usize = 11;
const DAMPING_INDEX: usize = 13;
const YAW_TORQUE_INDEX: usize = 16;
/// kappa_z; kappa_d and lambda follow.
const HUB_FORCE_INDEX: usize = 17;

/// All unknowns.
pub type Unknowns = SVector<f64, UNKNOWN_COUNT>;

/// Velocity along the world's axes, body rates.
pub const CHANNEL_COUNT: usize = 6;

/// Six series.
pub type Channels = [Vec<f64>; CHANNEL_COUNT];

/// At the start of a log the rotors' speeds are unknown.
const UNKNOWN_START_S: f64 = 0.5;

/// A log and the model that is fitted to it.
#[derive(Debug, Clone)]
pub struct IdentifiedModel<'a> {
    log: &'a FlightLog,
    commands: Commands,
    /// m_0, kg; J_0, kg m^2; g, m/s^2.
    mass: f64,
    inertia: Vector3<f64>,
    gravity: f64,
    layout: Layout,
    first: usize,
}

/// Where a search begins, and how far from there an unknown may be, one standard deviation: so wide that it does not
/// matter for an observable quantity; those of the hubs as wide as the numbers that RotorPy has for the Hummingbird are
/// great.
#[must_use]
pub fn prior() -> (Unknowns, Unknowns) {
    let start = [0.0, 0.0, 0.0, 0.0, 0.02, 1e-4, 0.0, 0.0, 0.3, 0.3, 0.3, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let wide =
        [0.5, 0.5, 0.5, 0.5, 0.05, 1e-3, 0.03, 0.03, 0.7, 0.7, 0.7, 5.0, 5.0, 5.0, 5.0, 5.0, 2.0, 2.0, 2.0, 0.01];
    (start.into(), wide.into())
}

impl<'a> IdentifiedModel<'a> {
    /// # Errors
    /// If the file has no rotors, or its allocation refuses a wrench of the log.
    pub fn new(log: &'a FlightLog, configuration: &Configuration) -> Result<Self, String> {
        let rotors =
            configuration.rotors().ok_or("rotors: is missing; the log's commands need a model of the rotors")?;
        let vehicle = configuration.vehicle();
        Ok(Self {
            log,
            commands: Commands::new(log, rotors)?,
            mass: vehicle.mass.into(),
            inertia: vehicle.inertia.map(f64::from),
            gravity: vehicle.gravity.into(),
            layout: Layout::of_rotors(rotors),
            first: (UNKNOWN_START_S / log.period).round() as usize,
        })
    }

    /// How long the log is, s.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.log.seconds()
    }

    /// The rotors' impulses for these unknowns.
    #[must_use]
    pub fn impulses(&self, unknowns: &Unknowns) -> Vec<Impulse> {
        self.commands.impulses(unknowns[WHOLE_DELAY_INDEX], unknowns[SQUARED_LAG_INDEX])
    }

    /// The low-passes of the log's body rates.
    #[must_use]
    pub fn low_passes(&self) -> Option<&LowPasses> {
        self.commands.low_passes.as_ref()
    }

    /// The residuals of each channel: measured less integrated. `sensed_motions` is as [`Self::sensed_motions`] has it.
    #[must_use]
    pub fn residuals(&self, unknowns: &Unknowns, impulses: &[Impulse], sensed_motions: &[SensedMotion]) -> Channels {
        let Numbers { strength, turning, drag, centre, wind, hubs } = self.numbers(unknowns);
        let damping = three(unknowns, DAMPING_INDEX);
        let yawing = Vector3::new(0.0, 0.0, unknowns[YAW_TORQUE_INDEX]);
        let of_one = turning.map(|turning| 1.0 / turning);
        let coupling = Vector3::new(of_one.y - of_one.z, of_one.z - of_one.x, of_one.x - of_one.y);
        let period = self.log.period;
        let mut velocity = Vector3::zeros();
        let mut rates = Vector3::zeros();
        let mut left = Channels::default();
        for (sample, (pair, impulse)) in self.steps(impulses).enumerate() {
            let [now, next] = pair else { break };
            let measured = now.velocity + now.attitude * now.angular_velocity.cross(&centre);
            let (apart, turned) = (measured - velocity, now.angular_velocity - rates);
            for axis in 0..3 {
                left[axis].push(apart[axis]);
                left[3 + axis].push(turned[axis]);
            }
            let up = (now.attitude * Vector3::z() + next.attitude * Vector3::z()) * 0.5;
            let airspeed = airspeed(pair, &wind);
            let dragged = now.attitude * -drag.component_mul(&airspeed);
            let carried = strength * impulse.thrust;
            velocity += up * (carried + hubs.lifted(&self.layout, &airspeed) * period)
                + (dragged - Vector3::z() * self.gravity) * period;
            let sensed =
                sensed_motions.get(sample).copied().unwrap_or_else(|| SensedMotion::hover(self.gravity * period));
            let omega = (now.angular_velocity + next.angular_velocity) * 0.5;
            let at_hubs = hubs.torque(&self.layout, &airspeed, omega.z) * (period / strength)
                + hubs.unlike(impulse, carried / period, &(sensed.air / period));
            let torque = impulse.torque + at_hubs - centre.cross(&(sensed.whole / strength));
            let across = Vector3::new(omega.y * omega.z, omega.z * omega.x, omega.x * omega.y);
            rates += turning.component_mul(&(torque + coupling.component_mul(&across) * period));
            rates += (yawing - damping.component_mul(&omega)) * period;
        }
        left
    }

    /// What an accelerometer at the centre of mass feels over each sample, m/s, body; `gusts` is b along the world's
    /// axes.
    #[must_use]
    pub fn sensed_motions(
        &self,
        unknowns: &Unknowns,
        impulses: &[Impulse],
        gusts: &[Vec<f64>; 3],
    ) -> Vec<SensedMotion> {
        let Numbers { strength, drag, wind, hubs, .. } = self.numbers(unknowns);
        let feel = |(sample, (pair, impulse)): (usize, (&[Moment], &Impulse))| {
            let gust = Vector3::from_fn(|axis, _| gusts[axis].get(sample).copied().unwrap_or(0.0));
            let gust = pair[0].attitude.inverse_transform_vector(&gust);
            let airspeed = airspeed(pair, &wind);
            let air = (gust - drag.component_mul(&airspeed)) * self.log.period;
            let carried = strength * impulse.thrust + hubs.lifted(&self.layout, &airspeed) * self.log.period;
            SensedMotion { whole: Vector3::z() * carried + air, air }
        };
        self.steps(impulses).enumerate().map(feel).collect()
    }

    /// The strength that carries the weight over the whole flight: where a search begins.
    #[must_use]
    pub fn balance(&self) -> f64 {
        let impulses = self.impulses(&prior().0);
        let (mut up, mut count) = (0.0, 0.0);
        for (pair, impulse) in self.steps(&impulses) {
            up += impulse.thrust * (pair[0].attitude * Vector3::z()).z;
            count += 1.0;
        }
        let gained = self.log.moments.last().map_or(0.0, |last| last.velocity.z)
            - self.log.moments.get(self.first).map_or(0.0, |first| first.velocity.z);
        let strength = (self.gravity * self.log.period * count + gained) / up * self.mass;
        if strength > 0.0 && strength.is_finite() { strength.ln() } else { 0.0 }
    }

    /// A hover's impulses, one for each moment but the last.
    #[must_use]
    pub fn hovering(&self, unknowns: &Unknowns) -> Vec<Impulse> {
        let thrust = self.gravity * self.log.period / self.numbers(unknowns).strength;
        vec![Impulse { thrust, torque: Vector3::zeros() }; self.log.moments.len().saturating_sub(1)]
    }

    fn steps<'b>(&'b self, impulses: &'b [Impulse]) -> impl Iterator<Item = (&'b [Moment], &'b Impulse)> {
        self.log.moments.windows(2).zip(impulses).skip(self.first)
    }

    fn numbers(&self, unknowns: &Unknowns) -> Numbers {
        Numbers {
            strength: unknowns[STRENGTH_INDEX].exp() / self.mass,
            turning: three(unknowns, INERTIA_STRENGTH_INDEX).map(f64::exp).component_div(&self.inertia),
            drag: three(unknowns, DRAG_INDEX),
            centre: Vector3::new(unknowns[CENTRE_INDEX], unknowns[CENTRE_INDEX + 1], 0.0),
            wind: Vector3::new(unknowns[WIND_INDEX], unknowns[WIND_INDEX + 1], 0.0),
            hubs: Hubs {
                along: unknowns[HUB_FORCE_INDEX],
                across: unknowns[HUB_FORCE_INDEX + 1],
                lift: unknowns[HUB_FORCE_INDEX + 2],
            },
        }
    }
}

/// Unknowns by the names of their equation: c/m, 1/kg; c/J, 1/(kg m^2); D/m, 1/s; r_c, m; w, m/s.
struct Numbers {
    strength: f64,
    turning: Vector3<f64>,
    drag: Vector3<f64>,
    centre: Vector3<f64>,
    wind: Vector3<f64>,
    hubs: Hubs,
}

fn three(unknowns: &Unknowns, at: usize) -> Vector3<f64> {
    Vector3::new(unknowns[at], unknowns[at + 1], unknowns[at + 2])
}

/// R' V between two moments, m/s, body.
fn airspeed(pair: &[Moment], wind: &Vector3<f64>) -> Vector3<f64> {
    let [now, next] = pair else { return Vector3::zeros() };
    now.attitude.inverse_transform_vector(&((now.velocity + next.velocity) * 0.5 - wind))
}

/// The specific force at the centre of mass over a sample, m/s, body.
#[derive(Debug, Clone, Copy)]
pub struct SensedMotion {
    /// R' (v_c' + g e3).
    whole: Vector3<f64>,
    /// A, of it what the air does.
    air: Vector3<f64>,
}

impl SensedMotion {
    /// A hover in still air.
    fn hover(weight: f64) -> Self {
        Self { whole: Vector3::z() * weight, air: Vector3::zeros() }
    }
}
