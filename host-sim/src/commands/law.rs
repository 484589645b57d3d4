//! The controller alone, lock-step over text, for other simulators.
//!
//! One line of 33 numbers in, one line of 4 numbers out, flushed, until the input ends:
//!
//! ```text
//! in:  t dt | x(3) v(3) world, z up | q(4) as x y z w, body to world | omega(3) body |
//!      reference x(3) v(3) a(3) j(3) s(3) yaw yaw_rate yaw_acceleration
//! out: thrust [N], torque x y z [N m], for the rotors: not clipped to any limit
//! ```
//!
//! SI units and rad. The output uses the filters as they stand; they then advance by the line's dt. t serves messages
//! only. A line that cannot be used is answered by `error: …` on its turn and changes nothing.

use crate::flight;
use controller_core::error::ParameterError;
use controller_core::heading::Heading;
use controller_core::law::Law;
use controller_core::reference::Reference;
use controller_core::state::{State, UNIT_TOLERANCE, Wrench};
use nalgebra::{Quaternion, Vector2, Vector3};
use scenario::Scenario;
use scenario::number::Number;
use scenario::timing::check_period;
use std::fmt;
use std::io::{self, BufRead, Read, Write};

/// Numbers of an input line.
const INPUT_NUMBERS: usize = 33;

/// What messages call them, what their elements are called, and how large they may be: beyond what any vehicle of this
/// kind does, they are nonsense, which the law would remember.
const INPUT_FIELDS: [(&str, &[&str], f64); 14] = [
    ("t", &[""], f64::MAX),
    ("dt", &[""], f64::MAX),
    ("x", &AXIS_NAMES, 1e6),
    ("v", &AXIS_NAMES, 1e4),
    ("q", &[".x", ".y", ".z", ".w"], 2.0),
    ("omega", &AXIS_NAMES, 1e4),
    ("reference x", &AXIS_NAMES, 1e6),
    ("reference v", &AXIS_NAMES, 1e4),
    ("reference a", &AXIS_NAMES, 1e4),
    ("reference j", &AXIS_NAMES, 1e6),
    ("reference s", &AXIS_NAMES, 1e8),
    ("yaw", &[""], 1e6),
    ("yaw", &["_rate"], 1e4),
    ("yaw", &["_acceleration"], 1e6),
];
const AXIS_NAMES: [&str; 3] = ["[0]", "[1]", "[2]"];

/// Whatever is sent, memory does not run out.
const INPUT_LINE_MAX_BYTES: usize = 1 << 16;

/// Why lines could not be served to their end.
#[derive(Debug)]
pub enum ServeError {
    /// The input cannot be read.
    Input(io::Error),
    /// The output cannot be written.
    Output(io::Error),
}

impl fmt::Display for ServeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input(error) => write!(f, "standard input: cannot be read: {error}"),
            Self::Output(error) => write!(f, "standard output: cannot be written: {error}"),
        }
    }
}

impl std::error::Error for ServeError {}

/// The law behind a text interface.
pub struct LawServer {
    law: Law,
    /// The reference's a_z must stay above this, m/s^2.
    least_vertical_acceleration: f64,
}

/// The numbers of one line, in order.
struct InputLine<'a> {
    values: &'a [f64],
}

impl InputLine<'_> {
    fn next(&mut self) -> f64 {
        let (first, rest) = self.values.split_first().unwrap_or((&0.0, &[]));
        self.values = rest;
        *first
    }

    fn vector(&mut self) -> Vector3<f32> {
        Vector3::new(self.next(), self.next(), self.next()).map(|value| value as f32)
    }
}

impl LawServer {
    /// The law for the scenario's vehicle and gains, reset. Its initial state, reference and plant are not used.
    ///
    /// # Errors
    /// As [`Law::new`]'s.
    pub fn new(scenario: &Scenario) -> Result<Self, ParameterError> {
        let configuration = &scenario.configuration;
        let (fall, gravity) = (f64::from(configuration.max_fall()), f64::from(configuration.vehicle().gravity));
        Ok(Self {
            law: flight::law(scenario)?,
            // A step of single precision above the limit, so that rounding never turns a refused number into a served
            // one.
            least_vertical_acceleration: fall - gravity * (1.0 - f64::from(f32::EPSILON)),
        })
    }

