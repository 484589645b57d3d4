//! The hybrid path-lifting algorithm of the paper's appendix, literally: argmax, dist, and both jump conditions.

use nalgebra::{Matrix3, Vector3, Vector4};

/// x_l without R~: the memory q_hat and the sign m*.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lift {
    pub memory: Vector4<f64>,
    pub sign: f64,
}

impl Lift {
    /// q_hat is the lift of R~(0) with q0 >= 0 (at q0 = 0 the first non-zero component is positive), m* = +1.
    pub fn initial(error: &Matrix3<f64>) -> Self {
        let [q, minus_q] = lifts(error);
        let leading = q.iter().copied().find(|&component| component != 0.0).unwrap_or(1.0);
        Self { memory: if leading > 0.0 { q } else { minus_q }, sign: 1.0 }
    }

    /// Jumps while the state lies in D_q or D_m, then gives the lift and the output m* Phi(q_hat, R~).
    pub fn advance(mut self, error: &Matrix3<f64>, delta: f64, alpha: f64) -> (Self, Vector4<f64>) {
        let candidates = lifts(error);
        let distance = candidates.iter().map(|p| 1.0 - self.memory.dot(p)).fold(f64::INFINITY, f64::min);
        let phi = nearest(&self.memory, error);
        if mrp(&(self.sign * phi)).norm() >= 1.0 + delta {
            self.sign = -self.sign;
        }
        // Phi is the same before and after q_hat follows it, so the order of the two jumps does not matter.
        if distance >= alpha {
            self.memory = phi;
        }
        (self, self.sign * phi)
    }
}

/// Phi(q_hat, R): of the two lifts of R, the one nearer to q_hat.
pub fn nearest(memory: &Vector4<f64>, rotation: &Matrix3<f64>) -> Vector4<f64> {
    let [p, minus_p] = lifts(rotation);
    if memory.dot(&p) >= memory.dot(&minus_p) { p } else { minus_p }
}

/// phi(q) = q_1 / (1 + q_0), infinite at q_0 = -1.
pub fn mrp(q: &Vector4<f64>) -> Vector3<f64> {
    if q[0] <= -1.0 {
        return Vector3::repeat(f64::INFINITY);
    }
    Vector3::new(q[1], q[2], q[3]) / (1.0 + q[0])
}

/// Q(R), both unit quaternions of a rotation matrix, by Shepperd's method.
pub fn lifts(r: &Matrix3<f64>) -> [Vector4<f64>; 2] {
    let trace = r.trace();
    let squares =
        [1.0 + trace, 1.0 + 2.0 * r[(0, 0)] - trace, 1.0 + 2.0 * r[(1, 1)] - trace, 1.0 + 2.0 * r[(2, 2)] - trace];
    let largest = (0..4).fold(0, |best, i| if squares[i] > squares[best] { i } else { best });
    let (x, y, z) = (r[(2, 1)] - r[(1, 2)], r[(0, 2)] - r[(2, 0)], r[(1, 0)] - r[(0, 1)]);
    let (xy, xz, yz) = (r[(0, 1)] + r[(1, 0)], r[(0, 2)] + r[(2, 0)], r[(1, 2)] + r[(2, 1)]);
    let q = match largest {
        0 => Vector4::new(squares[0], x, y, z),
        1 => Vector4::new(x, squares[1], xy, xz),
        2 => Vector4::new(y, xy, squares[2], yz),
        _ => Vector4::new(z, xz, yz, squares[3]),
    };
    let q = q / q.norm();
    [q, -q]
}

/// R(q) = I + 2 q_0 [q_1]_x + 2 [q_1]_x^2 for any q other than zero.
pub fn rotation(q: &Vector4<f64>) -> Matrix3<f64> {
    let q = q / q.norm();
    let s = super::skew(Vector3::new(q[1], q[2], q[3]));
    Matrix3::identity() + 2.0 * q[0] * s + 2.0 * s * s
}
