//! From a sensor at rest to what corrects it, for each procedure.

use crate::shared::Procedure;
use core::fmt::{self, Display};
use estimation::imu::Calibration;
use estimation::imu::calibration::NotLevel;
use estimation::imu::six_point::{SixPoint, SixPointError};
use estimation::imu::standstill::StandstillMeans;
use nalgebra::Vector3;

/// What a sensor at rest feels.
pub const GRAVITY_M_PER_S2: f32 = 9.806_65;

/// The greatest offset that one side alone may find: the data sheet's four times, or 4.7 degrees of tilt.
const OFFSET_MAX_M_PER_S2: f32 = 0.8;

/// Why there is no calibration.
pub enum Problem {
    /// Tilted.
    NotLevel(NotLevel),
    /// The six sides do not make one.
    Sides(SixPointError),
    /// The offset by one side is too large.
    Offset,
}

impl Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotLevel(error) => error.fmt(f),
            Self::Sides(error) => error.fmt(f),
            Self::Offset => f.write_str("Calibration: tilted, or offset over 0.8 m/s^2"),
        }
    }
}

/// What corrects a sensor that stood still so, `sides` being the six it has stood on.
/// An error names what is implausible.
pub fn solve(
    procedure: Procedure,
    before: &Calibration,
    rest: &StandstillMeans,
    sides: Option<SixPoint>,
) -> Result<Calibration, Problem> {
    let level = Calibration::NONE.level;
    match procedure {
        Procedure::Gyro => Ok(before.with_gyro_bias(rest)),
        Procedure::Level => before.levelled(rest).map_err(Problem::NotLevel),
        Procedure::OneSide => {
            let offset = rest.specific_force - Vector3::z().component_div(&before.scale) * GRAVITY_M_PER_S2;
            let plausible = offset.iter().all(|component| component.abs() <= OFFSET_MAX_M_PER_S2);
            if plausible { Ok(Calibration { offset, level, ..*before }) } else { Err(Problem::Offset) }
        }
        Procedure::SixSides => {
            let sides = sides.ok_or(Problem::Sides(SixPointError::FaceMissing))?;
            let (offset, scale) = sides.solve(GRAVITY_M_PER_S2).map_err(Problem::Sides)?;
            Ok(Calibration { offset, scale, level, ..*before })
        }
    }
}
