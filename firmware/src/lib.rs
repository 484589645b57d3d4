//! The flight tasks of a quadrotor: hardware-independent, so that they run on boards, in an emulator and on a desktop.
//!
//! | module | what it holds |
//! |---|---|
//! | [`bmi088`], [`bmi270`], [`icm42688`] | the boards' inertial measurement units, over any SPI |
//! | [`boot`] | from the embedded scenario to a pilot, with its certificate worked out and logged |
//! | [`card`] | every flight as a file on a memory card |
//! | [`configuration`] | the scenario this build embeds |
//! | [`control`] | the control task: pilot in, motors out, on time |
//! | [`crtp`] | CRTP, which the tools of the Crazyflie speak |
//! | [`deadline`] | bounds in time for everything that is waited for |
//! | [`dshot`] | motor commands as pulse widths |
//! | [`esc`] | what the motors' controllers answer |
//! | [`stop_sequence`] | the order of a board's last acts |
//! | [`frames`] | MAVLink's frames to the law's and back |
//! | [`hardware`] | a board's peripherals, as narrow traits |
//! | [`hil`] | a simulator in place of sensors and motors |
//! | [`imu`] | the IMU task: samples to increments, faults in words, calibration |
//! | [`last_words`] | why the vehicle restarted by itself, kept over the reset and reported |
//! | [`link`] | MAVLink: frames, what comes in, what goes out |
//! | [`mounting`] | how a sensor sits in the vehicle |
//! | [`outputs`] | thrusts to motor commands |
//! | `pace` | when a sensor has a new sample: by its edges, or by the clock |
//! | [`parameters`] | the numbers that may be set from the ground, certified where that matters, kept in flash |
//! | [`radio`] | the operator's transmitter: arming, kill switch, sticks |
//! | [`recorder`] | the last seconds of the last flight, in memory that outlives a reset |
//! | [`redundant`] | two inertial sensors as one |
//! | `registers` | registers of a sensor behind SPI, and powering it up through them |
//! | [`repeat`] | motor commands sent again while they are young |
//! | [`replay`] | the paper's flight as one number, for comparing machines bit by bit |
//! | [`restart`] | the commanded restart |
//! | [`shared`] | the values that tasks exchange, each with its time, and which task may write and read it |
//! | [`spi`] | devices on a bus that several may share |
//! | [`status`] | a light, the battery, the log |
//! | [`syslink`] | the line to a chip that carries packets over the radio and measures the battery |
//! | `words` | enumerations in words |
//!
//! The tasks are plain `async fn`s, generic over a board's peripherals; `boards::stm32::tasks` and `src/bin/mps2.rs`
//! list them by priority and run them on Embassy's executors. They decide nothing about flight: that is
//! [`flight`].

#![cfg_attr(target_os = "none", no_std)]
#![allow(clippy::new_without_default, reason = "what tasks share is made by const functions, in statics")]

pub mod bmi088;
pub mod bmi270;
#[cfg(target_os = "none")]
pub mod boards;
pub mod boot;
pub mod card;
pub mod configuration;
pub mod control;
pub mod crtp;
pub mod deadline;
pub mod dshot;
pub mod esc;
pub mod frames;
pub mod hardware;
pub mod hil;
pub mod icm42688;
pub mod imu;
pub mod last_words;
pub mod link;
pub mod mounting;
pub mod outputs;
mod pace;
pub mod parameters;
pub mod radio;
pub mod recorder;
pub mod redundant;
mod registers;
pub mod repeat;
pub mod replay;
pub mod restart;
pub mod shared;
pub mod spi;
pub mod status;
pub mod stop_sequence;
pub mod syslink;
mod words;

#[cfg(test)]
mod tests {
    pub mod bench;
}
