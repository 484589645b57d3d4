//! Whether a scenario may fly.
//!
//! Three things must hold of a vehicle, and none says anything about the others:
//!
//! - the *certificate* is a proof about commands: whatever the vehicle does, the law never asks for more than it has. A
//!   vehicle whose rotors follow a second late falls with every command within its limits.
//! - the [sampled loops](crate::sampled_loop) are an analysis of small motions about hover: with this period, delay and
//!   lag they die out, with [`LoopMargin::FLYABLE_MIN`] to spare. It knows nothing of limits and large angles.
//! - the [model flights](crate::large_motions) of the extended law show that large motions die out too, from a few
//!   starts. The paper's law, which swings for minutes about a target that is far away, has its theorem.
//!
//! Together they are what can be said without the vehicle. None is a proof that a recovery succeeds. Under the extended
//! law a fourth is about the file's own reference: [along itself](crate::along) it must take less than what is left,
//! and the model must stay near it.

use crate::along::Along;
use crate::file::Scenario;
use crate::large_motions::on_path::{OnPath, Path};
use crate::large_motions::{self, Farthest, NotArrived};
use crate::reference::ReferenceKind;
use crate::sampled_loop::LoopReport;
use crate::stability::{Lack, LoopMargin, Shortfall};
use controller_core::certificate::Certificate;
use controller_core::certificate::certified::{Certified, Refused};
use controller_core::certificate::inequality::Inequality;
use controller_core::configuration::LawParameters;
use controller_core::error::ParameterError;
use std::fmt;

/// Certificate, sampled loops and model flights of one scenario.
#[derive(Debug, Clone)]
pub struct Verdict {
    /// The certificate, and with it the key to flight where it holds.
    proof: Result<Box<Certified>, Box<Certificate>>,
    loops: [LoopReport; 6],
    /// The model flights; none are flown where one of the others does not hold.
    flights: Option<Result<Farthest, NotArrived>>,
    /// What the reference takes, under the extended law.
    along: Option<Along>,
    /// How the model flies the reference, where all else holds and it moves.
    on_path: Option<Result<OnPath, NotArrived>>,
}

/// Why a scenario may not fly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Refusal {
    /// An inequality of the certificate.
    Inequality(Inequality),
    /// A sampled loop.
    Loop(Lack),
    /// A model flight.
    Flight(NotArrived),
    /// The reference.
    Reference(Along),
}

impl Verdict {
    /// Works both out for `scenario`.
    ///
    /// # Errors
    /// If a number is beyond what the certificate or the loops can work with; no file that was read leads there.
    pub fn judge(scenario: &Scenario) -> Result<Self, ParameterError> {
        let proof = match Certified::new(scenario.configuration.clone()) {
            Ok(certified) => Ok(Box::new(certified)),
            Err(Refused::Fails(certificate)) => Err(Box::new(certificate)),
            Err(Refused::Undefined(error)) => return Err(error),
        };
        let loops = scenario.loops()?.reports();
        let is_extended = matches!(scenario.configuration.law(), LawParameters::Extended(_));
        let flights = match &proof {
            Ok(certified) if is_extended && LoopMargin::FLYABLE_MIN.first_lacking(&loops).is_none() => {
                Some(large_motions::flown(certified, &scenario.loop_timing())?)
            }
            _ => None,
        };
        let along = Along::judge(scenario);
        let on_path = match (&proof, flights, along) {
            (Ok(certified), Some(Ok(_)), Some(along)) if along.holds() && along.end_us > 0 => {
                let path = Path {
                    trajectory: &*scenario.trajectory,
                    end_us: along.end_us,
                    repeats: matches!(scenario.reference, ReferenceKind::Harmonic(_)),
                    tolerance: scenario.tolerance,
                };
                Some(path.flown(certified, &scenario.loop_timing())?)
            }
            _ => None,
        };
        Ok(Self { proof, loops, flights, along, on_path })
    }

    /// Everything for which the scenario may not fly: each inequality that fails, each loop without margin, unstable
    /// ones first, the first model flight that does not arrive, the reference, and the model's flight along it.
    pub fn refusals(&self) -> impl Iterator<Item = Refusal> {
        let failing = self.certificate().inequalities().filter(|inequality| !inequality.holds());
        let lacking = self.loops.iter().filter_map(|report| LoopMargin::FLYABLE_MIN.lacking(report));
        let (unstable, weak): (Vec<_>, Vec<_>) =
            lacking.partition(|lack| matches!(lack.what, Shortfall::Unstable { .. }));
        failing
            .copied()
            .map(Refusal::Inequality)
            .chain(unstable.into_iter().chain(weak).map(Refusal::Loop))
            .chain(self.not_arrived().map(Refusal::Flight))
            .chain(self.along.filter(|along| !along.holds()).map(Refusal::Reference))
            .chain(self.on_path.and_then(Result::err).map(Refusal::Flight))
    }

    /// The first of them; none if the scenario may fly.
    #[must_use]
    pub fn refusal(&self) -> Option<Refusal> {
        self.refusals().next()
    }

    /// The certificate, whether it holds or not.
    #[must_use]
    pub fn certificate(&self) -> &Certificate {
        self.proof.as_ref().map_or_else(|certificate| &**certificate, |certified| certified.certificate())
    }

    /// The certified configuration, if the certificate holds.
    #[must_use]
    pub fn certified(&self) -> Option<&Certified> {
        self.proof.as_ref().ok().map(|certified| &**certified)
    }

    /// The sampled loops.
    #[must_use]
    pub fn loops(&self) -> &[LoopReport; 6] {
        &self.loops
    }

    /// The model flights, if any were flown: the one that was farthest off, or the first that does not arrive.
    #[must_use]
    pub fn flights(&self) -> Option<Result<Farthest, NotArrived>> {
        self.flights
    }

    /// What the reference takes of what its vehicle leaves; none under the paper's law.
    #[must_use]
    pub fn along(&self) -> Option<&Along> {
        self.along.as_ref()
    }

    /// How the model flies the reference, if it was flown.
    #[must_use]
    pub fn on_path(&self) -> Option<Result<OnPath, NotArrived>> {
        self.on_path
    }

    /// The first model flight that does not arrive.
    #[must_use]
    pub fn not_arrived(&self) -> Option<NotArrived> {
        self.flights?.err()
    }

    /// The first loop that is unstable, or else without [`LoopMargin::FLYABLE_MIN`].
    #[must_use]
    pub fn lacking(&self) -> Option<Lack> {
        LoopMargin::FLYABLE_MIN.first_lacking(&self.loops)
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Inequality(inequality) => {
                let Inequality { name, unit, required, available, .. } = inequality;
                write!(f, "certificate, {name}: requires {required:.4} {unit}, available {available:.4} {unit}")
            }
            Self::Loop(lack) => write!(f, "{lack}"),
            Self::Flight(not_arrived) => write!(f, "{not_arrived}"),
            Self::Reference(along) => write!(f, "{along}"),
        }
    }
}

#[cfg(test)]
mod tests;
