//! How a controller is built: every part's constants from the configuration and the period, and again where the period
//! changes.

use super::Controller;
use crate::allocation::Rotors;
use crate::configuration::ExtendedLaw;
use crate::error::ParameterError;
use crate::extended::actuators::ActuatorModel;
use crate::extended::attitude::AttitudeLaw;
use crate::extended::budget::{TickBudget, TorqueBudget};
use crate::extended::direction_limiter::DirectionLimiter;
use crate::extended::estimates::Learning;
use crate::extended::fallback::{Slowed, slowed};
use crate::extended::heading::{self, HeadingLaw};
use crate::extended::measured::Measured;
use crate::extended::memory::{Averages, Memory};
use crate::extended::parameters::Extended;
use crate::extended::position::{FeedbackLimits, PositionLaw};
use crate::extended::rotor_loss::detector::Detector;
use crate::extended::thrust_range::ThrustRange;
use crate::math;
use crate::path_lifting;
use crate::vehicle::{Limits, Vehicle};
use nalgebra::Vector3;

impl Controller {
    /// The law for a vehicle with these rotors, as after a reset.
    ///
    /// # Errors
    /// Names `control.period`, `gains.c_1`, `gains.c_2` or `sampling.delay` if the period does not allow them.
    pub(crate) fn build(
        vehicle: &Vehicle,
        limits: &Limits,
        law: &ExtendedLaw,
        rotors: Option<&Rotors>,
        period: f32,
    ) -> Result<Self, ParameterError> {
        let ExtendedLaw { parameters, actuators } = law;
        let position = PositionLaw::new(parameters, vehicle.gravity, period)?;
        Self::check_period(parameters, period)?;
        let budget = TorqueBudget::new(parameters.floor_margin, limits, rotors);
        let p = parameters;
        let inertia = math::max(vehicle.inertia.x, vehicle.inertia.y);
        let acceleration = (budget.radius(1.0) / f64::from(inertia)) as f32;
        let slow = Slowed::<f64>::new(parameters, vehicle.gravity);
        Ok(Self {
            vehicle: *vehicle,
            limits: *limits,
            law: *law,
            rotors: rotors.cloned(),
            period,
            switching_scalar: path_lifting::switching_scalar(parameters.delta),
            steepest_fall: parameters.a_down - vehicle.gravity,
            ceiling: budget.ceiling(vehicle, limits),
            late: actuators.lag + actuators.delay,
            position,
            slowed: PositionLaw::new(&slowed(parameters, vehicle.gravity), vehicle.gravity, period)?,
            slow: FeedbackLimits::each(slow.level as f32),
            attitude: AttitudeLaw::new(parameters, &vehicle.inertia),
            heading: HeadingLaw::new(parameters, &vehicle.inertia),
            budget: TickBudget::new(&budget, [p.scale_least, p.scale_greatest]),
            reserve: inertia * p.turn_reserve,
            turning: DirectionLimiter::new(parameters, acceleration, period),
            learning: Learning::new(parameters, vehicle, limits, period),
            changed: None,
            range: ThrustRange::new(rotors, p.floor_margin, limits.thrust_max, limits.torque_max.z),
            actuators: ActuatorModel::new(actuators, period)?,
            settling: actuators.settling(period),
            memory: Memory::fresh(vehicle, Averages::known(Vector3::zeros(), 1.0)),
            detector: Detector::new(vehicle, rotors, actuators.lag, period),
            spinning: None,
            measured: Measured::default(),
        })
    }

    /// Checks that ticks of `period`, s, are short enough for the heading's gains.
    ///
    /// # Errors
    /// Names `gains.c_1` or `gains.c_2`.
    pub fn check_period(parameters: &Extended, period: f32) -> Result<(), ParameterError> {
        heading::check(parameters, period)
    }

    /// Changes the time to the next step, s, and from there on.
    ///
    /// # Errors
    /// As [`Self::new`]; the period then stays what it was.
    pub fn set_period(&mut self, period: f32) -> Result<(), ParameterError> {
        let rebuilt = Self::build(&self.vehicle, &self.limits, &self.law, self.rotors.as_ref(), period)?;
        let Self { memory, learning, measured, .. } = *self;
        let spinning = self.spinning.take();
        *self = Self { memory, learning, measured, spinning, changed: Some(rebuilt.learning), ..rebuilt };
        Ok(())
    }
}
