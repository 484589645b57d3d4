#![no_std]
#![deny(unsafe_code)]

pub mod error;
pub mod gains;
pub mod heading;
pub mod math;
pub mod reference;
pub mod state;
pub mod vehicle;
