//! A configuration of the extended law from a vehicle's numbers alone: every constant by its
//! [formula](crate::extended::defaults), and the widest references that certify.

use super::Certificate;
use crate::configuration::{Configuration, ExtendedLaw};
use crate::error::ParameterError;
use crate::extended::defaults::{self, Airframe, NOTHING_GIVEN};
use crate::extended::parameters::Extended;
use crate::reference::ReferenceBounds;

/// How often the bounds are lessened by a tenth: to a hundredth.
const ATTEMPTS_MAX: usize = 44;

impl Configuration {
    /// The extended law for `airframe`, with every constant from its numbers and the widest references that certify.
    ///
    /// # Errors
    /// Names the constant that these numbers leave no room for.
    pub fn from_airframe(airframe: &Airframe) -> Result<Self, ParameterError> {
        let parameters = Extended::new(defaults::constants(airframe, &NOTHING_GIVEN), airframe.vehicle)?;
        let law = ExtendedLaw { parameters, actuators: airframe.actuators };
        configure(airframe, law, flyable(airframe, law))
    }
}

fn configure(airframe: &Airframe, law: ExtendedLaw, bounds: ReferenceBounds) -> Result<Configuration, ParameterError> {
    let configuration = Configuration::extended(*airframe.vehicle, *airframe.limits, law, bounds)?;
    match airframe.rotors {
        Some(rotors) => configuration.with_rotors(rotors.clone()),
        None => Ok(configuration),
    }
}

/// The widest bounds of references that `law` certifies on `airframe`: a share of [`defaults::reference_bounds`],
/// lessened in steps of a tenth. If not even a hundredth certifies it is all of them, so that the certificate names the
/// reason.
pub fn flyable(airframe: &Airframe, law: ExtendedLaw) -> ReferenceBounds {
    let max = defaults::reference_bounds(airframe, &law.parameters);
    let mut share = 1.0;
    for _ in 0..ATTEMPTS_MAX {
        let bounds = ReferenceBounds {
            horizontal_acceleration: share * max.horizontal_acceleration,
            vertical_acceleration: share * max.vertical_acceleration,
            jerk: share * max.jerk,
            snap: share * max.snap,
            heading_rate: share * max.heading_rate,
            heading_second_derivative: share * max.heading_second_derivative,
            ..max
        };
        let certificate = configure(airframe, law, bounds).and_then(|configuration| Certificate::new(&configuration));
        if certificate.is_ok_and(|certificate| certificate.holds()) {
            return bounds;
        }
        share *= 0.9;
    }
    max
}

#[cfg(test)]
mod tests;
