//! The parameters that the flight rules and the governor work with.

use super::Parameters;
use super::table::Name;
use flight::FlightSettings;
use controller_core::governor::GovernorLimits;
use embassy_sync::blocking_mutex::raw::RawMutex;

/// What an operator chose about flights.
#[must_use]
pub fn settings<M: RawMutex>(parameters: &Parameters<M>) -> FlightSettings {
    FlightSettings {
        take_off_height: parameters.get(Name::TakeOffHeight),
        landing_speed: parameters.get(Name::LandingSpeed),
        ground_station_patience: parameters.get(Name::GroundStationPatience),
        fence_radius: parameters.get(Name::FenceRadius),
        fence_height: parameters.get(Name::FenceHeight),
        tracking_error_max: parameters.get(Name::TrackingErrorMax),
    }
}

/// How fast the governor may be.
#[must_use]
pub fn limits<M: RawMutex>(parameters: &Parameters<M>) -> GovernorLimits {
    GovernorLimits {
        horizontal_speed: parameters.get(Name::HorizontalSpeed),
        vertical_speed: parameters.get(Name::VerticalSpeed),
        ..GovernorLimits::default()
    }
}
