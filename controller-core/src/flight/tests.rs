//! What the tests of the parts of a flight share.

pub(crate) mod example;
