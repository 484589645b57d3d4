//! Latitude and longitude of a vehicle without GPS: its local frame, put on a globe.
//!
//! ```text
//! lat = lat_0 + north / R        lon = lon_0 + east / (R cos lat_0)        R = 6,371 km
//! ```
//!
//! Many clients have no other coordinates. Where a ground station has set an origin (SET_GPS_GLOBAL_ORIGIN), it is what
//! its maps show; until then it is 0 N, 0 E at sea level, and nothing but the distances means anything. A degree is 1e7
//! units.

use controller_core::math;
use nalgebra::Vector3;

/// Metres to a unit of latitude.
const M_PER_UNIT: f32 = 0.011_119_493;

/// Degrees beyond which there is no place, units.
const LATITUDE_MAX: i32 = 850_000_000;
const LONGITUDE_MAX: i32 = 1_800_000_000;

/// Units of angle that are 2^64 parts of a turn: 2^64 / 3.6e9.
const TURNS_PER_UNIT: i64 = 5_124_095_576;

/// Where the local frame's origin is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Origin {
    /// Units.
    pub latitude: i32,
    /// Units.
    pub longitude: i32,
    /// Above mean sea level, mm.
    pub altitude: i32,
}

/// A place on the globe.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Units.
    pub latitude: i32,
    /// Units.
    pub longitude: i32,
    /// Above mean sea level, m.
    pub altitude: f32,
}

impl Origin {
    /// One that a ground station has sent; none beyond 85 degrees of latitude, where this arithmetic ends.
    pub fn new(latitude: i32, longitude: i32, altitude: i32) -> Option<Self> {
        let exists = latitude.unsigned_abs() <= LATITUDE_MAX.unsigned_abs()
            && longitude.unsigned_abs() <= LONGITUDE_MAX.unsigned_abs();
        exists.then_some(Self { latitude, longitude, altitude })
    }

    /// Metres to a unit of longitude here.
    fn metres_east(&self) -> f32 {
        let turns = i64::from(self.latitude).wrapping_mul(TURNS_PER_UNIT).cast_unsigned();
        M_PER_UNIT * math::sin_cos_turns(turns).1
    }

    /// A place of north, east, down, m.
    pub fn place(&self, ned: &Vector3<f32>) -> Place {
        let units = |metres: f32, unit: f32| (metres / unit) as i32;
        Place {
            latitude: self.latitude.saturating_add(units(ned.x, M_PER_UNIT)),
            longitude: self.longitude.saturating_add(units(ned.y, self.metres_east())),
            altitude: self.altitude as f32 * 1e-3 - ned.z,
        }
    }

    /// Where a place is, north, east, down, m.
    pub fn local(&self, place: &Place) -> Vector3<f32> {
        let north = place.latitude.wrapping_sub(self.latitude) as f32 * M_PER_UNIT;
        let east = place.longitude.wrapping_sub(self.longitude) as f32 * self.metres_east();
        Vector3::new(north, east, self.altitude as f32 * 1e-3 - place.altitude)
    }
}

#[cfg(test)]
mod tests;
