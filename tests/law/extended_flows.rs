//! The extended law's Lyapunov functions along its flows, with derivatives worked out from their definitions and the
//! equations of motion (nothing simplified by hand, so that a wrong sign or gain in the law shows). Sections 1, 5, 6
//! and 13 of `docs/extended-law.md`.
//!
//! - [`attitude`]: V falls by the damping alone, whatever yaw does, and across half a turn;
//! - [`heading`]: the heading's energy never rises, whatever yaw gets;
//! - [`position`]: V_0 never rises under a constant force that is known, nor does it under the slowed law, which needs
//!   no more than the reserve; what a force error does to z_1 and z_2;
//! - [`theorem`]: the whole law, slowed and back, under a constant force and a wrong thrust scale.

mod attitude;
mod heading;
mod position;
mod theorem;
