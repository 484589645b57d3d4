//! Flies scenarios on the desktop and serves the control law to other simulators.

use clap::{ArgGroup, Args, Parser, Subcommand};
use host_sim::certify::certify;
use host_sim::claims;
use host_sim::fly::{FlyError, certification, fly};
use host_sim::hil::port::{Address, Port};
use host_sim::hil::{self, HilError, Session};
use host_sim::law::LawServer;
use host_sim::log::WholeFile;
use host_sim::table::{percent, short};
use host_sim::tune::requirements::Requirements;
use host_sim::tune::{Effort, output, tune, widest_bounds};
use scenario::{Scenario, bounds, check_name};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

/// A well-posed run whose claims fail.
const CLAIMS_FAIL: u8 = 1;
/// Input that cannot be used, or output that cannot be written.
const BAD_INPUT: u8 = 2;
/// Longest recovery that a search may fly thousands of times, s.
const GREATEST_RECOVERY: f64 = 3600.0;

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
  host-sim certify mine.toml                 prove its limits, down to each rotor, or say what fails
  host-sim tune mine.toml --out tuned.toml   search gains that certify and make the most of the vehicle
  host-sim law scenarios/hover.toml < lines  the controller alone, for simulators of your own
  host-sim hil --connect 127.0.0.1:5760 vehicles/study.toml
                                             the vehicle alone, for firmware in an emulator or on a board

A scenario file is TOML: start from one in scenarios/ or vehicles/; docs/scenario-file.md describes every key.

Exit status:
  0  every claim holds (law: the input ended)
  1  a well-posed run whose claims or certificate fail
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
    /// Prove the limits of a configuration: every inequality as printed in the paper and sharp, then each rotor.
    Certify {
        /// Scenario file [default: the paper's, built in]
        file: Option<PathBuf>,
    },
    /// Search gains: everything certifies; then the least height lost from upside down; then the greatest k_p.
    #[command(after_help = TUNE_HELP)]
    Tune(TuneArguments),
    /// Serve the control law alone, lock-step on standard input and output.
    #[command(after_help = LAW_HELP)]
    Law {
        /// Scenario file whose vehicle and gains are used [default: the paper's, built in]
        file: Option<PathBuf>,
    },
    /// Be the vehicle of a flight controller that runs elsewhere, lock-step over MAVLink.
    #[command(after_help = HIL_HELP)]
    Hil(HilArguments),
}

#[derive(Args)]
#[command(group(ArgGroup::new("other side").required(true).args(["connect", "listen"])))]
struct HilArguments {
    /// Scenario file: vehicle, rotors, delay; it starts on the ground below its initial position
    file: PathBuf,
    /// Find the flight controller at this address
    #[arg(long, value_name = "HOST:PORT")]
    connect: Option<String>,
    /// Wait at this address for the flight controller
    #[arg(long, value_name = "HOST:PORT")]
    listen: Option<String>,
    /// End after so much vehicle time, s [default: when the other side goes]
    #[arg(long, value_name = "SECONDS")]
    duration: Option<f64>,
    /// Withhold the pose from this vehicle time on, s: a pose source that fails
    #[arg(long, value_name = "SECONDS")]
    pose_until: Option<f64>,
    /// Longest wait for the other side, s
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0)]
    patience: f64,
    /// Write a row for each command: state, commands, thrust
    #[arg(long, value_name = "FILE.csv")]
    log: Option<PathBuf>,
}

#[derive(Args)]
struct TuneArguments {
    /// Scenario file: vehicle, limits, rotors, delay, reference; its gains are where the search starts
    file: PathBuf,
    /// Scenario file to write [default: <name>-tuned.toml]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Least margin of every inequality, as a fraction
    #[arg(long, default_value_t = 0.05)]
    margin: f64,
    /// Least gain margin of every sampled loop, as a factor: at the actuators, and of k_p and k_v together
    #[arg(long, default_value_t = 2.0)]
    gain_margin: f64,
    /// Least delay margin of every sampled loop, ms
    #[arg(long, default_value_t = 3.0)]
    delay_margin: f64,
    /// Greatest position error of the file's own flight in its last quarter, m
    #[arg(long, default_value_t = 1e-3)]
    position_error: f64,
    /// Greatest norm of its modified Rodrigues parameters there
    #[arg(long, default_value_t = 1e-4)]
    mrp_error: f64,
    /// How long a recovery from upside down may take, s; its last quarter must be still
    #[arg(long, default_value_t = 20.0)]
    recovery: f64,
    /// Keep the paper's thrust T = m |u|: no thrust projection
    #[arg(long)]
    no_projection: bool,
    /// Generations of each of the two stages; 48 candidates each
    #[arg(long, default_value_t = 150)]
    generations: u32,
    /// Seed of the search
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Also report the largest factor by which the reference bounds could grow with these gains
    #[arg(long)]
    widen: bool,
}

