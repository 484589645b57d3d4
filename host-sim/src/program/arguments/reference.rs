//! The arguments of `reference`, in clap's terms.

use clap::Args;
use host_sim::reports::reference_rows::{FOLLOWED_WITHIN_2_CM_FACTOR, ROW_RATE_MAX_HZ};
use std::path::PathBuf;

/// The end of `reference --help`.
pub const HELP: &str = "\
The columns are t, x to z, vx to vz, ax to az and yaw_deg: s, m, degrees, z up.
Whatever the file's [reference] is, this is what the law is given: smooth, with
a beginning and an end at rest; but a tenth slower, since a vehicle guesses the
jerk and snap of a stream, and smooths one that seems to be beyond its bounds.
python/examples/stream_rows.py streams the rows to a vehicle over MAVLink; as
file = \"rows.csv\" they are a reference again.

Exit status: 0; 1 if the vehicle is not certified for the reference, as
`certify` says; the rows are written all the same. 2 if a file cannot be used or
written.";

/// A reference, and where its rows go.
#[derive(Args)]
pub struct ReferenceArguments {
    /// Scenario file [default: the paper's, built in]
    pub file: Option<PathBuf>,
    /// CSV to write
    #[arg(long, value_name = "FILE.csv")]
    pub rows: PathBuf,
    /// Rows a second, 1 to 1000
    #[arg(long, default_value_t = 50.0, value_name = "HZ")]
    rate: f64,
    /// How many times slower than the reference the rows are, 1 to 100
    #[arg(long, default_value_t = FOLLOWED_WITHIN_2_CM_FACTOR, value_name = "FACTOR")]
    slower: f64,
}

impl ReferenceArguments {
    /// Rows a second.
    pub fn rate(&self) -> Result<f64, String> {
        if (1.0..=ROW_RATE_MAX_HZ).contains(&self.rate) {
            Ok(self.rate)
        } else {
            Err(format!("--rate: must be from 1 to {ROW_RATE_MAX_HZ} Hz, found {}", self.rate))
        }
    }

    /// How many times slower the rows are.
    pub fn slower(&self) -> Result<f64, String> {
        if (1.0..=100.0).contains(&self.slower) {
            Ok(self.slower)
        } else {
            Err(format!("--slower: must be from 1 to 100, found {}", self.slower))
        }
    }
}
