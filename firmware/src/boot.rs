//! From the embedded scenario to a pilot: the certificate worked out again on the machine that will fly, and logged.
//!
//! It takes two seconds or more on a Cortex-M4F (350 million instructions: double precision is software there), and most
//! of the stack there is, before any task runs. A refused configuration boots as well: it answers, tests motors, and never arms, and says which inequality fails.

use crate::configuration;
use crate::outputs::Outputs;
use crate::parameters::Parameters;
use crate::parameters::table::Name;
use controller_core::certificate::configuration::{Certified, Refused};
use controller_core::error::ParameterError;
use controller_core::flight::Pilot;
use controller_core::governor::GovernorLimits;
use embassy_sync::blocking_mutex::raw::RawMutex;
use static_cell::StaticCell;

/// Certifies the embedded configuration, logs every margin, and makes a pilot of it, certified or grounded, in the place
/// that is meant for it; with it comes what turns its thrusts into motor commands.
///
/// # Errors
/// If the embedded file has no rotors, or not as many as the board has motors; the build refuses such files.
pub fn start<M: RawMutex>(
    place: &'static StaticCell<Pilot>,
    parameters: &Parameters<M>,
) -> Result<(&'static mut Pilot, Outputs), ParameterError> {
    let outputs = Outputs::new(configuration::embedded()?.rotors().ok_or(configuration::NO_ROTORS)?)?;
    let certification = certify();
    let limits = GovernorLimits {
        horizontal_speed: parameters.get(Name::HorizontalSpeed),
        vertical_speed: parameters.get(Name::VerticalSpeed),
        ..GovernorLimits::default()
    };
    Ok((pilot(place, certification.as_ref(), limits), outputs))
}

// The two that follow need most of the stack, one after the other: neither may become part of the other's frame.

#[allow(clippy::result_large_err)] // the core's own error, once, on the ground
#[inline(never)]
fn certify() -> Result<Certified, Refused> {
    let certification = configuration::embedded().map_err(Refused::Undefined).and_then(Certified::new);
    log(&certification);
    certification
}

#[inline(never)]
fn pilot(
    place: &'static StaticCell<Pilot>,
    certification: Result<&Certified, &Refused>,
    limits: GovernorLimits,
) -> &'static mut Pilot {
    place.init_with(|| Pilot::new(certification, limits))
}

/// Every inequality that decides, with its margin, and the verdict.
#[cfg(target_os = "none")]
fn log(certification: &Result<Certified, Refused>) {
    let certificate = match certification {
        Ok(certified) => certified.certificate(),
        Err(Refused::Fails(certificate)) => certificate,
        Err(Refused::Undefined(error)) => return defmt::error!("not certified: {}", error),
    };
    defmt::info!("scenario {=str}", configuration::NAME);
    for inequality in certificate.inequalities() {
        let (required, available) = (inequality.required as f32, inequality.available as f32);
        let (unit, percent) = (inequality.unit, 100.0 * inequality.margin() as f32);
        match inequality.holds() {
            true => defmt::info!(
                "{=str}: {=f32} of {=f32} {=str}, {=f32} % left",
                inequality.name,
                required,
                available,
                unit,
                percent
            ),
            false => defmt::error!("{=str} FAILS: {=f32} of {=f32} {=str}", inequality.name, required, available, unit),
        }
    }
    match certification {
        Ok(_) => defmt::info!("certified"),
        Err(_) => defmt::error!("not certified: this vehicle will not arm"),
    }
}

/// A desktop has `host-sim certify` for this.
#[cfg(not(target_os = "none"))]
fn log(_certification: &Result<Certified, Refused>) {}
