//! Rotors as they are mounted: validated, with the effectiveness matrix B and its minimum-norm inverse.
//!
//! Rotor i with thrust f_i acts on the body with
//!
//! ```text
//! tau = p_i x (f_i e3) + s_i (k_m / k_eta) f_i e3 = (y_i, -x_i, s_i k_m / k_eta) f_i,   f_i = k_eta (speed)^2
//! ```
//!
//! so column i of B is (1, y_i, -x_i, s_i k_m / k_eta): newtons and newton metres per newton. The height z_i is kept
//! for other users; with all thrusts along body z it moves no torque. Drag of the air on the rotor turns the body
//! *against* the rotor's own rotation: s_i = +1 for a rotor that turns clockwise seen from above.
//!
//! The pseudo-inverse B+ = B' (B B')^-1 gives the thrusts of least sum of squares; for four rotors it is the inverse.
//! It is worked out in f64 from rows scaled to unit length, so that newtons and newton metres weigh the same.
//!
//! Tilted rotors, and rotors that push down, are beyond this module.

use super::collected;
use crate::error::{ParameterError, Reason, require, require_finite, require_positive};
use crate::math;
use crate::state::Wrench;
use core::ops::Deref;
use heapless::Vec;
use nalgebra::{Vector3, Vector4};

/// The fewest rotors that can span thrust and three torques.
pub const ROTORS_MIN: usize = 4;

/// The most rotors a vehicle may have.
pub const ROTORS_MAX: usize = 8;

/// The greatest distance of a rotor from the centre of mass along an axis, and the greatest k_m / k_eta, m.
const ROTOR_LENGTH_MAX_M: f32 = 100.0;

/// The greatest thrust of one rotor, N.
const ROTOR_THRUST_MAX_N: f32 = 1e6;

/// How far each row of B must stay from every combination of the other three: the least sine of the angle between them.
///
/// Below it, one wrench component can only be had with rotor thrusts 100 times those it would need alone.
pub const ROW_INDEPENDENCE_SINE_MIN: f64 = 0.01;

/// The eight names of a field that every rotor has; rotors are numbered from 1.
macro_rules! of_each_rotor {
    ($name:literal) => {
        [
            concat!("rotors.", $name, ", rotor 1"),
            concat!("rotors.", $name, ", rotor 2"),
            concat!("rotors.", $name, ", rotor 3"),
            concat!("rotors.", $name, ", rotor 4"),
            concat!("rotors.", $name, ", rotor 5"),
            concat!("rotors.", $name, ", rotor 6"),
            concat!("rotors.", $name, ", rotor 7"),
            concat!("rotors.", $name, ", rotor 8"),
        ]
    };
}

const POSITION_FIELDS: [&str; ROTORS_MAX] = of_each_rotor!("position");
const THRUST_COEFFICIENT_FIELDS: [&str; ROTORS_MAX] = of_each_rotor!("thrust_coefficient");
const DRAG_COEFFICIENT_FIELDS: [&str; ROTORS_MAX] = of_each_rotor!("drag_coefficient");
const THRUST_MIN_FIELDS: [&str; ROTORS_MAX] = of_each_rotor!("thrust_min");
const THRUST_MAX_FIELDS: [&str; ROTORS_MAX] = of_each_rotor!("thrust_max");

/// Which way a rotor turns, seen from above (from +z, looking down).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Spin {
    /// Its drag turns the body counter-clockwise: positive yaw torque, s = +1.
    Clockwise,
    /// Its drag turns the body clockwise: negative yaw torque, s = -1.
    CounterClockwise,
}

impl Spin {
    /// The sign s of the drag torque on the body about +z.
    pub fn sign(self) -> f32 {
        match self {
            Self::Clockwise => 1.0,
            Self::CounterClockwise => -1.0,
        }
    }
}

