//! The parameters that the flight rules and the governor work with.

use super::Parameters;
use super::table::Name;
use ::flight::FlightSettings;
use controller_core::governor::GovernorLimits;
use embassy_sync::blocking_mutex::raw::RawMutex;

impl<M: RawMutex> Parameters<M> {
    /// What an operator chose about flights.
    pub fn flight_settings(&self) -> FlightSettings {
        FlightSettings {
            take_off_height: self.get(Name::TakeOffHeight),
            landing_speed: self.get(Name::LandingSpeed),
            ground_station_timeout: self.get(Name::GroundStationPatience),
            fence_radius: self.get(Name::FenceRadius),
            fence_height: self.get(Name::FenceHeight),
            tracking_error_max: self.get(Name::TrackingErrorMax),
        }
    }

    /// How fast the governor may be.
    pub fn governor_limits(&self) -> GovernorLimits {
        GovernorLimits {
            horizontal_speed: self.get(Name::HorizontalSpeed),
            vertical_speed: self.get(Name::VerticalSpeed),
            ..GovernorLimits::default()
        }
    }
}
