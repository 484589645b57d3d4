//! The program: its commands, messages and files, and the pages about it.

mod campaign;
mod campaign_directory;
mod certify;
mod cli;
mod compare;
mod documentation;
mod documented_defaults;
mod identify;
// It needs /dev/full, and signals.
#[cfg(target_os = "linux")]
mod output;
mod overwriting;
mod verdicts;
