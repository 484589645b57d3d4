//! CRTP, which the tools of the Crazyflie speak, beside MAVLink.

pub mod packet;
pub mod session;
