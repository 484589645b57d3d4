//! Poses: ODOMETRY, ATT_POS_MOCAP and the vision messages, checked and turned into the law's frames.
//!
//! | message | accepted | besides |
//! |---|---|---|
//! | ODOMETRY | position in LOCAL_NED or LOCAL_FRD, velocity in BODY_FRD or in the frame of the position | quality, reset counter, covariance |
//! | ATT_POS_MOCAP | FRD to NED | nothing |
//! | VISION_POSITION_ESTIMATE, GLOBAL_VISION_POSITION_ESTIMATE, VICON_POSITION_ESTIMATE | NED, roll, pitch and yaw of FRD | covariance; reset counter, but of VICON's |
//!
//! A pose's time is its sender's, on the vehicle's clock: see [`SenderClock`]. A sender without a clock (its times are
//! zero) has its poses stamped as they arrive. What a pose takes at least, from the camera to here, is known where its
//! sender answers TIMESYNC by the clock that stamps its poses ([`TimeSync`]); where it does not, parameter POSE_DELAY
//! gives it. A message whose time does not advance, its sender's or the vehicle's, is a repetition, or was overtaken,
//! and is dropped.
//!
//! One sender is listened to at a time, until it has been silent for [`SOURCE_TIMEOUT_US`]: two that disagree would
//! look like jumps. [`Pose::new`] checks the numbers; a message that it refuses does not count. Velocities and body
//! rates must be finite too, though the IMU's are flown (docs/mocap.md says why). Of the pose's covariance the greatest
//! variances of position and of attitude count, where they are positive (NaN means unknown, and zero that the sender
//! left it out). Infinite ones mean that the sender has no pose, and are refused.

use super::frame::Frame;
use super::sender_clock::{LATE_MAX_US, SenderClock};
use super::time_sync::{Offset, TimeSync};
use crate::frames;
use controller_core::math;
use controller_core::rotation::half_rotation;
use core::fmt;
use estimation::estimator::PoseMeasurement;
use flight::{Pose, PoseError, Stamped, Velocity};
use mavlink::MessageData;
use mavlink::dialects::common::{
    ATT_POS_MOCAP_DATA, GLOBAL_VISION_POSITION_ESTIMATE_DATA, MavFrame, ODOMETRY_DATA, TIMESYNC_DATA,
    VICON_POSITION_ESTIMATE_DATA, VISION_POSITION_ESTIMATE_DATA,
};
use nalgebra::{Quaternion, Vector3};

/// How long a source must have been silent before another is listened to.
pub const SOURCE_TIMEOUT_US: u64 = 1_000_000;

/// How long a delay that TIMESYNC gave counts as known: single messages may be stamped too early for it.
const DELAY_KNOWN_US: u64 = 1_000_000;

/// Where ODOMETRY's extension fields lie, which the message's type does not have.
const RESET_COUNTER_OFFSET: usize = ODOMETRY_DATA::ENCODED_LEN;
const QUALITY_OFFSET: usize = ODOMETRY_DATA::ENCODED_LEN + 2;

/// And a vision message's, a float each of the covariance, and behind it the reset counter.
const VISION_RESET_COUNTER_OFFSET: usize = VISION_POSITION_ESTIMATE_DATA::ENCODED_LEN + 84;

/// Whether a message of this number is a pose.
pub const fn is_pose(message: u32) -> bool {
    matches!(message, ODOMETRY_DATA::ID | ATT_POS_MOCAP_DATA::ID) || is_vision(message)
}

const fn is_vision(message: u32) -> bool {
    matches!(
        message,
        VISION_POSITION_ESTIMATE_DATA::ID | VICON_POSITION_ESTIMATE_DATA::ID | GLOBAL_VISION_POSITION_ESTIMATE_DATA::ID
    )
}

/// Why a pose was not taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PoseRefusal {
    /// Its numbers are invalid.
    Numbers(PoseError),
    /// Frames that are not converted here, or a message cut short.
    Frame,
    /// The sender's time is not after that of its last message.
    Repeated,
    /// It was under way for more than [`LATE_MAX_US`], by TIMESYNC.
    Late,
    /// It was under way for that much longer than others, or its sender's clock was set or stood still: without
    /// TIMESYNC the two look alike.
    LateOrSet,
    /// Its sender's clock was set or stood still: TIMESYNC says that it is not late.
    Set,
    /// Another source is being listened to.
    SecondSource,
}

