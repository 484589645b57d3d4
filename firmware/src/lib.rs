//! The flight tasks of a quadrotor: hardware-independent, so that they run on boards, in an emulator and on a desktop.
//!
//! | module | what it holds |
//! |---|---|
//! | [`configuration`] | the scenario this build embeds, and its certificate worked out at boot |
//! | [`hardware`] | what the tasks ask of a board, as narrow traits |
//! | [`replay`] | the paper's flight as one number, for comparing machines bit by bit |
//! | [`shared`] | what the tasks tell each other, every value with its time |
//!
//! The tasks are plain `async fn`s, generic over a board's peripherals; a board's binary (`src/bin`) lists them by
//! priority and runs them on Embassy's executors. They decide nothing about flight: that is [`controller_core::flight`].

#![cfg_attr(target_os = "none", no_std)]

#[cfg(target_os = "none")]
pub mod boards;
pub mod configuration;
pub mod hardware;
pub mod replay;
pub mod shared;
