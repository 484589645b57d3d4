//! What a whole set of wrenches asks of each rotor: the certificate's last link, from the law to the rotors.
//!
//! The law's thrust lies in [T_lo, T_hi] and its torque in a sum of sets C = C_1 + C_2 + … (each saturated feedback and
//! each feedforward term is one). The mixer's first step gives rotor i the thrust f_i = b_T T + b_tau . tau, with
//! (b_T, b_tau) row i of B+. Its extremes over all T and tau are exact:
//!
//! ```text
//! max f_i = max(b_T T_lo, b_T T_hi) + h(b_tau),   min f_i = min(b_T T_lo, b_T T_hi) - h(-b_tau),
//! h(d) = max { d . tau : tau in C } = h_1(d) + h_2(d) + …
//! ```
//!
//! h is the *support function* of C. A radial saturation is a ball, h = r |d|: bounding it by a box would ask for up to
//! sqrt(3) times as much.
//!
//! | [`Shape`] | set | h(d) |
//! |---|---|---|
//! | `Ball` | \|tau\| <= r | r \|d\| |
//! | `Ellipsoid` | D times the unit ball, D = diag(semi-axes) | \|D d\| |
//! | `Box` | \|tau_k\| <= w_k | sum w_k \|d_k\| |
//! | `Gyroscopic` | omega x J omega, \|omega\| <= W | W^2 times the largest eigenvalue of the form d . (omega x J omega) |
//!
//! J times a ball of radius r is the ellipsoid with semi-axes J_kk r.
//!
//! **Whom to blame.** From its share of the middle thrust (T_lo + T_hi) / 2, a rotor is displaced by half the thrust's
//! interval and by the terms of C; these add up to the extreme. The one that displaces it most towards the limit it comes
//! closest to is named; where the share alone is beyond the limit, it is the thrust. Which axis costs most is
//! a separate question: how much less the rotor would have to do if the law asked for no torque about
//! that axis. For real quadrotors it is yaw: a newton metre of it costs several times the thrust that one of roll does
//! (k_eta / k_m against 1 / arm; 4.9 times for a 0.5 kg vehicle with 10 inch rotors).
//!
//! For four rotors this is exact: a set of wrenches fits the rotors if and only if every [`RotorDemand::fits`]. For more it
//! is sufficient only: the mixer also reaches wrenches for which B+ leaves a range. T and tau count as independent.
//! Results are rounded outwards by [`ROUNDING`], which covers the f32 of the mixer's tick.

use super::collected;
use super::geometry::{ROTORS_MAX, Rotor, Rotors};
use crate::error::{ParameterError, Reason, require};
use crate::math;
use core::fmt;
use heapless::Vec;
use nalgebra::{Vector3, Vector4};

/// Relative to the sum of all contributions: eight times the rounding of single precision.
pub const ROUNDING: f64 = 1e-6;

/// Newton steps for the largest eigenvalue. Each halves the error at least (quarters it, away from a double root), so
/// that these reach the rounding of f64.
const NEWTON_STEPS: usize = 52;

/// A set of torques around zero, N m, body axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// All torques up to a length.
    Ball {
        /// Greatest |tau|, N m.
        radius: f64,
    },
    /// A ball stretched along the axes.
    Ellipsoid {
        /// Greatest torque about each axis alone, N m.
        semi_axes: Vector3<f64>,
    },
    /// Every axis by itself.
    Box {
        /// Greatest torque about each axis, N m.
        half_widths: Vector3<f64>,
    },
    /// omega x J omega over all angular velocities up to a length.
    Gyroscopic {
        /// Diagonal of J, kg m^2.
        inertia: Vector3<f64>,
        /// Greatest |omega|, rad/s.
        rate: f64,
    },
}

/// One term of the law's torque: a name for reports, and the set it fills.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TorqueTerm {
    name: &'static str,
    shape: Shape,
}

