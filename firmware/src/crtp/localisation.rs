//! Poses from outside.
//!
//! | channel | data | is |
//! |---|---|---|
//! | 0 | p (m) | where the vehicle is |
//! | 1 | 8, p, q (scalar last) | where it is and how it is turned |
//! | 1 | 9, for each vehicle: its number (1 byte), p (mm), q (4 bytes) | the same of several vehicles |
//! | 2 | for each vehicle: its number, p (mm) | where several are |
//! | 1 | 3; 4 | an emergency stop; its watchdog is fed |
//!
//! A vehicle's number is the last byte of its radio's address. A place without an attitude is taken with the attitude
//! that the estimate has, which it then says nothing about; where there is no estimate, with roll and pitch by gravity
//! and the nose along x, as Bitcraze's estimator begins. The vehicle has to be put down like that.

use super::fields::Fields;
use super::packet::Packet;
use super::parameters::Settings;
use crate::shared::Report;
use estimation::estimator::PoseMeasurement;
use flight::{Pose, PoseError, Velocity};
use nalgebra::{Quaternion, Vector3};

/// What an attitude that follows from nothing is worth, rad: so little that the estimate stays as it is.
const ATTITUDE_UNKNOWN_RAD: f32 = 1.0;

/// How exact a place is that comes without an attitude, m, where nobody has set that.
const POSITION_DEVIATION_M: f32 = 0.005;

/// The most vehicles in a packet.
const VEHICLES_MAX: usize = 4;

/// What a packet of this port brings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Localised {
    /// A pose of this vehicle.
    Pose(Result<PoseMeasurement, PoseError>),
    /// Stop the motors.
    EmergencyStop,
    /// Stop them if the next of these does not come in time.
    WatchdogFed,
}

/// What a packet brings to the vehicle with this number; none where it says nothing of it.
pub fn localised(packet: &Packet, number: u8, settings: &Settings, report: Option<&Report>) -> Option<Localised> {
    let mut fields = Fields::new(packet.data());
    let mut is_rounded = false;
    let (position, attitude) = match packet.channel {
        0 => (fields.vector()?, None),
        1 => match fields.u8()? {
            3 => return Some(Localised::EmergencyStop),
            4 => return Some(Localised::WatchdogFed),
            8 => {
                let position = fields.vector()?;
                let (x, y, z, w) = (fields.f32()?, fields.f32()?, fields.f32()?, fields.f32()?);
                (position, Some(Quaternion::new(w, x, y, z)))
            }
            9 => {
                is_rounded = true;
                own(&mut fields, number, |fields| Some((fields.thousandths()?, Some(fields.quaternion()?))))?
            }
            _ => return None,
        },
        2 => {
            is_rounded = true;
            own(&mut fields, number, |fields| Some((fields.thousandths()?, None)))?
        }
        _ => return None,
    };
    let still = Velocity::World(Vector3::zeros());
    let turned = attitude.unwrap_or_else(|| presumed(report));
    Some(Localised::Pose(Pose::new(position, still, turned).map(|pose| {
        let measured = PoseMeasurement::new(&pose);
        let measured = if is_rounded { measured.rounded() } else { measured };
        let Settings { position_deviation: exact, attitude_deviation: turn, .. } = *settings;
        match attitude {
            Some(_) if exact > 0.0 && turn > 0.0 => measured.deviations(exact, turn),
            Some(_) => measured,
            None => measured.place(if exact > 0.0 { exact } else { POSITION_DEVIATION_M }, ATTITUDE_UNKNOWN_RAD),
        }
    })))
}

/// What is said of the vehicle with this number among several.
fn own<T>(fields: &mut Fields<'_>, number: u8, mut read: impl FnMut(&mut Fields<'_>) -> Option<T>) -> Option<T> {
    for _ in 0..VEHICLES_MAX {
        let vehicle = fields.u8()?;
        let said = read(fields)?;
        if vehicle == number {
            return Some(said);
        }
    }
    None
}

/// The attitude of a vehicle of which only the place is known.
fn presumed(report: Option<&Report>) -> Quaternion<f32> {
    let known = report.and_then(|report| report.state.map(|state| state.attitude));
    let leaning = report.and_then(|report| report.lean).map(|lean| lean.attitude);
    known.or(leaning).unwrap_or_else(Quaternion::identity)
}
