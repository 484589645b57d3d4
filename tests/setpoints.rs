//! References from setpoints; other people's controllers within the limits.

mod governor_campaign;
mod shield;
