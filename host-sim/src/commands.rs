//! Commands that need no room of their own.
//!
//! | module | command |
//! |---|---|
//! | [`fly`] | a flight with its log, figures and report |
//! | [`certify`] | every inequality of the certificate |
//! | [`law`] | the controller alone, for simulators that others wrote |

pub mod certify;
pub mod fly;
pub mod law;
