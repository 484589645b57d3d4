//! The figures of the trials, and the cost that a search minimises.

use super::models::COST_MODELS;

/// The trials' figures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrialFigures {
    /// Height lost in the recovery, m.
    pub height_lost: f64,
    /// Until the recovery is within 0.1 m for good, s.
    pub recovered: f64,
    /// Until the recovery's yaw is within 0.1 rad for good, s.
    pub turned: f64,
    /// Deepest excursion in the gust, m.
    pub gust: f64,
    /// The offset at the gust's end, m.
    pub offset: f64,
    /// Until the step is within 0.1 m for good, s.
    pub step: f64,
    /// Change of a rotor's command within 10 ms under noise, rms, as a share of its thrust in hover; zero without
    /// rotors.
    pub activity: f64,
    /// Position under noise, m, rms.
    pub noise: f64,
    /// The figures beyond a law's promise, on the file's own model; `None` for another model.
    pub beyond: Option<HarderTrialFigures>,
    /// Commands that a limit cut, in all trials.
    pub clipped: u64,
}

/// The figures of the trials beyond a law's promise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HarderTrialFigures {
    /// Deepest excursion in the storm, m.
    pub storm: f64,
    /// Until the far step is within 0.1 m for good, s.
    pub far: f64,
    /// Until the step with weak rotors is within 0.1 m for good, s.
    pub weak: f64,
    /// Height lost in the heavy vehicle's recovery, m.
    pub heavy_lost: f64,
    /// Until it is within 0.1 m for good, s.
    pub heavy: f64,
}

/// A figure: its name, its unit, the value with which a pilot begins to be content, and its weight.
pub type Figure = (&'static str, &'static str, f64, f64);

/// The figures that every model shows, as [`TrialFigures::values`].
pub const MODEL_FIGURES: [Figure; 7] = [
    ("upside down: height lost", "m", 3.0, 1.0),
    ("upside down: back for good after", "s", 5.0, 1.0),
    ("upside down: yaw back after", "s", 8.0, 1.0),
    ("gust of 5 m/s: excursion", "m", 0.3, 1.0),
    ("step of 1 m: there after", "s", 2.0, 1.0),
    ("noise: position, rms", "m", 4e-3, 1.0),
    ("noise: rotor command's change in 10 ms", "of hovering", 0.05, 0.5),
];

/// The figures of the file's own model alone, as [`HarderTrialFigures::values`].
pub const OWN_MODEL_FIGURES: [Figure; 5] = [
    ("storm of 12 m/s: excursion", "m", 2.0, 0.5),
    ("step of 10 m: there after", "s", 5.0, 1.0),
    ("step with weak rotors: there after", "s", 4.0, 0.5),
    ("upside down, heavy: height lost", "m", 6.0, 0.5),
    ("upside down, heavy: back after", "s", 8.0, 0.5),
];

/// No figure counts more than this many times its content value, so that the other figures judge a vehicle that cannot
/// fly one of the trials.
const FIGURE_COST_MAX: f64 = 10.0;

/// The weighted sum of `values`.
fn weighted(figures: &[Figure], values: &[f64]) -> f64 {
    let parts = figures.iter().zip(values);
    parts.map(|((_, _, content, weight), value)| weight * (value / content).min(FIGURE_COST_MAX)).sum()
}

impl HarderTrialFigures {
    /// The values of [`OWN_MODEL_FIGURES`].
    pub fn values(&self) -> [f64; 5] {
        [self.storm, self.far, self.weak, self.heavy_lost, self.heavy]
    }
}

impl TrialFigures {
    /// The values of [`MODEL_FIGURES`].
    pub const fn values(&self) -> [f64; 7] {
        [self.height_lost, self.recovered, self.turned, self.gust, self.step, self.noise, self.activity]
    }

    /// The weighted sum that a search minimises. A figure of only one of the `COST_MODELS` counts as if all had it.
    pub fn cost(&self) -> f64 {
        let beyond = self.beyond.map_or(0.0, |beyond| weighted(&OWN_MODEL_FIGURES, &beyond.values()));
        weighted(&MODEL_FIGURES, &self.values()) + COST_MODELS.len() as f64 * beyond
    }
}
