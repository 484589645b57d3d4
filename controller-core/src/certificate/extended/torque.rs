//! Every torque the extended law can command, along a direction b of torque space. Section 11 of `docs/extended-law.md`.
//!
//! The torque is a sum of terms, each bounded along b = (b_12, b_3) while body z is off the commanded thrust by the angle theta,
//! r = sin(theta / 2):
//!
//! | term | greatest along b |
//! |---|---|
//! | potential | \|b_12\| (w r / 2 + G r sqrt(1 - r^2)) + \|b_3\| (w eta / 2) sqrt((1 - r^2 - qbar^2) / (1 - r^2 + eta^2 - 2 eta qbar)) |
//! | damping | \|b_12\| M_omega_t + \|b_3\| M_omega_z |
//! | bias estimate | (\|b_1\| + \|b_2\|) D_t + \|b_3\| D_y |
//! | J R~^T omega_d' | \|J b\| times the greatest \|omega'_12\| sin alpha + A \|cos alpha\|, alpha from \|theta - beta\| to theta + beta |
//! | gyroscopic | \|omega_d\|^2 times the largest eigenvalue of the form b . (omega x J omega) |
//!
//! beta is the angle between J b and the z axis. Where 1 - r^2 <= eta qbar, the last root is sqrt(1 - r^2) / eta instead.
//! At R~ = 1 the last two are one, with the terms that W makes put together: [`Torques::feedforward`].

use super::motion::Cell;
use crate::allocation::support::{Shape, TorqueTerm};
use crate::error::ParameterError;
use crate::extended::parameters::{AttitudeParameters, Extended};
use crate::math;
use nalgebra::{Vector2, Vector3};

/// Cells of theta between no error and a half turn.
pub const TILT_CELLS: usize = 24;

/// The law's torque terms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Torques {
    attitude: [f64; 8],
    bias: [f64; 2],
    inertia: Vector3<f64>,
    /// A and W_max.
    turn: [f64; 2],
    qbar: f64,
}

/// An interval of theta.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TiltCell {
    /// Sine and cosine of theta at its ends.
    ends: [(f64, f64); 2],
    /// Greatest torque of the tilt's potential, N m.
    tilting: f64,
    /// Greatest torque of the potential about z, N m.
    yawing: f64,
}

impl TiltCell {
    /// The greatest cosine of theta.
    #[must_use]
    pub fn cosine(&self) -> f64 {
        self.ends[0].1
    }
}

/// J b, for a direction b of torque space: its length, kg m^2, and the sine and cosine of its angle to the z axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lever {
    length: f64,
    sin: f64,
    cos: f64,
}

/// What the desired frame accelerates by: greatest |omega'_12|, and the greatest of it all, rad/s^2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Swing {
    across: f64,
    most: f64,
}

/// qbar, at whose negative the lift switches.
#[must_use]
pub fn switching_scalar(delta: f32) -> f64 {
    let square = (1.0 + f64::from(delta)) * (1.0 + f64::from(delta));
    (square - 1.0) / (square + 1.0)
}

impl Torques {
    /// For the constants `parameters` and the diagonal of J, kg m^2.
    #[must_use]
    pub fn new(parameters: &Extended, inertia: &Vector3<f64>) -> Self {
        let AttitudeParameters { w, eta, k_t, m_t, eta_t, m_omega_t, m_omega_z, delta, .. } = parameters.attitude;
        let e = &parameters.estimates;
        Self {
            attitude: [w, eta, k_t, m_t, eta_t, m_omega_t, m_omega_z, 0.0].map(f64::from),
            bias: [e.torque_tilt, e.torque_yaw].map(f64::from),
            inertia: *inertia,
            turn: [parameters.heading.acceleration, parameters.heading.rate].map(f64::from),
            qbar: switching_scalar(delta),
        }
    }

