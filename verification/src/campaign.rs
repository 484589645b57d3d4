//! A campaign without files.

use controller_core::certificate::certified::Certified;
use controller_core::error::ParameterError;
use host_sim::flight::Flight;
use rayon::prelude::*;
use scenario::Scenario;

/// Flies the flights 0 to `count` - 1 on all cores, each in its `circumstances`, under the law and the allocation of
/// `certified`. Returns what `gather` makes of each, in the order of their numbers.
///
/// # Errors
/// [`ParameterError`] if the law refuses a scenario's period; a [`Scenario`] that was read from a file has a good one.
pub fn fly_all<T: Send>(
    certified: &Certified,
    count: u64,
    circumstances: impl Fn(u64) -> Scenario + Sync,
    gather: impl Fn(&Scenario, Flight) -> T + Sync,
) -> Result<Vec<T>, ParameterError> {
    let fly = |number| {
        let scenario = circumstances(number);
        let flight = Flight::certified(&scenario, certified)?;
        Ok(gather(&scenario, flight))
    };
    (0..count).into_par_iter().map(fly).collect()
}
