//! A first-order lag followed by integrators, solved exactly over a stretch of held input.
//!
//! ```text
//! a' = (w - a) / lag,   y_1' = a,   y_2' = y_1,   y_3' = y_2,   y_4' = y_3
//! ```
//!
//! The m-fold integral of e^(-s/lag) from 0 to t is t^m phi_m(t/lag), where phi_0(x) = e^-x and
//! phi_m(x) = sum over k of (-x)^k / (k + m)!. What a held w adds to y_m is the rest: t^m (1/m! - phi_m) =
//! t^m x phi_(m+1). Those are the entries of the matrix exponential, without forming one; no step of it cancels, for
//! any ratio of t to the lag, and a lag of zero is an ordinary case.

/// The longest chain: from the torque through rate, tilt and velocity to the position.
pub(super) const INTEGRATORS_MAX: usize = 4;

/// 1/m!.
pub(super) const INVERSE_FACTORIAL: [f64; INTEGRATORS_MAX + 2] = [1.0, 1.0, 0.5, 1.0 / 6.0, 1.0 / 24.0, 1.0 / 120.0];

/// Entry m is for y_m (y_0 = a) at the end of a stretch.
#[derive(Debug, Clone, Copy)]
pub(super) struct LagResponse {
    /// The effect of a unit of `a` at the start on y_m.
    pub free: [f64; INTEGRATORS_MAX + 1],
    /// The effect of a unit of held input on y_m.
    pub forced: [f64; INTEGRATORS_MAX + 1],
}

impl LagResponse {
    /// Over a stretch of `duration` > 0, with `lag` >= 0 in the same unit of time.
    pub fn over(duration: f64, lag: f64) -> Self {
        // Without lag the input is integrated as it stands: 1/m!.
        let mut response = Self { free: [0.0; _], forced: core::array::from_fn(|m| INVERSE_FACTORIAL[m]) };
        let x = duration / lag;
        if x.is_finite() {
            let phi = phi(x);
            for (m, (free, forced)) in response.free.iter_mut().zip(&mut response.forced).enumerate() {
                *free = phi[m];
                *forced = x * phi[m + 1];
            }
        }
        let mut power = 1.0;
        for (free, forced) in response.free.iter_mut().zip(&mut response.forced) {
            *free *= power;
            *forced *= power;
            power *= duration;
        }
        response
    }
}

/// What held commands, some samples late, do to a and y_m in one sample:
///
/// ```text
/// y_m+ = sum_j y_(m-j) / j! + free_m a + newer_m w_(k-n) + older_m w_(k-n-1)
/// newer_m = forced_m(1 - f),   older_m = forced_m(1) - forced_m(1 - f)
/// ```
///
/// with n whole samples of delay and a fraction f.
#[derive(Debug, Clone, Copy)]
pub(super) struct Arrival {
    /// n.
    pub whole_delay: usize,
    /// Per `a`.
    pub free: [f64; INTEGRATORS_MAX + 1],
    /// Per w_(k-n).
    pub newer: [f64; INTEGRATORS_MAX + 1],
    /// Per w_(k-n-1).
    pub older: [f64; INTEGRATORS_MAX + 1],
}

impl Arrival {
    /// Through an actuator of the given lag >= 0, `delay` >= 0 late, both in samples.
    pub fn new(lag: f64, delay: f64) -> Self {
        let whole_delay = delay.floor();
        let full = LagResponse::over(1.0, lag);
        let late = LagResponse::over(1.0 - (delay - whole_delay), lag);
        let mut older = full.forced;
        for (older, newer) in older.iter_mut().zip(&late.forced) {
            *older -= newer;
        }
        Self { whole_delay: whole_delay as usize, free: full.free, newer: late.forced, older }
    }

    /// The same with so much more of every command.
    pub fn times(&self, gain: f64) -> Self {
        let scaled = |weights: [f64; INTEGRATORS_MAX + 1]| weights.map(|weight| gain * weight);
        Self { newer: scaled(self.newer), older: scaled(self.older), ..*self }
    }

    /// How many commands before the present one still count.
    pub fn earlier_commands(&self) -> usize {
        self.whole_delay + usize::from(self.older.iter().any(|older| *older != 0.0))
    }
}

/// phi_0 to phi_(INTEGRATORS_MAX + 1) at x > 0, linked by phi_m = 1/m! - x phi_(m+1).
fn phi(x: f64) -> [f64; INTEGRATORS_MAX + 2] {
    /// Terms of the series; at x = 1 the first one left out is below 1e-20 of the sum.
    const SERIES_TERMS: u32 = 18;
    const PHI_ORDER_MAX: usize = INTEGRATORS_MAX + 1;
    let mut phi = [0.0; INTEGRATORS_MAX + 2];
    if x <= 1.0 {
        // The series for the last one, then downwards: each step shrinks the error by x.
        let mut term = INVERSE_FACTORIAL[PHI_ORDER_MAX];
        for k in 1..=SERIES_TERMS {
            phi[PHI_ORDER_MAX] += term;
            term *= -x / (f64::from(k) + PHI_ORDER_MAX as f64);
        }
        for m in (0..PHI_ORDER_MAX).rev() {
            phi[m] = INVERSE_FACTORIAL[m] - x * phi[m + 1];
        }
    } else {
        phi[0] = (-x).exp();
        for m in 0..PHI_ORDER_MAX {
            phi[m + 1] = (INVERSE_FACTORIAL[m] - phi[m]) / x;
        }
    }
    phi
}

#[cfg(test)]
mod tests;
