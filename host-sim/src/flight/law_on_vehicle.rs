//! The law that flies: ours, or a rival with its gains.
//!
//! A [`LawChoice`] names a law; a [`LawOnVehicle`] is that law on one vehicle, ready for any number of flights. Our law
//! is certified once for all flights, as on boards; an uncertified one flies as its scenario has it.

use crate::flight::Flight;
use crate::rivals::choice::{LawChoice, OUR_LAW};
use crate::rivals::kind::RivalKind;
use crate::rivals::rival::Rival;
use controller_core::certificate::certified::Certified;
use controller_core::error::ParameterError;
use scenario::Scenario;

/// A law on a vehicle.
#[derive(Debug)]
pub enum LawOnVehicle {
    /// The scenario's own, with what certifies it, if anything does.
    Ours(Option<Box<Certified>>),
    /// Another one, at the start of a flight.
    Rival(RivalKind, Box<dyn Rival>),
}

impl LawOnVehicle {
    /// The law of `choice` on the vehicle of `scenario`, which is what a rival knows of it. `certified` is what
    /// certifies ours. None if the rival is undefined for its gains.
    pub fn new(choice: &LawChoice, scenario: &Scenario, certified: Option<&Certified>) -> Option<Self> {
        Some(match choice {
            LawChoice::Ours => Self::Ours(certified.cloned().map(Box::new)),
            LawChoice::Rival(kind, gains) => Self::Rival(*kind, kind.build(scenario, gains)?),
        })
    }

    /// Its name beside others.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Ours(_) => OUR_LAW,
            Self::Rival(kind, _) => kind.name(),
        }
    }

    /// A flight in the circumstances of `scenario`.
    ///
    /// # Errors
    /// If our law refuses the scenario's period; none that was read from a file does.
    pub fn flight(&self, scenario: &Scenario) -> Result<Flight, ParameterError> {
        match self {
            Self::Ours(Some(certified)) => Flight::certified(scenario, certified),
            Self::Ours(None) => Flight::uncertified(scenario),
            Self::Rival(_, rival) => Ok(Flight::of_rival(scenario, rival.boxed())),
        }
    }
}
