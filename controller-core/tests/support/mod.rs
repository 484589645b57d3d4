//! What the reference tests share: random numbers with a fixed seed, and a reference's derivatives as numbers.

pub mod coq;
pub mod gappa;
pub mod hummingbird;

use controller_core::reference::{Reference, ReferenceBounds};

/// SplitMix64.
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform in [low, high).
    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.bits() >> 11) as f64 / 9_007_199_254_740_992.0)
    }

    /// Between low and high, all magnitudes equally likely.
    pub fn magnitude(&mut self, low: f64, high: f64) -> f64 {
        self.within(low.ln(), high.ln()).exp()
    }
}

/// The six quantities of Assumption 1 at one instant, computed in double precision from what is flown.
pub fn demands(reference: &Reference) -> [f64; 6] {
    let a = reference.acceleration.map(f64::from);
    let rate = f64::from(reference.heading.rate());
    let turning = f64::from(reference.heading.acceleration());
    [
        a.x.hypot(a.y),
        a.z.abs(),
        reference.jerk.map(f64::from).norm(),
        reference.snap.map(f64::from).norm(),
        rate.abs(),
        turning.hypot(rate * rate),
    ]
}

/// The bounds on them, in the same order.
pub fn bounds(bounds: &ReferenceBounds) -> [f64; 6] {
    [
        bounds.horizontal_acceleration,
        bounds.vertical_acceleration,
        bounds.jerk,
        bounds.snap,
        bounds.heading_rate,
        bounds.heading_second_derivative,
    ]
    .map(f64::from)
}

/// The position's derivatives, from the position itself to snap.
pub fn derivatives(reference: &Reference) -> [[f64; 3]; 5] {
    let r = reference;
    [r.position, r.velocity, r.acceleration, r.jerk, r.snap].map(|v| v.map(f64::from).into())
}

/// psi in (-pi, pi].
pub fn psi(reference: &Reference) -> f64 {
    let direction = reference.heading.direction().map(f64::from);
    direction.y.atan2(direction.x)
}

/// The difference of two angles in (-pi, pi].
pub fn turn(to: f64, from: f64) -> f64 {
    (to - from).sin().atan2((to - from).cos())
}

/// df/dt at `time_us` from four neighbours `step_us` apart: error step^4 f^(5) / 30.
pub fn slope(f: impl Fn(u64) -> f64, time_us: u64, step_us: u64) -> f64 {
    let difference = |n: u64| f(time_us + n * step_us) - f(time_us - n * step_us);
    (8.0 * difference(1) - difference(2)) / (12.0 * step_us as f64 * 1e-6)
}
