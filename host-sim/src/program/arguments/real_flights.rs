//! The arguments of `replay-model`, `replay-estimator` and `replay-law`, in clap's terms.

use clap::Args;
use std::path::PathBuf;

/// A recorded flight, and what it is held against.
#[derive(Args)]
pub struct RealFlightArguments {
    /// CSV of a real flight: numbers in columns with names
    pub log: PathBuf,
    /// Which column is what, a few lines of TOML (docs/real-flights.md) [default: those of a data set that is known,
    /// by the names of its columns]
    #[arg(long, value_name = "FILE")]
    pub columns: Option<PathBuf>,
    /// Scenario file whose vehicle is the model: rotors, mass and inertia as they are believed to be
    #[arg(long, value_name = "FILE")]
    pub scenario: PathBuf,
}

/// The same, and a picture.
#[derive(Args)]
pub struct ReplayLawArguments {
    #[command(flatten)]
    pub flight: RealFlightArguments,
    /// Picture to write: setpoints, flown, ours [default: none]
    #[arg(long, value_name = "FILE.svg")]
    pub plot: Option<PathBuf>,
}

/// The end of the help of all three.
pub const REAL_FLIGHT_HELP: &str = "\
A file of columns says which column is what:

  [time]
  column = \"t\"
  unit = \"s\"                   # s, ms, us, ns
  [pose]                       # by motion capture; body to world
  position = [\"px\", \"py\", \"pz\"]
  attitude = [\"qw\", \"qx\", \"qy\", \"qz\"]   # or roll, pitch, yaw; or a matrix
  [imu]
  rates = [\"gx\", \"gy\", \"gz\"]
  rates_unit = \"rad/s\"         # or deg/s
  force = [\"ax\", \"ay\", \"az\"]
  force_unit = \"m/s^2\"         # or g, mg
  [motors]                     # in the order of the scenario's rotors
  columns = [\"m1\", \"m2\", \"m3\", \"m4\"]
  unit = \"share\"               # of full; or measured speeds: rad/s, rpm; or N
  full = 65535

More of it, and NanoBench's flights: docs/real-flights.md. What cannot be as the
columns say (units, axes, order of motors, times) is named, with what to write.

Exit status: 0 if the flight shows what was asked, 1 if it does not or is not as
the columns say, 2 if a file cannot be used or written.";
