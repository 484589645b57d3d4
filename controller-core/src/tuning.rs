//! The operator's changes to a built configuration: figures of the vehicle, and factors on gains.
//!
//! | what | changes | its sampled loops |
//! |---|---|---|
//! | [`Figures`] | mass, limits, reference bounds, rotors' thrusts | the same: no loop about hover depends on one of them |
//! | [`Factors`] | gains, each by one of [`Percent`]'s few factors | others: a build [judges](judged) every choice of factors beforehand |
//!
//! A changed configuration is made by the constructors that made the built one, and may fly as any other does: once it
//! is [`Certified`](crate::certificate::certified::Certified). Moments of inertia, filters and estimates are the
//! build's alone.

pub mod judged;

use crate::allocation::{Rotor, Rotors, collected};
use crate::configuration::{Configuration, ExtendedLaw, LawParameters, PaperLaw};
use crate::error::{ParameterError, Reason, require};
use crate::extended::parameters::Extended;
use crate::gains::{GainParameters, Gains};
use crate::reference::ReferenceBounds;
use crate::vehicle::{LimitParameters, Limits, Vehicle, VehicleParameters};
use heapless::Vec;
use nalgebra::Vector3;

/// One of the factors that a gain may have, percent: 70, 80 and so on to 130.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Percent(u8);

impl Percent {
    /// The least.
    pub const FACTOR_MIN_PERCENT: u8 = 70;
    /// From one to the next.
    pub const FACTOR_STEP_PERCENT: u8 = 10;
    /// How many there are.
    pub const COUNT: usize = 7;
    /// As built.
    pub const AS_BUILT: Self = Self(3);

    /// The factor of this many percent, if it is one.
    pub fn new(percent: f32) -> Option<Self> {
        (0..Self::COUNT as u8).map(Self).find(|level| level.percent() == percent)
    }

    /// Every one, the least first.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..Self::COUNT as u8).map(Self)
    }

    /// In percent.
    pub fn percent(self) -> f32 {
        f32::from(Self::FACTOR_MIN_PERCENT + Self::FACTOR_STEP_PERCENT * self.0)
    }

    /// `gain` times the factor; with [`Self::AS_BUILT`] the same to the bit.
    fn times(self, gain: f32) -> f32 {
        gain * (self.percent() / 100.0)
    }

    /// Its place among all of them.
    fn index(self) -> usize {
        usize::from(self.0)
    }
}

/// Factors on the gains that were built, by what they answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Factors {
    /// An attitude error: k_theta; of the extended law k_tilt.
    pub attitude: Percent,
    /// A body rate: k_omega; of the extended law k_omega_t and c_2.
    pub rate: Percent,
    /// A horizontal position error: k_p across. The paper's law has one k_p for all axes.
    pub position_across: Percent,
    /// A horizontal velocity error: k_v across. The paper's law has one k_v for all axes.
    pub velocity_across: Percent,
    /// An error in height: k_p along the vertical, of the extended law alone.
    pub position_vertical: Percent,
    /// A vertical velocity error: k_v along the vertical, of the extended law alone.
    pub velocity_vertical: Percent,
}

impl Factors {
    /// The gains as built.
    pub const BUILT: Self = Self {
        attitude: Percent::AS_BUILT,
        rate: Percent::AS_BUILT,
        position_across: Percent::AS_BUILT,
        velocity_across: Percent::AS_BUILT,
        position_vertical: Percent::AS_BUILT,
        velocity_vertical: Percent::AS_BUILT,
    };

