//! The firmware in closed loop with a simulated vehicle: its tasks on this desktop, or an image elsewhere.
//!
//! | module | what it holds |
//! |---|---|
//! | [`sitl`] | the firmware's own tasks, with MAVLink on UDP for clients |
//! | [`hil`] | the vehicle for a controller in an emulator or on a board, in lock-step |
//! | [`first_flight`] | a first flight's bench checks, with a person and a vehicle on a link |
//! | `pace`, [`ports`], `input` | what they need: the clock on the wall; the clients' UDP ports; lines of input |
//! | `answer`, `messages` | the simulator's side of the lock-step |

pub(crate) mod answer;
pub mod crtp_port;
pub mod first_flight;
pub mod hil;
pub(crate) mod input;
pub(crate) mod messages;
pub(crate) mod pace;
pub mod ports;
pub mod sitl;
