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
    #[must_use]
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
    #[must_use]
    pub fn place(&self, ned: &Vector3<f32>) -> Place {
        let units = |metres: f32, unit: f32| (metres / unit) as i32;
        Place {
            latitude: self.latitude.saturating_add(units(ned.x, M_PER_UNIT)),
            longitude: self.longitude.saturating_add(units(ned.y, self.metres_east())),
            altitude: self.altitude as f32 * 1e-3 - ned.z,
        }
    }

    /// Where a place is, north, east, down, m.
    #[must_use]
    pub fn local(&self, place: &Place) -> Vector3<f32> {
        let north = place.latitude.wrapping_sub(self.latitude) as f32 * M_PER_UNIT;
        let east = place.longitude.wrapping_sub(self.longitude) as f32 * self.metres_east();
        Vector3::new(north, east, self.altitude as f32 * 1e-3 - place.altitude)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back_is_within_a_centimetre_anywhere() {
        for (latitude, longitude) in [(0, 0), (473_977_420, 85_455_940), (-337_000_000, -708_000_000), (840_000_000, 5)]
        {
            let origin = Origin::new(latitude, longitude, 488_000).unwrap();
            for ned in [Vector3::new(3.0, -40.0, -2.5), Vector3::new(-100.0, 100.0, 7.0), Vector3::zeros()] {
                let back = origin.local(&origin.place(&ned));
                assert!((back - ned).norm() < 0.02, "{origin:?}: {ned} {back}");
            }
        }
    }

    #[test]
    fn a_degree_of_longitude_is_half_as_long_at_sixty_degrees() {
        let origin = Origin::new(600_000_000, 0, 0).unwrap();
        let place = Place { latitude: 600_000_000, longitude: 10_000, altitude: 0.0 };
        let local = origin.local(&place);
        assert!((local.y - 0.5 * 10_000.0 * M_PER_UNIT).abs() < 0.01, "{local}");
        assert_eq!(local.x, 0.0);
    }

    #[test]
    fn places_that_are_none_are_refused() {
        assert!(Origin::new(860_000_000, 0, 0).is_none() && Origin::new(0, 1_900_000_000, 0).is_none());
        assert!(Origin::new(i32::MIN, i32::MIN, 0).is_none());
    }
}
