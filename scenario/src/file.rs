//! A whole scenario file: its sections, read into one flight that can be flown.

mod layout;

use crate::actuation::idle::LeastCommand;
use crate::body::BodyState;
use crate::campaign::{self, Campaign};
use crate::path;
use crate::reality::sensors::{self, VelocitySource};
use crate::reality::{Reality, estimator};
use crate::reference::ReferenceKind;
use crate::sampled_loop::{self, LoopModel};
use crate::section::{FieldError, Section};
use crate::timing::Timing;
use crate::trajectory::vehicle::PathVehicle;
use crate::trajectory::{Directory, FORCE_KEPT, TOLERANCE};
use crate::{actuation, initial, plausibility, vehicle};
use controller_core::allocation::Motor;
use controller_core::configuration::{Configuration, LawParameters};
use controller_core::error::ParameterError;
use controller_core::extended::actuators::ActuatorParameters;
use controller_core::extended::defaults::Airframe;
use controller_core::reference::{ReferenceBounds, Trajectory};
pub use layout::LAYOUT;
use std::fmt;
use std::path::Path;
use std::sync::Arc;
use toml::Table;

/// The paper's Section VI, built in.
pub const PAPER: &str = include_str!("../../scenarios/paper.toml");

/// The firmware's default vehicle, built in.
pub const STUDY: &str = include_str!("../../vehicles/study.toml");

/// After the last of a path's points, if the file has no duration.
const HOLD_AFTER_LAST_POINT_S: f64 = 5.0;

/// A flight that can be flown.
#[derive(Clone)]
pub struct Scenario {
    /// Names the flight and its output directory.
    pub name: String,
    /// Duration, control period, plant step.
    pub timing: Timing,
    /// Vehicle, limits, gains, the reference's bounds, thrust floor, rotors: what a certificate would be about. Without
    /// rotors thrust and torque act directly.
    pub configuration: Configuration,
    /// First-order lag of the rotors' speeds, s; zero for none.
    pub rotor_lag: f64,
    /// The rotors' least command in flight; none without rotors.
    pub least_command: Option<LeastCommand>,
    /// From a tick to the moment its wrench acts, plant steps.
    pub delay_steps: u64,
    /// The true vehicle, air and sensors, beyond the model.
    pub reality: Reality,
    /// Where it starts.
    pub initial: BodyState,
    /// The reference, as in the file.
    pub reference: ReferenceKind,
    /// How far it may stray from that once it is there, m.
    pub tolerance: f64,
    /// The force per mass that is kept free along it, m/s^2.
    pub force_kept: f32,
    /// The same, ready to be evaluated.
    pub trajectory: Arc<dyn Trajectory + Send + Sync>,
    /// How its circumstances differ from flight to flight of a campaign.
    pub campaign: Campaign,
    /// What few vehicles have, each number in a sentence.
    pub unusual: Vec<String>,
}

impl Scenario {
    /// The paper's scenario.
    ///
    /// # Errors
    /// Never, as long as the built-in file is right; a test reads it.
    pub fn paper() -> Result<Self, ScenarioError> {
        Self::parse(PAPER, "scenarios/paper.toml (built in)")
    }

    /// Reads a file.
    ///
    /// # Errors
    /// [`ScenarioError`]: unreadable, no TOML, or a field that was refused.
    pub fn load(path: &Path) -> Result<Self, ScenarioError> {
        let file = path.display().to_string();
        match crate::text::read(path) {
            Ok(text) => Self::parse(&text, &file),
            Err(error) => Err(ScenarioError { file, what: format!("cannot be read: {error}") }),
        }
    }

