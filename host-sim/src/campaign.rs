//! Many flights at once: on all cores, without a file.
//!
//! A campaign is a number of flights in circumstances that differ: where they start, what the vehicle really is, how the air
//! moves, how noisy the sensors are, what is asked for. Each flight's circumstances come from its number alone, so a campaign gives
//! the same again whatever the number of cores, and any of its flights can be flown again by itself.

pub mod draw;
pub mod hours;
pub mod outcome;
pub mod recoveries;

use crate::flight::Flight;
use controller_core::certificate::certified::Certified;
use controller_core::error::ParameterError;
use rayon::prelude::*;
use scenario::Scenario;

/// Flies the flights 0 to `count` - 1 on all cores: each in its `circumstances`, and of each what `gather` makes of it, in the
/// order of their numbers. With `certified` the law and the allocation are those that boards fly, certified once for all
/// flights; without it each is flown as the uncertified configuration that its scenario has.
///
/// # Errors
/// [`ParameterError`] if the law refuses a scenario's period; a [`Scenario`] that was read from a file has a good one.
pub fn fly_all<T: Send>(
    certified: Option<&Certified>,
    count: u64,
    circumstances: impl Fn(u64) -> Scenario + Sync,
    gather: impl Fn(&Scenario, Flight) -> T + Sync,
) -> Result<Vec<T>, ParameterError> {
    let fly = |number| {
        let scenario = circumstances(number);
        let flight = match certified {
            Some(certified) => Flight::certified(&scenario, certified),
            None => Flight::uncertified(&scenario),
        };
        Ok(gather(&scenario, flight?))
    };
    (0..count).into_par_iter().map(fly).collect()
}

/// The value below which `part`, 0 to 1, of `values` lie; none of no values. Values that are no numbers count as the greatest.
#[must_use]
pub fn quantile(values: &[f64], part: f64) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(|a, b| a.is_nan().cmp(&b.is_nan()).then(a.total_cmp(b)));
    let last = sorted.len().checked_sub(1)?;
    sorted.get((part.clamp(0.0, 1.0) * last as f64).round() as usize).copied()
}

#[cfg(test)]
mod tests;
