//! The ground station and the pose source: MAVLink written and read by the public crate, not by the firmware's own
//! code.

use controller_core::state::State;
use firmware::hardware::Clock;
use host_sim::sessions::sitl::clock::SimClock;
use host_sim::sessions::sitl::memory_line::MemoryLine;
use mavlink::dialects::common::*;
use mavlink::{MAVLinkV2MessageRaw, MavHeader, MavlinkVersion, Message};
use std::cell::{Cell, RefCell};
use std::rc::Rc;

/// A ground station on the vehicle's link; clones are the same station.
#[derive(Clone)]
pub struct Station(Rc<Inner>);

struct Inner {
    clock: SimClock,
    up: MemoryLine,
    down: MemoryLine,
    received: RefCell<Vec<(u64, MavMessage)>>,
    sequence: Cell<u8>,
    heartbeats: Cell<bool>,
}

impl Station {
    /// A station at the ends of two lines: `up` to the vehicle, `down` from it.
    pub fn new(clock: &SimClock, up: MemoryLine, down: MemoryLine) -> Self {
        Self(Rc::new(Inner {
            clock: clock.clone(),
            up,
            down,
            received: RefCell::default(),
            sequence: Cell::new(0),
            heartbeats: Cell::new(true),
        }))
    }

    /// A message as it goes over the line, from system 255.
    pub fn frame(&self, message: &MavMessage) -> Vec<u8> {
        let sequence = self.0.sequence.get();
        self.0.sequence.set(sequence.wrapping_add(1));
        let mut raw = MAVLinkV2MessageRaw::new();
        raw.serialize_message(MavHeader { system_id: 255, component_id: 190, sequence }, message);
        raw.raw_bytes().to_vec()
    }

    /// Sends a message.
    pub fn send(&self, message: &MavMessage) {
        let bytes = self.frame(message);
        self.0.up.push(&bytes);
    }

    /// Sends bytes as they are.
    pub fn send_bytes(&self, bytes: &[u8]) {
        self.0.up.push(bytes);
    }

    /// Begins or ceases to send heartbeats.
    pub fn beat(&self, on: bool) {
        self.0.heartbeats.set(on);
    }

    /// Sends heartbeats once a second and listens, for ever.
    pub async fn run(self) {
        let mut beat = 0;
        loop {
            let now = self.0.clock.now();
            if now >= beat {
                beat += 1_000_000;
                if self.0.heartbeats.get() {
                    let mavtype = MavType::MAV_TYPE_GCS;
                    self.send(&MavMessage::HEARTBEAT(HEARTBEAT_DATA { mavtype, ..HEARTBEAT_DATA::DEFAULT }));
                }
            }
            self.listen(now);
            self.0.clock.until(now + 10_000).await;
        }
    }

    fn listen(&self, now: u64) {
        let bytes = self.0.down.drain();
        let mut rest: &[u8] = &bytes;
        while let Some(length) = rest.get(1).map(|payload| usize::from(*payload) + 12) {
            let mut raw = MAVLinkV2MessageRaw::new();
            raw.as_mut_slice()[..length].copy_from_slice(&rest[..length]);
            assert!(raw.has_valid_crc::<MavMessage>(), "the vehicle sent a broken frame");
            let message = MavMessage::parse(MavlinkVersion::V2, raw.message_id(), raw.payload()).unwrap();
            self.0.received.borrow_mut().push((now, message));
            rest = &rest[length..];
        }
    }

    /// Asks to arm or disarm.
    pub fn arm(&self, arm: bool) {
        self.command(MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, [f32::from(u8::from(arm)), 0.0, 0.0, 0.0]);
    }

    /// Disarms, in the air as well.
    pub fn disarm_by_force(&self) {
        self.command(MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, [0.0, 21196.0, 0.0, 0.0]);
    }

    /// Asks for flight by setpoints: PX4's mode OFFBOARD.
    pub fn fly_setpoints(&self) {
        self.command(MavCmd::MAV_CMD_DO_SET_MODE, [1.0, 6.0, 0.0, 0.0]);
    }

    /// Asks to hold position: PX4's mode AUTO.LOITER.
    pub fn hold(&self) {
        self.command(MavCmd::MAV_CMD_DO_SET_MODE, [1.0, 4.0, 3.0, 0.0]);
    }

    /// Asks for the policy's flight: PX4's mode AUTO.EXTERNAL1.
    pub fn fly_policy(&self) {
        self.command(MavCmd::MAV_CMD_DO_SET_MODE, [1.0, 4.0, 11.0, 0.0]);
    }

