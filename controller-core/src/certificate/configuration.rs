//! What the certificate judges.

use crate::allocation::Rotors;
use crate::error::{ParameterError, Reason, require, require_positive};
use crate::gains::Gains;
use crate::reference::ReferenceBounds;
use crate::vehicle::{Limits, Vehicle};

/// Everything the certificate judges: vehicle, limits, gains, the references that will be flown, and the options.
#[derive(Debug, Clone, PartialEq)]
pub struct Configuration {
    vehicle: Vehicle,
    limits: Limits,
    gains: Gains,
    bounds: ReferenceBounds,
    thrust_floor: Option<f32>,
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
        let bounds = bounds.validated()?;
        let room = vehicle.gravity - bounds.vertical_acceleration;
        require(gains.m_p < room, "gains.m_p", Reason::NotBelow(room))?;
        Ok(Self { vehicle, limits, gains, bounds, thrust_floor: None, rotors: None })
    }

    /// Turns on the thrust projection T = max(m u.R e3, floor), `floor` in N; see [`crate::projection`].
    ///
    /// # Errors
    /// If the floor is not positive or above m (g - M_p - K_a3), where the argument for the projection ends.
    pub fn with_thrust_floor(self, floor: f32) -> Result<Self, ParameterError> {
        let field = "control.thrust_floor";
        require_positive(floor, field)?;
        let least = self.greatest_thrust_floor();
        require(floor <= least, field, Reason::NotBelow(least))?;
        Ok(Self { thrust_floor: Some(floor), ..self })
    }

    /// The same vehicle, limits and rotors with other gains and without projection.
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
        let configuration = Self::new(self.vehicle, self.limits, self.gains, bounds)?;
        let configuration = Self { rotors: self.rotors.clone(), ..configuration };
        self.thrust_floor.map_or(Ok(configuration.clone()), |floor| configuration.with_thrust_floor(floor))
    }

    /// m (g - M_p - K_a3), N: the greatest floor the thrust projection may have.
    #[must_use]
    pub fn greatest_thrust_floor(&self) -> f32 {
        self.vehicle.mass * (self.vehicle.gravity - self.gains.m_p - self.bounds.vertical_acceleration)
    }

    /// Carries the certificate to the rotors.
    ///
    /// # Errors
    /// If the rotors at full thrust cannot hover the vehicle, or at least thrust still lift it.
    pub fn with_rotors(self, rotors: Rotors) -> Result<Self, ParameterError> {
        let hover = self.vehicle.mass * self.vehicle.gravity;
        let greatest: f32 = rotors.iter().map(|rotor| rotor.thrust_max).sum();
        let least: f32 = rotors.iter().map(|rotor| rotor.thrust_min).sum();
        require(greatest > hover, "rotors.speed", Reason::NotAbove(hover))?;
        require(least < hover, "rotors.speed", Reason::NotBelow(hover))?;
        Ok(Self { rotors: Some(rotors), ..self })
    }

    /// The vehicle.
    #[must_use]
    pub fn vehicle(&self) -> &Vehicle {
        &self.vehicle
    }

    /// The user's limits.
    #[must_use]
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// The gains.
    #[must_use]
    pub fn gains(&self) -> &Gains {
        &self.gains
    }

    /// Omega_r: the references this configuration is for.
    #[must_use]
    pub fn bounds(&self) -> &ReferenceBounds {
        &self.bounds
    }

    /// The floor of the thrust projection, N; none for the paper's law.
    #[must_use]
    pub fn thrust_floor(&self) -> Option<f32> {
        self.thrust_floor
    }

    /// The rotors, if the certificate is to reach them.
    #[must_use]
    pub fn rotors(&self) -> Option<&Rotors> {
        self.rotors.as_ref()
    }
}
