//! The command line, in clap's terms, and its checks.

mod campaign;
mod certify;
mod compare;
mod first_flight;
mod identify;
mod log;
mod real_flights;
mod reference;
mod replay;
mod sessions;
mod shells;
mod tune;
mod vehicle;

pub use campaign::{CampaignArguments, MergeArguments};
pub use certify::CertifyArguments;
use clap::{Parser, Subcommand};
pub use compare::{CompareArguments, GainsWanted};
pub use first_flight::FirstFlightArguments;
use identify::IDENTIFY_HELP;
pub use identify::IdentifyArguments;
use log::LOG_HELP;
pub use log::LogArguments;
use real_flights::REAL_FLIGHT_HELP;
pub use real_flights::{RealFlightArguments, ReplayLawArguments};
pub use reference::ReferenceArguments;
pub use replay::ReplayArguments;
pub use sessions::{HilArguments, SitlArguments};
pub use shells::{CompletionsArguments, ManArguments, completions, manual};
use std::path::PathBuf;
pub use tune::TuneArguments;
use vehicle::VEHICLE_HELP;
pub use vehicle::VehicleArguments;

/// Widest line of help, columns: no terminal is narrower by default.
const HELP_WIDTH_MAX: usize = 80;

/// Fly a quadrotor under the saturated hybrid law, and check what was claimed against what was flown.
#[derive(Parser)]
#[command(version, arg_required_else_help = false, max_term_width = HELP_WIDTH_MAX, after_help = HELP)]
pub struct Arguments {
    /// What to do; left out: fly the paper's scenario.
    #[command(subcommand)]
    pub command: Option<Command>,
}

const HELP: &str = "\
Examples:
  host-sim                           the paper's experiment, from upside down
  host-sim fly mine.toml             a flight; results in flights/<its name>
  host-sim fly mine.toml --out here  choose where the results go
  host-sim certify mine.toml         prove its limits, or say what fails
  host-sim tune mine.toml --out tuned.toml
                                     search for gains that certify and fly well
  host-sim identify log.csv --scenario mine.toml --out found.toml
                                     mass, inertia, lag, drag ... from a log
  host-sim replay-model log.csv --columns columns.toml --scenario mine.toml
                                     half of a real flight foretells the other
  host-sim log LOG00012.ULG --ulog px4.ulg --spectrum gyro.svg
                                     for Flight Review and PlotJuggler
  host-sim vehicle cf2x.urdf --out cf2x.toml
                                     a vehicle from another program's file
  host-sim campaign mine.toml        a thousand random throws
  host-sim compare mine.toml         our law beside others, in the same flights
  host-sim law mine.toml < lines     the law alone, for simulators of your own
  host-sim hil --connect 127.0.0.1:5760 vehicles/study.toml
                                     the vehicle alone, for firmware elsewhere
  host-sim first-flight micoair-h743 mine.toml --link serial:/dev/ttyACM0
                                     bench checks before a first flight
  host-sim sitl                      firmware and vehicle, for MAVLink on UDP
                                     14540 and 14550

A scenario file is TOML: start from one in scenarios/ or vehicles/;
docs/scenario-file.md describes every key.

Exit status:
  0    every claim holds (certify: the scenario may fly; tune: gains were found;
       law: the input ended)
  1    a well-posed run that fails: a claim, an inequality of the certificate, a
       sampled loop that is unstable or without margin, a flight that does not
       reach or hold its reference, gains not found
  2    input that cannot be used, or output that cannot be written; one line on
       stderr says why
  129, 130, 143  interrupted by SIGHUP, SIGINT or SIGTERM";

const FLY_HELP: &str = "\
Besides the file's limits and the certificate's bounds a flight claims
- that every inequality of its certificate holds;
- that its sampled loops are stable, with 1.5 times the gain, 1 / 1.5 of it or 2
  ms more delay;
- that it reached its reference for good within the first 90 % of its duration:
  from then on its position is within 0.2 m of the reference's, off the ground,
  and its attitude, heading included, within 0.05 (modified Rodrigues
  parameters; 11 degrees);
- that once there it never strayed further than reference.tolerance (default:
  0.5 m).
The scenario is flown even where a claim cannot hold; the last line names the
claims that fail. A waypoint path that leaves the box of its points is said,
with place and time; a reference that goes below the ground is refused. While it
flies, no other run writes into the directory. Interrupted, it leaves no file.";

