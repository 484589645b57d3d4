//! The residuals between model and log, whitened: the innovations of a Kalman filter.
//!
//! On each axis the residual r is measured with white noise, and driven by an acceleration b that comes and goes
//! (turbulence, what the estimator errs in attitude) and by a random walk of its own (what the estimator corrects):
//!
//! ```text
//! r_k+1 = r_k + T b_k + n_r + n_i,   b_k+1 = e^(-T / T_b) b_k + n_b,   y_k = r_k + n
//! ```
//!
//! n_i is the effect of n_b on r within the period: variance T^2/3 of n_b's, covariance with it T/2, for T well below
//! T_b. Without it innovations would go on for a second sample, and the numbers would seem surer than they are.
//!
//! The three levels and T_b are those of greatest likelihood ([`Noise::fitted`]). The filter is linear: passed through
//! it, residuals and their derivatives become those of a weighted least-squares problem with white noise. Innovations
//! depend on the past only, so feedback from noise to commands leaves the estimate without bias: the direct method of
//! closed-loop identification. Source: L. Ljung, *System Identification*, 2nd edition, sections 7.2 and 13.4.

/// The noise of one axis. Ratios are to the white noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Of b where it stands: its standard deviation, 1/s^2 of the white noise's.
    pub wander: f64,
    /// T_b, s.
    pub time: f64,
    /// Of n_r for a step: its standard deviation over the white noise's.
    pub walk: f64,
}

/// How the filter takes each sample: its gains and the square root of the innovation's variance.
#[derive(Debug, Clone)]
pub struct Whitening {
    period: f64,
    decay: f64,
    /// Per sample until they settle: gains, deviation.
    gains: Vec<([f64; 2], f64)>,
}

/// The factors by which levels are searched.
const LEVEL_SEARCH_FACTORS: [f64; 4] = [16.0, 4.0, 2.0, 1.4];

impl Noise {
    /// Where the search begins.
    pub const START: Self = Self { wander: 30.0, time: 3.0, walk: 0.1 };

    /// The noise that makes `residuals`, a sample each `period`, s, most likely; searched from `self`.
    #[must_use]
    pub fn fitted(self, residuals: &[f64], period: f64) -> Self {
        let mut best = (self.cost(residuals, period), self);
        for step in LEVEL_SEARCH_FACTORS {
            for _ in 0..4 {
                let before = best.0;
                for factor in [step, 1.0 / step] {
                    let now = best.1;
                    let tried = [
                        Self { wander: (now.wander * factor).clamp(1e-3, 1e6), ..now },
                        Self { time: (now.time * factor).clamp(0.05, 20.0), ..now },
                        Self { walk: (now.walk * factor).clamp(1e-4, 1e3), ..now },
                        // As much driven in a short time, for longer: along this the likelihood changes least.
                        Self {
                            wander: (now.wander * factor).clamp(1e-3, 1e6),
                            time: (now.time * factor * factor).clamp(0.05, 20.0),
                            ..now
                        },
                    ];
                    for noise in tried {
                        let cost = noise.cost(residuals, period);
                        if cost < best.0 {
                            best = (cost, noise);
                        }
                    }
                }
                if best.0 >= before {
                    break;
                }
            }
        }
        best.1
    }

    /// Minus twice the log-likelihood, without constants, for the white noise that fits best.
    fn cost(&self, residuals: &[f64], period: f64) -> f64 {
        let whitening = self.whitening(residuals.len(), period);
        let white = whitening.whiten(residuals);
        let count = white.len() as f64;
        let spread: f64 = (0..residuals.len()).skip(SETTLING_INNOVATIONS).map(|k| 2.0 * whitening.at(k).1.ln()).sum();
        count * (white.iter().map(|e| e * e).sum::<f64>() / count).ln() + spread
    }

    /// The filter for so many samples.
    #[must_use]
    pub fn whitening(&self, samples: usize, period: f64) -> Whitening {
        let decay = (-period / self.time).exp();
        let (walk, fresh) = (self.walk * self.walk, self.wander * self.wander * (1.0 - decay * decay));
        // p_rr, p_rb, p_bb; where r begins is not known.
        let (mut rr, mut rb, mut bb) = (1e8, 0.0, self.wander * self.wander);
        let mut gains: Vec<([f64; 2], f64)> = Vec::new();
        for _ in 0..samples {
            let variance = rr + 1.0;
            let gain = [rr / variance, rb / variance];
            let settled = gains.last().is_some_and(|(last, _)| {
                (last[0] - gain[0]).abs() < 1e-9 && (last[1] - gain[1]).abs() < 1e-9 * (1.0 + gain[1].abs())
            });
            gains.push((gain, variance.sqrt()));
            if settled {
                break;
            }
            let (kept_rr, kept_rb, kept_bb) = (rr * (1.0 - gain[0]), rb * (1.0 - gain[0]), bb - gain[1] * rb);
            rr = kept_rr + 2.0 * period * kept_rb + period * period * (kept_bb + fresh / 3.0) + walk;
            rb = decay * (kept_rb + period * kept_bb) + 0.5 * period * fresh;
            bb = decay * decay * kept_bb + fresh;
        }
        Whitening { period, decay, gains }
    }
}

/// The innovations that say only where r begins.
const SETTLING_INNOVATIONS: usize = 3;

impl Whitening {
    fn at(&self, sample: usize) -> ([f64; 2], f64) {
        self.gains.get(sample).or(self.gains.last()).copied().unwrap_or(([0.0; 2], 1.0))
    }

    /// Innovations over their deviations in units of the white noise, without the first few.
    #[must_use]
    pub fn whiten(&self, residuals: &[f64]) -> Vec<f64> {
        let mut white = Vec::with_capacity(residuals.len());
        self.run(residuals, |innovation, _| white.push(innovation));
        white.drain(..SETTLING_INNOVATIONS.min(white.len()));
        white
    }

    /// b as the filter knows it at each sample.
    #[must_use]
    pub fn wander(&self, residuals: &[f64]) -> Vec<f64> {
        let mut wander = Vec::with_capacity(residuals.len());
        self.run(residuals, |_, b| wander.push(b));
        wander
    }

    fn run(&self, residuals: &[f64], mut take: impl FnMut(f64, f64)) {
        let (mut r, mut b) = (0.0, 0.0);
        for (sample, measured) in residuals.iter().enumerate() {
            let ([gain_r, gain_b], deviation) = self.at(sample);
            let innovation = measured - r;
            r += gain_r * innovation;
            b += gain_b * innovation;
            take(innovation / deviation, b);
            r += self.period * b;
            b *= self.decay;
        }
    }
}
