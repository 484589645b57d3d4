//! What one tick of the law depends on, and what it comes to.

use super::estimates::Averages;
use super::fallback::Fallback;
use crate::support::oracle::lifting::Lift;
use nalgebra::{Matrix3, Vector2, Vector3, Vector4};

/// What the law knows from the tick before.
#[derive(Debug, Clone, Copy)]
pub struct Last {
    pub velocity: Vector3<f64>,
    pub axis: Vector3<f64>,
    pub omega: Vector3<f64>,
    /// a of section 6.
    pub forward: Vector3<f64>,
}

/// Everything one tick depends on.
#[derive(Debug, Clone, Copy)]
pub struct Tick {
    pub position_error: Vector3<f64>,
    pub velocity_error: Vector3<f64>,
    pub velocity: Vector3<f64>,
    pub rotation: Matrix3<f64>,
    pub omega: Vector3<f64>,
    /// p_d' to p_d''''.
    pub reference: [Vector3<f64>; 4],
    /// psi, psi', psi''.
    pub heading: [f64; 3],
    /// c, x and y.
    pub filters: [Vector3<f64>; 3],
    pub lift: Option<Lift>,
    /// Along m; none before the first tick.
    pub side: Option<Vector2<f64>>,
    /// The torque about z, either way, that was left in the last tick, N m.
    pub yaw_room: f64,
    pub averages: Averages,
    pub fallback: Fallback,
    /// None before the first tick.
    pub last: Option<Last>,
    /// Nothing is learnt.
    pub held: bool,
    /// The mean acceleration since the last tick, where it was measured, m/s^2.
    pub felt: Option<Vector3<f64>>,
    /// The mean of the wrench commanded since the last tick, through delay and lag; the impulse that is still under
    /// way. Both corrected by rotor speeds, where these were measured.
    pub acted: Vector4<f64>,
    pub pending: Vector4<f64>,
    pub nudge: Nudge,
}

/// The roundings of sums and differences that are formed on the way: added to each.
#[derive(Debug, Clone, Copy, Default)]
pub struct Nudge {
    /// u, u' and u''.
    pub command: [Vector3<f64>; 3],
    /// z_2, m/s.
    pub z_2: Vector3<f64>,
    /// What u is beside c, as far as the force is cut to it.
    pub rest: Vector3<f64>,
    /// The parts of the torque about the tilt's axes, in the order in which they are spent, N m.
    pub parts: [Vector2<f64>; PART_COUNT],
    /// The room of every row, as each part sees it, and U: relative. u_z, m/s^2.
    pub rooms: [f64; PART_COUNT],
    pub greatest: f64,
    pub lift: f64,
    /// N and C, N.
    pub thrust: f64,
    /// rho'' across rho, rad/s^2, as limited.
    pub turn: Vector3<f64>,
    /// What yaw asks for, and what is left for it, N m.
    pub yaw: [f64; 2],
}

/// Bias, pull, gyroscopic torque, damping, precession, turning.
pub const PART_COUNT: usize = 6;

/// What one tick comes to.
#[derive(Debug, Clone, Copy)]
pub struct Answer {
    pub thrust: f64,
    pub torque: Vector3<f64>,
    /// P and lambda D.
    pub pull: Vector2<f64>,
    pub damping: Vector2<f64>,
    pub omega_d: Vector3<f64>,
    pub omega_d_dot: Vector3<f64>,
    pub filters: [Vector3<f64>; 3],
    pub averages: Averages,
    /// m* Phi, and the lift's memory.
    pub lifted: Vector4<f64>,
    pub lift: Lift,
    /// Along m, as long as b reaches across rho; one while it is held.
    pub side: Vector2<f64>,
    pub yaw_room: f64,
    pub fallback: Fallback,
    /// a of section 6.
    pub forward: Vector3<f64>,
    /// The sizes of what was added up to the parts of the torque about the tilt's axes, and about z, N m.
    pub sizes: [f64; PART_COUNT + 1],
    /// How far the tick is from an edge at which the answer jumps: the lift's switch, the side's region, its switch.
    pub edge: f64,
    /// Which way the tick went where it can go two: [`BRANCHES`].
    pub taken: [bool; BRANCHES.len()],
}

/// What the branches are called.
pub const BRANCHES: [&str; 18] = [
    "rho's rate",
    "rho's acceleration",
    "cone",
    "|u| below U",
    "c_z above -A_-",
    "force held",
    "M below M_theta",
    "g short",
    "lambda < 1",
    "h short",
    "turn short of torque",
    "turn short of thrust",
    "floor",
    "ceiling",
    "yaw cut",
    "thrust cut for yaw",
    "side held",
    "the other way round",
];
