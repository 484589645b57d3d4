//! The arguments of `first-flight`, in clap's terms, and their checks.

use clap::{Args, ValueEnum};
use host_sim::sessions::first_flight::checks::CHECKS;
use host_sim::sessions::first_flight::line::Address;
use host_sim::sessions::first_flight::person::{Person, Prepared, Terminal};
use host_sim::sessions::first_flight::record::Subject;
use host_sim::sessions::first_flight::walk::{BOARDS, Board};
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

/// Shown below the options.
pub const HELP: &str = "\
Two people, a board that is flashed with the image of FILE, propellers OFF. The
walk tells what to do, looks at the telemetry, judges what it can judge itself,
and asks for the rest. docs/first-flight.md and docs/boards.md say why.

  host-sim first-flight micoair-h743 mine.toml --link serial:/dev/ttyACM0
  host-sim first-flight micoair-h743 mine.toml --link udp:127.0.0.1:14550
                                     with `host-sim sitl mine.toml` on a desk

Checks, in their order; --only makes one of them again:
  boot         the image: certified, with the numbers of FILE
  ticks        tick times, missed ticks, the sensor at rest
  usb          pulled out and put in
  axes         accelerometer and gyro, held four ways
  calibration  gyro, accelerometer on six sides, level
  tilt         which rotors would speed up; no motor turns
  battery      against a meter
  frames       on an oscilloscope, where there is one
  motors       each: place, direction, least level, vibration
  stop         a disarm command stops a motor
  kill, radio  the kill switch; a transmitter that is turned off
  bootloader   into the chip's bootloader and back
  settings     small fence, low take-off, slow motions
  arming       poses; armed and disarmed in every way

What passed is kept in --record: a walk that was broken off goes on there. A
record of another board, file or image does not count. --page is the page to
sign; it is written at the end of every walk.

--answers FILE answers by key instead of a person, as TOML: the key in brackets
at a question, and the answer.  \"battery.meter\" = \"16.1\"

Exit status: 0 every check passed or was skipped for a reason; 1 one failed, or
the walk was broken off; 2 for what cannot be used.";

/// The arguments.
#[derive(Args)]
pub struct FirstFlightArguments {
    /// The board
    #[arg(value_enum)]
    board: BoardName,
    /// The scenario file that the image was built with
    pub file: PathBuf,
    /// Where the vehicle is: serial:PORT, serial:PORT@BAUD, tcp:HOST:PORT, or udp:HOST:PORT to listen there
    #[arg(long, value_name = "LINK", default_value = "udp:127.0.0.1:14550")]
    pub link: Address,
    /// What passed, kept here [default: FILE's name with .first-flight.toml]
    #[arg(long, value_name = "FILE.toml")]
    record: Option<PathBuf>,
    /// The page to sign [default: FILE's name with .first-flight.md]
    #[arg(long, value_name = "FILE.md")]
    page: Option<PathBuf>,
    /// The image that was flashed, so that another one begins the record anew
    #[arg(long, value_name = "FILE")]
    image: Option<PathBuf>,
    /// Make this check alone, whether it has passed or not
    #[arg(long, value_name = "CHECK")]
    pub only: Option<String>,
    /// The vehicle's time passes so many times more slowly than ours: an emulated board's
    #[arg(long, value_name = "TIMES", default_value_t = 1.0, value_parser = slower)]
    pub slower: f64,
    /// Take answers from this file
    #[arg(long, value_name = "FILE.toml")]
    answers: Option<PathBuf>,
}

/// The boards, as the command line has them.
#[derive(Clone, Copy, ValueEnum)]
enum BoardName {
    MicoairH743,
    MatekH743,
    CrazyflieBolt,
}

/// How many times more slowly.
fn slower(written: &str) -> Result<f64, String> {
    let times = written.parse().map_err(|_| "is not a number".to_owned())?;
    if (1.0..=1000.0).contains(&times) { Ok(times) } else { Err("must be from 1 to 1000".to_owned()) }
}

/// Reads a file of any kind.
fn read(path: &Path, option: &str) -> Result<Vec<u8>, String> {
    std::fs::read(path).map_err(|error| format!("{option}{}: cannot be read: {error}", path.display()))
}

/// The SHA-256 of bytes, in hexadecimal digits.
fn hash(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

impl FirstFlightArguments {
    /// The board.
    pub fn board(&self) -> Board {
        match self.board {
            BoardName::MicoairH743 => BOARDS[0],
            BoardName::MatekH743 => BOARDS[1],
            BoardName::CrazyflieBolt => BOARDS[2],
        }
    }

    /// What is checked; `text` is the scenario file's.
    ///
    /// # Errors
    /// An image that cannot be read.
    pub fn subject(&self, text: &str) -> Result<Subject, String> {
        let image = match &self.image {
            Some(image) => hash(&read(image, "--image ")?),
            None => format!("not given; this program is {}", env!("CARGO_PKG_VERSION")),
        };
        Ok(Subject { board: self.board().name.to_owned(), scenario: hash(text.as_bytes()), image })
    }

    /// Where the record is kept.
    pub fn record(&self) -> PathBuf {
        self.record.clone().unwrap_or_else(|| self.file.with_extension("first-flight.toml"))
    }

    /// Where the page is written.
    pub fn page(&self) -> PathBuf {
        self.page.clone().unwrap_or_else(|| self.file.with_extension("first-flight.md"))
    }

    /// Who answers.
    ///
    /// # Errors
    /// Answers that cannot be read, or a check that there is not.
    pub fn person(&self) -> Result<Box<dyn Person>, String> {
        if let Some(only) = &self.only
            && !CHECKS.iter().any(|check| check.id == only)
        {
            let ids: Vec<_> = CHECKS.iter().map(|check| check.id).collect();
            return Err(format!("--only {only}: is no check; there are {}", ids.join(", ")));
        }
        let Some(path) = &self.answers else { return Ok(Box::new(Terminal::open())) };
        let text = String::from_utf8(read(path, "--answers ")?)
            .map_err(|_| format!("--answers {}: is no text", path.display()))?;
        let answers = Prepared::parse(&text).map_err(|error| format!("--answers {}: {error}", path.display()))?;
        Ok(Box::new(answers))
    }
}
