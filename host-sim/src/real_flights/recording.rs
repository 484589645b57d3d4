//! A recorded flight: streams in SI units, world z up, body forward, left, up, each on its own times.
//!
//! From z down, y and z change their signs: of vectors, and of attitudes' vector part.

use super::columns::{AttitudeForm, ColumnMap, MotorMeasure, Stream};
use super::numbers::{Files, Rows};
use super::series::Series;
use nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};
use std::path::Path;

/// The streams. Poses and estimates: position, then the attitude's w, x, y, z.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// By motion capture.
    pub pose: Option<Series>,
    /// Rates, rad/s, then specific force, m/s^2, where there is an accelerometer.
    pub imu: Series,
    /// Each motor's, then the battery's voltage where it counts.
    pub motors: Series,
    /// What motors' numbers are.
    pub measure: MotorMeasure,
    /// The vehicle's own.
    pub estimate: Option<Series>,
    /// Position, and yaw, rad, where there is one.
    pub setpoint: Option<Series>,
    /// Hz, of the loop that wrote the commands.
    pub loop_rate: Option<f64>,
}

/// How far the length of a quaternion, or the determinant of a matrix, may be from 1.
const UNIT_TOLERANCE: f64 = 0.05;

impl Recording {
    /// Reads the file at `path`, and those beside it that `map` names.
    ///
    /// # Errors
    /// Names the file, and the line or the column that cannot be used.
    pub fn read(path: &Path, map: &ColumnMap) -> Result<Self, String> {
        let mut files = Files::new(path, map.names());
        let flips = |count: usize| -> Vec<f64> {
            (0..count).map(|i| if map.z_down && i % 3 > 0 { -1.0 } else { 1.0 }).collect()
        };
        let flipped = |rows: Rows, count: usize| -> Rows {
            let flips = flips(count);
            let flip = |row: Vec<f64>| {
                row.iter().enumerate().map(|(i, number)| number * flips.get(i).copied().unwrap_or(1.0)).collect()
            };
            rows.into_iter().map(|(time, row)| (time, flip(row))).collect()
        };
        let series = |name: &str, rows: Rows, keeps: bool| {
            Series::new(rows, keeps).map_err(|what| format!("{}: {name}: {what}", path.display()))
        };
        let mut posed = |name: &str, stream: &Option<(Stream, AttitudeForm)>| -> Result<Option<Series>, String> {
            match stream {
                None => Ok(None),
                Some((stream, form)) => {
                    let rows = files.rows(stream)?;
                    let rows = rows.into_iter().map(|(time, row)| {
                        let pose = pose(&row, *form).ok_or_else(|| {
                            format!(
                                "{}: {name}: the attitude at {time} s is no rotation: {:?}",
                                path.display(),
                                &row[3..]
                            )
                        })?;
                        Ok((time, pose))
                    });
                    let rows = flipped(rows.collect::<Result<Rows, String>>()?, 3);
                    let rows = rows.into_iter().map(|(time, mut row)| {
                        if map.z_down {
                            (row[5], row[6]) = (-row[5], -row[6]);
                        }
                        (time, row)
                    });
                    let mut series = series(name, rows.collect(), false)?;
                    continuous(&mut series.rows);
                    Ok(Some(series))
                }
            }
        };
        let (pose, estimate) = (posed("pose", &map.pose)?, posed("estimate", &map.estimate)?);
        let imu = series("imu", flipped(files.rows(&map.imu)?, 6), false)?;
        let (motors, measure) = &map.motors;
        let motors = series("motors", files.rows(motors)?, true)?;
        let setpoint = match &map.setpoint {
            None => None,
            Some(stream) => {
                let mut rows = flipped(files.rows(stream)?, 3);
                if map.z_down {
                    rows.iter_mut().for_each(|(_, row)| row.iter_mut().skip(3).for_each(|yaw| *yaw = -*yaw));
                }
                Some(series("setpoint", rows, true)?)
            }
        };
        Ok(Self { pose, imu, motors, measure: *measure, estimate, setpoint, loop_rate: map.loop_rate })
    }

    /// What was read, a line each.
    pub fn described(&self) -> String {
        let streams = [
            ("poses", self.pose.as_ref()),
            ("imu", Some(&self.imu)),
            ("motors", Some(&self.motors)),
            ("estimate", self.estimate.as_ref()),
            ("setpoint", self.setpoint.as_ref()),
        ];
        let lines =
            streams.iter().filter_map(|(name, series)| Some(format!("  {name}: {}\n", series.as_ref()?.described())));
        lines.collect()
    }
}

/// Position and quaternion of a row that has an attitude in this form.
fn pose(row: &[f64], form: AttitudeForm) -> Option<Vec<f64>> {
    let (position, attitude) = row.split_at_checked(3)?;
    let attitude = match (form, attitude) {
        (AttitudeForm::Quaternion, &[w, x, y, z]) => {
            let quaternion = Quaternion::new(w, x, y, z);
            ((quaternion.norm() - 1.0).abs() < UNIT_TOLERANCE).then(|| UnitQuaternion::new_normalize(quaternion))?
        }
        (AttitudeForm::Euler, &[roll, pitch, yaw]) => UnitQuaternion::from_euler_angles(roll, pitch, yaw),
        (AttitudeForm::Matrix, rows) => {
            let matrix = Matrix3::from_row_slice(rows);
            let off = (matrix * matrix.transpose() - Matrix3::identity()).amax();
            let is_rotation = off < UNIT_TOLERANCE && matrix.determinant() > 0.0;
            is_rotation.then(|| UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix(&matrix)))?
        }
        _ => return None,
    };
    Some(position.iter().copied().chain([attitude.w, attitude.i, attitude.j, attitude.k]).collect())
}

/// Gives neighbouring quaternions one sign, so that a straight line between them is short.
fn continuous(rows: &mut [Vec<f64>]) {
    for index in 1..rows.len() {
        let (before, after) = rows.split_at_mut(index);
        if let (Some(last), Some(next)) = (before.last(), after.first_mut()) {
            let along: f64 = last.iter().zip(next.iter()).skip(3).map(|(a, b)| a * b).sum();
            if along < 0.0 {
                next.iter_mut().skip(3).for_each(|part| *part = -*part);
            }
        }
    }
}

/// Position and attitude of a row of poses or estimates.
pub fn of_row(row: &[f64]) -> (Vector3<f64>, UnitQuaternion<f64>) {
    let number = |index: usize| row.get(index).copied().unwrap_or(0.0);
    let attitude = Quaternion::new(number(3), number(4), number(5), number(6));
    (Vector3::new(number(0), number(1), number(2)), UnitQuaternion::new_normalize(attitude))
}
