//! The only kind of configuration that may fly: a certified one. The laws that fly are made here, and from nothing
//! else.

use super::Certificate;
use crate::configuration::Configuration;
use crate::configuration::{LawParameters, PaperLaw};
use crate::controller::Controller;
use crate::error::{ParameterError, Reason};
use crate::extended;
use crate::law::Law;

/// Why a configuration is not certified.
#[allow(clippy::large_enum_variant)] // without an allocator there is nowhere else to put the certificate
#[derive(Debug, Clone, PartialEq)]
pub enum Refused {
    /// Its certificate does not hold; look there for the inequality that fails.
    Fails(Certificate),
    /// A bound is beyond double precision.
    Undefined(ParameterError),
}

/// A configuration whose certificate holds. There is no other way to make one than to certify it.
#[derive(Debug, Clone, PartialEq)]
pub struct Certified {
    configuration: Configuration,
    certificate: Certificate,
}

impl Certified {
    /// Certifies `configuration`.
    ///
    /// # Errors
    /// [`Refused`] names the inequality that fails, and by how much.
    #[allow(clippy::result_large_err)] // as above, and it happens once, on the ground
    pub fn new(configuration: Configuration) -> Result<Self, Refused> {
        let certificate = Certificate::new(&configuration).map_err(Refused::Undefined)?;
        if certificate.holds() { Ok(Self { configuration, certificate }) } else { Err(Refused::Fails(certificate)) }
    }

    /// What was certified.
    pub fn configuration(&self) -> &Configuration {
        &self.configuration
    }

    /// The proof.
    pub fn certificate(&self) -> &Certificate {
        &self.certificate
    }
}

/// The configuration is for another law.
const IS_OTHER_LAW: ParameterError = ParameterError { field: "control.law", reason: Reason::OtherLaw };

impl Law {
    /// The law of a certified configuration; `period` is the time between steps, s, in (0, 0.1].
    ///
    /// # Errors
    /// The law's own: [`Controller::new`], [`extended::controller::Controller::new`].
    pub fn new(certified: &Certified, period: f32) -> Result<Self, ParameterError> {
        Self::build(certified.configuration(), period)
    }
}

impl Controller {
    /// The paper's law for a certified configuration of it, as after a reset. `period` is the time between steps, s, in
    /// (0, 0.1].
    ///
    /// # Errors
    /// Names `control.period` if it is outside, `control.law` if the configuration's is another.
    pub fn new(certified: &Certified, period: f32) -> Result<Self, ParameterError> {
        let configuration = certified.configuration();
        let PaperLaw { gains, thrust_floor } = *configuration.paper().ok_or(IS_OTHER_LAW)?;
        Self::build(*configuration.vehicle(), gains, thrust_floor, period)
    }
}

impl extended::controller::Controller {
    /// The extended law for a certified configuration of it, as after a reset. `period` is the time between steps, s,
    /// in (0, 0.1].
    ///
    /// # Errors
    /// Names `control.period` if it is outside, `gains.c_1`, `gains.c_2` or `sampling.delay` if the period does not
    /// allow them, `control.law` if the configuration is for another law.
    pub fn new(certified: &Certified, period: f32) -> Result<Self, ParameterError> {
        let configuration = certified.configuration();
        let LawParameters::Extended(law) = configuration.law() else { return Err(IS_OTHER_LAW) };
        Self::build(configuration.vehicle(), configuration.limits(), law, configuration.rotors(), period)
    }
}
