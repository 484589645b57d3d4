//! What is written of a flight.
//!
//! | module | what it holds |
//! |---|---|
//! | [`log`] | log.csv |
//! | [`plots`] | the paper's figures and pictures of the path, still and moving |
//! | [`report`] | report.html: a page of tables, plots, replays and distributions |
//! | `recording` | flight.mcap, for Foxglove |
//! | [`reference_rows`] | a scenario's reference as rows of a CSV file |

pub mod log;
pub mod plots;
pub(crate) mod recording;
pub mod reference_rows;
pub mod report;