impl TorqueTerm {
    /// A term whose sizes are finite and not negative.
    ///
    /// # Errors
    /// Gives the term's name as the field.
    pub fn new(name: &'static str, shape: Shape) -> Result<Self, ParameterError> {
        let sizes = match shape {
            Shape::Ball { radius } => Vector4::new(radius, 0.0, 0.0, 0.0),
            Shape::Ellipsoid { semi_axes: v } | Shape::Box { half_widths: v } => v.push(0.0),
            Shape::Gyroscopic { inertia, rate } => inertia.push(rate),
        };
        for size in sizes.iter() {
            require(size.is_finite(), name, Reason::NotFinite)?;
            require(*size >= 0.0, name, Reason::Negative)?;
        }
        Ok(Self { name, shape })
    }

    /// The term's name.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// h(d): the greatest d . tau over the set.
    #[must_use]
    pub fn support(&self, direction: &Vector3<f64>) -> f64 {
        let length = |v: Vector3<f64>| math::sqrt_f64(v.norm_squared());
        match &self.shape {
            Shape::Ball { radius } => radius * length(*direction),
            Shape::Ellipsoid { semi_axes } => length(semi_axes.component_mul(direction)),
            Shape::Box { half_widths } => half_widths.dot(&direction.abs()),
            Shape::Gyroscopic { inertia, rate } => rate * rate * gyroscopic_gain(inertia, direction),
        }
    }
}

/// The greatest d . (omega x J omega) over unit vectors omega.
///
/// The form's matrix has a zero diagonal and a, b, c off it, so its eigenvalues solve x^3 - p x - q = 0 with
/// p = a^2 + b^2 + c^2, q = 2 a b c. All roots are real and none exceeds 2 sqrt(p/3): from there Newton's method falls
/// towards the largest without passing it, so that every step is an upper bound.
fn gyroscopic_gain(inertia: &Vector3<f64>, direction: &Vector3<f64>) -> f64 {
    let differences = Vector3::new(inertia.z - inertia.y, inertia.x - inertia.z, inertia.y - inertia.x);
    let form = differences.component_mul(direction) * 0.5;
    let p = form.norm_squared();
    let q = 2.0 * form.x * form.y * form.z;
    let mut root = 2.0 * math::sqrt_f64(p / 3.0);
    for _ in 0..NEWTON_STEPS {
        let value = root * (root * root - p) - q;
        let slope = 3.0 * root * root - p;
        if value <= 0.0 || slope <= 0.0 {
            break;
        }
        root -= value / slope;
    }
    root
}

/// Every wrench the law may command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Commands<'a> {
    thrust: (f64, f64),
    torque: &'a [TorqueTerm],
}

impl<'a> Commands<'a> {
    /// Thrust from `least` to `greatest`, N, with torques in the sum of the `torque` terms.
    ///
    /// # Errors
    /// Names `thrust` if its bounds are not finite or in the wrong order.
    pub fn new(least: f64, greatest: f64, torque: &'a [TorqueTerm]) -> Result<Self, ParameterError> {
        require(least.is_finite() && greatest.is_finite(), "thrust", Reason::NotFinite)?;
        require(least <= greatest, "thrust", Reason::NotIncreasing)?;
        Ok(Self { thrust: (least, greatest), torque })
    }

    /// The greatest row . (T, tau), and the part of it that is thrust.
    fn reach(&self, row: &Vector4<f64>) -> Reach {
        let thrust = (row.x * self.thrust.0).max(row.x * self.thrust.1);
        let torque = self.support(&torque_part(row));
        Reach { thrust, total: thrust + torque + ROUNDING * (thrust.abs() + torque) }
    }

    fn support(&self, direction: &Vector3<f64>) -> f64 {
        self.torque.iter().map(|term| term.support(direction)).sum()
    }
}

/// (tau_x, tau_y, tau_z) of a row over (T, tau).
fn torque_part(row: &Vector4<f64>) -> Vector3<f64> {
    Vector3::new(row.y, row.z, row.w)
}

struct Reach {
    thrust: f64,
    total: f64,
}

/// An end of a rotor's range.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Limit {
    /// Its least thrust.
    Minimum,
    /// Its greatest thrust.
    Maximum,
}

/// What brings a rotor towards its limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// The thrust command.
    Thrust,
    /// The torque term of this name.
    Torque(&'static str),
}

/// A torque axis of the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    /// About x.
    Roll,
    /// About y.
    Pitch,
    /// About z.
    Yaw,
}

