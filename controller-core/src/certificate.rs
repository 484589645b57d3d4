//! The proof before take-off: every inequality that a law's limits rest on, evaluated for one configuration.
//!
//! From vehicle, limits, law and reference bounds the certificate works out, as required, available and margin:
//!
//! - for the paper's law ([`paper`]) the inequalities on thrust and torque of Assumption 1 and Theorems 1 and 2, in two
//!   forms, always both: *as printed* ([`printed`]) and *sharp* ([`sharp`], derived in `docs/sharp-bound.md`), which
//!   decides; and every rotor's least and greatest thrust ([`rotors`]);
//! - for the extended law ([`extended`]) those of `docs/extended-law.md`; and of a reference that is known, instant by
//!   instant, what it takes of them ([`path`]).
//!
//! They bound everything reachable after a reset (filters at zero, path lifted anew), and nothing else.

pub mod airframe;
pub mod certified;
pub mod extended;
pub mod form;
pub mod inequality;
pub mod paper;
pub mod path;
pub mod printed;
pub mod reachable;
pub mod rotors;
pub mod sharp;

use crate::configuration::{Configuration, LawParameters};
use crate::error::ParameterError;
use crate::math::enclosure::Enclosure;
use crate::math::real::Real;
use extended::ExtendedCertificate;
use form::Interval;
use inequality::Inequality;
use nalgebra::Vector3;
use paper::PaperCertificate;

/// The certificate of one configuration.
#[allow(clippy::large_enum_variant)] // without an allocator there is nowhere else to put either
#[derive(Debug, Clone, PartialEq)]
pub enum Certificate<R = f64> {
    /// Of the paper's law.
    Paper(PaperCertificate<R>),
    /// Of the extended law.
    Extended(ExtendedCertificate<R>),
}

impl<R: Real> Certificate<R> {
    fn evaluate(configuration: &Configuration) -> Result<Self, ParameterError> {
        Ok(match configuration.law() {
            LawParameters::Paper(law) => Self::Paper(PaperCertificate::new(configuration, law)?),
            LawParameters::Extended(law) => Self::Extended(ExtendedCertificate::new(configuration, law)?),
        })
    }

    /// The paper's law's, if this is one.
    pub fn paper(&self) -> Option<&PaperCertificate<R>> {
        match self {
            Self::Paper(certificate) => Some(certificate),
            Self::Extended(_) => None,
        }
    }

    /// Everything that decides.
    pub fn inequalities(&self) -> impl Iterator<Item = &Inequality<R>> {
        (0..).map_while(|place| match self {
            Self::Paper(certificate) => certificate.inequality(place),
            Self::Extended(certificate) => certificate.inequalities.get(place),
        })
    }

    /// Whether the configuration is certified: everything that decides holds.
    pub fn holds(&self) -> bool {
        self.inequalities().all(Inequality::holds)
    }

    /// Every thrust the law can command, N.
    pub fn thrust(&self) -> Interval<R> {
        match self {
            Self::Paper(certificate) => certificate.sharp.thrust,
            Self::Extended(certificate) => certificate.bounds.thrust,
        }
    }

    /// Greatest |torque| about each body axis, N m.
    pub fn torque(&self) -> Vector3<R> {
        match self {
            Self::Paper(certificate) => certificate.sharp.torque,
            Self::Extended(certificate) => certificate.bounds.torque,
        }
    }

    /// Every thrust the law can command of a rotor, N, the first being rotor 0; none beyond the last.
    pub fn rotor(&self, rotor: usize) -> Option<Interval<R>> {
        match self {
            Self::Paper(certificate) => {
                let demand = &certificate.rotors.get(rotor)?.demand;
                Some(Interval { min: demand.min, max: demand.max })
            }
            Self::Extended(certificate) => certificate.bounds.rotors.get(rotor).copied(),
        }
    }
}

impl Certificate {
    /// Works out every inequality for `configuration`, in double precision and a bounded amount of work: what decides.
    ///
    /// # Errors
    /// If a bound is beyond double precision; no configuration that its constructors accept leads there.
    pub fn new(configuration: &Configuration) -> Result<Self, ParameterError> {
        Self::evaluate(configuration)
    }

    /// The inequality with the least margin.
    pub fn tightest(&self) -> Option<Inequality> {
        inequality::tightest(self.inequalities())
    }
}

impl Certificate<Enclosure> {
    /// [`Certificate::new`] with every rounding outwards: an inequality that holds here holds in exact arithmetic, for
    /// the numbers that the configuration stores.
    ///
    /// # Errors
    /// As [`Certificate::new`].
    pub fn enclose(configuration: &Configuration) -> Result<Self, ParameterError> {
        Self::evaluate(configuration)
    }
}

#[cfg(test)]
pub(crate) mod tests;
