//! A vehicle's numbers as a vehicle file. A number that the source has not is marked: `key = "missing"` below a comment
//! that says how to measure it. Nothing reads such a file as a scenario, so no flight takes a guess for a measurement.

use super::numbers::{Actuation, RotorNumbers, Thrust, VehicleNumbers};
use controller_core::allocation::Spin;
use nalgebra::{Matrix3, Vector3};
use scenario::number::{Number, array};
use scenario::section::MISSING;
use toml_edit::Value;

/// Products of inertia, relative to the greatest moment, that a scenario takes for zero.
const INERTIA_PRODUCT_SHARE: f64 = 1e-6;
/// The page about measuring.
const MEASURING_PAGE: &str = "docs/identify.md";
const COMMENT_COLUMNS_MAX: usize = 118;

/// Each key that may be missing, its unit, and how to find it.
const HOW_TO_MEASURE: [(&str, &str, &str); 10] = [
    ("vehicle.mass", "kg", "weigh the vehicle as it flies, battery in (section 1)"),
    ("vehicle.inertia", "kg m^2, [x, y, z]", "hang it on two strings and time its swings about each axis (section 2)"),
    (
        "rotors.position",
        "m, [x, y, z] each",
        "measure where each motor stands from where the battery balances the frame (section 1)",
    ),
    ("rotors.spin", "\"cw\" or \"ccw\" each", "look from above which way each rotor turns (section 1)"),
    ("rotors.thrust_coefficient", "N/(rad/s)^2", "thrust over speed squared on a thrust stand (docs/thrust-stand.md)"),
    (
        "rotors.drag_coefficient",
        "N m/(rad/s)^2",
        "torque over speed squared on a thrust stand, or the propeller's data sheet (section 1)",
    ),
    (
        "rotors.speed",
        "rad/s, [least, greatest]",
        "the speeds at idle and at full command, nominal voltage (docs/thrust-stand.md)",
    ),
    (
        "rotors.thrust_max",
        "N, each",
        "thrust at full command on a thrust stand, nominal voltage (docs/thrust-stand.md)",
    ),
    ("rotors.torque_per_thrust", "m", "torque over thrust: the propeller's data sheet or a thrust stand (section 1)"),
    ("rotors.lag", "s", "begin with 0.03, which is much, and identify it from a flight (sections 3 to 5)"),
];

/// One line of a section.
struct Entry {
    path: String,
    /// None if it is missing.
    value: Option<String>,
    comments: Vec<String>,
}

/// A vehicle file, and what of it is missing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Written {
    /// The TOML.
    pub text: String,
    /// Dotted paths.
    pub missing: Vec<String>,
}

/// Numbers of one's own in place of a source's: dotted path and TOML value.
pub type Given = (String, String);

/// How a vehicle is written.
#[derive(Debug, Clone, Default)]
pub struct Wishes {
    /// Numbers of one's own.
    pub given: Vec<Given>,
    /// Whether products of inertia count as zero.
    pub neglect_products: bool,
}

/// `vehicle` as a file called `name`.
///
/// # Errors
/// Names a value given by `--with` that is not a number.
pub fn written(vehicle: &VehicleNumbers, name: &str, from: &str, wishes: &Wishes) -> Result<Written, String> {
    let mut entries = entries(vehicle, wishes.neglect_products);
    for (path, comment) in &vehicle.notes {
        if let Some(entry) = entries.iter_mut().find(|entry| entry.path == *path) {
            entry.comments.push(comment.clone());
        }
    }
    for (path, value) in &wishes.given {
        check_given(path, value)?;
        let comments = vec!["given beside the source".to_owned()];
        let entry = Entry { path: path.clone(), value: Some(value.clone()), comments };
        match entries.iter_mut().find(|entry| entry.path == *path) {
            Some(there) => *there = entry,
            None => entries.push(entry),
        }
    }
    let missing = entries.iter().filter(|entry| entry.value.is_none()).map(|entry| entry.path.clone()).collect();
    let mut text = comment(&format!("From {from}: {}.", vehicle.source));
    text += &format!("name = {}\n", Value::from(name));
    let mut sections: Vec<&str> = Vec::new();
    for (section, _) in entries.iter().filter_map(|entry| entry.path.rsplit_once('.')) {
        if !sections.contains(&section) {
            sections.push(section);
        }
    }
    for section in sections {
        text += &format!("\n[{section}]\n");
        for entry in &entries {
            if let Some((_, key)) = entry.path.rsplit_once('.').filter(|(of, _)| *of == section) {
                text += &entry.comments.iter().map(|line| comment(line)).collect::<String>();
                let value =
                    entry.value.as_deref().map_or_else(|| measure(&entry.path, key), |v| format!("{key} = {v}\n"));
                text += &value;
            }
        }
    }
    Ok(Written { text, missing })
}

/// The mark of a missing number, with how to find it.
fn measure(path: &str, key: &str) -> String {
    let (unit, how) =
        HOW_TO_MEASURE.iter().find(|(known, ..)| *known == path).map_or(("", ""), |(_, unit, how)| (unit, how));
    comment(&format!("MISSING: {key}, {unit}: {how}: {MEASURING_PAGE}")) + &format!("{key} = \"{MISSING}\"\n")
}

