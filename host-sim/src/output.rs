//! How the program writes: files that appear whole, one writer a directory, tables, progress, and an end at a signal.
//!
//! | module | what it holds |
//! |---|---|
//! | [`whole_file`] | a file that appears whole or not at all |
//! | `directory_lock` | one writer for a directory |
//! | [`table`] | aligned tables of text |
//! | [`progress`] | a bar on a terminal, elsewhere a line now and then |
//! | [`interrupt`] | SIGINT, SIGTERM and SIGHUP end long work at its next step |

#[cfg(feature = "desk")]
pub(crate) mod directory_lock;
#[cfg(feature = "desk")]
pub mod interrupt;
#[cfg(feature = "desk")]
pub mod progress;
pub mod table;
#[cfg(feature = "desk")]
pub mod whole_file;
