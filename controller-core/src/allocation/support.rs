//! The demand of a whole set of wrenches on each rotor: the certificate's last link, from the law to the rotors.
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
//! h is the *support function* of C. A radial saturation is a ball, h = r |d|: bounding it by a box would demand up to
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
//! For four rotors this is exact: a set of wrenches fits the rotors if and only if every [`RotorDemand::fits`]. For
//! more it is sufficient only: the mixer also reaches wrenches for which B+ leaves a range. T and tau count as
//! independent. Results are rounded outwards by [`ROUNDING`], which covers the f32 of the mixer's tick.

use super::collected;
use super::geometry::{ROTORS_MAX, Rotor, Rotors};
use crate::error::{ParameterError, Reason, require};
use crate::math;
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

    /// The greatest row . (T, tau), rounded outwards.
    fn greatest(&self, row: &Vector4<f64>) -> f64 {
        let thrust = (row.x * self.thrust.0).max(row.x * self.thrust.1);
        let direction = torque_part(row);
        let torque: f64 = self.torque.iter().map(|term| term.support(&direction)).sum();
        thrust + torque + ROUNDING * (thrust.abs() + torque)
    }
}

/// (tau_x, tau_y, tau_z) of a row over (T, tau).
#[must_use]
pub fn torque_part(row: &Vector4<f64>) -> Vector3<f64> {
    Vector3::new(row.y, row.z, row.w)
}

/// The extremes of one rotor's thrust over a set of commands, and what it has. All in N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RotorDemand {
    /// Least commanded thrust.
    pub least: f64,
    /// Greatest commanded thrust.
    pub greatest: f64,
    /// Least thrust it can give.
    pub available_min: f64,
    /// Greatest thrust it can give.
    pub available_max: f64,
}

impl RotorDemand {
    /// The demand of `commands` on `rotor`, whose thrust is `row` of B+ times the wrench.
    #[must_use]
    pub fn new(rotor: &Rotor, row: &Vector4<f64>, commands: &Commands) -> Self {
        Self {
            least: -commands.greatest(&-row),
            greatest: commands.greatest(row),
            available_min: f64::from(rotor.thrust_min),
            available_max: f64::from(rotor.thrust_max),
        }
    }

    /// Whether the rotor's range covers its demand.
    #[must_use]
    pub fn fits(&self) -> bool {
        self.least >= self.available_min && self.greatest <= self.available_max
    }
}

/// The demand of `commands` on each rotor, in the rotors' order.
#[must_use]
pub fn demands(rotors: &Rotors, commands: &Commands) -> Vec<RotorDemand, ROTORS_MAX> {
    let all = rotors.iter().zip(rotors.pseudo_inverse());
    collected(all.map(|(rotor, row)| RotorDemand::new(rotor, row, commands)))
}
