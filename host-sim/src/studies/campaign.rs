//! Many flights at once, on all cores.
//!
//! A campaign is a number of flights in circumstances that differ: where they start, what the vehicle really is, how
//! the air moves, how noisy the sensors are, which reference it flies. Each flight's circumstances come from its number
//! alone, so a campaign gives the same again whatever the number of cores, and any of its flights can be flown again by
//! itself.
//!
//! | module | what it holds |
//! |---|---|
//! | [`draw`], [`random_flight`] | the circumstances of a flight, from seed and number; that flight under a law |
//! | [`written`] | those circumstances in the report of one flight |
//! | [`step`] | the plant step of a campaign's flights |
//! | [`outcome`], [`rows`] | what a flight showed; that as columns in Arrow's format |
//! | [`rotor_loss`], [`losses`] | what it showed of a rotor that failed or was taken to; that of all flights |
//! | [`manifest`], [`store`], [`batches`] | what a directory holds; its files; those with flights in them |
//! | [`fly`], [`summary`], [`report`] | the commands `campaign` and `merge`, what they print, and their page |

pub mod batches;
pub mod columns;
pub mod draw;
pub mod fly;
pub mod losses;
pub mod manifest;
pub mod outcome;
pub mod random_flight;
pub mod report;
pub mod rotor_loss;
pub mod rows;
pub mod step;
pub mod store;
pub mod summary;
pub mod written;

use arrow_schema::ArrowError;
use std::fmt;

/// Why a campaign ended before its end.
#[derive(Debug)]
pub enum CampaignError {
    /// Input that cannot be used.
    Input(String),
    /// Output that cannot be written.
    Output(String),
    /// The flights do not fit their columns.
    Rows(ArrowError),
    /// Interrupted by this signal. What was finished is kept.
    Interrupted(u8),
}

impl fmt::Display for CampaignError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input(what) | Self::Output(what) => f.write_str(what),
            Self::Rows(error) => write!(f, "{error}"),
            Self::Interrupted(signal) => {
                write!(
                    f,
                    "interrupted by signal {signal}; what was finished is kept, and the same command goes on from there"
                )
            }
        }
    }
}

impl std::error::Error for CampaignError {}

/// The value below which `part`, 0 to 1, of `values` lie; none of no values. Values that are no numbers count as the
/// greatest.
#[must_use]
pub fn quantile(values: &[f64], part: f64) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(|a, b| a.is_nan().cmp(&b.is_nan()).then(a.total_cmp(b)));
    let last = sorted.len().checked_sub(1)?;
    sorted.get((part.clamp(0.0, 1.0) * last as f64).round() as usize).copied()
}

#[cfg(test)]
mod tests;
