//! The only kind of configuration that may fly: a certified one.

use super::Certificate;
use super::configuration::Configuration;
use crate::error::ParameterError;

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
    /// [`Refused`] says which inequality fails and by how much.
    #[allow(clippy::result_large_err)] // as above, and it happens once, on the ground
    pub fn new(configuration: Configuration) -> Result<Self, Refused> {
        let certificate = Certificate::new(&configuration).map_err(Refused::Undefined)?;
        if certificate.holds() { Ok(Self { configuration, certificate }) } else { Err(Refused::Fails(certificate)) }
    }

    /// What was certified.
    #[must_use]
    pub fn configuration(&self) -> &Configuration {
        &self.configuration
    }

    /// The proof.
    #[must_use]
    pub fn certificate(&self) -> &Certificate {
        &self.certificate
    }
}
