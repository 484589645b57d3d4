//! What the STM32 boards share: the traits of [`crate::hardware`] on Embassy's drivers, and the tasks.

pub mod absent;
#[cfg(feature = "stm32h743")]
pub mod battery;
pub mod board;
mod bootloader;
#[cfg(feature = "stm32h743")]
pub mod card;
pub mod cause;
pub mod chip;
pub mod clock;
pub mod crystal;
pub mod ears;
pub mod edges;
pub mod executors;
pub(super) mod fault;
pub mod imu;
pub mod light;
pub mod link;
pub mod motors;
pub mod packet_radio;
pub mod restart;
pub mod started;
pub mod storage;
pub mod tasks;
pub mod transfers;
pub mod usb;
pub mod watchdog;
