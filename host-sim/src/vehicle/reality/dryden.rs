//! Turbulence in Dryden's form, MIL-F-8785C at low altitude.
//!
//! With h the altitude and W_20 the wind at 20 feet, lengths in feet:
//!
//! ```text
//! L_w = h,   L_u = L_v = h / (0.177 + 0.000823 h)^1.2
//! sigma_w = 0.1 W_20,   sigma_u = sigma_v = sigma_w / (0.177 + 0.000823 h)^0.4
//! ```
//!
//! u is along the mean wind's horizontal direction (along world x where it has none), v across it to the left, w up.
//! The spectra belong to white noise n of unit two-sided density that went through the filters (T = L / V, V the
//! airspeed)
//!
//! ```text
//! u = sigma sqrt(2 T) / (1 + T s) n                         autocorrelation sigma^2 e^-t
//! v, w = sigma sqrt(T) (1 + sqrt(3) T s) / (1 + T s)^2 n    autocorrelation sigma^2 e^-t (1 - t/2)       t = |lag| / T
//! ```
//!
//! Both are advanced exactly, a = h / T per step of h: the state x of unit variance in stationarity follows
//! x+ = Phi x + chol(I - Phi Phi') n with independent unit normal n, and starts stationary.
//!
//! ```text
//! u: Phi = e^-a, output sigma x
//! v, w: Phi = e^-a ((1 + a, a), (-a, 1 - a)), output sigma/2 (x_1 + sqrt(3) x_2)
//! ```
//!
//! There are no rotary gusts: the vehicle is small beside the turbulence.
//!
//! Source: MIL-F-8785C, *Flying Qualities of Piloted Airplanes*, 1980, sections 3.7.1.2, 3.7.3.4 and 3.7.3.5.

use nalgebra::Vector3;
use rand::SeedableRng;
use rand::rngs::Xoshiro256PlusPlus;
use rand_distr::{Distribution, StandardNormal};
use scenario::reality::wind;

const FOOT_M: f64 = 0.3048;

/// Turbulence at one place.
#[derive(Debug, Clone)]
pub struct Turbulence {
    random: Xoshiro256PlusPlus,
    /// The world's directions of u and v.
    along: Vector3<f64>,
    across: Vector3<f64>,
    u: FirstOrder,
    v: SecondOrder,
    w: SecondOrder,
}

impl Turbulence {
    /// Stationary turbulence in a mean wind of `steady`, m/s, that advances in steps of `step` s.
    #[must_use]
    pub fn new(turbulence: &wind::Turbulence, steady: &Vector3<f64>, step: f64) -> Self {
        let height = turbulence.altitude / FOOT_M;
        let ground = 0.177 + 0.000823 * height;
        let sigma_w = 0.1 * turbulence.wind_at_20_feet;
        let sigma_u = sigma_w / ground.powf(0.4);
        let (length_u, length_w) = (FOOT_M * height / ground.powf(1.2), turbulence.altitude);
        let steps = |length: f64| step * turbulence.airspeed / length;
        let mut random = Xoshiro256PlusPlus::seed_from_u64(turbulence.seed);
        let horizontal = Vector3::new(steady.x, steady.y, 0.0);
        let along = horizontal.try_normalize(0.0).unwrap_or_else(Vector3::x);
        Self {
            u: FirstOrder::new(sigma_u, steps(length_u), &mut random),
            v: SecondOrder::new(sigma_u, steps(length_u), &mut random),
            w: SecondOrder::new(sigma_w, steps(length_w), &mut random),
            along,
            across: Vector3::z().cross(&along),
            random,
        }
    }

    /// m/s, world.
    #[must_use]
    pub fn velocity(&self) -> Vector3<f64> {
        self.along * self.u.output() + self.across * self.v.output() + Vector3::z() * self.w.output()
    }

    /// Goes on by one step.
    pub fn advance(&mut self) {
        self.u.advance(&mut self.random);
        self.v.advance(&mut self.random);
        self.w.advance(&mut self.random);
    }
}

fn normal(random: &mut Xoshiro256PlusPlus) -> f64 {
    StandardNormal.sample(random)
}

/// sigma sqrt(2 T) / (1 + T s).
#[derive(Debug, Clone)]
struct FirstOrder {
    sigma: f64,
    decay: f64,
    noise: f64,
    state: f64,
}

impl FirstOrder {
    /// `steps` is a = h / T.
    fn new(sigma: f64, steps: f64, random: &mut Xoshiro256PlusPlus) -> Self {
        Self { sigma, decay: (-steps).exp(), noise: (-(-2.0 * steps).exp_m1()).sqrt(), state: normal(random) }
    }

    fn output(&self) -> f64 {
        self.sigma * self.state
    }

    fn advance(&mut self, random: &mut Xoshiro256PlusPlus) {
        self.state = self.decay * self.state + self.noise * normal(random);
    }
}

/// sigma sqrt(T) (1 + sqrt(3) T s) / (1 + T s)^2.
#[derive(Debug, Clone)]
struct SecondOrder {
    sigma: f64,
    /// a and e^-a.
    steps: f64,
    decay: f64,
    /// chol(I - Phi Phi'), by rows: l_11; l_21, l_22.
    noise: (f64, f64, f64),
    state: (f64, f64),
}

impl SecondOrder {
    fn new(sigma: f64, steps: f64, random: &mut Xoshiro256PlusPlus) -> Self {
        let state = (normal(random), normal(random));
        Self { sigma, steps, decay: (-steps).exp(), noise: noise_of(steps), state }
    }

    fn output(&self) -> f64 {
        0.5 * self.sigma * (self.state.0 + 3.0_f64.sqrt() * self.state.1)
    }

    fn advance(&mut self, random: &mut Xoshiro256PlusPlus) {
        let (a, (x, y)) = (self.steps, self.state);
        let (first, second) = (normal(random), normal(random));
        let (l_11, l_21, l_22) = self.noise;
        self.state = (
            self.decay * ((1.0 + a) * x + a * y) + l_11 * first,
            self.decay * ((1.0 - a) * y - a * x) + l_21 * first + l_22 * second,
        );
    }
}

/// chol(I - Phi Phi') for a step of a:
///
/// ```text
/// q_11 = 1 - e^-2a (1 + 2a + 2a^2),   q_12 = 2 a^2 e^-2a,   q_22 = 1 - e^-2a (1 - 2a + 2a^2)
/// ```
fn noise_of(a: f64) -> (f64, f64, f64) {
    let left = (-2.0 * a).exp();
    // q_11 = e^-2a ((2a)^3/3! + (2a)^4/4! + ...): of small a the closed form leaves nothing but rounding.
    let q_11 = if a < 0.5 {
        let terms = (4..30).scan((2.0 * a).powi(3) / 6.0, |term, n| {
            let now = *term;
            *term *= 2.0 * a / f64::from(n);
            Some(now)
        });
        left * terms.sum::<f64>()
    } else {
        1.0 - left * (1.0 + 2.0 * a + 2.0 * a * a)
    };
    let q_12 = 2.0 * a * a * left;
    let q_22 = -(-2.0 * a).exp_m1() + left * (2.0 * a - 2.0 * a * a);
    let l_11 = q_11.sqrt();
    let l_21 = if l_11 > 0.0 { q_12 / l_11 } else { 0.0 };
    (l_11, l_21, (q_22 - l_21 * l_21).max(0.0).sqrt())
}

#[cfg(test)]
mod tests;