/// One rotor, its thrust along +body z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rotor {
    /// Hub position from the centre of mass, m, body frame.
    pub position: Vector3<f32>,
    /// Direction of rotation.
    pub spin: Spin,
    /// k_eta: thrust per squared speed, N/(rad/s)^2.
    pub thrust_coefficient: f32,
    /// k_m: drag torque per squared speed, N m/(rad/s)^2.
    pub drag_coefficient: f32,
    /// Least thrust while flying, N: that of the idle speed.
    pub thrust_min: f32,
    /// Greatest thrust, N.
    pub thrust_max: f32,
}

impl Rotor {
    /// Thrust, N, at a speed in rad/s.
    pub fn thrust_at(&self, speed: f32) -> f32 {
        self.thrust_coefficient * speed * speed
    }

    /// Speed, rad/s, at a thrust in N (negative ones count as zero).
    pub fn speed_at(&self, thrust: f32) -> f32 {
        math::sqrt(thrust.max(0.0) / self.thrust_coefficient)
    }

    /// The wrench (T, tau_x, tau_y, tau_z) of one newton of its thrust.
    fn column(&self) -> Vector4<f64> {
        let yaw = f64::from(self.spin.sign()) * f64::from(self.drag_coefficient) / f64::from(self.thrust_coefficient);
        Vector4::new(1.0, f64::from(self.position.y), -f64::from(self.position.x), yaw)
    }
}

/// A quadrotor with four equal rotors on the diagonals of a square; see [`Rotors::quad_x`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QuadX {
    /// From the centre of mass to each hub, m.
    pub arm: f32,
    /// k_eta, N/(rad/s)^2.
    pub thrust_coefficient: f32,
    /// k_m, N m/(rad/s)^2.
    pub drag_coefficient: f32,
    /// Least speed while flying, rad/s.
    pub speed_min: f32,
    /// Greatest speed, rad/s.
    pub speed_max: f32,
}

/// Four to eight rotors that span the wrench. Reads like a slice of [`Rotor`].
#[derive(Debug, Clone, PartialEq)]
pub struct Rotors {
    rotors: Vec<Rotor, ROTORS_MAX>,
    columns: Vec<Vector4<f64>, ROTORS_MAX>,
    inverse: Vec<Vector4<f64>, ROTORS_MAX>,
    speeds_are_nominal: bool,
}

impl Rotors {
    /// Checks every rotor, their number, and that together they produce thrust, roll, pitch and yaw independently.
    ///
    /// # Errors
    /// Names the field, with the rotor's number from 1; [`Reason::DoesNotSpan`] for `rotors` when one row of B is a
    /// combination of the others to within [`ROW_INDEPENDENCE_SINE_MIN`].
    pub fn new(rotors: &[Rotor]) -> Result<Self, ParameterError> {
        require(rotors.len() >= ROTORS_MIN, "rotors", Reason::TooFew(ROTORS_MIN))?;
        let too_many = ParameterError { field: "rotors", reason: Reason::TooMany(ROTORS_MAX) };
        let list = Vec::from_slice(rotors).map_err(|_| too_many)?;
        for (rotor, field) in rotors.iter().zip(POSITION_FIELDS) {
            for component in rotor.position.iter() {
                require_finite(*component, field)?;
                require(component.abs() < ROTOR_LENGTH_MAX_M, field, Reason::NotBelow(ROTOR_LENGTH_MAX_M))?;
            }
        }
        for (rotor, field) in rotors.iter().zip(THRUST_COEFFICIENT_FIELDS) {
            require_positive(rotor.thrust_coefficient, field)?;
        }
        for (rotor, field) in rotors.iter().zip(DRAG_COEFFICIENT_FIELDS) {
            require_positive(rotor.drag_coefficient, field)?;
            let max = ROTOR_LENGTH_MAX_M * rotor.thrust_coefficient;
            require(rotor.drag_coefficient < max, field, Reason::NotBelow(max))?;
        }
        for (rotor, field) in rotors.iter().zip(THRUST_MAX_FIELDS) {
            require_positive(rotor.thrust_max, field)?;
            require(rotor.thrust_max < ROTOR_THRUST_MAX_N, field, Reason::NotBelow(ROTOR_THRUST_MAX_N))?;
        }
        for (rotor, field) in rotors.iter().zip(THRUST_MIN_FIELDS) {
            require_finite(rotor.thrust_min, field)?;
            require(rotor.thrust_min >= 0.0, field, Reason::Negative)?;
            require(rotor.thrust_min < rotor.thrust_max, field, Reason::NotBelow(rotor.thrust_max))?;
        }
        Self::spanning(list).ok_or(ParameterError { field: "rotors", reason: Reason::DoesNotSpan })
    }

