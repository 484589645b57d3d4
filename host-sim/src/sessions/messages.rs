//! The session's messages in MAVLink's frames: the flight controller's commands, and their answers.

use super::answer::{Answer, MeasuredPose};
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use firmware::frames;
use firmware::link::frame::{Frame, Version};
use firmware::link::signing::Signing;
use firmware::link::time_sync;
use flight::{ImuSample, Stamped};
use mavlink::dialects::common::{
    ESC_STATUS_DATA, HIL_ACTUATOR_CONTROLS_DATA, HIL_SENSOR_DATA, HilSensorUpdatedFlags, MavFrame, MavModeFlag,
    ODOMETRY_DATA,
};
use mavlink::{MAVLinkV2MessageRaw, MavHeader, MavlinkVersion, MessageData};

/// Motors that a flight controller commands.
pub const MOTOR_COUNT: usize = 4;

/// This side's MAVLink system: beside the vehicle's own.
const OWN_SYSTEM: u8 = 142;

/// Where the variances of x, y, z, roll, pitch and yaw lie in the upper triangle of a covariance, row by row.
const COVARIANCE_DIAGONAL: [usize; 6] = [0, 6, 11, 15, 18, 20];

/// One tick's motor commands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Controls {
    /// The flight controller's time, us.
    pub time: u64,
    /// Whether it drives the motors.
    pub armed: bool,
    /// 0 to 1 each, in the rotors' order.
    pub commands: [f32; MOTOR_COUNT],
}

impl Controls {
    /// The commands in a frame, if it holds any.
    pub fn from_frame(frame: &Frame<'_>) -> Option<Self> {
        let message: HIL_ACTUATOR_CONTROLS_DATA = decode(frame)?;
        let armed = message.mode.contains(MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED);
        let [a, b, c, d, ..] = message.controls;
        Some(Self { time: message.time_usec, armed, commands: [a, b, c, d] })
    }
}

/// The message in a frame, if it is of this type and its enumerations are known ones. Version 1 does not cut fields
/// off.
pub(super) fn decode<D: MessageData>(frame: &Frame<'_>) -> Option<D> {
    let whole = frame.version == Version::V2 || frame.payload.len() >= D::ENCODED_LEN;
    if frame.message == D::ID && whole { D::deser(MavlinkVersion::V2, frame.payload).ok() } else { None }
}

/// Puts the session's answers into bytes, counting them.
#[derive(Default)]
pub struct Encoder {
    sequence: u8,
    /// Signs them, once it has a key.
    pub signing: Signing<NoopRawMutex>,
}

impl Encoder {
    /// Appends an answer: the poses, the rotors' speeds, then the sensors' samples.
    pub fn answer(&mut self, answer: &Answer, bytes: &mut Vec<u8>) {
        answer.poses.iter().for_each(|pose| self.odometry(pose, bytes));
        answer.rotor_speeds.iter().for_each(|speeds| self.controllers(speeds, bytes));
        answer.samples.iter().for_each(|sample| self.sensor(sample, bytes));
    }

    /// Appends the answer, at `now`, us, to a TIMESYNC sent at `sent` of its sender's clock.
    pub fn time_sync(&mut self, sent: i64, now: u64, bytes: &mut Vec<u8>) {
        self.append(&time_sync::answer(sent, now), bytes);
    }

    /// Appends a pose as an ODOMETRY.
    fn odometry(&mut self, pose: &Stamped<MeasuredPose>, bytes: &mut Vec<u8>) {
        let Stamped { value: MeasuredPose { position, attitude, motion, deviations }, time } = pose;
        let position = frames::world(position);
        let q = frames::attitude(attitude);
        let (velocity, rates) = motion.unwrap_or_default();
        let (velocity, rates) = (frames::body(&velocity), frames::body(&rates));
        let mut pose_covariance = [0.0; 21];
        if let Some((of_position, of_attitude)) = deviations {
            COVARIANCE_DIAGONAL[..3].iter().for_each(|&place| pose_covariance[place] = of_position * of_position);
            COVARIANCE_DIAGONAL[3..].iter().for_each(|&place| pose_covariance[place] = of_attitude * of_attitude);
        }
        let mut velocity_covariance = [0.0; 21];
        if motion.is_none() {
            velocity_covariance[0] = f32::NAN;
        }
        self.append(
            &ODOMETRY_DATA {
                time_usec: *time,
                x: position.x,
                y: position.y,
                z: position.z,
                q: [q.w, q.i, q.j, q.k],
                vx: velocity.x,
                vy: velocity.y,
                vz: velocity.z,
                rollspeed: rates.x,
                pitchspeed: rates.y,
                yawspeed: rates.z,
                pose_covariance,
                velocity_covariance,
                frame_id: MavFrame::MAV_FRAME_LOCAL_NED,
                child_frame_id: MavFrame::MAV_FRAME_BODY_FRD,
            },
            bytes,
        );
    }

    /// Appends the rotors' speeds as an ESC_STATUS.
    fn controllers(&mut self, speeds: &Stamped<[f32; MOTOR_COUNT]>, bytes: &mut Vec<u8>) {
        let rpm = speeds.value.map(|speed| (speed * 60.0 / std::f32::consts::TAU).round() as i32);
        let unknown = [f32::NAN; MOTOR_COUNT];
        let status = ESC_STATUS_DATA { time_usec: speeds.time, rpm, voltage: unknown, current: unknown, index: 0 };
        self.append(&status, bytes);
    }

    /// Appends gyro and accelerometer as a HIL_SENSOR.
    fn sensor(&mut self, sample: &Stamped<ImuSample>, bytes: &mut Vec<u8>) {
        let gyro = frames::body(&sample.value.angular_velocity);
        let force = frames::body(&sample.value.specific_force);
        use HilSensorUpdatedFlags as Field;
        self.append(
            &HIL_SENSOR_DATA {
                time_usec: sample.time,
                xacc: force.x,
                yacc: force.y,
                zacc: force.z,
                xgyro: gyro.x,
                ygyro: gyro.y,
                zgyro: gyro.z,
                fields_updated: Field::HIL_SENSOR_UPDATED_XACC
                    | Field::HIL_SENSOR_UPDATED_YACC
                    | Field::HIL_SENSOR_UPDATED_ZACC
                    | Field::HIL_SENSOR_UPDATED_XGYRO
                    | Field::HIL_SENSOR_UPDATED_YGYRO
                    | Field::HIL_SENSOR_UPDATED_ZGYRO,
                ..HIL_SENSOR_DATA::default()
            },
            bytes,
        );
    }

    fn append(&mut self, message: &impl MessageData, bytes: &mut Vec<u8>) {
        let header = MavHeader { system_id: OWN_SYSTEM.into(), component_id: 1, sequence: self.sequence };
        self.sequence = self.sequence.wrapping_add(1);
        let mut frame = MAVLinkV2MessageRaw::new();
        frame.serialize_message_data(header, message);
        // Stamps follow each other; the vehicle's own move them on.
        self.signing.sign(&mut frame, 0);
        bytes.extend_from_slice(frame.raw_bytes());
    }
}
