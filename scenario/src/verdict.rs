//! Whether a scenario may fly.
//!
//! Two things must hold, and neither says anything about the other:
//!
//! - the *certificate* is a proof about commands: whatever the vehicle does, the law never asks for more than it has. A
//!   vehicle whose rotors follow a second late falls with every command within its limits.
//! - the [sampled loops](crate::sampled_loop) are an analysis of small motions about hover: with this period, delay and
//!   lag they die out, with [`LoopMargin::LEAST`] to spare. It knows nothing of limits and large angles.
//!
//! Together they are what can be said without flying. Neither is a proof that a recovery succeeds.

use crate::file::Scenario;
use crate::sampled_loop::LoopReport;
use crate::stability::{Lack, LoopMargin};
use controller_core::certificate::Certificate;
use controller_core::certificate::certified::{Certified, Refused};
use controller_core::certificate::inequality::Inequality;
use controller_core::error::ParameterError;
use std::fmt;

/// Certificate and sampled loops of one scenario.
#[derive(Debug, Clone)]
pub struct Verdict {
    /// The certificate, and with it the key to flight where it holds.
    proof: Result<Box<Certified>, Box<Certificate>>,
    loops: [LoopReport; 6],
}

/// Why a scenario may not fly: the first inequality that fails, or else the first loop without margin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Refusal {
    /// An inequality of the certificate.
    Inequality(Inequality),
    /// A sampled loop.
    Loop(Lack),
}

impl Verdict {
    /// Works both out for `scenario`.
    ///
    /// # Errors
    /// If a number is beyond what the certificate or the loops can work with; no file that was read leads there.
    pub fn of(scenario: &Scenario) -> Result<Self, ParameterError> {
        let proof = match Certified::new(scenario.configuration.clone()) {
            Ok(certified) => Ok(Box::new(certified)),
            Err(Refused::Fails(certificate)) => Err(Box::new(certificate)),
            Err(Refused::Undefined(error)) => return Err(error),
        };
        Ok(Self { proof, loops: scenario.loops()?.reports() })
    }

    /// Why the scenario may not fly; none if it may.
    #[must_use]
    pub fn refusal(&self) -> Option<Refusal> {
        let failing = self.certificate().inequalities().find(|inequality| !inequality.holds());
        failing.copied().map(Refusal::Inequality).or_else(|| self.lacking().map(Refusal::Loop))
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

    /// The first loop that is unstable, or else without [`LoopMargin::LEAST`].
    #[must_use]
    pub fn lacking(&self) -> Option<Lack> {
        LoopMargin::LEAST.first_lacking(&self.loops)
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
        }
    }
}

#[cfg(test)]
mod tests;