    /// Reads `text`; `file` is what errors call it.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub fn parse(text: &str, file: &str) -> Result<Self, ScenarioError> {
        let refuse = |what: String| ScenarioError { file: file.to_owned(), what };
        let table: Table = text.parse().map_err(|error| refuse(syntax(text, &error)))?;
        let directory = Path::new(file).parent();
        Self::read(Section::root(&table), directory).map_err(|error| refuse(error.to_string()))
    }

    fn read(root: Section, directory: Directory) -> Result<Self, FieldError> {
        let root = &root.with(&LAYOUT)?;
        root.check_measured()?;
        let name = read_name(root)?;
        let timing = Timing::read(root)?;
        let delay_steps = actuation::read_delay(root, &timing)?;
        let delay = delay_steps as f64 * timing.step();
        let sensors = sensors::read(root, &timing, delay / timing.period())?;
        let estimator = estimator::read(root, &timing)?;
        let vehicle = vehicle::read_vehicle(root)?;
        let (rotors, least_command) = actuation::read_rotors(root, &vehicle)?.unzip();
        let rotor_lag = actuation::read_lag(root)?;
        // What is measured shows a command's effect later by what the sensors are late.
        let shown = delay + sensors.map_or(0.0, |sensors| sensors.delay_ticks as f64 * timing.period());
        let actuators = ActuatorParameters { lag: rotor_lag as f32, delay: shown as f32 };
        let unusual = plausibility::check(root, &vehicle, rotors.as_ref(), rotor_lag)?;
        if let (Some(rotors), Some(least)) = (&rotors, &least_command) {
            least.check_hover(&vehicle, rotors)?;
        }
        let limits = vehicle::read_limits(root, &vehicle, rotors.as_ref())?;
        let configuration = |own: &ReferenceBounds| {
            vehicle::read_configuration(root, (vehicle, limits, rotors.clone()), own, actuators, timing.period())
        };
        let force_kept = ReferenceKind::number(root, &FORCE_KEPT)? as f32;
        let allow = || {
            let configuration = configuration(&ReferenceBounds::REST)?;
            Ok(PathVehicle { configuration, has_bounds: root.has("reference_bounds"), force_kept })
        };
        let reference = ReferenceKind::read(root, directory, &allow)?;
        let tolerance = ReferenceKind::number(root, &TOLERANCE)?;
        let trajectory = reference.build().map_err(|error| root.refused(&error))?;
        let timing = match &reference {
            ReferenceKind::Route(route) if !root.has("duration") => {
                timing.lasting(route.duration() + HOLD_AFTER_LAST_POINT_S)
            }
            _ => timing,
        };
        let configuration = configuration(&trajectory.bounds())?;
        let start = trajectory.at(0).position.map(f64::from);
        let initial = initial::read_initial(root, start, timing.step())?;
        let reality = Reality::read(root, &configuration, (sensors, estimator), &initial)?;
        path::check_ground(&reference, &*trajectory, reality.ground)?;
        let campaign = campaign::read(root, &timing, &configuration)?;
        Ok(Self {
            name,
            timing,
            configuration,
            rotor_lag,
            least_command,
            delay_steps,
            reality,
            initial,
            reference,
            tolerance,
            force_kept,
            trajectory,
            campaign,
            unusual,
        })
    }

    /// The rotors' motors; ideal ones without rotors.
    #[must_use]
    pub fn motor(&self) -> Motor {
        self.least_command.map_or(Motor::IDEAL, |least| least.motor)
    }

    /// From a tick to the moment its wrench acts, s.
    #[must_use]
    pub fn delay(&self) -> f64 {
        self.delay_steps as f64 * self.timing.step()
    }

    /// By how much what is measured is late, s: with an estimator, the body rates.
    #[must_use]
    pub fn input_delay(&self) -> f64 {
        let sensors = self.reality.sensors.map_or(0.0, |sensors| sensors.delay_ticks as f64 * self.timing.period());
        sensors + self.reality.estimator.map_or(0.0, |_| estimator::rates_delay(&self.timing))
    }

    /// The sampled loops of its vehicle, gains, rotors and timing, with the delays of inputs and outputs together, and
    /// where the velocity comes from.
    ///
    /// # Errors
    /// If the timing is outside the model's range; no file that was read leads there.
    pub fn loops(&self) -> Result<LoopModel, ParameterError> {
        let known = LoopModel::new(self.configuration.vehicle(), self.configuration.law(), self.loop_timing())?;
        Ok(match self.reality.sensors.map(|sensors| sensors.velocity) {
            Some(VelocitySource::AlphaBeta { bandwidth }) => known.with_velocity_from_positions(bandwidth),
            // An observer with an accelerometer errs by itself, independently of the vehicle.
            _ => known,
        })
    }

    /// When commands are computed and how they reach the vehicle, for its sampled loops.
    #[must_use]
    pub fn loop_timing(&self) -> sampled_loop::LoopTiming {
        let period = self.timing.period();
        let delay_samples = (self.delay() + self.input_delay()) / period;
        sampled_loop::LoopTiming { period, rotor_lag: self.rotor_lag, delay_samples }
    }

    /// What the extended law's constants follow from where the file leaves them out; none under the paper's law.
    #[must_use]
    pub fn airframe(&self) -> Option<Airframe<'_>> {
        let LawParameters::Extended(law) = self.configuration.law() else { return None };
        let (vehicle, rotors) = (self.configuration.vehicle(), self.configuration.rotors());
        Some(Airframe {
            vehicle,
            limits: self.configuration.limits(),
            rotors,
            actuators: law.actuators,
            period: self.timing.period() as f32,
            drag: self.reality.drag.map_or(0.0, |drag| vehicle::known_drag(&drag, vehicle, rotors)),
        })
    }

    /// Whether `other` is the same flight, whatever its name.
    #[must_use]
    pub fn flies_like(&self, other: &Self) -> bool {
        self.timing == other.timing
            && self.configuration == other.configuration
            && self.rotor_lag == other.rotor_lag
            && self.motor() == other.motor()
            && self.delay_steps == other.delay_steps
            && self.reality == other.reality
            && self.initial == other.initial
            && self.reference == other.reference
    }

    /// Whether this is the paper's scenario, whatever its name: then the paper's published figures are claims about it.
    #[must_use]
    pub fn is_papers(&self) -> bool {
        Self::paper().is_ok_and(|paper| self.flies_like(&paper))
    }
}