/// The extremes of one rotor's thrust over a set of commands, and what it has. All in N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RotorDemand {
    /// The rotor, from 1.
    pub rotor: usize,
    /// Least thrust asked for.
    pub least: f64,
    /// Greatest thrust asked for.
    pub greatest: f64,
    /// Least thrust it can give.
    pub available_min: f64,
    /// Greatest thrust it can give.
    pub available_max: f64,
    /// What is left at the limit it comes closest to; negative if the demand goes beyond.
    pub margin: f64,
    /// That limit.
    pub limit: Limit,
    /// What displaces it most from its share of the middle thrust towards that limit.
    pub blame: Cause,
    /// By how much.
    pub blamed: f64,
    /// The axis whose torque costs it most on the way to that limit.
    pub weak_axis: Axis,
    /// How much less that limit would be pressed without torque about that axis.
    pub relief: f64,
}

impl RotorDemand {
    /// Whether the rotor can give all that is asked of it.
    #[must_use]
    pub fn fits(&self) -> bool {
        self.margin >= 0.0
    }

    /// What `commands` ask of rotor `number`, whose thrust is `row` of B+ times the wrench.
    #[must_use]
    pub fn new(number: usize, rotor: &Rotor, row: &Vector4<f64>, commands: &Commands) -> Self {
        let (available_min, available_max) = (f64::from(rotor.thrust_min), f64::from(rotor.thrust_max));
        let (up, down) = (commands.reach(row), commands.reach(&-row));
        let (above, below) = (available_max - up.total, -down.total - available_min);
        let (limit, margin, sign) =
            if above <= below { (Limit::Maximum, above, 1.0) } else { (Limit::Minimum, below, -1.0) };
        let towards = torque_part(row) * sign;
        let (share, spread) = (0.5 * (up.thrust - down.thrust), 0.5 * (up.thrust + down.thrust));
        let beyond = (share - available_max).max(available_min - share);
        let worse = |worst: (Cause, f64), term: &TorqueTerm| {
            let part = term.support(&towards);
            if part > worst.1 { (Cause::Torque(term.name), part) } else { worst }
        };
        let (blame, blamed) = if beyond > 0.0 {
            (Cause::Thrust, beyond)
        } else {
            commands.torque.iter().fold((Cause::Thrust, spread), worse)
        };
        let with_all_axes = commands.support(&towards);
        let (mut weak_axis, mut relief) = (Axis::Roll, f64::NEG_INFINITY);
        for (axis, place) in [(Axis::Roll, 0), (Axis::Pitch, 1), (Axis::Yaw, 2)] {
            let mut rest = towards;
            if let Some(component) = rest.get_mut(place) {
                *component = 0.0;
            }
            let without = with_all_axes - commands.support(&rest);
            if without > relief {
                (weak_axis, relief) = (axis, without);
            }
        }
        Self {
            rotor: number,
            least: -down.total,
            greatest: up.total,
            available_min,
            available_max,
            margin,
            limit,
            blame,
            blamed,
            weak_axis,
            relief,
        }
    }
}

impl fmt::Display for RotorDemand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (end, available, demand) = match self.limit {
            Limit::Minimum => ("least", self.available_min, self.least),
            Limit::Maximum => ("greatest", self.available_max, self.greatest),
        };
        let verdict = if self.fits() { "with a margin of" } else { "too much by" };
        write!(
            f,
            "rotor {}: asked for {demand:.3} N, {end} available {available:.3} N, {verdict} {:.3} N; most of it from ",
            self.rotor,
            self.margin.abs()
        )?;
        match self.blame {
            Cause::Thrust => write!(f, "thrust")?,
            Cause::Torque(name) => write!(f, "{name}")?,
        }
        let axis = match self.weak_axis {
            Axis::Roll => "roll",
            Axis::Pitch => "pitch",
            Axis::Yaw => "yaw",
        };
        write!(f, " ({:.3} N); the weak axis is {axis} ({:.3} N)", self.blamed, self.relief)
    }
}

/// What `commands` ask of each rotor, in the rotors' order.
#[must_use]
pub fn demands(rotors: &Rotors, commands: &Commands) -> Vec<RotorDemand, ROTORS_MAX> {
    let all = rotors.iter().zip(rotors.pseudo_inverse()).enumerate();
    collected(all.map(|(index, (rotor, row))| RotorDemand::new(index + 1, rotor, row, commands)))
}
