//! What judges a path for a configuration.

use controller_core::certificate::path::PathJudge;
use controller_core::configuration::{Configuration, LawParameters};
use controller_core::math::real::Real;

/// The judge of a configuration; none under the paper's law.
#[must_use]
pub fn judge<R: Real>(configuration: &Configuration, force_kept: f32) -> Option<PathJudge<R>> {
    match configuration.law() {
        LawParameters::Extended(law) => Some(PathJudge::new(configuration, law, force_kept)),
        LawParameters::Paper(_) => None,
    }
}