fn comment(text: &str) -> String {
    let options = textwrap::Options::new(COMMENT_COLUMNS_MAX).initial_indent("# ").subsequent_indent("#   ");
    let shown: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    textwrap::fill(&shown, options) + "\n"
}

fn check_given(path: &str, value: &str) -> Result<(), String> {
    let is_plain = |part: &str| !part.is_empty() && part.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if !(path.split('.').count() == 2 && path.split('.').all(is_plain)) {
        return Err(format!("{path:?}: must be section.key, such as rotors.lag"));
    }
    match value.parse::<Value>() {
        Ok(_) if !value.contains(['\n', '#']) => Ok(()),
        _ => Err(format!("{path}: must be a number or a list in one line, such as 0.03 or [1e-3, 1e-3, 2e-3]")),
    }
}

/// All that is known or missing, in the order of the file.
fn entries(vehicle: &VehicleNumbers, neglect_products: bool) -> Vec<Entry> {
    let mut entries = Vec::new();
    let mut add = |path: &str, value: Option<String>| {
        entries.push(Entry { path: path.to_owned(), value, comments: Vec::new() });
    };
    let number = |number: f64| Number(number).to_string();
    add("vehicle.mass", vehicle.mass.map(number));
    add("vehicle.inertia", vehicle.inertia.map(|matrix| inertia(&matrix, neglect_products)));
    if let Some(gravity) = vehicle.gravity {
        add("vehicle.gravity", Some(number(gravity)));
    }
    match &vehicle.actuation {
        Actuation::Wrench { thrust_max, torque_max } => {
            add("limits.thrust_max", Some(number(*thrust_max)));
            add("limits.torque_max", Some(vector(torque_max)));
        }
        Actuation::Rotors(rotors) => add_rotors(rotors, &mut add),
    }
    let drag = &vehicle.drag;
    if drag.frame != Vector3::zeros() {
        add("drag.frame", Some(vector(&drag.frame)));
    }
    for (path, coefficient) in [
        ("drag.rotor_across", drag.rotor_across),
        ("drag.rotor_along", drag.rotor_along),
        ("drag.translational_lift", drag.translational_lift),
        ("drag.flapping", drag.flapping),
    ] {
        if coefficient != 0.0 {
            add(path, Some(number(coefficient)));
        }
    }
    if let Some(matrix) = vehicle.inertia.filter(|matrix| !is_diagonal(matrix)) {
        let [xy, xz, yz] = [(0, 1), (0, 2), (1, 2)].map(|place| Number(matrix[place]).to_string());
        let note = if neglect_products {
            format!("products of inertia neglected: xy = {xy}, xz = {xz}, yz = {yz}")
        } else {
            "the whole matrix: its products of inertia must be zero (certify says by which angles the axes are off): \
             turn the axes, balance the vehicle, or neglect them (--neglect-products)"
                .to_owned()
        };
        entries.iter_mut().filter(|entry| entry.path == "vehicle.inertia").for_each(|e| e.comments.push(note.clone()));
    }
    entries
}

fn add_rotors(rotors: &RotorNumbers, add: &mut impl FnMut(&str, Option<String>)) {
    let number = |number: f64| Number(number).to_string();
    let position = rotors.position.as_ref().map(|all| {
        let rows: Vec<String> = all.iter().map(|position| format!("    {},\n", vector(position))).collect();
        format!("[\n{}]", rows.concat())
    });
    let spin = rotors.spin.as_ref().map(|all| {
        let name = |spin: &Spin| if *spin == Spin::Clockwise { "\"cw\"" } else { "\"ccw\"" };
        format!("[{}]", all.iter().map(name).collect::<Vec<_>>().join(", "))
    });
    add("rotors.position", position);
    add("rotors.spin", spin);
    match &rotors.thrust {
        Thrust::BySpeed { thrust_coefficient, drag_coefficient, speed } => {
            add("rotors.thrust_coefficient", thrust_coefficient.map(number));
            add("rotors.drag_coefficient", drag_coefficient.map(number));
            add("rotors.speed", speed.map(|speed| array(&speed)));
        }
        Thrust::Greatest { thrust_min, thrust_max, torque_per_thrust } => {
            if *thrust_min > 0.0 {
                add("rotors.thrust_min", Some(number(*thrust_min)));
            }
            add("rotors.thrust_max", thrust_max.map(number));
            add("rotors.torque_per_thrust", torque_per_thrust.map(number));
        }
    }
    add("rotors.lag", rotors.lag.map(number));
}

fn vector(vector: &Vector3<f64>) -> String {
    // Without a negative zero.
    array(&[vector.x + 0.0, vector.y + 0.0, vector.z + 0.0])
}

fn is_diagonal(matrix: &Matrix3<f64>) -> bool {
    (matrix - Matrix3::from_diagonal(&matrix.diagonal())).amax() <= INERTIA_PRODUCT_SHARE * matrix.diagonal().amax()
}

/// The moments of a diagonal matrix, or all of it.
fn inertia(matrix: &Matrix3<f64>, neglect_products: bool) -> String {
    if neglect_products || is_diagonal(matrix) {
        return vector(&matrix.diagonal());
    }
    let rows: Vec<String> = matrix.row_iter().map(|row| format!("    {},\n", vector(&row.transpose()))).collect();
    format!("[\n{}]", rows.concat())
}