impl fmt::Display for PoseRefusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Numbers(error) => error.fmt(f),
            Self::Frame => f.write_str("use LOCAL_NED and BODY_FRD"),
            Self::Repeated => f.write_str("its time does not advance"),
            Self::Late => f.write_str("more than 0.5 s late"),
            Self::LateOrSet => f.write_str("0.5 s late; let it answer TIMESYNC"),
            Self::Set => f.write_str("its sender's clock was set"),
            Self::SecondSource => f.write_str("another source is in use"),
        }
    }
}

/// The source of poses that is listened to.
#[derive(Debug, Clone, Copy)]
struct Source {
    system: u8,
    component: u8,
    message: u32,
    /// None if it has none.
    clock: Option<SenderClock>,
    sync: TimeSync,
    /// When its last message arrived, us.
    arrived: u64,
    /// When its pose was true, us; none before the first.
    stamped: Option<u64>,
    /// What it was taken to have been under way, us, and when it arrived of which that was last known by TIMESYNC.
    delay: u64,
    synchronised: Option<u64>,
}

/// Turns messages into poses.
#[derive(Debug, Default)]
pub struct Poses {
    source: Option<Source>,
}

impl Poses {
    /// Takes an answer to TIMESYNC, if it comes from the system that is listened to.
    pub fn synchronise(&mut self, frame: &Frame<'_>, message: &TIMESYNC_DATA) {
        if let Some(source) = self.source.as_mut().filter(|source| source.system == frame.header.system) {
            source.sync.take(message, frame.time);
        }
    }

    /// Whether the poses' delay is known by TIMESYNC.
    pub fn is_synchronised(&self) -> bool {
        self.source.as_ref().is_some_and(Source::is_synchronised)
    }

    /// The pose in `frame`; none in another message. Where the delay is unknown otherwise, it took `delay`, us, at
    /// least.
    /// Errors: [`PoseRefusal`] for a message that cannot be used; nothing of it is kept.
    pub fn take(&mut self, frame: &Frame<'_>, delay: u64) -> Result<Option<Stamped<PoseMeasurement>>, PoseRefusal> {
        let (value, time) = match frame.message {
            ODOMETRY_DATA::ID => {
                let message = frame.decode().ok_or(PoseRefusal::Frame)?;
                (odometry(frame, &message)?, message.time_usec)
            }
            ATT_POS_MOCAP_DATA::ID => {
                let message: ATT_POS_MOCAP_DATA = frame.decode().ok_or(PoseRefusal::Frame)?;
                let ATT_POS_MOCAP_DATA { time_usec, q, x, y, z } = message;
                let still = Velocity::World(Vector3::zeros());
                (PoseMeasurement::new(&pose([x, y, z], q, still)?), time_usec)
            }
            message if is_vision(message) => {
                // All three have the same fields in the same places.
                let alike = Frame { message: VISION_POSITION_ESTIMATE_DATA::ID, ..*frame };
                let message: VISION_POSITION_ESTIMATE_DATA = alike.decode().ok_or(PoseRefusal::Frame)?;
                (vision(frame, &message)?, message.usec)
            }
            _ => return Ok(None),
        };
        Ok(self.true_time(frame, time, delay)?.map(|time| Stamped { value, time }))
    }

