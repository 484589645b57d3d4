//! The paper's flight as one number, computed here: the one that desktop and boards have.

use host_sim::flight::Flight;
use paper_flight::{FLIGHT_TICKS, Replay, record};
use scenario::Scenario;
use serde::Serialize;

/// The number as published.
const PUBLISHED_HASH: &str = include_str!("../../tests/paper_flight.sha256");

/// The number here and the published one.
#[derive(Debug, Serialize)]
pub struct Number {
    /// 64 hexadecimal digits.
    pub hash: String,
    /// As published.
    pub published: &'static str,
    /// Whether they agree.
    pub same: bool,
}

/// Flies the paper's scenario and has [`paper_flight`] make its number.
///
/// # Errors
/// If a machine computes so wrongly that the flight ends.
pub fn number() -> Result<Number, String> {
    let scenario = Scenario::paper().map_err(|error| error.to_string())?;
    let mut flight = Flight::new(&scenario).map_err(|error| error.to_string())?;
    let mut replay = Replay::new().ok_or("the paper's vehicle is not certified here")?;
    for _ in 0..FLIGHT_TICKS {
        let state = flight.tick().map_err(|error| error.to_string())?.state.measured();
        replay.tick(&record(&state)).map_err(|error| error.to_string())?;
    }
    let (hash, published) = (replay.digest().as_str().to_owned(), PUBLISHED_HASH.trim());
    Ok(Number { same: hash == published, hash, published })
}
