//! The extended law's Lyapunov functions along its flows, with derivatives worked out from their definitions and the equations of
//! motion (nothing simplified by hand, so that a wrong sign or gain in the law shows). Sections 1, 2, 4 and 13 of
//! `docs/extended-law.md`.
//!
//! - [`attitude`]: V falls along flows by the damping alone, and across the switch; the target is the only equilibrium.
//! - [`position`]: V_0 never rises; what a force error does to z_1 and z_2.
//! - [`generator`]: the force estimate never leaves its levels.

mod attitude;
mod generator;
mod position;
