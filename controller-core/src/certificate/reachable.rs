//! What the filters can reach from x_f = 0, and so what u, u', u'' can be.
//!
//! Each axis of the cascade u_f' = -k_f (u_f - u_s), u_s' = -k_s (u_s - ubar) has an input |ubar| <= M_p. Its reachable
//! set from zero is the convex region between the two extremal arcs that run from (M_p, M_p) to (-M_p, -M_p) and back
//! with the input at its bound. Along an arc, with E_f = e^(-k_f t), E_s = e^(-k_s t),
//!
//! u_s = M_p (2 E_s - 1),  u_f - u_s = 2 M_p k_s (E_f - E_s) / (k_s - k_f).
//!
//! The linear functions the law needs take their maxima on it, in closed form (`docs/sharp-bound.md`, step 1), with
//! U_l = (k_f / k_s)^(k_f / (k_s - k_f)), e^-1 when the two are equal:
//!
//! | quantity, per axis | greatest magnitude | the paper's |
//! |---|---|---|
//! | u_f' = -k_f (u_f - u_s) | 2 k_f U_l M_p | the same |
//! | u_f'' = k_f (k_f (u_f - u_s) - k_s (u_s - ubar)) | 2 k_f M_p (k_s + k_f U_l^2) | 2 k_f M_p (k_s + k_f U_l) |
//!
//! Single axes stay single axes here: the horizontal pair is bounded by its Euclidean norm, sqrt(2) times an axis, and
//! the vertical axis by itself.

use crate::math::real::Real;
use crate::reference::ReferenceBounds;

/// Bounds on u and its derivatives over everything reachable after a reset, m/s^2, m/s^3, m/s^4.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reachable<R = f64> {
    /// Least u_z = g - M_p - K_a3; the law is defined while it is positive.
    pub vertical_min: R,
    /// Greatest u_z = g + M_p + K_a3.
    pub vertical_max: R,
    /// Greatest |(u_x, u_y)| = sqrt(2) M_p + K_a12.
    pub horizontal: R,
    /// Greatest |u'|.
    pub jerk: R,
    /// Greatest |(u'_x, u'_y)|.
    pub horizontal_jerk: R,
    /// Greatest |u'_z|.
    pub vertical_jerk: R,
    /// Greatest |(u''_x, u''_y)|.
    pub horizontal_snap: R,
    /// Greatest |u''_z|.
    pub vertical_snap: R,
}

/// U_l of Lemma 1: half the L1 norm of the impulse response from ubar to u_f - u_s.
pub fn half_l1_norm<R: Real>(k_f: R, k_s: R) -> R {
    // (k_f / k_s)^(k_f / (k_s - k_f)) = exp(-ln(1 + x) / x) with x = k_s / k_f - 1.
    let x = k_s / k_f - 1.0;
    let exponent = if k_s == k_f { R::from(-1.0) } else { -x.ln_1p() / x };
    exponent.exp()
}

impl<R: Real> Reachable<R> {
    /// For filters of bandwidth `k_f`, `k_s` (1/s), feedback level `m_p` (m/s^2) and a reference within `bounds`.
    pub fn new(k_f: R, k_s: R, m_p: R, gravity: R, bounds: &ReferenceBounds) -> Self {
        let half_l1 = half_l1_norm(k_f, k_s);
        let axis_jerk = k_f * 2.0 * half_l1 * m_p;
        let axis_snap = k_f * 2.0 * m_p * (k_s + k_f * half_l1 * half_l1);
        let [jerk, snap, vertical, horizontal] =
            [bounds.jerk, bounds.snap, bounds.vertical_acceleration, bounds.horizontal_acceleration].map(R::from);
        // The Euclidean norms of two and of three axes.
        let [both, all] = [2.0, 3.0].map(|axes| R::from(axes).sqrt());
        Self {
            vertical_min: gravity - m_p - vertical,
            vertical_max: gravity + m_p + vertical,
            horizontal: both * m_p + horizontal,
            jerk: all * axis_jerk + jerk,
            horizontal_jerk: both * axis_jerk + jerk,
            vertical_jerk: axis_jerk + jerk,
            horizontal_snap: both * axis_snap + snap,
            vertical_snap: axis_snap + snap,
        }
    }

    /// Greatest |u|.
    pub fn magnitude(&self) -> R {
        self.horizontal.hypot(self.vertical_max)
    }
}
