//! What one tick of the law depends on, and what it comes to.

use super::estimates::Averages;
use super::net::Net;
use crate::support::oracle::lifting::Lift;
use nalgebra::{Matrix3, Vector3, Vector4};

/// What the law knows from the tick before.
#[derive(Debug, Clone, Copy)]
pub struct Last {
    pub velocity: Vector3<f64>,
    pub axis: Vector3<f64>,
    pub omega: Vector3<f64>,
    /// R~^T omega_d'.
    pub wanted: Vector3<f64>,
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
    /// chi and W; none before the first tick.
    pub lag: Option<[f64; 2]>,
    pub lift: Option<Lift>,
    pub averages: Averages,
    pub net: Net,
    /// None before the first tick.
    pub last: Option<Last>,
    /// Nothing is learnt.
    pub held: bool,
    /// The mean of the wrench commanded since the last tick, through delay and lag; the impulse that is still under
    /// way.
    pub acted: Vector4<f64>,
    pub pending: Vector4<f64>,
    pub nudge: Nudge,
}

/// The roundings of sums and differences that are formed on the way: added to each.
#[derive(Debug, Clone, Copy, Default)]
pub struct Nudge {
    /// u, u' and u''.
    pub command: [Vector3<f64>; 3],
    /// U, relative.
    pub greatest: f64,
    /// alpha, rad/s^2.
    pub budget: f64,
    /// rho'' across rho, rad/s^2, as limited.
    pub turn: Vector3<f64>,
    /// W', rad/s^2.
    pub heading: f64,
}

/// What one tick comes to.
#[derive(Debug, Clone, Copy)]
pub struct Answer {
    pub thrust: f64,
    pub torque: Vector3<f64>,
    pub omega_d: Vector3<f64>,
    pub omega_d_dot: Vector3<f64>,
    pub filters: [Vector3<f64>; 3],
    pub averages: Averages,
    /// chi and W.
    pub lag: [f64; 2],
    /// m* Phi, and the lift's memory.
    pub lifted: Vector4<f64>,
    pub lift: Lift,
    pub net: Net,
    /// R~^T omega_d'.
    pub wanted: Vector3<f64>,
    /// Which way the tick went where it can go two: the frame's rate, its acceleration, the same with W, its cone; |u|,
    /// c_z; the damping's share; the floor, the ceiling; W cut.
    pub taken: [bool; 10],
}
