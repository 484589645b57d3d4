//! The arguments of sessions with another program, `sitl` and `hil`, in clap's terms, and their checks.

use clap::{ArgGroup, Args, ValueEnum};
use host_sim::sessions::crtp_port::DEFAULT_ADDRESS;
use host_sim::sessions::hil::HilSession;
use host_sim::sessions::hil::port::Address;
use host_sim::sessions::ports::Ports;
use host_sim::sessions::sitl;
use host_sim::sessions::sitl::faults::Fault;
use host_sim::sessions::sitl::simulated_hardware::PoseSource;
use std::net::{SocketAddr, ToSocketAddrs};
use std::path::PathBuf;
use std::time::Duration;

/// The arguments of `sitl`.
#[derive(Args)]
pub struct SitlArguments {
    /// Scenario file: vehicle, rotors, gains, delay, [estimator], wind and the like [default: vehicles/study.toml,
    /// built in]
    pub file: Option<PathBuf>,
    /// How many times as fast as the desk's the vehicle's time passes, 0.1 to 100
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0)]
    speed: f64,
    /// End after so much vehicle time, s [default: at Ctrl-C]
    #[arg(long, value_name = "SECONDS")]
    duration: Option<f64>,
    /// Where poses come from: the simulation's own camera, or a client over MAVLink (ODOMETRY or ATT_POS_MOCAP); with
    /// link, nothing else sends a pose
    #[arg(long, value_name = "SOURCE", value_enum, default_value_t = Poses::Camera)]
    poses: Poses,
    /// Let something fail: pose, gyro, accelerometer, motors, ground-station, battery=VOLTS, rotor1, or rotor1=0.4 with
    /// that share of its thrust left; may be given again
    #[arg(long = "fault", value_name = "WHAT@START..END")]
    faults: Vec<Fault>,
    /// Take words from standard input for a person's hands on the vehicle that stands, one a line: nose-up, left-up,
    /// flat, turned-left, on-back, carry X Y Z, kill and so on; another word lists all
    #[arg(long)]
    hands: bool,
    /// Keep parameters in this file from one session to the next
    #[arg(long, value_name = "FILE")]
    parameters: Option<PathBuf>,
    /// Sign frames with the key in this file, 64 hexadecimal digits, and refuse what is not: docs/security.md
    #[arg(long, value_name = "FILE")]
    signing_key: Option<PathBuf>,
    /// Record the session for Foxglove, 100 moments a second of the vehicle's time, 1.7 KB each at most; the file shows
    /// up at the end
    #[arg(long, value_name = "FILE.mcap")]
    mcap: Option<PathBuf>,
    /// Write the raw gyro as a ULog, for `host-sim log --spectrum`; the file shows up at the end
    #[arg(long, value_name = "FILE.ulg")]
    gyro: Option<PathBuf>,
    /// Send where the vehicle really is to this port of this machine, 100 lines of JSON a second: a motion capture for
    /// a bridge to be tried on
    #[arg(long, value_name = "PORT")]
    truth_port: Option<u16>,
    /// Take clients of the Crazyflie as well, cflib and cfclient, by UDP at this address: docs/crazyflie.md. They look at
    /// ports 19850 to 19859; each vehicle needs its own, and its own three ports below
    #[arg(long, value_name = "HOST:PORT", num_args = 0..=1, default_missing_value = DEFAULT_ADDRESS,
        value_parser = address)]
    crtp: Option<SocketAddr>,
    #[command(flatten)]
    ports: PortArguments,
}

/// Where poses come from, as the command line has it.
#[derive(Clone, Copy, ValueEnum)]
enum Poses {
    Camera,
    Link,
}

/// Where MAVLink clients are.
#[derive(Args)]
struct PortArguments {
    /// Port at which offboard clients listen
    #[arg(long, value_name = "PORT", default_value_t = Ports::default().offboard)]
    offboard_port: u16,
    /// Port at which ground stations listen
    #[arg(long, value_name = "PORT", default_value_t = Ports::default().ground)]
    ground_port: u16,
    /// Local port: sends everything, and answers every client that sends to it
    #[arg(long, value_name = "PORT", default_value_t = Ports::default().local)]
    local_port: u16,
}

/// The fastest session: no desk is faster.
const SPEED_MAX: f64 = 100.0;
const SPEED_MIN: f64 = 0.1;

/// The arguments of `hil`.
#[derive(Args)]
#[command(group(ArgGroup::new("other side").required(true).args(["connect", "listen"])))]
#[command(override_usage = "\
host-sim hil [OPTIONS] --connect <HOST:PORT> <FILE>
       host-sim hil [OPTIONS] --listen <HOST:PORT> <FILE>")]