    /// Asks for a take-off, m high.
    pub fn take_off(&self, height: f32) {
        self.send(&MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
            command: MavCmd::MAV_CMD_NAV_TAKEOFF,
            param7: height,
            target_system: 1,
            target_component: 1,
            ..COMMAND_LONG_DATA::DEFAULT
        }));
    }

    /// Asks for a landing.
    pub fn land(&self) {
        self.command(MavCmd::MAV_CMD_NAV_LAND, [0.0; 4]);
    }

    /// Sets a parameter.
    pub fn set(&self, name: &str, value: f32) {
        self.send(&MavMessage::PARAM_SET(PARAM_SET_DATA {
            param_value: value,
            param_id: name.into(),
            param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
            target_system: 1,
            target_component: 1,
        }));
    }

    /// Asks for a motor, from 1, to turn at so many percent for so many seconds.
    pub fn test_motor(&self, number: u8, percent: f32, seconds: f32) {
        self.command(MavCmd::MAV_CMD_DO_MOTOR_TEST, [f32::from(number), 0.0, percent, seconds]);
    }

    fn command(&self, command: MavCmd, [param1, param2, param3, param4]: [f32; 4]) {
        self.send(&MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
            command,
            param1,
            param2,
            param3,
            param4,
            target_system: 1,
            target_component: 1,
            ..COMMAND_LONG_DATA::DEFAULT
        }));
    }

    /// Asks to go to a point, m, world (x, y, z up), heading along world x.
    pub fn go_to(&self, [x, y, z]: [f32; 3]) {
        let data = SET_POSITION_TARGET_LOCAL_NED_DATA {
            coordinate_frame: MavFrame::MAV_FRAME_LOCAL_NED,
            // Position and yaw.
            type_mask: PositionTargetTypemask::from_bits_truncate(0b1001_1111_1000),
            x: y,
            y: x,
            z: -z,
            yaw: std::f32::consts::FRAC_PI_2,
            ..SET_POSITION_TARGET_LOCAL_NED_DATA::DEFAULT
        };
        self.send(&MavMessage::SET_POSITION_TARGET_LOCAL_NED(data));
    }

    /// Asks to follow a point that moves, m to m/s^2, world, with the heading kept.
    pub fn stream(&self, [x, y, z]: [f32; 3], [vx, vy, vz]: [f32; 3], [ax, ay, az]: [f32; 3]) {
        self.send(&MavMessage::SET_POSITION_TARGET_LOCAL_NED(SET_POSITION_TARGET_LOCAL_NED_DATA {
            coordinate_frame: MavFrame::MAV_FRAME_LOCAL_NED,
            // All but yaw and its rate.
            type_mask: PositionTargetTypemask::from_bits_truncate(0b1100_0000_0000),
            x: y,
            y: x,
            z: -z,
            vx: vy,
            vy: vx,
            vz: -vz,
            afx: ay,
            afy: ax,
            afz: -az,
            ..SET_POSITION_TARGET_LOCAL_NED_DATA::DEFAULT
        }));
    }

    /// Asks to move at a velocity, m/s, world, with the heading kept.
    pub fn move_at(&self, [x, y, z]: [f32; 3]) {
        self.send(&MavMessage::SET_POSITION_TARGET_LOCAL_NED(SET_POSITION_TARGET_LOCAL_NED_DATA {
            coordinate_frame: MavFrame::MAV_FRAME_LOCAL_NED,
            // Velocity alone.
            type_mask: PositionTargetTypemask::from_bits_truncate(0b1101_1100_0111),
            vx: y,
            vy: x,
            vz: -z,
            ..SET_POSITION_TARGET_LOCAL_NED_DATA::DEFAULT
        }));
    }

    /// A pose as ODOMETRY: the same rotation and vectors in MAVLink's frames, worked out by hand.
    pub fn odometry(pose: &State) -> MavMessage {
        // World: east, north, up to north, east, down; body: left and up change sign. As quaternions, a half turn about
        // (1, 1, 0) / sqrt 2 before and one about x behind.
        let half = std::f32::consts::FRAC_1_SQRT_2;
        let q = nalgebra::Quaternion::new(0.0, half, half, 0.0)
            * pose.attitude
            * nalgebra::Quaternion::new(0.0, 1.0, 0.0, 0.0);
        let hardware = nalgebra::UnitQuaternion::new_unchecked(pose.attitude);
        let v = hardware.inverse_transform_vector(&pose.velocity);
        MavMessage::ODOMETRY(ODOMETRY_DATA {
            x: pose.position.y,
            y: pose.position.x,
            z: -pose.position.z,
            q: [q.w, q.i, q.j, q.k],
            vx: v.x,
            vy: -v.y,
            vz: -v.z,
            frame_id: MavFrame::MAV_FRAME_LOCAL_NED,
            child_frame_id: MavFrame::MAV_FRAME_BODY_FRD,
            ..ODOMETRY_DATA::DEFAULT
        })
    }

    /// The texts received so far, with their times, us.
    pub fn texts(&self) -> Vec<(u64, String)> {
        let text = |(time, message): &(u64, MavMessage)| match message {
            MavMessage::STATUSTEXT(data) => Some((*time, data.text.to_str().unwrap().to_owned())),
            _ => None,
        };
        self.0.received.borrow().iter().filter_map(text).collect()
    }

    /// When a text that begins so was first received, us.
    pub fn received(&self, beginning: &str) -> Option<u64> {
        self.texts().into_iter().find(|(_, text)| text.starts_with(beginning)).map(|(time, _)| time)
    }

    /// Acknowledgements after this are of commands after this.
    pub fn forget_acknowledgements(&self) {
        self.0.received.borrow_mut().retain(|(_, message)| !matches!(message, MavMessage::COMMAND_ACK(_)));
    }

    /// The result of the newest acknowledgement.
    pub fn acknowledged(&self) -> Option<MavResult> {
        self.0.received.borrow().iter().rev().find_map(|(_, message)| match message {
            MavMessage::COMMAND_ACK(data) => Some(data.result),
            _ => None,
        })
    }
}