    /// The law's constants with these factors, for `vehicle`.
    ///
    /// # Errors
    /// As the law's constructor, and [`Reason::OtherLaw`] for a factor on a gain that this law has not.
    pub fn law(&self, law: &LawParameters, vehicle: &Vehicle) -> Result<LawParameters, ParameterError> {
        match law {
            LawParameters::Paper(PaperLaw { gains, thrust_floor }) => {
                for (factor, field) in
                    [(self.position_vertical, "gains.k_p_vertical"), (self.velocity_vertical, "gains.k_v_vertical")]
                {
                    require(factor == Percent::AS_BUILT, field, Reason::OtherLaw)?;
                }
                let gains = GainParameters {
                    k_theta: self.attitude.times(gains.k_theta),
                    k_omega: self.rate.times(gains.k_omega),
                    k_p: self.position_across.times(gains.k_p),
                    k_v: self.velocity_across.times(gains.k_v),
                    ..**gains
                };
                Ok(LawParameters::Paper(PaperLaw { gains: Gains::new(gains, vehicle)?, thrust_floor: *thrust_floor }))
            }
            LawParameters::Extended(ExtendedLaw { parameters, actuators }) => {
                let mut constants = **parameters;
                for (gain, factor) in [
                    (&mut constants.k_tilt, self.attitude),
                    (&mut constants.k_omega_t, self.rate),
                    (&mut constants.c_2, self.rate),
                    (&mut constants.k_p_across, self.position_across),
                    (&mut constants.k_v_across, self.velocity_across),
                    (&mut constants.k_p_vertical, self.position_vertical),
                    (&mut constants.k_v_vertical, self.velocity_vertical),
                ] {
                    *gain = factor.times(*gain);
                }
                let parameters = Extended::new(constants, vehicle)?;
                Ok(LawParameters::Extended(ExtendedLaw { parameters, actuators: *actuators }))
            }
        }
    }
}

/// Figures of a vehicle that change with what it carries and what turns it, and how hard it is flown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Figures {
    /// kg.
    pub mass: f32,
    /// Limit of the thrust, N.
    pub thrust_max: f32,
    /// Limit of the torque about each body axis, N m.
    pub torque_max: Vector3<f32>,
    /// The bounds of references.
    pub bounds: ReferenceBounds,
    /// Least and greatest thrust of each rotor, N; zeros without rotors.
    pub rotor_thrust: [f32; 2],
}

impl Figures {
    /// Those of `configuration`; of its rotors' the first one's.
    pub fn from_configuration(configuration: &Configuration) -> Self {
        let first = configuration.rotors().and_then(|rotors| rotors.first());
        Self {
            mass: configuration.vehicle().mass,
            thrust_max: configuration.limits().thrust_max,
            torque_max: configuration.limits().torque_max,
            bounds: *configuration.bounds(),
            rotor_thrust: first.map_or([0.0; 2], |rotor| [rotor.thrust_min, rotor.thrust_max]),
        }
    }
}

/// What was changed of a configuration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tuning {
    /// The figures.
    pub figures: Figures,
    /// The gains' factors.
    pub factors: Factors,
}

impl Tuning {
    /// `built` with these figures and factors.
    ///
    /// # Errors
    /// What its constructors refuse, by the field's name.
    pub fn apply(&self, built: &Configuration) -> Result<Configuration, ParameterError> {
        let Self { figures, factors } = self;
        let vehicle = Vehicle::new(VehicleParameters { mass: figures.mass, ..**built.vehicle() })?;
        let limits = LimitParameters { thrust_max: figures.thrust_max, torque_max: figures.torque_max };
        let limits = Limits::new(limits, &vehicle)?;
        let configuration = match factors.law(built.law(), &vehicle)? {
            LawParameters::Paper(PaperLaw { gains, .. }) => Configuration::new(vehicle, limits, gains, figures.bounds)?,
            LawParameters::Extended(law) => Configuration::extended(vehicle, limits, law, figures.bounds)?,
        };
        let configuration = match built.thrust_floor() {
            Some(floor) => configuration.with_thrust_floor(floor)?,
            None => configuration,
        };
        match built.rotors() {
            Some(rotors) => configuration.with_rotors(self.rotors(rotors, &Figures::from_configuration(built))?),
            None => Ok(configuration),
        }
    }

    /// `rotors` with the thrusts that were changed.
    fn rotors(&self, built_rotors: &Rotors, built: &Figures) -> Result<Rotors, ParameterError> {
        let ([min, max], [built_least, built_most]) = (self.figures.rotor_thrust, built.rotor_thrust);
        let changed = |rotor: &Rotor| Rotor {
            thrust_min: if min == built_least { rotor.thrust_min } else { min },
            thrust_max: if max == built_most { rotor.thrust_max } else { max },
            ..*rotor
        };
        let rotors: Vec<Rotor, { crate::allocation::geometry::ROTORS_MAX }> =
            collected(built_rotors.iter().map(changed));
        let changed = Rotors::new(&rotors)?;
        Ok(if built_rotors.are_of_nominal_speed() { changed.of_nominal_speed() } else { changed })
    }
}

#[cfg(test)]
mod tests;
