//! What a source says of a vehicle: plain numbers, each of which may be missing. SI units, body axes x forward, y left,
//! z up, positions from the centre of mass.

use controller_core::allocation::Spin;
use nalgebra::{Matrix3, Vector3};
use scenario::reality::drag::Drag;

/// A vehicle as a source has it.
#[derive(Debug, Clone, PartialEq)]
pub struct VehicleNumbers {
    /// What the source is, for the first line of the file.
    pub source: String,
    /// kg.
    pub mass: Option<f64>,
    /// About the centre of mass, kg m^2.
    pub inertia: Option<Matrix3<f64>>,
    /// m/s^2; none where the source leaves it to who flies.
    pub gravity: Option<f64>,
    /// What moves it.
    pub actuation: Actuation,
    /// What the air does to it, as far as it is known; zero for the rest.
    pub drag: Drag,
    /// What a reader of the file should know of a key, by its dotted path.
    pub notes: Vec<(&'static str, String)>,
}

/// What moves a vehicle.
#[derive(Debug, Clone, PartialEq)]
pub enum Actuation {
    /// Rotors that are alike.
    Rotors(RotorNumbers),
    /// Thrust, N, and torque, N m, of the whole vehicle; the source has no rotors.
    Wrench {
        /// N.
        thrust_max: f64,
        /// N m.
        torque_max: Vector3<f64>,
    },
}

/// Rotors.
#[derive(Debug, Clone, PartialEq)]
pub struct RotorNumbers {
    /// m.
    pub position: Option<Vec<Vector3<f64>>>,
    /// Seen from above.
    pub spin: Option<Vec<Spin>>,
    /// How they push.
    pub thrust: Thrust,
    /// First-order, s.
    pub lag: Option<f64>,
}

/// How each rotor pushes.
#[derive(Debug, Clone, PartialEq)]
pub enum Thrust {
    /// By its speed.
    BySpeed {
        /// N/(rad/s)^2.
        thrust_coefficient: Option<f64>,
        /// N m/(rad/s)^2.
        drag_coefficient: Option<f64>,
        /// Least and greatest, rad/s.
        speed: Option<[f64; 2]>,
    },
    /// By its greatest thrust; the source has no speeds.
    Greatest {
        /// N; zero for none.
        thrust_min: f64,
        /// N.
        thrust_max: Option<f64>,
        /// m.
        torque_per_thrust: Option<f64>,
    },
}

impl VehicleNumbers {
    /// A vehicle of which `source` has said nothing yet.
    #[must_use]
    pub fn new(source: impl Into<String>, actuation: Actuation) -> Self {
        Self {
            source: source.into(),
            mass: None,
            inertia: None,
            gravity: None,
            actuation,
            drag: Drag::default(),
            notes: Vec::new(),
        }
    }
}

/// What all of `values` are, each with the place it is from; none without any.
///
/// # Errors
/// If they differ: the rotors of a scenario are alike.
pub fn alike(what: &str, values: &[(String, f64)]) -> Result<Option<f64>, String> {
    const ALIKE_TOLERANCE_SHARE: f64 = 1e-6;
    let Some(((first_place, first), rest)) = values.split_first() else { return Ok(None) };
    match rest.iter().find(|(_, value)| (value - first).abs() > ALIKE_TOLERANCE_SHARE * first.abs().max(value.abs())) {
        None => Ok(Some(*first)),
        Some((place, other)) => Err(format!(
            "{place}: {what} must be the same for all rotors, found {other}, and {first} at {first_place}; write the \
             vehicle file by hand with the weakest rotor's numbers"
        )),
    }
}
