//! From the embedded scenario to a pilot: the certificate worked out again on the machine that will fly, and logged.
//!
//! What was stored of parameters that the certificate depends on is part of it: see [`crate::parameters::tuned`]. If
//! the vehicle cannot fly with them, each that was set is named.
//!
//! It takes two to six seconds on a Cortex-M4F (350 to 930 million instructions: double precision is software there),
//! and more of the stack than anything later, before any task runs: `budgets.toml` bounds it. A refused configuration
//! boots as well: it answers, tests motors, never arms, and names the inequality that fails. The numbers are sent on
//! request: see [`crate::link::bench_report`].

use crate::configuration::{self, Pilot};
use crate::outputs::Outputs;
use crate::parameters::tuned::Built;
use crate::shared::{BootView, Event, Severity};
use controller_core::certificate::certified::{Certified, Refused};
use controller_core::configuration::Configuration;
use controller_core::error::ParameterError;
use controller_core::governor::GovernorLimits;
use embassy_sync::blocking_mutex::raw::RawMutex;
use estimation::estimator::{Estimator, Settings};
use flight::{FlightSettings, Memory};
use static_cell::{ConstStaticCell, StaticCell};

/// Where a pilot lies, its estimator, and what its governor and mixer work with.
pub struct Place {
    built: StaticCell<Built>,
    certification: StaticCell<Result<Certified, Refused>>,
    pilot: StaticCell<Pilot>,
    estimator: StaticCell<Estimator>,
    memory: ConstStaticCell<Memory>,
}

impl Place {
    /// For one pilot.
    #[allow(clippy::new_without_default)] // it is made where it stays
    pub const fn new() -> Self {
        Self {
            built: StaticCell::new(),
            certification: StaticCell::new(),
            pilot: StaticCell::new(),
            estimator: StaticCell::new(),
            memory: ConstStaticCell::new(Memory::EMPTY),
        }
    }
}

/// Certifies the embedded configuration with the stored parameters, logs its numbers, and makes a pilot of it,
/// certified or grounded, in the place that is meant for it; with it comes what turns its thrusts into motor commands.
/// Fails if the embedded file has no rotors, or not as many as the board has motors; the build refuses such files.
#[inline(never)]
pub fn start<M: RawMutex>(
    place: &'static Place,
    shared: BootView<'_, M>,
) -> Result<(&'static mut Pilot, Outputs), ParameterError> {
    let configuration = configuration::embedded()?;
    let built = Built {
        configuration,
        motor: configuration::MOTOR,
        loops: &configuration::LOOPS,
        identity: configuration::IDENTITY,
        period: configuration::PERIOD_US,
        follows_rotors: configuration::FOLLOWS_ROTORS,
    };
    start_named(place, shared, built, configuration::IS_NAMED)
}

/// The same of what was built for a named vehicle, or for none in particular: that never arms, and says so.
/// Errors: as [`start_with`].
#[inline]
pub fn start_named<M: RawMutex>(
    place: &'static Place,
    shared: BootView<'_, M>,
    built: Built,
    is_named: bool,
) -> Result<(&'static mut Pilot, Outputs), ParameterError> {
    let parameters = shared.parameters();
    let built: &'static Built = place.built.init_with(|| built);
    if built.follows_rotors {
        shared.follows_rotors().raise();
    }
    if parameters.boot(built) {
        shared.announce(Event::new(Severity::Warning, "Another configuration was tuned: as built now"));
    }
    let tuned = if is_named {
        built.tuned(|name| parameters.raw(name))
    } else {
        shared.announce(Event::new(Severity::Critical, "No vehicle: build with SCENARIO"));
        Err(configuration::NO_VEHICLE)
    };
    let certification = certify(place, tuned);
    log(certification);
    shared.verdict().put(certification, 0);
    if certification.is_err() && is_named {
        for name in parameters.set_by_hand() {
            let words = format_args!("{} {}: cannot be flown", name.row().name, parameters.get(name));
            shared.announce(Event::new(Severity::Critical, words));
        }
    }
    // What is grounded answers and tests motors as built.
    let (configuration, motor) = match certification {
        Ok(certified) => (certified.configuration(), built.motor(|name| parameters.raw(name))),
        Err(_) => (&built.configuration, built.motor),
    };
    let outputs = Outputs::new(configuration.rotors().ok_or(configuration::NO_ROTORS)?, motor)?;
    let estimator = estimator(place, &Settings::bmi088(configuration.vehicle()));
    let (limits, settings) = (parameters.governor_limits(), parameters.flight_settings());
    Ok((pilot(place, certification.as_ref(), &limits, &settings, built.period, estimator), outputs))
}

/// The same of another configuration than the embedded one, on a machine that reads scenario files.
/// Fails if it has no rotors, or not as many as there are motors.
#[inline]
pub fn start_with<M: RawMutex>(
    place: &'static Place,
    shared: BootView<'_, M>,
    built: Built,
) -> Result<(&'static mut Pilot, Outputs), ParameterError> {
    start_named(place, shared, built, true)
}

// Configuration, estimator, certificate and pilot need most of the stack, one after the other: none may become part of
// another's frame.

#[allow(clippy::result_large_err)] // the core's own error, once, on the ground
#[inline(never)]
fn certify(
    place: &'static Place,
    configuration: Result<Configuration, ParameterError>,
) -> &'static Result<Certified, Refused> {
    place.certification.init_with(|| Certified::new(configuration.map_err(Refused::Undefined)?))
}

#[inline(never)]
fn estimator(place: &'static Place, settings: &Settings) -> &'static mut Estimator {
    place.estimator.init_with(|| Estimator::new(settings))
}

#[inline(never)]
fn pilot(
    place: &'static Place,
    certification: Result<&Certified, &Refused>,
    limits: &GovernorLimits,
    settings: &FlightSettings,
    period: u64,
    estimator: &'static mut Estimator,
) -> &'static mut Pilot {
    let memory = place.memory.take();
    let policy = configuration::policy;
    place.pilot.init_with(|| Pilot::carrying(certification, limits, settings, period, estimator, memory, policy()))
}

/// The numbers of every inequality that decides, and the verdict. `host-sim certify` explains them.
#[cfg(target_os = "none")]
fn log(certification: &Result<Certified, Refused>) {
    defmt::info!("scenario {=str}", configuration::NAME);
    let certificate = match certification {
        Ok(certified) => certified.certificate(),
        Err(Refused::Fails(certificate)) => certificate,
        Err(Refused::Undefined(error)) => return defmt::error!("not certified: {}", error),
    };
    for inequality in certificate.inequalities() {
        let (name, required, available) = (inequality.name, inequality.required as f32, inequality.available as f32);
        match inequality.holds() {
            true => defmt::info!("{=str}: {=f32} of {=f32}", name, required, available),
            false => defmt::error!("{=str}: {=f32} of {=f32}", name, required, available),
        }
    }
    match certification {
        Ok(_) => defmt::info!("certified"),
        Err(_) => defmt::error!("not certified"),
    }
}

/// A desktop has `host-sim certify` for this.
#[cfg(not(target_os = "none"))]
fn log(_certification: &Result<Certified, Refused>) {}
