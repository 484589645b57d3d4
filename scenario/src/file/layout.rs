//! The declaration of a whole scenario file.

use crate::key::{Key, Layout, Values};
use crate::reality::{battery, disturbance, drag, estimator, failure, ground, sensors, truth, wind};
use crate::reference::LAYOUTS;
use crate::timing::{self, DURATION};
use crate::{actuation, campaign, initial, vehicle};
use controller_core::extended::parameters::ExtendedParameters;
use controller_core::gains::GainParameters;
use controller_core::reference::ReferenceBounds;

/// A scenario file: its sections in the order in which errors list them.
pub const LAYOUT: Layout = Layout {
    name: "",
    about: "A flight: a vehicle, its limits and gains, where it starts and its reference. SI units, world z up, body x \
            forward, y left, z up.",
    keys: &[
        Key::new("name", Values::Text, "Names the flight: 1 to 64 letters, digits, '-', '_' or '.'."),
        DURATION,
        Key::new("vehicle", Values::Table(&vehicle::VEHICLE), vehicle::VEHICLE.about),
        Key::table(&vehicle::LIMITS),
        Key::new(
            "gains",
            Values::Constants("gains", &[&ExtendedParameters::TABLE, &GainParameters::TABLE]),
            "The gains of a law: of the extended one each may be left out, of the paper's none.",
        )
        .optional(),
        Key::new(
            "estimates",
            Values::Constants("estimates", &[&ExtendedParameters::TABLE]),
            "The estimates of the extended law; what is left out follows from the vehicle's numbers.",
        )
        .optional(),
        Key::table(&timing::CONTROL),
        Key::table(&timing::PLANT),
        Key::table(&actuation::ROTORS),
        Key::table(&actuation::SAMPLING),
        Key::table(&initial::LAYOUT),
        Key::new("reference", Values::Kinds(&LAYOUTS), "Left out: hover where the flight starts.").optional(),
        Key::new(
            "reference_bounds",
            Values::Constants("reference_bounds", &[&ReferenceBounds::TABLE]),
            "The references that the certificate is to cover; what is left out follows from the vehicle or the \
             reference.",
        )
        .optional(),
        Key::table(&campaign::LAYOUT),
        Key::table(&truth::LAYOUT),
        Key::table(&drag::LAYOUT),
        Key::table(&wind::LAYOUT),
        Key::table(&disturbance::LAYOUT),
        Key::table(&battery::LAYOUT),
        Key::table(&failure::LAYOUT),
        Key::table(&ground::LAYOUT),
        Key::table(&sensors::LAYOUT),
        Key::table(&estimator::LAYOUT),
    ],
};