    /// Four equal rotors: 1 front left and 3 rear right turn clockwise, 2 rear left and 4 front right
    /// counter-clockwise.
    ///
    /// # Errors
    /// As [`Rotors::new`]; a bad arm shows as the positions it makes, bad speeds as the thrusts.
    pub fn quad_x(quad: QuadX) -> Result<Self, ParameterError> {
        let side = quad.arm * core::f32::consts::FRAC_1_SQRT_2;
        require_positive(quad.arm, "rotors.arm")?;
        require_finite(quad.speed_max, "rotors.speed_max")?;
        require_finite(quad.speed_min, "rotors.speed_min")?;
        require(quad.speed_min >= 0.0, "rotors.speed_min", Reason::Negative)?;
        let rotor = |x, y, spin| Rotor {
            position: Vector3::new(x, y, 0.0),
            spin,
            thrust_coefficient: quad.thrust_coefficient,
            drag_coefficient: quad.drag_coefficient,
            thrust_min: quad.thrust_coefficient * quad.speed_min * quad.speed_min,
            thrust_max: quad.thrust_coefficient * quad.speed_max * quad.speed_max,
        };
        Self::new(&[
            rotor(side, side, Spin::Clockwise),
            rotor(-side, side, Spin::CounterClockwise),
            rotor(-side, -side, Spin::Clockwise),
            rotor(side, -side, Spin::CounterClockwise),
        ])
    }

    /// Column i of B: the wrench (T, tau_x, tau_y, tau_z) of one newton of rotor i.
    pub fn effectiveness(&self) -> &[Vector4<f64>] {
        &self.columns
    }

    /// Row i of B+: the thrust of rotor i, N, per unit of (T, tau_x, tau_y, tau_z), least sum of squares.
    pub fn pseudo_inverse(&self) -> &[Vector4<f64>] {
        &self.inverse
    }

    /// The same rotors, of which only thrusts are known: a coefficient is that of a speed which nobody has measured.
    #[must_use]
    pub fn of_nominal_speed(self) -> Self {
        Self { speeds_are_nominal: true, ..self }
    }

    /// Whether the thrust coefficients belong to speeds that nobody has measured.
    pub fn are_of_nominal_speed(&self) -> bool {
        self.speeds_are_nominal
    }

    /// The wrench of rotors that turn at `speeds`, rad/s; none where one of them is missing, and where only nominal
    /// speeds are known.
    pub fn wrench_at(&self, speeds: &[Option<f32>]) -> Option<Wrench> {
        if self.speeds_are_nominal || speeds.len() < self.rotors.len() {
            return None;
        }
        let mut sum = Vector4::zeros();
        for ((rotor, column), speed) in self.rotors.iter().zip(&self.columns).zip(speeds) {
            sum += column.map(|x| x as f32) * rotor.thrust_at((*speed)?);
        }
        Some(Wrench { thrust: sum.x, torque: Vector3::new(sum.y, sum.z, sum.w) })
    }

    /// The least and the greatest thrust of all rotors together, N.
    pub fn thrust_together(&self) -> (f32, f32) {
        let sum = |thrust: fn(&Rotor) -> f32| self.rotors.iter().map(thrust).sum();
        (sum(|rotor| rotor.thrust_min), sum(|rotor| rotor.thrust_max))
    }