    /// Serves lines until the input ends or the output is closed.
    ///
    /// # Errors
    /// If the input cannot be read or the output not written, but for a closed pipe.
    pub fn serve(&mut self, mut input: impl BufRead, mut output: impl Write) -> Result<(), ServeError> {
        let mut line = Vec::new();
        let longest = INPUT_LINE_MAX_BYTES as u64 + 1;
        while input.by_ref().take(longest).read_until(b'\n', &mut line).map_err(ServeError::Input)? > 0 {
            let is_too_long = line.len() > INPUT_LINE_MAX_BYTES;
            let answer = if is_too_long {
                Err(format!("a line must have at most {INPUT_LINE_MAX_BYTES} bytes, its end included"))
            } else {
                self.answer(&String::from_utf8_lossy(&line))
            };
            let answered = match answer {
                Ok(Wrench { thrust, torque }) => {
                    let [thrust, x, y, z] = [thrust, torque.x, torque.y, torque.z].map(Number);
                    writeln!(output, "{thrust} {x} {y} {z}")
                }
                Err(problem) => writeln!(output, "error: {problem}"),
            };
            match answered.and_then(|()| output.flush()) {
                Err(error) if error.kind() == io::ErrorKind::BrokenPipe => return Ok(()),
                other => other.map_err(ServeError::Output)?,
            }
            if is_too_long && !line.ends_with(b"\n") {
                input.skip_until(b'\n').map_err(ServeError::Input)?;
            }
            line.clear();
        }
        Ok(())
    }

    /// What the last answer was divided by: the wrench that acts is so many times the answer, as far as the law knows.
    #[must_use]
    pub fn thrust_scale(&self) -> f32 {
        self.law.thrust_scale()
    }

    /// The wrench for one line, or why the line is invalid.
    ///
    /// # Errors
    /// One line of text; the controller's memory is then unchanged.
    pub fn answer(&mut self, line: &str) -> Result<Wrench, String> {
        let values = parse(line)?;
        let mut numbers = InputLine { values: &values };
        let time = numbers.next();
        let at_time = |problem: String| format!("t = {time}: {problem}");

        let period = numbers.next();
        check_period(period).map_err(|problem| at_time(format!("dt: {problem}")))?;
        let (position, velocity) = (numbers.vector(), numbers.vector());
        let [i, j, k, w] = [numbers.next(), numbers.next(), numbers.next(), numbers.next()];
        let attitude = Quaternion::new(w, i, j, k);
        let length = attitude.norm();
        // A NaN was refused before; an overflowing length is not near one.
        if (length - 1.0).abs() > f64::from(UNIT_TOLERANCE) {
            let problem = format!("q: must have unit length within {UNIT_TOLERANCE}, found length {length}");
            return Err(at_time(problem));
        }
        let attitude = Quaternion::from((attitude.coords / length).map(|value| value as f32));
        let state = State { position, velocity, attitude, angular_velocity: numbers.vector() };

        let (position, velocity, acceleration) = (numbers.vector(), numbers.vector(), numbers.vector());
        let (jerk, snap) = (numbers.vector(), numbers.vector());
        let yaw = numbers.next();
        let direction = Vector2::new(yaw.cos() as f32, yaw.sin() as f32);
        let heading = Heading::new(direction, numbers.next() as f32, numbers.next() as f32)
            .map_err(|error| at_time(error.to_string()))?;
        let reference = Reference { position, velocity, acceleration, jerk, snap, heading };
        if f64::from(acceleration.z) <= self.least_vertical_acceleration {
            let limit = self.least_vertical_acceleration;
            return Err(at_time(format!("reference a[2]: must stay above M_p - g = {limit:.6}, found {}", values[23])));
        }

        self.law.set_period(period as f32).map_err(|error| at_time(error.to_string()))?;
        let (wrench, _) = self.law.step(&state, &reference).map_err(|error| at_time(error.to_string()))?;
        Ok(wrench.scaled(1.0 / self.law.thrust_scale()))
    }
}

/// Exactly 33 finite numbers within their ranges.
fn parse(line: &str) -> Result<[f64; INPUT_NUMBERS], String> {
    let found = line.split_whitespace().count();
    if found != INPUT_NUMBERS {
        return Err(format!("needs {INPUT_NUMBERS} numbers on a line, found {found}"));
    }
    let fields = INPUT_FIELDS.iter().flat_map(|field| field.1.iter().map(move |element| (field.0, element, field.2)));
    let mut values = [0.0; INPUT_NUMBERS];
    for ((value, word), (name, element, greatest)) in values.iter_mut().zip(line.split_whitespace()).zip(fields) {
        *value = number(word, greatest).map_err(|problem| format!("{name}{element}: {problem}"))?;
    }
    Ok(values)
}

fn number(word: &str, greatest: f64) -> Result<f64, String> {
    let number: f64 = word.parse().map_err(|_| format!("must be a number, found {word:?}"))?;
    if !number.is_finite() {
        return Err(format!("must be finite, found {number}"));
    }
    if number.abs() > greatest {
        return Err(format!("must be within ±{greatest}, found {number:e}"));
    }
    Ok(number)
}

#[cfg(test)]
mod tests;