    /// Decides whether this sender is the one listened to and whether its message is a new one; when it was true, us,
    /// or none where that is not after what was taken last.
    fn true_time(&mut self, frame: &Frame<'_>, time: u64, delay: u64) -> Result<Option<u64>, PoseRefusal> {
        let (system, component) = (frame.header.system, frame.header.component);
        let sender = (system, component, frame.message);
        let fresh = Source {
            system,
            component,
            message: frame.message,
            clock: None,
            sync: TimeSync::default(),
            arrived: frame.time,
            stamped: None,
            delay,
            synchronised: None,
        };
        let source = self.source.get_or_insert(fresh);
        if (source.system, source.component, source.message) != sender {
            if frame.time.saturating_sub(source.arrived) <= SOURCE_TIMEOUT_US {
                return Err(PoseRefusal::SecondSource);
            }
            *source = fresh;
        }
        if source.is_late(time, frame.time) {
            return Err(PoseRefusal::Late);
        }
        let is_set = source.is_synchronised() && source.sync.recent(frame.time).is_some();
        if let (Some(clock), Some(Offset { value, error })) = (&mut source.clock, source.sync.offset(frame.time)) {
            clock.restore(value - i128::from(error), time, frame.time);
        }
        let begun = source.clock.as_ref().map(SenderClock::begun);
        let advances = source.clock.as_ref().is_some_and(|clock| clock.advances(time));
        let stamp = match &mut source.clock {
            _ if time == 0 => Some(frame.time),
            Some(clock) => clock.stamp(time, frame.time),
            none => {
                *none = Some(SenderClock::new(time, frame.time));
                Some(frame.time)
            }
        };
        if begun.is_some() && begun != source.clock.as_ref().map(SenderClock::begun) {
            source.begin_anew();
        }
        let known = source.delay(time);
        let delay = known.unwrap_or(delay);
        let refusal = match (advances, is_set) {
            (false, _) => PoseRefusal::Repeated,
            (true, false) => PoseRefusal::LateOrSet,
            (true, true) => PoseRefusal::Set,
        };
        let stamp = stamp.map(|stamp| stamp.saturating_sub(delay)).ok_or(refusal)?;
        // A sender whose clock comes and goes is stamped in two ways, which need not keep the order.
        if source.stamped.is_some_and(|last| stamp <= last) {
            // Better knowledge of the delay sets stamps back: nothing that its sender could help.
            return if delay > source.delay { Ok(None) } else { Err(PoseRefusal::Repeated) };
        }
        (source.arrived, source.stamped, source.delay) = (frame.time, Some(stamp), delay);
        source.synchronised = known.map_or(source.synchronised, |_| Some(frame.time));
        Ok(Some(stamp))
    }
}

impl Source {
    /// Whether TIMESYNC gave the delay of its last messages.
    fn is_synchronised(&self) -> bool {
        self.synchronised.is_some_and(|known| self.arrived.saturating_sub(known) <= DELAY_KNOWN_US)
    }

    /// What a message of `time` took at least, us, by TIMESYNC; none if that is not of the clock which stamps the
    /// messages.
    fn delay(&self, time: u64) -> Option<u64> {
        let clock = self.clock.as_ref().filter(|_| time != 0)?;
        let Offset { value, error } = self.sync.offset(self.arrived)?;
        let delay = clock.offset() - value;
        // No message is here before it was sent; and one that is too late does not count.
        let plausible = (-i128::from(error)..=i128::from(LATE_MAX_US)).contains(&delay);
        plausible.then(|| u64::try_from(delay).unwrap_or(0))
    }

    /// Whether a message of `time` that arrived at `arrived`, us, is too late by TIMESYNC. A time that does not advance
    /// is not late: it is no new one, or its clock was set.
    fn is_late(&self, time: u64, arrived: u64) -> bool {
        let goes_on = self.clock.as_ref().is_some_and(|clock| clock.advances(time));
        let known = self.sync.recent(arrived).filter(|_| self.is_synchronised() && goes_on && time != 0);
        known.is_some_and(|Offset { value, error }| {
            i128::from(arrived) - i128::from(time) - value > i128::from(LATE_MAX_US) + i128::from(error)
        })
    }

    /// The sender's clock was set: TIMESYNC's offset is of the old one. The line's delay is kept until the next answer.
    fn begin_anew(&mut self) {
        let value =
            self.clock.as_ref().filter(|_| self.is_synchronised()).map(|clock| clock.offset() - i128::from(self.delay));
        self.sync = value.map_or_else(TimeSync::default, |value| TimeSync::presumed(value, self.arrived));
    }
}

