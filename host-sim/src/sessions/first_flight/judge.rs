//! What measured values mean: whether they show what a step of the first flight asks for. No link and no person here.

use controller_core::allocation::{Rotor, Rotors, Spin};
use controller_core::certificate::Certificate;
use controller_core::certificate::certified::{Certified, Refused};
use nalgebra::Vector3;

/// The horizontal force that a tilt shows at least, m/s^2: 15 degrees.
const TILT_MIN_M_PER_S2: f32 = 2.5;

/// The horizontal force that a level vehicle shows at most, m/s^2: 3 degrees.
const LEVEL_MAX_M_PER_S2: f32 = 0.5;

/// How far gravity's magnitude may be off, m/s^2, before the accelerometer is calibrated.
const GRAVITY_ERROR_MAX_M_PER_S2: f32 = 0.6;
const GRAVITY_M_PER_S2: f32 = 9.806_65;

/// The least angle by which a hand has turned it, rad: about the axis of a tilt, and about the vertical.
const TILTED_MIN_RAD: f32 = 0.15;
const TURNED_MIN_RAD: f32 = 0.8;

/// The body rate that shows a turn about the vertical, rad/s.
const TURNING_MIN_RAD_PER_S: f32 = 0.3;

/// How far from 1 a share must be to count.
const SHARE_MIN: f32 = 0.002;

/// How the line of a report rounds: to four decimals.
const ROUNDING_ERROR: f64 = 0.000_051;

/// How a person holds the vehicle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hold {
    /// Flat, as it stands.
    Flat,
    /// Its nose raised.
    NoseUp,
    /// Its left side raised.
    LeftUp,
    /// Turned counter-clockwise, seen from above, on the flat.
    TurnedLeft,
}

impl Hold {
    /// Every way.
    pub const ALL: [Self; 4] = [Self::Flat, Self::NoseUp, Self::LeftUp, Self::TurnedLeft];

    /// Its name, of a question and in a table.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Flat => "flat",
            Self::NoseUp => "nose-up",
            Self::LeftUp => "left-up",
            Self::TurnedLeft => "turned-left",
        }
    }

    /// What to do.
    #[must_use]
    pub fn instruction(self) -> &'static str {
        match self {
            Self::Flat => "Lay it flat, and leave it.",
            Self::NoseUp => "Raise the nose by 30 degrees, and hold it there.",
            Self::LeftUp => "Raise the left side by 30 degrees, and hold it there.",
            Self::TurnedLeft => "Keep it flat, and turn it to the left (counter-clockwise, seen from above).",
        }
    }

    /// The side that is raised.
    fn raised(self) -> Option<Vector3<f32>> {
        match self {
            Self::NoseUp => Some(Vector3::x()),
            Self::LeftUp => Some(Vector3::y()),
            Self::Flat | Self::TurnedLeft => None,
        }
    }

    /// Whether specific force, m/s^2, and the angle turned since the instruction, rad, both in body axes, show it.
    #[must_use]
    pub fn is_shown(self, force: &Vector3<f32>, turned: &Vector3<f32>) -> bool {
        let across = Vector3::new(force.x, force.y, 0.0);
        let is_gravity = (force.norm() - GRAVITY_M_PER_S2).abs() < GRAVITY_ERROR_MAX_M_PER_S2;
        match (self, self.raised()) {
            (Self::Flat, _) => is_gravity && force.z > 0.0 && across.norm() < 3.0 * LEVEL_MAX_M_PER_S2,
            (Self::TurnedLeft, _) => turned.z > TURNED_MIN_RAD,
            // Within 37 degrees of its direction. Raising a side turns about the axis from up to that side, reversed.
            (_, Some(raised)) => {
                let axis = raised.cross(&Vector3::z());
                let is_there = across.dot(&raised) > 0.8 * across.norm().max(TILT_MIN_M_PER_S2 / 0.8);
                is_there && turned.dot(&axis) > TILTED_MIN_RAD
            }
            (_, None) => false,
        }
    }

    /// Whether it is held so that shares of a levelling thrust can be judged; rates in rad/s.
    #[must_use]
    pub fn is_held(self, force: &Vector3<f32>, rate: &Vector3<f32>) -> bool {
        let across = Vector3::new(force.x, force.y, 0.0);
        match self.raised() {
            Some(raised) => across.dot(&raised) > 0.8 * across.norm().max(TILT_MIN_M_PER_S2 / 0.8) && rate.norm() < 0.2,
            None if self == Self::TurnedLeft => rate.z > TURNING_MIN_RAD_PER_S,
            None => across.norm() < LEVEL_MAX_M_PER_S2 && rate.norm() < 0.05,
        }
    }

    /// Whether a rotor would speed up to level the vehicle, or to stop its turn; none where that says nothing about it.
    #[must_use]
    pub fn speeds_up(self, rotor: &Rotor) -> Option<bool> {
        match self.raised() {
            Some(raised) => {
                let along = rotor.position.dot(&raised);
                // One on the axis of the tilt keeps its thrust.
                (along.abs() > 0.2 * rotor.position.norm()).then_some(along < 0.0)
            }
            // What turns as the vehicle does brakes it by its drag.
            None if self == Self::TurnedLeft => Some(rotor.spin == Spin::CounterClockwise),
            None => None,
        }
    }
}