const TUNE_HELP: &str = "\
The height lost is the start less the lowest point of a flight from the paper's first attitude (roll -179 degrees, yaw
100 degrees off the heading), at rest, on a hover reference where it starts. Printed at the end: the frontier of height lost against k_p with the inequality that limits each, and
the answer: the greatest k_p within 5 % of the least height.";

const LAW_HELP: &str = "\
One line of 33 numbers in, one line of 4 numbers out, flushed, until end of input. SI units, rad, world z up.
  in:   t dt | x(3) v(3) | q(4) as x y z w, body to world | omega(3) body |
        reference x(3) v(3) a(3) j(3) s(3) yaw yaw_rate yaw_acceleration
  out:  thrust [N], torque x y z [N m]; not clipped to any limit
The output uses the filters as they stand, which then advance by the line's dt (0 < dt <= 0.1 s). A line that cannot
be used is answered by \"error: ...\" on its turn and changes nothing.";

const HIL_HELP: &str = "\
The flight controller sends HIL_ACTUATOR_CONTROLS: its time, and from 0 to 1 for each rotor in the file's order. Each moves
the vehicle on by one control period, and is answered by ODOMETRY and HIL_SENSOR with the time of the command. Vehicle time
counts from the first command.

With QEMU, from the top of the repository (this firmware's emulated board; its second serial port is for the ground station):
  cargo build --profile board -p firmware --target thumbv7em-none-eabihf --no-default-features --features mps2 --bin mps2
  qemu-system-arm -M mps2-an386 -display none -monitor none -icount shift=0,sleep=off \\
    -serial tcp:127.0.0.1:5760,server=on,nodelay=on -serial tcp:127.0.0.1:5761,server=on,wait=off,nodelay=on \\
    -semihosting-config enable=on,target=native -kernel target/thumbv7em-none-eabihf/board/mps2
  cargo run --release -p host-sim -- hil --connect 127.0.0.1:5760 vehicles/study.toml
With a board, bridge its serial port: socat TCP-LISTEN:5760,nodelay /dev/ttyUSB0,raw,b921600";

fn main() -> ExitCode {
    let outcome = match Arguments::parse().command {
        None => run_fly(None, None),
        Some(Command::Fly { file, out }) => run_fly(file.as_deref(), out),
        Some(Command::Certify { file }) => run_certify(file.as_deref()),
        Some(Command::Tune(arguments)) => run_tune(&arguments),
        Some(Command::Law { file }) => run_law(file.as_deref()),
        Some(Command::Hil(arguments)) => run_hil(&arguments),
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

fn run_hil(arguments: &HilArguments) -> Result<ExitCode, String> {
    let scenario = Scenario::load(&arguments.file).map_err(|error| error.to_string())?;
    let session = arguments.session()?;
    let address = match (&arguments.connect, &arguments.listen) {
        (Some(address), _) => Address::Connect(address.clone()),
        (None, Some(address)) => Address::Listen(address.clone()),
        (None, None) => return Err("--connect or --listen: one is needed".to_owned()),
    };
    let patience = Duration::try_from_secs_f64(arguments.patience)
        .ok()
        .filter(|patience| !patience.is_zero())
        .ok_or_else(|| format!("--patience: must be greater than zero, found {}", arguments.patience))?;
    let mut port = Port::open(&address, patience).map_err(|error| error.to_string())?;
    match hil::serve(&scenario, &mut port, &session, arguments.log.as_deref()) {
        Ok(summary) => {
            let _ = writeln!(io::stdout(), "{}: {summary}", scenario.name);
            Ok(ExitCode::SUCCESS)
        }
        Err(error @ HilError::Flight(_)) => {
            eprintln!("error: {}: {error}", scenario.name);
            Ok(ExitCode::from(CLAIMS_FAIL))
        }
        Err(error) => Err(error.to_string()),
    }
}

fn run_certify(file: Option<&Path>) -> Result<ExitCode, String> {
    let (text, certified) = certify(&load(file)?).map_err(|error| error.to_string())?;
    let _ = io::stdout().write_all(text.as_bytes());
    Ok(if certified { ExitCode::SUCCESS } else { ExitCode::from(CLAIMS_FAIL) })
}

fn run_tune(arguments: &TuneArguments) -> Result<ExitCode, String> {
    let requirements = arguments.requirements()?;
    let mut scenario = Scenario::load(&arguments.file).map_err(|error| error.to_string())?;
    let original = std::fs::read_to_string(&arguments.file)
        .map_err(|error| format!("{}: cannot be read: {error}", arguments.file.display()))?;
    let name = arguments
        .out
        .as_deref()
        .and_then(Path::file_stem)
        .map_or_else(|| format!("{}-tuned", scenario.name), |stem| stem.to_string_lossy().into_owned());
    check_name(&name).map_err(|error| format!("--out: becomes the scenario's name: {error}"))?;
    scenario.name.clone_from(&name);
    let path = arguments.out.clone().unwrap_or_else(|| PathBuf::from(format!("{name}.toml")));
    // Whatever is wrong with the output shows now, not after the search.
    if same_file(&path, &arguments.file) {
        return Err(format!("{}: --out must be another file than the one tuned", path.display()));
    }
    let unwritable = |error| format!("{}: cannot be written: {error}", path.display());
    if path.is_dir() {
        return Err(unwritable(io::ErrorKind::IsADirectory.into()));
    }
    drop(WholeFile::create(&path).map_err(unwritable)?);
    let effort = Effort { generations: arguments.generations, seed: arguments.seed };
    let tuned = match tune(&scenario, requirements, effort) {
        Ok(tuned) => tuned,
        Err(closest) => {
            let what = closest.failed.clone().unwrap_or_default();
            let lost = short(closest.height_lost);
            eprintln!(
                "error: {}: no gains meet the requirements; the closest fail in: {what} (height lost {lost} m)",
                scenario.name
            );
            return Ok(ExitCode::from(CLAIMS_FAIL));
        }
    };
    let text = output::rewritten(&original, &tuned).map_err(|error| error.to_string())?;
    WholeFile::write(&path, &text).map_err(unwritable)?;
    let (certificate, _) = certify(&tuned.scenario).map_err(|error| error.to_string())?;
    let active = tuned.verdict.tightest.map_or(String::new(), |tightest| {
        format!("active constraint: {}, margin {}\n", tightest.name, percent(tightest.margin()))
    });
    let mut summary = format!(
        "{}\n{}\nheight lost {} m with k_p = {} 1/s^2\n{active}{} candidates judged; written to {}\n",
        certificate,
        tuned.frontier.table(),
        short(tuned.verdict.height_lost),
        short(tuned.verdict.position_gain),
        tuned.judged,
        path.display()
    );
    if arguments.widen {
        let (factor, widest) =
            widest_bounds(&tuned.scenario.configuration, requirements.margin).map_err(|error| error.to_string())?;
        summary += &format!(
            "\nwith these gains every margin stays at least {} for references {} times as demanding:\n\n{}",
            percent(requirements.margin),
            short(factor),
            bounds::written(&widest)
        );
    }
    let _ = io::stdout().write_all(summary.as_bytes());
    Ok(ExitCode::SUCCESS)
}

/// Whether both paths lead to one file that exists.
fn same_file(one: &Path, other: &Path) -> bool {
    matches!((one.canonicalize(), other.canonicalize()), (Ok(one), Ok(other)) if one == other)
}

impl HilArguments {
    fn session(&self) -> Result<Session, String> {
        let times = [("--duration", self.duration), ("--pose-until", self.pose_until)];
        for (name, time) in times {
            if let Some(time) = time.filter(|time| !(*time >= 0.0 && time.is_finite())) {
                return Err(format!("{name}: must not be negative, found {time}"));
            }
        }
        Ok(Session { duration: self.duration, pose_until: self.pose_until })
    }
}

impl TuneArguments {
    fn requirements(&self) -> Result<Requirements, String> {
        let positive = [
            ("--delay-margin", self.delay_margin),
            ("--position-error", self.position_error),
            ("--mrp-error", self.mrp_error),
            ("--recovery", self.recovery),
        ];
        if let Some((name, value)) = positive.into_iter().find(|(_, value)| !(*value > 0.0 && value.is_finite())) {
            return Err(format!("{name}: must be greater than zero and finite, found {value}"));
        }
        if self.recovery > GREATEST_RECOVERY {
            return Err(format!("--recovery: must be at most {GREATEST_RECOVERY} s, found {}", self.recovery));
        }
        if !(0.0..1.0).contains(&self.margin) {
            return Err(format!("--margin: must be from 0 to below 1, found {}", self.margin));
        }
        if !(self.gain_margin >= 1.0 && self.gain_margin.is_finite()) {
            return Err(format!("--gain-margin: must be at least 1, found {}", self.gain_margin));
        }
        if self.generations == 0 {
            return Err("--generations: must be at least 1, found 0".to_owned());
        }
        Ok(Requirements {
            margin: self.margin,
            gain_margin: self.gain_margin,
            delay_margin: 1e-3 * self.delay_margin,
            position_error: self.position_error,
            mrp_error: self.mrp_error,
            recovery: self.recovery,
            projection: !self.no_projection,
        })
    }
}
