//! Poses: ODOMETRY and ATT_POS_MOCAP, checked and turned into the law's frames.
//!
//! | message | accepted | velocity |
//! |---|---|---|
//! | ODOMETRY | position in LOCAL_NED or LOCAL_FRD | given: in BODY_FRD, or in the frame of the position |
//! | ATT_POS_MOCAP | FRD to NED | from differences of positions, see [`Differences`] |
//!
//! The pose's time is its arrival on the vehicle's clock: the clocks of sender and vehicle are not compared, so what passed
//! on the way there is not known, and not part of its age. The sender's own time serves two things: a message whose time
//! is not after the last one's is a repetition (or was overtaken) and is dropped, and differences are taken over it.
//!
//! One sender is listened to at a time, until it has been silent for [`SOURCE_SILENCE`]: two that disagree would look like
//! jumps. What numbers make a pose is [`Pose::new`]'s to say, and what it refuses makes the message worthless. Body rates
//! must be finite too, though the gyro's are flown; covariances are not looked at (NaN there means unknown).

use super::frame::Frame;
use crate::frames;
use controller_core::flight::{Pose, PoseError, Velocity};
use core::fmt;
use mavlink::MessageData;
use mavlink::dialects::common::{ATT_POS_MOCAP_DATA, MavFrame, ODOMETRY_DATA};
use nalgebra::{Quaternion, Vector3};

/// How long a source must have been silent before another is listened to, or its clock may start again, us.
pub const SOURCE_SILENCE: u64 = 1_000_000;

/// The longest gap that a difference is taken over, us of the sender's clock.
pub const GAP_MAX: u64 = 100_000;

/// The shortest, us: less would divide millimetres of noise by next to nothing.
pub const GAP_MIN: u64 = 1_000;

/// Time constant of the smoothing of differences, s.
const SMOOTHING: f32 = 0.02;

/// Why a pose was not taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PoseRefusal {
    /// Its numbers are none.
    Numbers(PoseError),
    /// Frames that are not converted here, or a message cut short.
    Frame,
    /// The sender's time is not after that of its last message.
    Repeated,
    /// Another source is being listened to.
    SecondSource,
    /// ATT_POS_MOCAP without a time: no velocity can be found.
    NoTime,
}

impl fmt::Display for PoseRefusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Numbers(error) => error.fmt(f),
            Self::Frame => f.write_str("use LOCAL_NED and BODY_FRD"),
            Self::Repeated => f.write_str("its time does not advance"),
            Self::SecondSource => f.write_str("another source is in use"),
            Self::NoTime => f.write_str("ATT_POS_MOCAP without a time"),
        }
    }
}

/// The source of poses that is listened to.
#[derive(Debug, Clone, Copy)]
struct Source {
    system: u8,
    component: u8,
    message: u32,
    /// The sender's time of the last message, us; zero if it has none.
    time: u64,
    /// When that arrived, us.
    arrived: u64,
}

/// Turns messages into poses.
#[derive(Debug, Default)]
pub struct Poses {
    source: Option<Source>,
    differences: Differences,
}

impl Poses {
    /// The pose in `frame`. None where there is none (yet): another message, or the first of those whose differences count.
    ///
    /// # Errors
    /// [`PoseRefusal`] for a message that cannot be used; nothing of it is kept.
    pub fn take(&mut self, frame: &Frame<'_>) -> Result<Option<Pose>, PoseRefusal> {
        match frame.message {
            ODOMETRY_DATA::ID => {
                let message = frame.decode().ok_or(PoseRefusal::Frame)?;
                let pose = odometry(&message)?;
                self.listen(frame, message.time_usec)?;
                Ok(Some(pose))
            }
            ATT_POS_MOCAP_DATA::ID => {
                let message: ATT_POS_MOCAP_DATA = frame.decode().ok_or(PoseRefusal::Frame)?;
                let ATT_POS_MOCAP_DATA { time_usec: time, q, x, y, z } = message;
                let pose = |velocity| pose([x, y, z], q, Velocity::World(velocity));
                // Nothing else may become the last position.
                let still = pose(Vector3::zeros())?;
                if time == 0 {
                    return Err(PoseRefusal::NoTime);
                }
                self.listen(frame, time)?;
                self.differences.take(still.position(), time, pose)
            }
            _ => Ok(None),
        }
    }

