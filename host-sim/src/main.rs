//! Flies scenarios on the desktop and serves the control law to other simulators.

use clap::{Parser, Subcommand};
use host_sim::claims;
use host_sim::fly::{FlyError, certification, fly};
use host_sim::law::LawServer;
use host_sim::scenario::Scenario;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// A well-posed run whose claims fail.
const CLAIMS_FAIL: u8 = 1;
/// Input that cannot be used, or output that cannot be written.
const BAD_INPUT: u8 = 2;

/// Fly a quadrotor under the saturated hybrid law, and check what was claimed against what was flown.
#[derive(Parser)]
#[command(version, arg_required_else_help = false, after_help = HELP)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
}

const HELP: &str = "\
Examples:
  host-sim                                   the paper's experiment: 40 s from upside down
  host-sim fly scenarios/circle.toml         another flight; results in flights/circle
  host-sim fly mine.toml --out results       choose where the results go
  host-sim law scenarios/hover.toml < lines  the controller alone, for simulators of your own

A scenario file is TOML; scenarios/paper.toml says what can stand in it.

Exit status:
  0  every claim holds (law: the input ended)
  1  a well-posed flight whose claims fail
  2  input that cannot be used; one line on stderr says which field and why";

#[derive(Subcommand)]
enum Command {
    /// Fly a scenario; write log.csv, figures and a report; print claims and verdicts.
    Fly {
        /// Scenario file [default: the paper's, built in]
        file: Option<PathBuf>,
        /// Directory for the results [default: flights/<name>]
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
    },
    /// Serve the control law alone, lock-step on standard input and output.
    #[command(after_help = LAW_HELP)]
    Law {
        /// Scenario file whose vehicle and gains are used [default: the paper's, built in]
        file: Option<PathBuf>,
    },
}

const LAW_HELP: &str = "\
One line of 33 numbers in, one line of 4 numbers out, flushed, until end of input. SI units, rad, world z up.
  in:   t dt | x(3) v(3) | q(4) as x y z w, body to world | omega(3) body |
        reference x(3) v(3) a(3) j(3) s(3) yaw yaw_rate yaw_acceleration
  out:  thrust [N], torque x y z [N m]; not clipped to any limit
The output uses the filters as they stand, which then advance by the line's dt (0 < dt <= 0.1 s). A line that cannot
be used is answered by \"error: ...\" on its turn and changes nothing.";

fn main() -> ExitCode {
    let outcome = match Arguments::parse().command {
        None => run_fly(None, None),
        Some(Command::Fly { file, out }) => run_fly(file.as_deref(), out),
        Some(Command::Law { file }) => run_law(file.as_deref()),
    };
    outcome.unwrap_or_else(|message| {
        eprintln!("error: {message}");
        ExitCode::from(BAD_INPUT)
    })
}

fn load(file: Option<&Path>) -> Result<Scenario, String> {
    file.map_or_else(Scenario::paper, Scenario::load).map_err(|error| error.to_string())
}

fn run_fly(file: Option<&Path>, out: Option<PathBuf>) -> Result<ExitCode, String> {
    let scenario = load(file)?;
    let directory = out.unwrap_or_else(|| Path::new("flights").join(&scenario.name));
    let claims = match fly(&scenario, &directory) {
        Ok(claims) => claims,
        Err(error @ FlyError::Flight(_)) => {
            eprintln!("error: {}: {error}", scenario.name);
            return Ok(ExitCode::from(CLAIMS_FAIL));
        }
        Err(error) => return Err(error.to_string()),
    };
    let holds = claims::all_hold(&claims);
    let summary = format!(
        "{}: {} s flown; {}\n\n{}\n{}; log, figures and report in {}\n",
        scenario.name,
        scenario.timing.duration(),
        certification(&scenario),
        claims::table(&claims),
        if holds { "every claim holds" } else { "NOT every claim holds" },
        directory.display()
    );
    // A reader that has gone away does not change whether the claims hold.
    let _ = io::stdout().write_all(summary.as_bytes());
    Ok(if holds { ExitCode::SUCCESS } else { ExitCode::from(CLAIMS_FAIL) })
}

fn run_law(file: Option<&Path>) -> Result<ExitCode, String> {
    let scenario = load(file)?;
    let mut server = LawServer::new(&scenario).map_err(|error| error.to_string())?;
    server.serve(io::stdin().lock(), io::stdout().lock()).map_err(|error| error.to_string())?;
    Ok(ExitCode::SUCCESS)
}
