//! The arguments of `log`, in clap's terms.

use clap::Args;
use std::path::PathBuf;

/// A log, and what is written of it.
#[derive(Args)]
pub struct LogArguments {
    /// ULog of the firmware: a file of its card, or a download of its recorder
    pub log: PathBuf,
    /// ULog to write, of PX4's topics
    #[arg(long, value_name = "FILE.ulg", required_unless_present = "spectrum")]
    pub ulog: Option<PathBuf>,
    /// Picture to draw: which frequencies shake the gyro, and how strongly
    #[arg(long, value_name = "FILE.svg")]
    pub spectrum: Option<PathBuf>,
}

/// The end of `log --help`.
pub const LOG_HELP: &str = "\
The firmware's own ULog has one topic, tick, in its own frames; PlotJuggler and
pyulog read it as it is. The file written has vehicle_attitude,
vehicle_angular_velocity, vehicle_local_position with its setpoint,
trajectory_setpoint, actuator_motors, battery_status, vehicle_status and
vehicle_land_detected in PX4's frames (north, east, down; forward, right, down),
so that Flight Review plots them. Information, parameters and texts are kept.
docs/log.md says what is left out.

--spectrum needs the topic sensor_gyro_fifo, which a card takes with LOG_GYRO = 1;
PX4's logs have it too. docs/vibration.md says how to read it.

Exit status: 0, or 2 if a file cannot be used or written.";
