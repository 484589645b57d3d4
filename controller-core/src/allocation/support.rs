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
//! independent. Results are rounded outwards by [`TICK_ROUNDING_SHARE`], which covers the f32 of the mixer's tick.

use super::collected;
use super::geometry::{ROTORS_MAX, Rotor, Rotors};
use crate::error::{ParameterError, Reason, require};
use crate::math::real::Real;
use heapless::Vec;
use nalgebra::{Vector3, Vector4};

/// Relative to the sum of all contributions: eight times the rounding of single precision.
pub const TICK_ROUNDING_SHARE: f64 = 1e-6;

/// A set of torques around zero, N m, body axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape<R = f64> {
    /// All torques up to a length.
    Ball {
        /// Greatest |tau|, N m.
        radius: R,
    },
    /// A ball stretched along the axes.
    Ellipsoid {
        /// Greatest torque about each axis alone, N m.
        semi_axes: Vector3<R>,
    },
    /// Every axis by itself.
    Box {
        /// Greatest torque about each axis, N m.
        half_widths: Vector3<R>,
    },
    /// omega x J omega over all angular velocities up to a length.
    Gyroscopic {
        /// Diagonal of J, kg m^2.
        inertia: Vector3<R>,
        /// Greatest |omega|, rad/s.
        rate: R,
    },
}

/// One term of the law's torque: a name for reports, and the set it fills.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TorqueTerm<R = f64> {
    name: &'static str,
    shape: Shape<R>,
}

impl<R: Real> TorqueTerm<R> {
    /// A term whose sizes are finite and not negative.
    ///
    /// # Errors
    /// Gives the term's name as the field.
    pub fn new(name: &'static str, shape: Shape<R>) -> Result<Self, ParameterError> {
        let zero = R::from(0.0);
        let sizes = match shape {
            Shape::Ball { radius } => Vector4::new(radius, zero, zero, zero),
            Shape::Ellipsoid { semi_axes: v } | Shape::Box { half_widths: v } => v.push(zero),
            Shape::Gyroscopic { inertia, rate } => inertia.push(rate),
        };
        for size in sizes.iter() {
            require(size.lower().is_finite() && size.upper().is_finite(), name, Reason::NotFinite)?;
            require(size.upper() >= 0.0, name, Reason::Negative)?;
        }
        Ok(Self { name, shape })
    }

    /// The term's name.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// h(d): the greatest d . tau over the set.
    pub fn support(&self, direction: &Vector3<R>) -> R {
        let length = |v: Vector3<R>| square(&v).sqrt_of_rounded();
        match &self.shape {
            Shape::Ball { radius } => *radius * length(*direction),
            Shape::Ellipsoid { semi_axes } => length(semi_axes.component_mul(direction)),
            Shape::Box { half_widths } => sum(&half_widths.component_mul(&direction.map(R::abs))),
            Shape::Gyroscopic { inertia, rate } => *rate * *rate * gyroscopic_gain(inertia, direction),
        }
    }
}

/// The greatest d . (omega x J omega) over unit vectors omega.
///
/// The form's matrix has a zero diagonal and a, b, c off it, so its eigenvalues solve x^3 - p x - q = 0 with
/// p = a^2 + b^2 + c^2, q = 2 a b c, and all roots are real.
fn gyroscopic_gain<R: Real>(inertia: &Vector3<R>, direction: &Vector3<R>) -> R {
    let differences = Vector3::new(inertia.z - inertia.y, inertia.x - inertia.z, inertia.y - inertia.x);
    let form = differences.component_mul(direction).map(|product| product * 0.5);
    R::max_cubic_root(square(&form), form.x * 2.0 * form.y * form.z)
}

fn sum<R: Real>(v: &Vector3<R>) -> R {
    v.x + v.y + v.z
}

fn square<R: Real>(v: &Vector3<R>) -> R {
    sum(&v.component_mul(v))
}

/// Every wrench the law may command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Commands<'a, R = f64> {
    thrust: (R, R),
    torque: &'a [TorqueTerm<R>],
}

impl<'a, R: Real> Commands<'a, R> {
    /// Thrust from `min` to `max`, N, with torques in the sum of the `torque` terms.
    ///
    /// # Errors
    /// Names `thrust` if its bounds are not finite or in the wrong order.
    pub fn new(min: R, max: R, torque: &'a [TorqueTerm<R>]) -> Result<Self, ParameterError> {
        let (lower, upper) = (min.lower(), max.upper());
        require(lower.is_finite() && upper.is_finite(), "thrust", Reason::NotFinite)?;
        require(lower <= upper, "thrust", Reason::NotIncreasing)?;
        Ok(Self { thrust: (min, max), torque })
    }

    /// The greatest row . (T, tau), rounded outwards.
    fn max_along(&self, row: &Vector4<f64>) -> R {
        let (min, max) = self.thrust;
        let thrust = (min * row.x).greater(max * row.x);
        let direction = torque_part(row).map(R::from);
        let torque = self.torque.iter().fold(R::from(0.0), |sum, term| sum + term.support(&direction));
        thrust + torque + (thrust.abs() + torque) * TICK_ROUNDING_SHARE
    }
}

/// (tau_x, tau_y, tau_z) of a row over (T, tau).
pub fn torque_part(row: &Vector4<f64>) -> Vector3<f64> {
    Vector3::new(row.y, row.z, row.w)
}

/// The extremes of one rotor's thrust over a set of commands, and what it has. All in N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RotorDemand<R = f64> {
    /// Least commanded thrust.
    pub min: R,
    /// Greatest commanded thrust.
    pub max: R,
    /// Least thrust it can give.
    pub available_min: f64,
    /// Greatest thrust it can give.
    pub available_max: f64,
}

impl<R: Real> RotorDemand<R> {
    /// The demand of `commands` on `rotor`, whose thrust is `row` of B+ times the wrench.
    pub fn new(rotor: &Rotor, row: &Vector4<f64>, commands: &Commands<R>) -> Self {
        Self {
            min: -commands.max_along(&-row),
            max: commands.max_along(row),
            available_min: f64::from(rotor.thrust_min),
            available_max: f64::from(rotor.thrust_max),
        }
    }

    /// Whether the rotor's range covers its demand.
    pub fn fits(&self) -> bool {
        self.min.lower() >= self.available_min && self.max.upper() <= self.available_max
    }
}

/// The demand of `commands` on each rotor, in the rotors' order.
pub fn demands<R: Real>(rotors: &Rotors, commands: &Commands<R>) -> Vec<RotorDemand<R>, ROTORS_MAX> {
    let all = rotors.iter().zip(rotors.pseudo_inverse());
    collected(all.map(|(rotor, row)| RotorDemand::new(rotor, row, commands)))
}
