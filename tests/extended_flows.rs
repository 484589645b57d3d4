//! The extended law's Lyapunov functions along its flows, with derivatives worked out from their definitions and the
//! equations of motion (nothing simplified by hand, so that a wrong sign or gain in the law shows). Sections 1, 6 and
//! 13 of `docs/extended-law.md`.
//!
//! - [`attitude`]: V falls along flows by the damping alone, whatever its share, and across the switch; the target is
//!   the only equilibrium.
//! - [`position`]: V_0 never rises under a constant force that is known; what a force error does to z_1 and z_2.

mod attitude;
mod position;
