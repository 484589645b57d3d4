//! Gazebo's motor model: one plugin for each rotor, by the names that its versions had.

use super::xml::{child, child_number, numbers, place, text};
use controller_core::allocation::Spin;
use roxmltree::Node;

/// What the plugin has in the name of its file.
const PLUGIN_FILES: [&str; 2] = ["multicopter-motor-model", "gazebo_motor_model"];
/// How the plugin's own name ends where its file is called otherwise, in `gz::sim::systems` as in `ignition::gazebo`.
const PLUGIN_CLASS: &str = "::MulticopterMotorModel";
/// The motor's number: the newer name and the older one.
const MOTOR_NUMBER: [&str; 2] = ["actuator_number", "motorNumber"];

/// What a motor model may state.
pub const MOTOR_NUMBERS: [&str; 6] =
    ["motorConstant", "momentConstant", "maxRotVelocity", "timeConstantUp", "timeConstantDown", "rotorDragCoefficient"];

/// One motor.
pub struct Motor {
    /// What errors call it.
    pub place: String,
    /// The whole name of the model that it is in.
    pub model: String,
    /// What that model calls its link.
    pub link: String,
    /// Its place among the motors.
    pub number: f64,
    /// Seen from above.
    pub spin: Spin,
    /// In the order of [`MOTOR_NUMBERS`].
    pub numbers: [Option<f64>; MOTOR_NUMBERS.len()],
}

/// Whether an element is a motor model.
#[must_use]
pub fn is_motor(node: &Node) -> bool {
    let [file, name] = ["filename", "name"].map(|of| node.attribute(of).unwrap_or_default());
    node.has_tag_name("plugin")
        && (PLUGIN_FILES.iter().any(|known| file.contains(known)) || name.ends_with(PLUGIN_CLASS))
}

/// Reads the motor of `plugin` in `model`.
///
/// # Errors
/// Names what is missing or no number.
pub fn motor(plugin: &Node, model: &str) -> Result<Motor, String> {
    let required = |name: &str| child(plugin, name).ok_or_else(|| format!("{}: no <{name}>", place(plugin)));
    let [link, turns] = ["linkName", "turningDirection"].map(required);
    let (link, turns) = (link?, turns?);
    let number = MOTOR_NUMBER.iter().find_map(|name| child(plugin, name));
    let number = number.ok_or_else(|| format!("{}: no <{}>", place(plugin), MOTOR_NUMBER.join("> or <")))?;
    let [number] = numbers(&number, "", text(&number))?;
    let place = format!("{} of motor {number}", place(plugin));
    let spin = match text(&turns) {
        "cw" => Spin::Clockwise,
        "ccw" => Spin::CounterClockwise,
        other => return Err(format!("{place}: turningDirection: must be cw or ccw, found {other:?}")),
    };
    let mut stated = [None; MOTOR_NUMBERS.len()];
    for (value, name) in stated.iter_mut().zip(MOTOR_NUMBERS) {
        *value = child_number(plugin, name)?;
        if let Some(value) = value.filter(|value| *value < 0.0) {
            return Err(format!("{place}: {name}: must not be negative, found {value}"));
        }
    }
    Ok(Motor { place, model: model.to_owned(), link: text(&link).to_owned(), number, spin, numbers: stated })
}