/// A scenario that cannot be flown: one line with the file, the field, what is wrong and what is allowed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ScenarioError {
    /// The file as given.
    pub file: String,
    /// Field and problem, or the place of a syntax error.
    pub what: String,
}

impl fmt::Display for ScenarioError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", one_line(&self.file), self.what)
    }
}

impl std::error::Error for ScenarioError {}

/// A file's name without line ends and other control characters.
fn one_line(name: &str) -> String {
    let shown = |c: char| if c.is_control() { c.escape_debug().to_string() } else { c.to_string() };
    name.chars().map(shown).collect()
}

/// Refuses a scenario's name that is not safe as a directory's.
///
/// # Errors
/// Names `name`.
pub fn check_name(name: &str) -> Result<(), FieldError> {
    let plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
    if !name.is_empty() && name.len() <= 64 && name.chars().all(plain) && !name.starts_with('.') {
        Ok(())
    } else {
        let allowed = "must be 1 to 64 letters, digits, '-', '_' or '.', not starting with '.'";
        Err(FieldError::new("name", format!("{allowed}, found {name:?}")))
    }
}

fn read_name(root: &Section) -> Result<String, FieldError> {
    let name = root.text("name")?;
    check_name(name).map(|()| name.to_owned())
}

/// A syntax error in one line, with its place.
fn syntax(text: &str, error: &toml::de::Error) -> String {
    let message = error.message().replace('\n', "; ");
    let Some(before) = error.span().and_then(|span| text.get(..span.start)) else {
        return format!("not TOML: {message}");
    };
    let line = before.matches('\n').count() + 1;
    let column = before.chars().rev().take_while(|c| *c != '\n').count() + 1;
    format!("line {line}, column {column}: not TOML: {message}")
}

#[cfg(test)]
mod tests;
