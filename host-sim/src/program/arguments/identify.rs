//! The arguments of `identify`, in clap's terms.

use clap::Args;
use std::path::PathBuf;

/// A log, and what it is held against.
#[derive(Args)]
pub struct IdentifyArguments {
    /// log.csv of a flight, or a ULog: of the firmware's recorder or card, or of PX4; with --columns, a CSV of a real
    /// flight
    pub log: PathBuf,
    /// Which column of a real flight's CSV is what, a few lines of TOML (docs/real-flights.md), or `nanobench`
    #[arg(long, value_name = "FILE", conflicts_with = "bench")]
    pub columns: Option<PathBuf>,
    /// Scenario file whose vehicle is the model: rotors, mass and inertia as they are believed to be [default:
    /// vehicles/study.toml, built in]
    #[arg(long, value_name = "FILE")]
    pub scenario: Option<PathBuf>,
    /// Bench data: weighing, bifilar swings, thrust stand (docs/identify.md)
    #[arg(long, value_name = "FILE")]
    pub bench: Option<PathBuf>,
    /// Scenario file to write: the same one with what was identified [default: none, only the report]
    #[arg(long, value_name = "FILE.toml")]
    pub out: Option<PathBuf>,
}

/// The end of `identify --help`.
pub const IDENTIFY_HELP: &str = "\
`identify` finds thrust scale over mass, inertia over thrust scale, rotor lag
and delay, centre of mass (x, y) and linear drag. Each has a standard
uncertainty, and an interval of 3.515 of them (more if the flight is shorter
than 80 s) to either side, meant for all sixteen together (docs/identify.md says
how often that held). The mass itself is not observable in flight: give its
weighing in a bench file, or the file's mass is taken.

  [weighing]
  mass = [0.5021, 0.5023]     # kg
  uncertainty = 0.0005        # kg

What to fly: a minute or more, steps there and back along both body axes,
climbing and sinking by metres, and turning, as scenarios/identify.toml does;
within the reference bounds. Of the state only what the vehicle measured or
estimated is used, not the simulated truth.

  host-sim fly scenarios/identify.toml
  host-sim identify flights/identify/log.csv --bench bench.toml \\
    --scenario scenarios/identify.toml --out mine.toml
  host-sim certify mine.toml

A CSV of a real flight (--columns): rotors' commands or measured speeds, IMU and
poses or the vehicle's own estimates, in columns of any name. Thrust scale,
rotor lag and drag come from the accelerometer then. A file of columns says

  [motors]
  columns = [\"rpm1\", \"rpm2\", \"rpm3\", \"rpm4\"]   # of the scenario's rotors
  unit = \"rpm\"      # or rad/s: measured; share of full; N

and likewise [time], [pose], [imu]: docs/real-flights.md, replay-model --help.

The report ends with each margin of the certificate and of the sampled loops:
with the file's numbers, with those found, and in the worst corner of their
intervals.

Exit status: 0 if the vehicle was identified, 1 if a quantity is not observable
in the log (it says which, and what to fly for it), 2 if a file cannot be used
or written.";
