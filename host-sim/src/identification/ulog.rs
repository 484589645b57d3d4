//! ULog, the format of PX4's logs and of the firmware's: read, and written for the tools of PX4.
//!
//! | module | what it holds |
//! |---|---|
//! | `formats` | a message's fields, where they begin, nested ones flattened |
//! | `reader` | a file's topics as columns, its parameters, information and texts |
//! | `spectrum` | the raw gyro's amplitudes over frequency |
//! | [`writer`] | a file of topics |
//! | `topics` | the firmware's ticks as PX4's topics, in PX4's frames |
//! | [`command`] | `host-sim log`, from a file to a file or a picture |
//!
//! The reader is our own: px4-ulog 0.6.1, the project's crate, panics on a subscription or a parameter that is too
//! short, and files come from anywhere.

pub mod command;
pub(crate) mod formats;
pub(crate) mod reader;
pub(crate) mod spectrum;
pub(crate) mod topics;
pub mod writer;

/// The first bytes of every ULog; the format's version follows.
pub const MAGIC: [u8; 7] = *b"ULog\x01\x12\x35";

/// Before the first message: magic, version, time.
pub const HEAD_BYTES: usize = 16;

#[cfg(test)]
mod tests;
