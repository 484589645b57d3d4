//! A configuration: the input of the certificate.

use crate::allocation::Rotors;
use crate::error::{ParameterError, Reason, require, require_positive};
use crate::extended::actuators::ActuatorParameters;
use crate::extended::parameters::Extended;
use crate::gains::Gains;
use crate::reference::ReferenceBounds;
use crate::vehicle::{Limits, Vehicle};

/// A law and its constants.
#[allow(clippy::large_enum_variant)] // without an allocator there is nowhere else to put either
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LawParameters {
    /// The paper's law.
    Paper(PaperLaw),
    /// The [extended](crate::extended) law.
    Extended(ExtendedLaw),
}

/// The paper's law and its option.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PaperLaw {
    /// The gains.
    pub gains: Gains,
    /// The floor of the thrust projection, N; none for the law as printed.
    pub thrust_floor: Option<f32>,
}

/// The extended law and the rotors' response that its estimates count on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExtendedLaw {
    /// The constants.
    pub parameters: Extended,
    /// How the wrench follows its commands.
    pub actuators: ActuatorParameters,
}

/// Everything the certificate judges: vehicle, limits, law, the references that will be flown, and the rotors.
#[derive(Debug, Clone, PartialEq)]
pub struct Configuration {
    vehicle: Vehicle,
    limits: Limits,
    law: LawParameters,
    bounds: ReferenceBounds,
    rotors: Option<Rotors>,
}

impl Configuration {
    /// The paper's law for `vehicle`, to fly references within `bounds`.
    ///
    /// # Errors
    /// If a bound is not finite or negative, or M_p >= g - K_a3, where the law is undefined.
    pub fn new(
        vehicle: Vehicle,
        limits: Limits,
        gains: Gains,
        bounds: ReferenceBounds,
    ) -> Result<Self, ParameterError> {
        Self::build(vehicle, limits, LawParameters::Paper(PaperLaw { gains, thrust_floor: None }), bounds)
    }

    /// The extended law for `vehicle`, to fly references within `bounds`.
    ///
    /// # Errors
    /// If a bound is not finite or negative, or A_- >= g - K_a3, where the law is undefined.
    pub fn extended(
        vehicle: Vehicle,
        limits: Limits,
        law: ExtendedLaw,
        bounds: ReferenceBounds,
    ) -> Result<Self, ParameterError> {
        Self::build(vehicle, limits, LawParameters::Extended(law), bounds)
    }

    fn build(
        vehicle: Vehicle,
        limits: Limits,
        law: LawParameters,
        bounds: ReferenceBounds,
    ) -> Result<Self, ParameterError> {
        let bounds = bounds.validated()?;
        let room = vehicle.gravity - bounds.vertical_acceleration;
        let (min, field) = match &law {
            LawParameters::Paper(PaperLaw { gains, .. }) => (gains.m_p, "gains.m_p"),
            LawParameters::Extended(ExtendedLaw { parameters, .. }) => (parameters.a_down, "gains.a_down"),
        };
        require(min < room, field, Reason::NotBelow(room))?;
        Ok(Self { vehicle, limits, law, bounds, rotors: None })
    }

    /// Turns on the thrust projection T = max(m u.R e3, floor) of the paper's law, `floor` in N; see
    /// [`crate::projection`].
    ///
    /// # Errors
    /// If the floor is not positive or above m (g - M_p - K_a3), where the argument for the projection ends, or the law
    /// is another.
    pub fn with_thrust_floor(self, floor: f32) -> Result<Self, ParameterError> {
        let field = "control.thrust_floor";
        let law = *self.paper().ok_or(ParameterError { field, reason: Reason::OtherLaw })?;
        require_positive(floor, field)?;
        let min = self.min_thrust();
        require(floor <= min, field, Reason::Above(min))?;
        Ok(Self { law: LawParameters::Paper(PaperLaw { thrust_floor: Some(floor), ..law }), ..self })
    }

    /// The same vehicle, limits and rotors under the paper's law with other gains and without projection.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_gains(&self, gains: Gains) -> Result<Self, ParameterError> {
        let configuration = Self::new(self.vehicle, self.limits, gains, self.bounds)?;
        Ok(Self { rotors: self.rotors.clone(), ..configuration })
    }

    /// The same for references within other bounds.
    ///
    /// # Errors
    /// As [`Self::new`], and as [`Self::with_thrust_floor`] if there is a floor.
    pub fn with_bounds(&self, bounds: ReferenceBounds) -> Result<Self, ParameterError> {
        let configuration = Self::build(self.vehicle, self.limits, self.law, bounds)?;
        let configuration = Self { rotors: self.rotors.clone(), ..configuration };
        self.thrust_floor().map_or(Ok(configuration.clone()), |floor| configuration.with_thrust_floor(floor))
    }

    /// By how much the law itself may command to fall, m/s^2: the reference's vertical acceleration must stay above
    /// this less g.
    pub fn max_fall(&self) -> f32 {
        match &self.law {
            LawParameters::Paper(PaperLaw { gains, .. }) => gains.m_p,
            LawParameters::Extended(ExtendedLaw { parameters, .. }) => parameters.a_down,
        }
    }

    /// m (g - K_a3) less m times what the law may command to fall, N: the greatest floor the thrust projection may
    /// have.
    pub fn min_thrust(&self) -> f32 {
        self.vehicle.mass * (self.vehicle.gravity - self.max_fall() - self.bounds.vertical_acceleration)
    }

    /// Carries the certificate to the rotors.
    ///
    /// # Errors
    /// If the rotors at full thrust cannot hover the vehicle, or at least thrust still lift it. For the extended law
    /// also if thrust does not reach one of them, or the thrust floor's margin is within rounding.
    pub fn with_rotors(self, rotors: Rotors) -> Result<Self, ParameterError> {
        rotors.check_hover(self.vehicle.mass * self.vehicle.gravity)?;
        if let LawParameters::Extended(law) = &self.law {
            // Its thrust floor lifts every rotor: a rotor that thrust does not reach cannot be lifted by it.
            law.parameters.check_rotors(&rotors)?;
        }
        Ok(Self { rotors: Some(rotors), ..self })
    }

    /// The vehicle.
    pub fn vehicle(&self) -> &Vehicle {
        &self.vehicle
    }

    /// The user's limits.
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// The law and its constants.
    pub fn law(&self) -> &LawParameters {
        &self.law
    }

    /// The paper's law; none if it is another.
    pub fn paper(&self) -> Option<&PaperLaw> {
        match &self.law {
            LawParameters::Paper(law) => Some(law),
            LawParameters::Extended(_) => None,
        }
    }

    /// The gains of the paper's law; none for another.
    pub fn gains(&self) -> Option<&Gains> {
        self.paper().map(|law| &law.gains)
    }

    /// Omega_r: the references this configuration is for.
    pub fn bounds(&self) -> &ReferenceBounds {
        &self.bounds
    }

    /// The floor of the thrust projection, N; none where it is off.
    pub fn thrust_floor(&self) -> Option<f32> {
        self.paper().and_then(|law| law.thrust_floor)
    }

    /// The rotors, if the certificate is to reach them.
    pub fn rotors(&self) -> Option<&Rotors> {
        self.rotors.as_ref()
    }
}

#[cfg(test)]
mod tests;