/// One command.
#[derive(Subcommand)]
pub enum Command {
    /// Fly a scenario; write log.csv, figures and a report; print claims and verdicts.
    #[command(after_help = FLY_HELP)]
    Fly {
        /// Scenario file [default: the paper's, built in]
        file: Option<PathBuf>,
        /// Directory for the results [default: flights/<name>]
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// Write flight.mcap as well, for Foxglove (docs/foxglove-layout.json arranges it): 1.7 KB a control tick
        #[arg(long)]
        mcap: bool,
        /// Fly even if log.csv will take more than 1 GB
        #[arg(long)]
        large_log: bool,
    },
    /// Fly a scenario and write it as a moving picture.
    #[command(after_help = replay::HELP)]
    Replay(ReplayArguments),
    /// Write a scenario's reference as rows of a CSV, to be streamed.
    #[command(after_help = reference::HELP)]
    Reference(ReferenceArguments),
    /// Say whether a scenario may fly: prove its commands' limits, down to each rotor, and judge its sampled loops.
    #[command(after_help = certify::HELP)]
    Certify(CertifyArguments),
    /// Refine a vehicle's constants by trial flights: certified first, then pleasant to fly. About a minute.
    #[command(after_help = tune::HELP)]
    Tune(TuneArguments),
    /// Find a vehicle's numbers, each with its uncertainty, from the log of a flight and from a bench.
    #[command(after_help = IDENTIFY_HELP)]
    Identify(IdentifyArguments),
    /// Find a vehicle in one half of a real flight, and foretell the other half by it.
    #[command(after_help = REAL_FLIGHT_HELP)]
    ReplayModel(RealFlightArguments),
    /// Run our estimator on the sensors of a real flight, beside the vehicle's own filter.
    #[command(after_help = REAL_FLIGHT_HELP)]
    ReplayEstimator(RealFlightArguments),
    /// Fly our law on the vehicle that a real flight shows, in the same air and on the same setpoints.
    #[command(after_help = REAL_FLIGHT_HELP)]
    ReplayLaw(ReplayLawArguments),
    /// Write a log of the firmware as the topics of PX4, for Flight Review and PlotJuggler.
    #[command(after_help = LOG_HELP)]
    Log(LogArguments),
    /// Read a vehicle's numbers from another program's file; write a vehicle file, with what is missing marked.
    #[command(after_help = VEHICLE_HELP)]
    Vehicle(VehicleArguments),
    /// Fly a scenario thousands of times in circumstances drawn at random; the same to the bit however it is split.
    #[command(after_help = campaign::HELP)]
    Campaign(CampaignArguments),
    /// Put the shards of a campaign together: the same bytes as the campaign that was never split.
    Merge(MergeArguments),
    /// Fly other laws beside ours: the same scenes, the same random flights; a table and pictures.
    #[command(after_help = COMPARE_HELP)]
    Compare(CompareArguments),
    /// Serve the control law alone, lock-step on standard input and output.
    #[command(after_help = LAW_HELP)]
    Law {
        /// Scenario file whose vehicle and gains are used [default: the paper's, built in]
        file: Option<PathBuf>,
    },
    /// Be the vehicle of a flight controller that runs elsewhere, lock-step over MAVLink.
    #[command(after_help = HIL_HELP)]
    Hil(HilArguments),
    /// Run the firmware's own tasks with a simulated vehicle; MAVLink clients connect by UDP on this machine.
    #[command(after_help = SITL_HELP)]
    Sitl(SitlArguments),
    /// Walk through a first flight's bench checks with a vehicle on a link: no debug probe, propellers off.
    #[command(after_help = first_flight::HELP)]
    FirstFlight(FirstFlightArguments),
    /// Print the JSON schema of scenario files, with which editors complete and check keys.
    #[command(after_help = shells::SCHEMA_HELP)]
    Schema,
    /// Print what a shell needs to complete commands, options and their values.
    #[command(after_help = shells::COMPLETIONS_HELP)]
    Completions(CompletionsArguments),
    /// Write the manual pages: one for the program, one for each command.
    Man(ManArguments),
}

const COMPARE_HELP: &str = "\
Each figure is better the less it is; a star begins each row in which another
law does better than ours. docs/rivals.md describes the laws and why the
comparison is fair. Random flights are those of `campaign --law NAME`, the same
for every law.

The rivals' gains are built in for the Hummingbird, the study vehicle and the
paper's. For any other vehicle they are searched first, each rival's as hard as
`tune` searches ours by default. That takes minutes; progress shows on stderr.
gains.toml, beside compare.csv, has the gains found, for --gains. If no gains of
a rival fly every trial to its end, the rival is left out, and named.

