//! Setpoints: SET_POSITION_TARGET_LOCAL_NED and its type mask, turned into setpoints of the governor.
//!
//! | used, of position / velocity / acceleration | becomes |
//! |---|---|
//! | position | go there and rest |
//! | velocity | move like that |
//! | position and velocity, with or without acceleration | follow that moving point |
//! | position on some axes, velocity on the others, or both | go there on those, move like that on these |
//! | anything else: acceleration alone or with some axes only, nothing on an axis, forces | refused |
//!
//! The heading is kept, turned to, or turned at a rate, by its two bits. Fields that the mask ignores are not read. The
//! governor checks ranges.
//!
//! | frame | position | velocity, acceleration | yaw |
//! |---|---|---|---|
//! | LOCAL_NED | there | there | from north |
//! | LOCAL_OFFSET_NED | from where the vehicle is | north, east, down | from where it points |
//! | BODY_NED, BODY_OFFSET_NED, BODY_FRD | from where it is, ahead, right, down | ahead, right, down | from where it points |
//!
//! Ahead is where the vehicle points, level: its tilt does not matter. Axes that turn with the vehicle are not the
//! world's: there a setpoint ahead needs one across too.

use crate::frames;
use crate::words::worded;
use controller_core::governor::{HeadingSetpoint, Motion, Setpoint};
use controller_core::math;
use controller_core::state::State;
use mavlink::dialects::common::{MavFrame, PositionTargetTypemask as Mask, SET_POSITION_TARGET_LOCAL_NED_DATA};
use nalgebra::{RealField, UnitQuaternion, Vector2, Vector3};

worded! {
    /// Why a setpoint was not taken.
    pub enum SetpointRefusal {
        /// A field in use is NaN or infinite.
        NotFinite = "a field is not finite",
        /// A combination of fields that the governor cannot fly.
        Mask = "type mask not supported",
        /// A frame that is not understood, or one that needs a position, without an estimate.
        Frame = "frame not understood",
        /// A radio's sticks fly.
        Sticks = "the sticks fly",
        /// Another sender's setpoints are flown.
        Others = "another sender's are flown",
    }
}

/// The bits that set a position aside, axis by axis; and those for velocity and acceleration.
const NO_POSITION: Mask = Mask::POSITION_TARGET_TYPEMASK_X_IGNORE
    .union(Mask::POSITION_TARGET_TYPEMASK_Y_IGNORE)
    .union(Mask::POSITION_TARGET_TYPEMASK_Z_IGNORE);
const NO_VELOCITY: Mask = Mask::POSITION_TARGET_TYPEMASK_VX_IGNORE
    .union(Mask::POSITION_TARGET_TYPEMASK_VY_IGNORE)
    .union(Mask::POSITION_TARGET_TYPEMASK_VZ_IGNORE);
const NO_ACCELERATION: Mask = Mask::POSITION_TARGET_TYPEMASK_AX_IGNORE
    .union(Mask::POSITION_TARGET_TYPEMASK_AY_IGNORE)
    .union(Mask::POSITION_TARGET_TYPEMASK_AZ_IGNORE);

/// Where the vehicle is, m, and where it points, in the law's world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Here {
    position: Vector3<f32>,
    /// A unit vector, level.
    ahead: Vector2<f32>,
}

impl Here {
    /// Of a vehicle in this state; none where it points straight up or down.
    pub fn at(state: &State) -> Option<Self> {
        let ahead = (UnitQuaternion::new_unchecked(state.attitude) * Vector3::x()).xy();
        let length = math::sqrt(ahead.norm_squared());
        (length > 0.1).then(|| Self { position: state.position, ahead: ahead / length })
    }

    /// Ahead, left, up in the law's world.
    pub fn turned(&self, v: &Vector3<f32>) -> Vector3<f32> {
        let (cosine, sine) = (self.ahead.x, self.ahead.y);
        Vector3::new(cosine * v.x - sine * v.y, sine * v.x + cosine * v.y, v.z)
    }
}

/// How the numbers of a frame are meant.
struct Axes<'h> {
    /// Where positions begin, and yaw.
    from: Option<&'h Here>,
    /// Whether they are ahead, right, down.
    turned: bool,
}

impl Axes<'_> {
    fn vector(&self, vector: [f32; 3]) -> Vector3<f32> {
        match self.from {
            Some(here) if self.turned => here.turned(&frames::body(&vector.into())),
            _ => frames::world(&vector.into()),
        }
    }

    fn place(&self, vector: [f32; 3]) -> Vector3<f32> {
        self.vector(vector) + self.from.map_or_else(Vector3::zeros, |here| here.position)
    }
}

/// How a frame is to be understood.
#[expect(deprecated, reason = "frames that clients still use")]
fn axes(frame: MavFrame, here: Option<&Here>) -> Result<Axes<'_>, SetpointRefusal> {
    let from = here.ok_or(SetpointRefusal::Frame);
    match frame {
        MavFrame::MAV_FRAME_LOCAL_NED => Ok(Axes { from: None, turned: false }),
        MavFrame::MAV_FRAME_LOCAL_OFFSET_NED => Ok(Axes { from: Some(from?), turned: false }),
        MavFrame::MAV_FRAME_BODY_NED | MavFrame::MAV_FRAME_BODY_OFFSET_NED | MavFrame::MAV_FRAME_BODY_FRD => {
            Ok(Axes { from: Some(from?), turned: true })
        }
        _ => Err(SetpointRefusal::Frame),
    }
}