    /// The greatest distance of a rotor from body z, m.
    pub fn max_arm(&self) -> f32 {
        let squares = self.rotors.iter().map(|rotor| rotor.position.xy().norm_squared());
        math::sqrt(squares.fold(f32::MIN_POSITIVE, math::max))
    }

    /// Checks that all rotors together can lift `weight`, N, and need not.
    ///
    /// # Errors
    /// Names `rotors.speed`: [`Reason::NotAbove`] where the greatest thrust is too little, [`Reason::NotBelow`] where
    /// the least is too much.
    pub fn check_hover(&self, weight: f32) -> Result<(), ParameterError> {
        let (min, max) = self.thrust_together();
        require(max > weight, "rotors.speed", Reason::NotAbove(weight))?;
        require(min < weight, "rotors.speed", Reason::NotBelow(weight))
    }

    /// What each wrench component is multiplied by to make the rows of B unit vectors.
    pub(super) fn scale(&self) -> Vector4<f64> {
        squares(&self.columns).map(|square| 1.0 / math::sqrt_f64(square))
    }

    /// Works out B, its scaling and B+, if the rows of B are independent enough.
    fn spanning(rotors: Vec<Rotor, ROTORS_MAX>) -> Option<Self> {
        let columns = columns(&rotors);
        let squares = squares(&columns);
        if !squares.iter().all(|square| *square > 0.0) {
            return None;
        }
        let scale = squares.map(|square| 1.0 / math::sqrt_f64(square));
        let scaled = || columns.iter().map(|column| column.component_mul(&scale));
        // The rows' cosines. The diagonal of the inverse is 1/sin^2 of each row's angle to the span of the others.
        let row = |select: fn(&Vector4<f64>) -> f64| -> Vector4<f64> {
            scaled().map(|column| column * select(&column)).sum()
        };
        let (x, y, z, w) = (row(|c| c.x), row(|c| c.y), row(|c| c.z), row(|c| c.w));
        let inverted =
            [(&x, normal(&y, &z, &w)), (&y, normal(&x, &z, &w)), (&z, normal(&x, &y, &w)), (&w, normal(&x, &y, &z))]
                .map(|(row, normal)| normal / normal.dot(row));
        let independent =
            |of_row: f64| of_row > 0.0 && of_row < 1.0 / (ROW_INDEPENDENCE_SINE_MIN * ROW_INDEPENDENCE_SINE_MIN);
        let [x, y, z, w] = &inverted;
        if ![x.x, y.y, z.z, w.w].into_iter().all(independent) {
            return None;
        }
        let solved = |column: Vector4<f64>| Vector4::from(inverted.map(|row| row.dot(&column)));
        let inverse = collected(scaled().map(|column| solved(column).component_mul(&scale)));
        Some(Self { rotors, columns, inverse, speeds_are_nominal: false })
    }
}

/// The columns of B.
fn columns(rotors: &[Rotor]) -> Vec<Vector4<f64>, ROTORS_MAX> {
    collected(rotors.iter().map(Rotor::column))
}

/// The squared lengths of the rows of B.
fn squares(columns: &[Vector4<f64>]) -> Vector4<f64> {
    columns.iter().map(|column| column.component_mul(column)).sum()
}

/// The vector normal to three others in four dimensions: the cross product's bigger sister.
pub(super) fn normal(a: &Vector4<f64>, b: &Vector4<f64>, c: &Vector4<f64>) -> Vector4<f64> {
    let minor = |pick: fn(&Vector4<f64>) -> Vector3<f64>| pick(a).cross(&pick(b)).dot(&pick(c));
    Vector4::new(
        minor(|v| Vector3::new(v.y, v.z, v.w)),
        -minor(|v| Vector3::new(v.x, v.z, v.w)),
        minor(|v| Vector3::new(v.x, v.y, v.w)),
        -minor(|v| Vector3::new(v.x, v.y, v.z)),
    )
}

impl Deref for Rotors {
    type Target = [Rotor];

    fn deref(&self) -> &[Rotor] {
        &self.rotors
    }
}

#[cfg(test)]
mod tests;
