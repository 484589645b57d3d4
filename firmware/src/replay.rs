//! Recorded flights as numbers, for comparing machines bit by bit: the paper's, in a [crate of its own](paper_flight),
//! and what else a tick computes, for the scenario that is built in.

pub mod estimate;
pub mod recovery;
pub mod shielded;

use crate::configuration;
use controller_core::configuration::{Configuration, ExtendedLaw, LawParameters};
use controller_core::extended::actuators::ActuatorParameters;
pub use paper_flight::{FLIGHT_TICKS, Hash, PERIOD_US, Replay, STATE_BYTES, papers, record, state};

/// Times between the ticks at which a recovery is replayed: 100 Hz, 500 Hz and 1 kHz.
pub const PERIODS_US: [u64; 3] = [10_000, 2_000, 1_000];

/// The embedded scenario with commands a tick of `period` us late, as its file has them at 100 Hz. None if it is for
/// another law.
pub fn embedded_at(period: u64) -> Option<Configuration> {
    let embedded = configuration::embedded().ok()?;
    let LawParameters::Extended(law) = embedded.law() else { return None };
    let ExtendedLaw { parameters, actuators } = law;
    let actuators = ActuatorParameters { delay: period as f32 * 1e-6, ..*actuators };
    let law = ExtendedLaw { parameters: *parameters, actuators };
    let late = Configuration::extended(*embedded.vehicle(), *embedded.limits(), law, *embedded.bounds()).ok()?;
    late.with_rotors(embedded.rotors()?.clone()).ok()
}