Exit status 0: every random flight of ours settles, and none of its commands is
cut or leaves its certified bounds; 1: one does not, or the scenario is not
certified.";

const LAW_HELP: &str = "\
One line of 33 numbers in, one line of 4 numbers out, flushed, until end of
input. SI units, rad, world z up.
  in:   t dt | x(3) v(3) | q(4) as x y z w, body to world | omega(3) body |
        reference x(3) v(3) a(3) j(3) s(3) yaw yaw_rate yaw_acceleration
  out:  thrust [N], torque x y z [N m]; not clipped to any limit
The output uses the filters as they stand, which then advance by the line's dt
(0.00025 to 0.1 s, and under the extended law at most 0.6 over the greater
estimates.force_bandwidth). A line that cannot be used, or is longer than 64 KB,
is answered by \"error: ...\" on its turn and changes nothing. Beyond these,
numbers cannot be used: x 1e6 m; v 1e4 m/s; omega and yaw rate 1e4 rad/s; a 1e4
m/s^2, j 1e6 m/s^3, s 1e8 m/s^4; yaw 1e6 rad, its acceleration 1e6 rad/s^2.";

const HIL_HELP: &str = "\
The flight controller sends HIL_ACTUATOR_CONTROLS: its time, and from 0 to 1 for
each rotor in the file's order. Each moves the vehicle on by one control period,
and is answered by ODOMETRY and then HIL_SENSOR. Their times are those at which
they are true, by the flight controller's clock: the command's, and what the
vehicle has moved since. The HIL_SENSOR of the period's end comes last. Vehicle
time counts from the first command.

Sensors are exact, one pose and one sample a period. With [estimator] in the
file they are those of a real vehicle: a sample each millisecond, with a
BMI088's noise and biases, and poses that are noisy, late or missing; the same
in every run. [sensors] does not count here.

With QEMU, from the top of the repository (this firmware's emulated board; its
second serial port is for the ground station):
  cargo build --profile board -p firmware --target thumbv7em-none-eabihf \\
    --no-default-features --features mps2 --bin mps2
  qemu-system-arm -M mps2-an386 -display none -monitor none \\
    -icount shift=0,sleep=off \\
    -serial tcp:127.0.0.1:5760,server=on,nodelay=on \\
    -serial tcp:127.0.0.1:5761,server=on,wait=off,nodelay=on \\
    -semihosting-config enable=on,target=native \\
    -kernel target/thumbv7em-none-eabihf/board/mps2
  host-sim hil --connect 127.0.0.1:5760 vehicles/study.toml
The two stay in lock-step however slow they are. For clients in real time
(MAVSDK, MAVProxy and so on), add --ground 127.0.0.1:5761 to have the second
serial port on UDP 14540 and 14550, and --speed to keep the vehicle's time
steady.

With a board, bridge its serial port:
  socat TCP-LISTEN:5760,nodelay /dev/ttyUSB0,raw,b921600
Such a line carries 92 bytes a millisecond; an exact answer has 315, one with
[estimator] up to 972, too many for a period of 10 ms.

Interrupted, a session ends as if its duration were over, and its log is kept;
the exit status is then 129, 130 or 143.";

const SITL_HELP: &str = "\
The vehicle stands on the ground below the file's initial position. Its poses
come from a camera inside, as ODOMETRY: a client need send none. Without
[estimator] in the file the sensors are a BMI088 and a camera with that
section's defaults; [reference] and [sensors] do not count. Connect, and wait
until it is ready (about 4 s):

  MAVSDK        connect udpin://127.0.0.1:14540
  pymavlink     mavutil.mavlink_connection(\"udpin:127.0.0.1:14540\")
  MAVProxy      mavproxy.py --master=udp:127.0.0.1:14550
  QGroundControl finds it by itself on 14550

A client commands by heartbeats: one a second, before it arms and ever after.
docs/sitl.md has whole examples.

Faults, in seconds of the vehicle's time:
  --fault pose@12..15            no pose arrives for 3 s
  --fault gyro@20                the IMU falls silent, for good; accelerometer,
                                 motors: likewise
  --fault ground-station@10..40  what clients send is lost, and what is sent to
                                 them
  --fault battery=9.8@30         the battery shows 9.8 V (set BAT_LOW or
                                 BAT_CRIT above it)

A line of status each second, and every text of the vehicle's, go to standard
output. The exit status is 0 after --duration, 129, 130 or 143 when interrupted,
2 for what cannot be used.";
