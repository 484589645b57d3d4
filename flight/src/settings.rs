//! The operator's settings for failures, with defaults for a first flight.

use controller_core::math;

/// Limits and answers to failures. Numbers out of range are clamped; a NaN becomes the default.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlightSettings {
    /// How high a take-off goes that names no height, m, in [0.5, 50].
    pub take_off_height: f32,
    /// How fast a landing goes down, m/s, in [0.1, 2].
    pub landing_speed: f32,
    /// How long the ground station may be silent before a vehicle that holds lands, s, in [2.5, 600].
    pub ground_station_timeout: f32,
    /// The fence: the maximum horizontal distance from where the vehicle was armed, m, in [2, 10000].
    pub fence_radius: f32,
    /// The fence: the maximum height above that place, m, in [2, 10000].
    pub fence_height: f32,
    /// How far the vehicle may be from its reference for longer than a while, m, in [0.5, 100].
    pub tracking_error_max: f32,
}

impl FlightSettings {
    /// For a first flight.
    pub const DEFAULT: Self = Self {
        take_off_height: 1.5,
        landing_speed: 0.5,
        ground_station_timeout: 10.0,
        fence_radius: 100.0,
        fence_height: 50.0,
        tracking_error_max: 3.0,
    };

    /// These, within what is allowed.
    #[must_use]
    pub(super) fn within_range(&self) -> Self {
        let default = Self::DEFAULT;
        Self {
            take_off_height: within(self.take_off_height, 0.5, 50.0, default.take_off_height),
            landing_speed: within(self.landing_speed, 0.1, 2.0, default.landing_speed),
            ground_station_timeout: within(self.ground_station_timeout, 2.5, 600.0, default.ground_station_timeout),
            fence_radius: within(self.fence_radius, 2.0, 10_000.0, default.fence_radius),
            fence_height: within(self.fence_height, 2.0, 10_000.0, default.fence_height),
            tracking_error_max: within(self.tracking_error_max, 0.5, 100.0, default.tracking_error_max),
        }
    }
}

impl Default for FlightSettings {
    fn default() -> Self {
        Self::DEFAULT
    }
}

fn within(value: f32, min: f32, max: f32, default: f32) -> f32 {
    if value.is_nan() { default } else { math::clamp(value, min, max) }
}

#[cfg(test)]
mod tests;