/// Where a rotor is, in words.
#[must_use]
pub fn place(rotor: &Rotor) -> &'static str {
    let (x, y) = (rotor.position.x, rotor.position.y);
    match (x.abs() > 0.3 * y.abs(), y.abs() > 0.3 * x.abs()) {
        (true, true) if x > 0.0 => {
            if y > 0.0 {
                "front left"
            } else {
                "front right"
            }
        }
        (true, true) => {
            if y > 0.0 {
                "rear left"
            } else {
                "rear right"
            }
        }
        (true, false) => {
            if x > 0.0 {
                "front"
            } else {
                "rear"
            }
        }
        (false, _) => {
            if y > 0.0 {
                "left"
            } else {
                "right"
            }
        }
    }
}

/// Which way it turns, in letters.
#[must_use]
pub fn direction(rotor: &Rotor) -> &'static str {
    if rotor.spin == Spin::Clockwise { "cw" } else { "ccw" }
}

/// The first rotor, from 1, whose share speaks against what a hold asks for.
#[must_use]
pub fn wrong_share(hold: Hold, rotors: &Rotors, shares: &[f32]) -> Option<usize> {
    let wrong = |(rotor, share): (&Rotor, &f32)| {
        hold.speeds_up(rotor)
            .is_some_and(|faster| if faster { *share <= 1.0 + SHARE_MIN } else { *share >= 1.0 - SHARE_MIN })
    };
    rotors.iter().zip(shares).position(wrong).map(|index| index + 1)
}

/// What a bench report says.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BootReport {
    /// Why it started, and on which board.
    pub started: Option<String>,
    /// The name of what is built in.
    pub scenario: Option<String>,
    /// The certificate's lines: name, required, available.
    pub rows: Vec<(String, f64, f64)>,
    /// The verdict.
    pub is_certified: bool,
    /// What keeps it from arming.
    pub refusal: Option<String>,
    /// Whether the report is whole.
    pub has_ended: bool,
}

impl BootReport {
    /// Of texts, in the order in which they came.
    #[must_use]
    pub fn read(texts: &[String]) -> Self {
        let mut report = Self::default();
        for text in texts {
            let numbers = text.rsplit_once(": ").and_then(|(name, numbers)| {
                let (required, available) = numbers.split_once(" of ")?;
                Some((name.to_owned(), required.parse().ok()?, available.parse().ok()?))
            });
            if let Some(started) = text.strip_prefix("Started by ") {
                // A report begins.
                report = Self { started: Some(started.to_owned()), ..Self::default() };
            } else if let Some(name) = text.strip_prefix("Scenario ") {
                report.scenario = Some(name.to_owned());
            } else if let Some(row) = numbers {
                report.rows.push(row);
            } else if text == "Certified" {
                report.is_certified = true;
            } else if text.starts_with("Refused") || text.starts_with("Not certified") {
                report.refusal = Some(text.clone());
            } else if text == "Report ends" {
                report.has_ended = true;
            }
        }
        report
    }

    /// How the vehicle's certificate differs from that of a file, in words; none where they are the same.
    #[must_use]
    pub fn difference(&self, verdict: &Result<Certified, Refused>) -> Option<String> {
        let certificate: &Certificate = match verdict {
            Ok(certified) => certified.certificate(),
            Err(Refused::Fails(certificate)) => certificate,
            Err(Refused::Undefined(error)) => return Some(format!("the file cannot be certified: {error}")),
        };
        let rows: Vec<_> = certificate.inequalities().collect();
        if rows.len() != self.rows.len() {
            return Some(format!("{} inequalities, {} in the file's certificate", self.rows.len(), rows.len()));
        }
        for (row, (name, required, available)) in rows.iter().zip(&self.rows) {
            let is_near = |one: f64, other: f64| (one - other).abs() <= ROUNDING_ERROR + 1e-6 * other.abs();
            if !row.name.starts_with(name.as_str())
                || !is_near(*required, row.required)
                || !is_near(*available, row.available)
            {
                let file = format!("{:.4} of {:.4}", row.required, row.available);
                return Some(format!("{name}: {required:.4} of {available:.4}, the file's {}: {file}", row.name));
            }
        }
        (self.is_certified != verdict.is_ok()).then(|| "the verdicts differ".to_owned())
    }
}

#[cfg(test)]
mod tests;