/// The setpoint of a SET_POSITION_TARGET_LOCAL_NED, for a vehicle that is `here`.
/// Errors: [`SetpointRefusal`] for what cannot be done or is not finite.
pub fn setpoint(
    message: &SET_POSITION_TARGET_LOCAL_NED_DATA,
    here: Option<&Here>,
) -> Result<Setpoint, SetpointRefusal> {
    let &SET_POSITION_TARGET_LOCAL_NED_DATA { x, y, z, vx, vy, vz, afx, afy, afz, type_mask: mask, .. } = message;
    let axes = axes(message.coordinate_frame, here)?;
    let position = Used::read([x, y, z], mask, NO_POSITION)?;
    let velocity = Used::read([vx, vy, vz], mask, NO_VELOCITY)?;
    let acceleration = Used::read([afx, afy, afz], mask, NO_ACCELERATION)?;
    let place = axes.place(position.vector);
    let (moving, accelerating) = (axes.vector(velocity.vector), axes.vector(acceleration.vector));
    let motion = match (position.axes, velocity.axes, acceleration.axes) {
        (_, _, [false, false, false]) => mixed(&axes, &place, &position, &moving, &velocity)?,
        (ALL, ALL, ALL) if !mask.contains(Mask::POSITION_TARGET_TYPEMASK_FORCE_SET) => {
            Motion::PositionVelocityAcceleration { position: place, velocity: moving, acceleration: accelerating }
        }
        _ => return Err(SetpointRefusal::Mask),
    };
    Ok(Setpoint { motion, turn: turn(message, axes.from)? })
}

/// Every axis.
const ALL: [bool; 3] = [true; 3];

/// Position, velocity, or some of each, axis by axis; nothing on an axis is refused.
fn mixed(
    axes: &Axes<'_>,
    place: &Vector3<f32>,
    position: &Used,
    moving: &Vector3<f32>,
    velocity: &Used,
) -> Result<Motion, SetpointRefusal> {
    Ok(match (position.axes, velocity.axes) {
        (ALL, [false, false, false]) => Motion::Position(*place),
        ([false, false, false], ALL) => Motion::Velocity(*moving),
        (ALL, ALL) => {
            Motion::PositionVelocityAcceleration { position: *place, velocity: *moving, acceleration: Vector3::zeros() }
        }
        ([px, py, pz], [vx, vy, vz]) => {
            let together = px == py && vx == vy;
            if !(px || vx) || !(py || vy) || !(pz || vz) || axes.turned && !together {
                return Err(SetpointRefusal::Mask);
            }
            // North is the law's y.
            let [x, y] = if axes.turned { [px, py] } else { [py, px] };
            let on = |is: bool, place: f32| is.then_some(place);
            Motion::Mixed { position: [on(x, place.x), on(y, place.y), on(pz, place.z)], velocity: *moving }
        }
    })
}

/// A vector under a mask: zero where it ignores an axis.
struct Used {
    vector: [f32; 3],
    axes: [bool; 3],
}

impl Used {
    fn read(vector: [f32; 3], mask: Mask, ignored: Mask) -> Result<Self, SetpointRefusal> {
        // The bits of a vector are neighbours, x lowest.
        let first = ignored.bits().trailing_zeros();
        let axes = [0, 1, 2].map(|axis| mask.bits() >> (first + axis) & 1 == 0);
        let [x, y, z] = vector;
        let [has_x, has_y, has_z] = axes;
        let kept = |has: bool, component: f32| if has { component } else { 0.0 };
        let vector = [kept(has_x, x), kept(has_y, y), kept(has_z, z)];
        let finite = vector.iter().all(|component| component.is_finite());
        if finite { Ok(Self { vector, axes }) } else { Err(SetpointRefusal::NotFinite) }
    }
}

/// Which way to point: from north, or from where the vehicle points.
fn turn(message: &SET_POSITION_TARGET_LOCAL_NED_DATA, from: Option<&Here>) -> Result<HeadingSetpoint, SetpointRefusal> {
    let turns = !message.type_mask.contains(Mask::POSITION_TARGET_TYPEMASK_YAW_IGNORE);
    let rotates = !message.type_mask.contains(Mask::POSITION_TARGET_TYPEMASK_YAW_RATE_IGNORE);
    if turns && !message.yaw.is_finite() || rotates && !message.yaw_rate.is_finite() {
        return Err(SetpointRefusal::NotFinite);
    }
    let rate = frames::heading_rate(message.yaw_rate);
    let angle = match from {
        None => frames::heading(message.yaw),
        // A yaw to the right is a heading to the other side.
        Some(here) => RealField::atan2(here.ahead.y, here.ahead.x) - message.yaw,
    };
    Ok(match (turns, rotates) {
        (false, false) => HeadingSetpoint::Keep,
        (false, true) => HeadingSetpoint::Rate(rate),
        (true, _) => HeadingSetpoint::Angle { angle, rate: if rotates { rate } else { 0.0 } },
    })
}
