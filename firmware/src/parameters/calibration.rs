//! The calibration of each inertial sensor as it is kept among the parameters: eleven rows of the table each.
//!
//! The level is kept as the direction that was up when the level vehicle stood still, in the sensor's corrected axes,
//! divided by its z: two numbers, and no rounding can make them anything but a rotation.

use super::table::{Name, PARAMETERS};
use super::{Parameters, ValueRefusal};
use crate::hardware::Unit;
use crate::shared::{Read, Write};
use embassy_sync::blocking_mutex::raw::RawMutex;
use estimation::imu::Calibration;
use estimation::imu::standstill::StandstillMeans;
use nalgebra::Vector3;

/// Rows of one sensor: bias, offset and scale on three axes, level on two.
const ROWS_OF_A_SENSOR: usize = 11;

/// A sensor's rows, in the table's order.
fn rows(unit: Unit) -> impl Iterator<Item = Name> {
    let first = match unit {
        Unit::First => Name::Imu1GyroX,
        Unit::Second => Name::Imu2GyroX,
    };
    PARAMETERS.iter().skip(first as usize).take(ROWS_OF_A_SENSOR).map(|row| row.parameter)
}

/// Whether the first sensor's accelerometer has been calibrated, and its level: whether their rows are no defaults.
pub fn found<M: RawMutex>(parameters: Read<'_, Parameters<M>>) -> (bool, bool) {
    let is_set = |name: Name| parameters.get(name) != name.row().default;
    let is_any_set = |from: Name, to: Name| {
        PARAMETERS.iter().take(to as usize + 1).skip(from as usize).any(|row| is_set(row.parameter))
    };
    (is_any_set(Name::Imu1OffsetX, Name::Imu1ScaleZ), is_any_set(Name::Imu1LevelX, Name::Imu1LevelY))
}

/// What corrects the samples of `unit`.
/// Errors: all of it but the level, where that is tilted by more than 5 degrees.
pub fn load<M: RawMutex>(parameters: Write<'_, Parameters<M>>, unit: Unit) -> Result<Calibration, Calibration> {
    let mut values = [0.0; ROWS_OF_A_SENSOR];
    for (value, name) in values.iter_mut().zip(rows(unit)) {
        *value = parameters.get(name);
    }
    let [b_x, b_y, b_z, o_x, o_y, o_z, s_x, s_y, s_z, level_x, level_y] = values;
    let (offset, scale) = (Vector3::new(o_x, o_y, o_z), Vector3::new(s_x, s_y, s_z));
    let unlevelled = Calibration { gyro_bias: Vector3::new(b_x, b_y, b_z), offset, scale, ..Calibration::NONE };
    let up = Vector3::new(level_x, level_y, 1.0);
    let level =
        StandstillMeans { angular_velocity: Vector3::zeros(), specific_force: offset + up.component_div(&scale) };
    unlevelled.levelled(&level).map_err(|_| unlevelled)
}

/// Keeps what corrects the samples of `unit`.
/// Errors: [`ValueRefusal`] names the first row that the table does not allow; those before it are changed.
pub fn store<M: RawMutex>(
    parameters: Write<'_, Parameters<M>>,
    unit: Unit,
    calibration: &Calibration,
) -> Result<(), ValueRefusal> {
    let Calibration { gyro_bias, offset, scale, level } = calibration;
    // L takes up to e3, so its last row is up.
    let (x, y, z) = (level.m31, level.m32, level.m33);
    let values = gyro_bias.iter().chain(offset).chain(scale).copied().chain([x / z, y / z]);
    rows(unit).zip(values).try_for_each(|(name, value)| parameters.set(name, value))
}