    /// Decides whether this sender is the one listened to and whether its message is a new one.
    fn listen(&mut self, frame: &Frame<'_>, time: u64) -> Result<(), PoseRefusal> {
        let (system, component) = (frame.header.system, frame.header.component);
        let new = Source { system, component, message: frame.message, time, arrived: frame.time };
        if let Some(old) = self.source.filter(|old| frame.time.saturating_sub(old.arrived) <= SOURCE_SILENCE) {
            if (old.system, old.component, old.message) != (system, component, frame.message) {
                return Err(PoseRefusal::SecondSource);
            }
            if time <= old.time && time != 0 {
                return Err(PoseRefusal::Repeated);
            }
        }
        self.source = Some(new);
        Ok(())
    }
}

/// The velocity of a sender that gives positions only.
///
/// Successive positions' difference over the sender's time between them, smoothed by a first-order filter with a time
/// constant of 20 ms: at 100 Hz that leaves 0.26 of the noise and makes it 25 ms old, differencing included. After a gap of
/// more than [`GAP_MAX`] it starts again, and there is no pose before the second position.
#[derive(Debug, Default)]
pub struct Differences {
    last: Option<(Vector3<f32>, u64)>,
    velocity: Option<Vector3<f32>>,
}

impl Differences {
    /// The pose at this position (m) and sender's time (us), if a velocity is known; `pose` makes it of a velocity (m/s).
    fn take(
        &mut self,
        position: Vector3<f32>,
        time: u64,
        pose: impl Fn(Vector3<f32>) -> Result<Pose, PoseRefusal>,
    ) -> Result<Option<Pose>, PoseRefusal> {
        let last = self.last.map(|(last, then)| (last, time.saturating_sub(then)));
        if last.is_some_and(|(_, gap)| gap < GAP_MIN) {
            return Err(PoseRefusal::Repeated);
        }
        self.last = Some((position, time));
        let Some((last, gap)) = last.filter(|&(_, gap)| gap <= GAP_MAX) else {
            self.velocity = None;
            return Ok(None);
        };
        let gap = gap as f32 * 1e-6;
        let difference = (position - last) / gap;
        // What no pose can have is a jump, and must not be smoothed into the next ones.
        pose(difference)?;
        let velocity = match self.velocity {
            Some(velocity) => velocity + (difference - velocity) * (gap / (SMOOTHING + gap)),
            None => difference,
        };
        self.velocity = Some(velocity);
        pose(velocity).map(Some)
    }
}

/// The pose in an ODOMETRY message.
///
/// # Errors
/// [`PoseRefusal::Frame`] or [`PoseRefusal::Numbers`].
pub(crate) fn odometry(message: &ODOMETRY_DATA) -> Result<Pose, PoseRefusal> {
    let &ODOMETRY_DATA { x, y, z, q, vx, vy, vz, frame_id: frame, child_frame_id: child, .. } = message;
    if ![message.rollspeed, message.pitchspeed, message.yawspeed].iter().all(|rate| rate.is_finite()) {
        return Err(PoseRefusal::Numbers(PoseError::NotFinite("body rate")));
    }
    let velocity = Vector3::new(vx, vy, vz);
    let velocity = match (frame, child) {
        (MavFrame::MAV_FRAME_LOCAL_NED | MavFrame::MAV_FRAME_LOCAL_FRD, MavFrame::MAV_FRAME_BODY_FRD) => {
            Velocity::Body(frames::body(&velocity))
        }
        (MavFrame::MAV_FRAME_LOCAL_NED, MavFrame::MAV_FRAME_LOCAL_NED)
        | (MavFrame::MAV_FRAME_LOCAL_FRD, MavFrame::MAV_FRAME_LOCAL_FRD) => Velocity::World(frames::world(&velocity)),
        _ => return Err(PoseRefusal::Frame),
    };
    pose([x, y, z], q, velocity)
}

/// The pose at a position of NED with an attitude FRD to NED, scalar first, and a velocity in the law's frames.
fn pose(position: [f32; 3], [w, i, j, k]: [f32; 4], velocity: Velocity) -> Result<Pose, PoseRefusal> {
    let attitude = frames::attitude(&Quaternion::new(w, i, j, k));
    Pose::new(frames::world(&position.into()), velocity, attitude).map_err(PoseRefusal::Numbers)
}