    /// The cells of theta, from no error to a half turn.
    pub fn tilt_cells(&self) -> impl Iterator<Item = TiltCell> + '_ {
        // Equal steps of r = sin(theta / 2): theta = 2 asin r, cos theta = 1 - 2 r^2, sin theta = 2 r sqrt(1 - r^2).
        (0..TILT_CELLS).map(move |cell| {
            let [near, far] = [cell, cell + 1].map(|end| end as f64 / TILT_CELLS as f64);
            let angle = |r: f64| (2.0 * r * math::sqrt_of_rounded(1.0 - r * r), 1.0 - 2.0 * r * r);
            TiltCell { ends: [angle(near), angle(far)], tilting: self.tilting(near, far), yawing: self.yawing(near) }
        })
    }

    /// Greatest w r / 2 + G r sqrt(1 - r^2) for r from `near` to `far`.
    fn tilting(&self, near: f64, far: f64) -> f64 {
        let [w, _, k_t, m_t, eta_t, ..] = self.attitude;
        let rest = |r: f64| math::sqrt_of_rounded(1.0 - r * r);
        // k_t r / sqrt(M_t^2 + k_t^2 r^2) rises with r, sqrt(1 - r^2) / sqrt(1 - r^2 + eta_t^2) falls.
        let rising = m_t * k_t * far / math::hypot(m_t, k_t * far);
        0.5 * w * far + rising * rest(near) / math::hypot(rest(near), eta_t)
    }

    /// Greatest w eta q_3 / 2h for r of at least `near`: at q_0 = -qbar, or at q_0 = -(1 - r^2) / eta where that is nearer. Where the lift
    /// switches only beyond q_0 = -eta, which no certificate allows, h is q_3 there.
    fn yawing(&self, near: f64) -> f64 {
        let [w, eta, ..] = self.attitude;
        let (rest, qbar) = (1.0 - near * near, self.qbar);
        let square = if qbar >= eta && rest >= eta * eta {
            1.0
        } else if rest > eta * qbar {
            (rest - qbar * qbar) / (rest + eta * eta - 2.0 * eta * qbar)
        } else {
            rest / (eta * eta)
        };
        0.5 * w * eta * math::sqrt_f64(square)
    }

    /// Greatest feedback along `b`: potential, damping and bias estimate.
    #[must_use]
    #[inline(never)] // called from many places, before flight
    pub fn feedback(&self, b: &Vector3<f64>, tilt: &TiltCell) -> f64 {
        let [.., m_omega_t, m_omega_z, _] = self.attitude;
        let (across, about) = (math::hypot(b.x, b.y), b.z.abs());
        across * (tilt.tilting + m_omega_t) + about * (tilt.yawing + m_omega_z) + self.bias(b)
    }

    /// Greatest bias estimate along `b`.
    #[must_use]
    pub fn bias(&self, b: &Vector3<f64>) -> f64 {
        let [tilt, yaw] = self.bias;
        tilt * (b.x.abs() + b.y.abs()) + yaw * b.z.abs()
    }

    /// J b.
    #[must_use]
    pub fn lever(&self, b: &Vector3<f64>) -> Lever {
        let weighted = self.inertia.component_mul(b);
        let (across, about) = (math::hypot(weighted.x, weighted.y), weighted.z.abs());
        let length = math::hypot(across, about);
        Lever { length, sin: across / length, cos: about / length }
    }

    /// |omega'_12| of at most `across`, rad/s^2, with the greatest turn.
    #[must_use]
    pub fn swing(&self, across: f64) -> Swing {
        Swing { across, most: math::hypot(across, self.turn[0]) }
    }

    /// Greatest J R~^T omega_d' along b.
    #[must_use]
    #[inline(never)] // called from many places, before flight
    pub fn swung(&self, lever: &Lever, tilt: &TiltCell, swing: &Swing) -> f64 {
        let [turn, _] = self.turn;
        let (&Lever { length, sin, cos }, &Swing { across, most }) = (lever, swing);
        if length <= 0.0 || most <= 0.0 {
            return 0.0;
        }
        // J b is beta off the z axis; turned by R~ it is alpha off, from |theta - beta| to theta + beta.
        let [(sin_near, cos_near), (sin_far, cos_far)] = tilt.ends;
        let nearest = if cos > cos_near {
            cos_near * cos + sin_near * sin
        } else if cos < cos_far {
            cos_far * cos + sin_far * sin
        } else {
            1.0
        };
        let beyond = sin_far * cos + cos_far * sin <= 0.0;
        let farthest = if beyond { -1.0 } else { cos_far * cos - sin_far * sin };
        // across sin alpha + turn |cos alpha| has its greatest value on either side of a right angle, and between the two its least.
        let reaches = |cosine: f64| nearest >= cosine && cosine >= farthest;
        let there = |cosine: f64| across * math::sqrt_of_rounded(1.0 - cosine * cosine) + turn * cosine.abs();
        let peak = turn / most;
        length * if reaches(peak) || reaches(-peak) { most } else { math::greater_f64(there(nearest), there(farthest)) }
    }

    /// Greatest gyroscopic torque along `b` for |omega_12| of at most `rate`, rad/s.
    ///
    /// # Errors
    /// If a number is not finite; the constructors before it leave no way to that.
    #[inline(never)] // called from many places, before flight
    pub fn gyroscopic(&self, b: &Vector3<f64>, rate: f64) -> Result<f64, ParameterError> {
        let [_, turn] = self.turn;
        let shape = Shape::Gyroscopic { inertia: self.inertia, rate: math::hypot(rate, turn) };
        Ok(TorqueTerm::new("gyroscopic torque", shape)?.support(b))
    }

    /// Greatest feed-forward along `b` without attitude error, in one `cell` of u.
    ///
    /// With a = (J_1 b_1, J_2 b_2) and c = ((J_1 + J_3 - J_2) b_1, (J_2 + J_3 - J_1) b_2) it is at most |a| |w| / n +
    /// (p / n) sqrt((2r / n)^2 |a|^2 + W^2 |c|^2 + (4 r / n) |W| |a x c|) + |b_3| (J_3 A + |J_2 - J_1| p^2 / 2 n^2).
    #[must_use]
    #[inline(never)] // called from many places, before flight
    pub fn feedforward(&self, b: &Vector3<f64>, cell: &Cell) -> f64 {
        let [acceleration, rate] = self.turn;
        let j = &self.inertia;
        let a = Vector2::new(j.x * b.x, j.y * b.y);
        let c = Vector2::new((j.x + j.z - j.y) * b.x, (j.y + j.z - j.x) * b.y);
        let (length, other) = (math::hypot(a.x, a.y), math::hypot(c.x, c.y));
        let tilting = if length > 0.0 {
            // The cross term is second order in J_2 - J_1: half of its square is charged to each side. A flat body may have no c.
            let skew = if other > 0.0 { (a.x * c.y - a.y * c.x).abs() / (length * other) } else { 0.0 };
            length * (cell.swing + cell.curl(rate * other / length) * math::sqrt_f64(1.0 + skew))
        } else {
            0.0
        };
        let yawing = j.z * acceleration + 0.5 * (j.y - j.x).abs() * cell.rate() * cell.rate();
        tilting + b.z.abs() * yawing
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::attitude::rotate_back;
    use crate::extended::attitude::AttitudeLaw;
    use crate::extended::example;
    use crate::extended::parameters::ExtendedParameters;
    use nalgebra::Quaternion;

    /// Xorshift, for tests that repeat to the bit.
    struct Random(u64);

    impl Random {
        fn signed(&mut self) -> f64 {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
            (self.0 >> 11) as f64 / 4_503_599_627_370_496.0 - 1.0
        }

        fn vector(&mut self) -> Vector3<f64> {
            Vector3::new(self.signed(), self.signed(), self.signed())
        }
    }

    fn torques() -> Torques {
        let parameters = Extended::new(example::PARAMETERS, &example::vehicle()).unwrap();
        Torques::new(&parameters, &Vector3::new(3e-3, 5e-3, 9e-3))
    }

    #[test]
    fn each_component_of_a_bias_may_be_at_its_level_at_once() {
        let (torques, levels) = (torques(), Vector3::new(0.03, 0.03, 0.005));
        for b in [Vector3::new(1.0, 1.0, 1.0), Vector3::new(-1.0, 2.0, 0.0), Vector3::new(0.0, 0.0, -3.0)] {
            assert!((torques.bias(&b) - levels.dot(&b.abs())).abs() < 1e-8, "{b}");
        }
    }

    #[test]
    fn no_motion_of_the_frame_has_a_greater_gyroscopic_torque_and_one_has_nearly_it() {
        let (torques, mut random) = (torques(), Random(9));
        for _ in 0..50 {
            let (b, rate, turn) = (random.vector(), 2.0 * random.signed().abs(), 1.5);
            let bound = torques.gyroscopic(&b, rate).unwrap();
            let most = (0..20_000).map(|_| random.vector().normalize() * math::hypot(rate, turn));
            let most = most.map(|omega| b.dot(&omega.cross(&torques.inertia.component_mul(&omega))));
            let most = most.fold(0.0, f64::max);
            assert!(most <= bound * (1.0 + 1e-9) && most > 0.97 * bound, "{most} of {bound} along {b}");
        }
    }

    /// The law's own torques, each cell of the tilt by itself: with a narrow hysteresis, with one so wide that the greatest
    /// yaw of a nearly inverted vehicle is no longer at the switch, and with one that no certificate allows.
    #[test]
    fn in_every_cell_of_the_tilt_no_torque_is_beyond_its_bound() {
        for (eta, delta) in [(0.1, 0.02), (0.7, 1.0), (0.95, 1.0), (0.3, 0.6), (0.1, 0.2)] {
            let attitude = AttitudeParameters { eta, delta, ..example::PARAMETERS.attitude };
            let parameters = ExtendedParameters { attitude, ..example::PARAMETERS };
            let parameters = Extended::new(parameters, &example::vehicle()).unwrap();
            let inertia = Vector3::new(3e-3, 5e-3, 7e-3);
            let torques = Torques::new(&parameters, &inertia);
            let law = AttitudeLaw::new(&attitude, &inertia.cast());
            let mut random = Random(7);
            for (cell, tilt) in torques.tilt_cells().enumerate() {
                // Across, about and along anything: what is too wide for one is not to hide behind another.
                let (mut fed, mut swung) = ([0.0_f64; 3], [[0.0_f64; 3]; 2]);
                for sample in 0..30_000 {
                    let r = (cell as f64 + 0.5 + 0.5 * random.signed()) / TILT_CELLS as f64;
                    let rest = math::sqrt_f64((1.0 - r * r).max(0.0));
                    let least = (-torques.qbar).max(-rest);
                    let q_0 = least + (rest - least) * (0.5 + 0.5 * random.signed());
                    let q_3 = math::sqrt_f64((rest * rest - q_0 * q_0).max(0.0));
                    let across = random.vector().xy().normalize() * r;
                    let q = Quaternion::new(q_0, across.x, across.y, q_3);
                    let error = q.cast::<f32>();
                    let still = Vector3::zeros();
                    let fast = (random.vector() * 1e4).cast();
                    let anything = random.vector();
                    let kind = sample % 3;
                    let b = [Vector3::new(anything.x, anything.y, 0.0), Vector3::z(), anything][kind];
                    let parts = law.torque(&error, &fast, &still, &still);
                    let along = b.dot(&(parts.potential + parts.damping).cast()).abs() + torques.bias(&b);
                    fed[kind] = fed[kind].max(along / torques.feedback(&b, &tilt));
                    // Much faster than the frame turns about rho, and slower.
                    let slow = sample / 3 % 2;
                    let swing = [40.0, 1.0][slow];
                    let side = random.vector().xy().normalize() * swing;
                    let turn = f64::from(parameters.heading.acceleration) * random.signed().signum();
                    let acceleration = Vector3::new(side.x, side.y, turn).cast::<f32>();
                    let moved = inertia.component_mul(&rotate_back(&error, &acceleration).cast());
                    let part = b.dot(&moved).abs() / torques.swung(&torques.lever(&b), &tilt, &torques.swing(swing));
                    swung[slow][kind] = swung[slow][kind].max(part);
                }
                for (part, close) in [(fed, 0.93), (swung[0], 0.99), (swung[1], 0.7)] {
                    let least = part.into_iter().fold(f64::INFINITY, f64::min);
                    let most = part.into_iter().fold(0.0, f64::max);
                    assert!(most <= 1.0 + 1e-4 && least > close, "eta {eta}, cell {cell}: {fed:?} and {swung:?}");
                }
                assert!(swung.iter().flatten().all(|part| *part <= 1.0 + 1e-5), "eta {eta}, cell {cell}: {swung:?}");
            }
        }
    }
}
