//! From the wrench to the rotors, and back.
//!
//! The control law ends in a wrench w = (T, tau), body frame (x forward, y left, z up). Rotors deliver
//!
//! ```text
//! w = B f,   f_min,i <= f_i <= f_max,i,   column i of B = (1, y_i, -x_i, s_i k_m,i / k_eta,i)
//! ```
//!
//! for rotor i at (x_i, y_i) with thrust f_i = k_eta,i (rotor speed)^2 and drag torque s_i k_m,i (rotor speed)^2 about
//! body z. The wrenches they can deliver, the *polytope*, are the image of a box.
//!
//! - [`geometry`]: the rotors as validated types, B and its inverse;
//! - [`mixer`]: wrench to rotor thrusts; what does not fit is given up, yaw first, then thrust, roll and pitch last;
//! - [`minimum_norm`]: its first step, B+ w, which is all that a certified flight needs;
//! - [`remaining`]: the same after a rotor has failed;
//! - `attainable` (internal): the polytope as half-spaces, arranged for the mixer's three queries, and for
//!   [`max_torques`];
//! - [`curve`]: thrust to motor command and back, with battery compensation;
//! - [`support`]: the demand of a whole set of wrenches on each rotor: the certificate's last link.

mod attainable;
pub mod curve;
pub mod geometry;
pub mod minimum_norm;
pub mod mixer;
pub mod remaining;
pub mod support;

pub use attainable::max_torques;
pub use curve::{Battery, Motor, ThrustCurve};
pub use geometry::{QuadX, Rotor, Rotors, Spin};
pub use minimum_norm::{MinimumNorm, Thrusts};
pub use mixer::{Allocation, Mixer};
pub use support::{Commands, RotorDemand, Shape, TorqueTerm, demands};

use heapless::Vec;

/// Collects what fits; heapless' own `collect` panics when full, which the callers' counts rule out and a panic-free
/// core must not contain.
pub fn collected<T, const N: usize>(items: impl Iterator<Item = T>) -> Vec<T, N> {
    let mut list = Vec::new();
    for item in items {
        if list.push(item).is_err() {
            break;
        }
    }
    list
}
