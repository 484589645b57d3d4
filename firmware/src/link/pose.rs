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
//! jumps. A field that is used and is not finite, or out of any sensible range, makes the message worthless; covariances
//! are not looked at (NaN there means unknown).

use super::frame::Frame;
use super::message::{ATT_POS_MOCAP, LOCAL_NED, ODOMETRY};
use crate::frames;
use controller_core::flight::Pose;
use controller_core::governor::SPEED_RANGE;
use controller_core::math;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// How far from the origin a pose is believed, m.
pub const POSITION_MAX: f32 = 10_000.0;

/// How far from one a quaternion's length may be; closer ones are normalised.
pub const LENGTH_TOLERANCE: f32 = 0.05;

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
    /// A field in use is NaN or infinite.
    NotFinite,
    /// Further away or faster than any vehicle.
    OutOfRange,
    /// The quaternion's length is not one.
    NotARotation,
    /// Frames that are not converted here.
    Frame,
    /// The sender's time is not after that of its last message.
    Repeated,
    /// Another source is being listened to.
    SecondSource,
    /// ATT_POS_MOCAP without a time: no velocity can be found.
    NoTime,
}

impl PoseRefusal {
    /// The reason in words, to follow "Pose refused: ".
    #[must_use]
    pub fn text(self) -> &'static str {
        match self {
            Self::NotFinite => "a field is not finite",
            Self::OutOfRange => "too far away or too fast",
            Self::NotARotation => "quaternion not of unit length",
            Self::Frame => "use LOCAL_NED and BODY_FRD",
            Self::Repeated => "its time does not advance",
            Self::SecondSource => "another source is in use",
            Self::NoTime => "ATT_POS_MOCAP without a time",
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
            ODOMETRY => {
                let pose = odometry(frame)?;
                self.listen(frame, frame.u64(0))?;
                Ok(Some(pose))
            }
            ATT_POS_MOCAP => {
                // Time, attitude, position.
                let (time, pose) = (frame.u64(0), still(frame, 24, 8)?);
                if time == 0 {
                    return Err(PoseRefusal::NoTime);
                }
                self.listen(frame, time)?;
                let velocity = self.differences.take(pose.position, time)?;
                Ok(velocity.map(|velocity| Pose { velocity, ..pose }))
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
    /// The velocity at this position (m) and sender's time (us), if one is known.
    fn take(&mut self, position: Vector3<f32>, time: u64) -> Result<Option<Vector3<f32>>, PoseRefusal> {
        let last = self.last.map(|(last, then)| (last, time.saturating_sub(then)));
        if last.is_some_and(|(_, gap)| gap < GAP_MIN) {
            return Err(PoseRefusal::Repeated);
        }
        self.last = Some((position, time));
        let Some((last, gap)) = last.filter(|&(_, gap)| gap <= GAP_MAX) else {
            self.velocity = None;
            return Ok(None);
        };
        let gap = gap as u32 as f32 * 1e-6;
        let difference = (position - last) / gap;
        check(&difference, SPEED_RANGE)?;
        let velocity = match self.velocity {
            Some(velocity) => velocity + (difference - velocity) * (gap / (SMOOTHING + gap)),
            None => difference,
        };
        self.velocity = Some(velocity);
        Ok(self.velocity)
    }
}

/// MAV_FRAME_BODY_FRD.
const BODY_FRD: u8 = 12;
/// MAV_FRAME_LOCAL_FRD.
const LOCAL_FRD: u8 = 20;

/// The pose in an ODOMETRY message. Its body rates are checked but not used: the gyro is nearer.
pub(crate) fn odometry(message: &Frame<'_>) -> Result<Pose, PoseRefusal> {
    // Time, position, attitude, velocity, body rates, two covariances, the frames of position and velocity.
    let (velocity, frame, child) = (message.vector(36), message.byte(228), message.byte(229));
    if frame != LOCAL_NED && frame != LOCAL_FRD {
        return Err(PoseRefusal::Frame);
    }
    if !message.are_finite(36, 6) {
        return Err(PoseRefusal::NotFinite);
    }
    check(&velocity, SPEED_RANGE)?;
    let pose = still(message, 8, 20)?;
    let velocity = match child {
        BODY_FRD => UnitQuaternion::new_unchecked(pose.attitude) * frames::body(&velocity),
        child if child == frame => frames::world(&velocity),
        _ => return Err(PoseRefusal::Frame),
    };
    Ok(Pose { velocity, ..pose })
}

/// The pose of a vehicle at rest, with a position of NED and an attitude FRD to NED at these places of the message.
fn still(message: &Frame<'_>, position: usize, attitude: usize) -> Result<Pose, PoseRefusal> {
    if !message.are_finite(attitude, 4) {
        return Err(PoseRefusal::NotFinite);
    }
    let position = message.vector(position);
    check(&position, POSITION_MAX)?;
    // Scalar first.
    let q = Quaternion::from_parts(message.f32(attitude), message.vector(attitude + 4));
    let length = math::sqrt(q.norm_squared());
    if !((1.0 - LENGTH_TOLERANCE)..=(1.0 + LENGTH_TOLERANCE)).contains(&length) {
        return Err(PoseRefusal::NotARotation);
    }
    let (position, attitude) = (frames::world(&position), frames::attitude(&(q / length)));
    Ok(Pose { position, velocity: Vector3::zeros(), attitude })
}

/// Refuses components that are not finite or greater than `range`.
fn check(vector: &Vector3<f32>, range: f32) -> Result<(), PoseRefusal> {
    if vector.iter().any(|component| !component.is_finite()) {
        return Err(PoseRefusal::NotFinite);
    }
    if vector.iter().any(|component| component.abs() > range) {
        return Err(PoseRefusal::OutOfRange);
    }
    Ok(())
}
