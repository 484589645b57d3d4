//! What `replay` can be asked.

use clap::Args;
use host_sim::reports::plots::replay::Stretch;
use std::path::PathBuf;

pub const HELP: &str = "\
The picture shows the path, the reference, the path's shadow on the floor and
the vehicle larger than life, in 20 pictures a second; the bar below is how much
is over. Any browser plays it, and a page of GitHub. `fly` writes the same
flight as report.html, which can be turned and stopped.

Exit status 0: the picture is written, whether or not the flight's claims hold;
1: the flight could not go on.";

/// The longest moving picture.
const PICTURE_MAX_S: f64 = 60.0;

/// A flight as a moving picture.
#[derive(Args)]
pub struct ReplayArguments {
    /// Scenario file [default: the paper's, built in]
    pub file: Option<PathBuf>,
    /// GIF to write
    #[arg(long, value_name = "FILE")]
    pub gif: PathBuf,
    /// The first moment shown, s
    #[arg(long, default_value_t = 0.0, value_name = "S")]
    from: f64,
    /// The last moment shown, s [default: the flight's end]
    #[arg(long, value_name = "S")]
    to: Option<f64>,
    /// Seconds of flight in a second, 0.05 to 100
    #[arg(long, default_value_t = 1.0)]
    speed: f64,
}

impl ReplayArguments {
    /// What is shown of a flight that takes so long, s.
    pub fn stretch(&self, duration: f64) -> Result<Stretch, String> {
        let (from, to, speed) = (self.from, self.to.unwrap_or(duration), self.speed);
        if !(0.05..=100.0).contains(&speed) {
            return Err(format!("--speed: must be from 0.05 to 100, found {speed}"));
        }
        if !(0.0 <= from && from < to && to <= duration) {
            return Err(format!(
                "--from, --to: must be two moments of the flight, which takes {duration} s, in order; found {from} and {to}"
            ));
        }
        let long = (to - from) / speed;
        if long > PICTURE_MAX_S {
            return Err(format!(
                "--gif: the picture would take {long:.0} s, at most {PICTURE_MAX_S} s are allowed: take a higher --speed or a shorter stretch"
            ));
        }
        Ok(Stretch { from, to, speed })
    }
}
