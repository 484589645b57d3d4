//! Commands that need no room of their own.
//!
//! | module | command |
//! |---|---|
//! | [`fly`] | a flight with its log, figures and report |
//! | [`certify`] | every inequality of the certificate |
//! | [`law`] | the controller alone, for simulators that others wrote |

pub mod certify;
#[cfg(feature = "desk")]
pub mod fly;
#[cfg(feature = "desk")]
pub mod law;