/// The pose in an ODOMETRY message, which came in `frame`.
/// Errors: [`PoseRefusal::Frame`] or [`PoseRefusal::Numbers`].
pub(crate) fn odometry(frame: &Frame<'_>, message: &ODOMETRY_DATA) -> Result<PoseMeasurement, PoseRefusal> {
    let &ODOMETRY_DATA { x, y, z, q, vx, vy, vz, frame_id, child_frame_id, .. } = message;
    if ![message.rollspeed, message.pitchspeed, message.yawspeed].iter().all(|rate| rate.is_finite()) {
        return Err(PoseRefusal::Numbers(PoseError::NotFinite("body rate")));
    }
    let velocity = Vector3::new(vx, vy, vz);
    let velocity = match (frame_id, child_frame_id) {
        (MavFrame::MAV_FRAME_LOCAL_NED | MavFrame::MAV_FRAME_LOCAL_FRD, MavFrame::MAV_FRAME_BODY_FRD) => {
            Velocity::Body(frames::body(&velocity))
        }
        (MavFrame::MAV_FRAME_LOCAL_NED, MavFrame::MAV_FRAME_LOCAL_NED)
        | (MavFrame::MAV_FRAME_LOCAL_FRD, MavFrame::MAV_FRAME_LOCAL_FRD) => Velocity::World(frames::world(&velocity)),
        _ => return Err(PoseRefusal::Frame),
    };
    let measured = PoseMeasurement::with_velocity(&pose([x, y, z], q, velocity)?);
    let measured = deviations(measured, &message.pose_covariance)?;
    // Zeros at the end are cut off, and older senders do not know these fields.
    let extension = |place: usize| frame.payload.get(place).copied().unwrap_or(0);
    Ok(measured.quality(extension(QUALITY_OFFSET).cast_signed()).reset_counter(extension(RESET_COUNTER_OFFSET)))
}

/// The pose in a vision message, which came in `frame`.
fn vision(frame: &Frame<'_>, message: &VISION_POSITION_ESTIMATE_DATA) -> Result<PoseMeasurement, PoseRefusal> {
    let &VISION_POSITION_ESTIMATE_DATA { x, y, z, roll, pitch, yaw, .. } = message;
    let [roll, pitch, yaw] = [Vector3::x() * roll, Vector3::y() * pitch, Vector3::z() * yaw];
    let turned = half_rotation(&(yaw * 0.5)) * half_rotation(&(pitch * 0.5)) * half_rotation(&(roll * 0.5));
    let [i, j, k, w] = turned.coords.into();
    let still = Velocity::World(Vector3::zeros());
    let measured = PoseMeasurement::new(&pose([x, y, z], [w, i, j, k], still)?);
    // Zeros at the end are cut off, and older senders do not know these fields.
    let extension = |place: usize| frame.payload.get(place).copied().unwrap_or(0);
    let number = |index: usize| {
        let place = VISION_POSITION_ESTIMATE_DATA::ENCODED_LEN + 4 * index;
        f32::from_le_bytes([0, 1, 2, 3].map(|byte| extension(place + byte)))
    };
    let measured = deviations(measured, &core::array::from_fn(number))?;
    Ok(measured.reset_counter(extension(VISION_RESET_COUNTER_OFFSET)))
}

/// With the deviations of a covariance, if it is known.
/// Errors: [`PoseRefusal::Numbers`] if any variance is infinite.
fn deviations(measured: PoseMeasurement, covariance: &[f32; 21]) -> Result<PoseMeasurement, PoseRefusal> {
    // The diagonal of the upper triangle, row by row: x, y, z, roll, pitch, yaw.
    let [xx, .., yy, _, _, _, _, zz, _, _, _, rr, _, _, pp, _, hh] = *covariance;
    if [xx, yy, zz, rr, pp, hh].iter().any(|variance| variance.is_infinite()) {
        return Err(PoseRefusal::Numbers(PoseError::NotFinite("covariance")));
    }
    Ok(measured.deviations(deviation([xx, yy, zz]), deviation([rr, pp, hh])))
}

/// The root of the greatest of three variances; NaN if any of them is unknown.
fn deviation(variances: [f32; 3]) -> f32 {
    if !variances.iter().all(|&variance| variance > 0.0) {
        return f32::NAN;
    }
    math::sqrt(variances.iter().fold(0.0, |greatest, &variance| math::max(greatest, variance)))
}

/// The pose at a position of NED with an attitude FRD to NED, scalar first, and a velocity in the law's frames.
fn pose(position: [f32; 3], [w, i, j, k]: [f32; 4], velocity: Velocity) -> Result<Pose, PoseRefusal> {
    let attitude = frames::attitude(&Quaternion::new(w, i, j, k));
    Pose::new(frames::world(&position.into()), velocity, attitude).map_err(PoseRefusal::Numbers)
}