pub struct HilArguments {
    /// Scenario file: vehicle, rotors, delay, [estimator]; it starts on the ground below its initial position
    pub file: PathBuf,
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
    /// Write a row for each command: state a period later, commands, thrust, the command's own time in us
    #[arg(long, value_name = "FILE.csv")]
    pub log: Option<PathBuf>,
    /// Let the vehicle's time pass at most so many times as fast as the desk's, 0.1 to 100 [default: as fast as both
    /// sides go]
    #[arg(long, value_name = "FACTOR")]
    speed: Option<f64>,
    /// Find the flight controller's line for ground stations at this address, and hand it to MAVLink clients by UDP, as
    /// sitl does
    #[arg(long, value_name = "HOST:PORT")]
    ground: Option<String>,
    #[command(flatten)]
    ports: PortArguments,
}

/// An address of this machine: a host's name, or its numbers, and a port.
fn address(text: &str) -> Result<SocketAddr, String> {
    let found = text.to_socket_addrs().map_err(|error| format!("{error}; an address is written 127.0.0.1:19850"))?;
    let mut found: Vec<SocketAddr> = found.collect();
    found.sort_by_key(SocketAddr::is_ipv6);
    found.into_iter().next().ok_or_else(|| "no such address".to_owned())
}

/// A session's speed, if it is in range.
fn speed(speed: f64) -> Result<f64, String> {
    let possible = (SPEED_MIN..=SPEED_MAX).contains(&speed);
    possible.then_some(speed).ok_or_else(|| format!("--speed: must be from {SPEED_MIN} to {SPEED_MAX}, found {speed}"))
}

impl PortArguments {
    /// The ports.
    ///
    /// # Errors
    /// If two are equal, or one is 0.
    fn ports(&self) -> Result<Ports, String> {
        let ports = Ports { offboard: self.offboard_port, ground: self.ground_port, local: self.local_port };
        if ports.local == ports.offboard || ports.local == ports.ground || ports.offboard == ports.ground {
            return Err("--offboard-port, --ground-port, --local-port: must be three ports".to_owned());
        }
        let named =
            [("--offboard-port", ports.offboard), ("--ground-port", ports.ground), ("--local-port", ports.local)];
        match named.into_iter().find(|(_, port)| *port == 0) {
            Some((name, _)) => Err(format!("{name}: must be from 1 to 65535, found 0")),
            None => Ok(ports),
        }
    }
}

impl SitlArguments {
    /// The session with a scenario from `file`, which has this `text`.
    ///
    /// # Errors
    /// Names the argument that is invalid.
    pub fn session(&self, text: String, file: String) -> Result<sitl::SitlSession, String> {
        let speed = speed(self.speed)?;
        if let Some(duration) = self.duration.filter(|duration| !(*duration >= 0.0 && duration.is_finite())) {
            return Err(format!("--duration: must not be negative, found {duration}"));
        }
        Ok(sitl::SitlSession {
            file,
            ports: self.ports.ports()?,
            crtp: self.crtp,
            speed,
            duration: self.duration,
            poses: match self.poses {
                Poses::Camera => PoseSource::Camera,
                Poses::Link => PoseSource::Link,
            },
            has_hands: self.hands,
            faults: self.faults.clone(),
            parameters: self.parameters.clone(),
            signing_key: self.signing_key.as_deref().map(sitl::key::read).transpose()?,
            truth: self.truth_port,
            recording: self.mcap.clone().map(|path| (path, text)),
            gyro: self.gyro.clone(),
        })
    }
}

impl HilArguments {
    /// Where the other side is to be found.
    ///
    /// # Errors
    /// If neither is given; clap does not let that pass.
    pub fn address(&self) -> Result<Address, String> {
        match (&self.connect, &self.listen) {
            (Some(address), _) => Ok(Address::Connect(address.clone())),
            (None, Some(address)) => Ok(Address::Listen(address.clone())),
            (None, None) => Err("--connect or --listen: one is needed".to_owned()),
        }
    }

    /// The longest wait for the other side.
    ///
    /// # Errors
    /// Names the argument if it is no valid time.
    pub fn timeout(&self) -> Result<Duration, String> {
        let timeout = Duration::try_from_secs_f64(self.patience).ok().filter(|timeout| !timeout.is_zero());
        timeout.ok_or_else(|| format!("--patience: must be greater than zero, found {}", self.patience))
    }

    /// The session's times.
    ///
    /// # Errors
    /// Names the argument that is no valid time.
    pub fn session(&self) -> Result<HilSession, String> {
        let times = [("--duration", self.duration), ("--pose-until", self.pose_until)];
        for (name, time) in times {
            if let Some(time) = time.filter(|time| !(*time >= 0.0 && time.is_finite())) {
                return Err(format!("{name}: must not be negative, found {time}"));
            }
        }
        Ok(HilSession {
            duration: self.duration,
            pose_until: self.pose_until,
            speed: self.speed.map(speed).transpose()?,
        })
    }

    /// The line for ground stations, and the clients it is handed to.
    ///
    /// # Errors
    /// Names invalid ports, and ports given without `--ground`.
    pub fn ground(&self) -> Result<Option<(&str, Ports)>, String> {
        let ports = self.ports.ports()?;
        if self.ground.is_none() && ports != Ports::default() {
            return Err("--offboard-port, --ground-port, --local-port: need --ground".to_owned());
        }
        Ok(self.ground.as_deref().map(|line| (line, ports)))
    }
}
