//! SDF of Gazebo with its motor model, as PX4's models have it: `gz-sim-multicopter-motor-model-system`, or the older
//! `libgazebo_motor_model.so`.
//!
//! All links are put together as they stand at zero joint angles, those of included models too: `model://NAME` is
//! looked for where PX4's repositories have it, in `NAME/model.sdf` beside the folder of the file. A motor's thrust is
//! `motorConstant` w^2, its torque `momentConstant` times that, w at most `maxRotVelocity` (rad/s); `ccw` and `cw` are
//! seen from above. Our rotors have one lag: the slower of `timeConstantUp` and `timeConstantDown`.
//! `rotorDragCoefficient` is kg/rad, across the rotor; `rollingMomentCoefficient` has no counterpart.

use super::numbers::{Actuation, RotorNumbers, Thrust, VehicleNumbers, alike};
use super::rigid::{Part, inertia, pose, upright};
use super::xml::{child, child_number, children, document, mass, numbers, place, text};
use controller_core::allocation::Spin;
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};
use roxmltree::Node;
use std::collections::HashMap;
use std::path::Path;

/// What the motor model's plugin has in the name of its file.
const MOTOR_MODELS: [&str; 2] = ["multicopter-motor-model", "gazebo_motor_model"];
/// How deep models may include each other.
const DEEPEST: usize = 8;
/// The most links, and the most included models, of a vehicle.
const MOST: usize = 200;

/// A model with what it includes.
#[derive(Default)]
struct Model {
    parts: Vec<Part>,
    links: HashMap<String, Isometry3<f64>>,
    motors: Vec<Motor>,
    included: usize,
}

/// One motor model.
struct Motor {
    place: String,
    link: String,
    number: f64,
    spin: Spin,
    /// In the order of [`NUMBERS`].
    numbers: [Option<f64>; NUMBERS.len()],
}

/// What a motor model may state.
const NUMBERS: [&str; 6] =
    ["motorConstant", "momentConstant", "maxRotVelocity", "timeConstantUp", "timeConstantDown", "rotorDragCoefficient"];

/// Reads the document of `sdf`, which stands in `file`.
///
/// # Errors
/// Names the element, of an included file as well.
pub fn read(sdf: &Node, file: &Path) -> Result<VehicleNumbers, String> {
    let mut model = Model::default();
    model.add(&model_of(sdf)?, &Isometry3::identity(), file, 0)?;
    let whole = Part::together(&model.parts);
    let centre = whole.map(|whole| whole.centre).unwrap_or_default();
    model.motors.sort_by(|a, b| a.number.total_cmp(&b.number));
    for pair in model.motors.windows(2) {
        if pair[0].number == pair[1].number {
            return Err(format!("{}: motorNumber {} is another's already", pair[1].place, pair[1].number));
        }
    }
    let mut position = Vec::new();
    for motor in &model.motors {
        let stands = model.links.get(&motor.link).ok_or_else(|| {
            format!(
                "{}: linkName: there is no link {:?} in the model, nor in what it includes",
                motor.place, motor.link
            )
        })?;
        position.push(upright(&motor.place, stands)? - centre);
    }
    let mut of_all = [None; NUMBERS.len()];
    for (index, (number, name)) in of_all.iter_mut().zip(NUMBERS).enumerate() {
        let stated: Vec<_> =
            model.motors.iter().filter_map(|motor| Some((motor.place.clone(), motor.numbers[index]?))).collect();
        if !stated.is_empty() && stated.len() < model.motors.len() {
            return Err(format!("{}: {name}: the other motors do not state it; state it for all", stated[0].0));
        }
        *number = alike(name, &stated)?;
    }
    let [thrust, moment, speed, up, down, across] = of_all;
    let rotors = RotorNumbers {
        position: Some(position).filter(|position| !position.is_empty()),
        spin: Some(model.motors.iter().map(|motor| motor.spin).collect::<Vec<_>>()).filter(|spin| !spin.is_empty()),
        thrust: Thrust::BySpeed {
            thrust_coefficient: thrust,
            drag_coefficient: thrust.zip(moment).map(|(thrust, moment)| thrust * moment),
            speed: speed.map(|greatest| [0.0, greatest]),
        },
        lag: up.into_iter().chain(down).reduce(f64::max),
    };
    let mut vehicle = VehicleNumbers::new("SDF of Gazebo with its motor model", Actuation::Rotors(rotors));
    (vehicle.mass, vehicle.inertia) = (whole.map(|whole| whole.mass), whole.map(|whole| whole.inertia));
    vehicle.drag.rotor_across = across.unwrap_or(0.0);
    if let (Some(up), Some(down)) = (up, down)
        && up != down
    {
        let note = format!("the slower of timeConstantUp = {up} and timeConstantDown = {down}");
        vehicle.notes.push(("rotors.lag", note));
    }
    Ok(vehicle)
}

/// The model of a document: its own, or the first of its world with a motor.
fn model_of<'a, 'input>(sdf: &Node<'a, 'input>) -> Result<Node<'a, 'input>, String> {
    let worlds = children(sdf, "world").flat_map(|world| world.children().filter(|node| node.has_tag_name("model")));
    let mut models = children(sdf, "model").chain(worlds);
    let first = models.next().ok_or_else(|| "<sdf>: no <model> in it".to_owned())?;
    Ok(std::iter::once(first).chain(models).find(|model| model.descendants().any(|n| is_motor(&n))).unwrap_or(first))
}

fn is_motor(node: &Node) -> bool {
    let file = node.attribute("filename").unwrap_or_default();
    node.has_tag_name("plugin") && MOTOR_MODELS.iter().any(|model| file.contains(model))
}

impl Model {
    /// Adds a `<model>` of `file`, whose frame stands at `stands`. What it includes comes first: its own links may
    /// stand relative to those.
    fn add(&mut self, model: &Node, stands: &Isometry3<f64>, file: &Path, depth: usize) -> Result<(), String> {
        for nested in children(model, "model") {
            let frame = self.frame(&nested, stands)?;
            self.add(&nested, &frame, file, depth)?;
        }
        children(model, "include").try_for_each(|include| self.include(&include, stands, file, depth))?;
        for link in children(model, "link") {
            let name = link.attribute("name").unwrap_or_default();
            let frame = self.frame(&link, stands)?;
            if self.links.insert(name.to_owned(), frame).is_some() {
                return Err(format!("{}: there is another link of this name", place(&link)));
            }
            if self.links.len() > MOST {
                return Err(format!("{}: more than {MOST} links", place(&link)));
            }
            self.parts.push(part(&link)?.placed(&frame));
        }
        for plugin in model.children().filter(is_motor) {
            self.motors.push(motor(&plugin)?);
        }
        Ok(())
    }

    fn include(&mut self, include: &Node, stands: &Isometry3<f64>, file: &Path, depth: usize) -> Result<(), String> {
        let place = place(include);
        let uri = child(include, "uri").map(|uri| text(&uri).to_owned()).unwrap_or_default();
        let name = uri.strip_prefix("model://").unwrap_or(&uri);
        if name.is_empty() || name.contains(['/', '\\']) || name.starts_with('.') {
            return Err(format!("{place}: uri: must be model://NAME, found {uri:?}"));
        }
        self.included += 1;
        if depth >= DEEPEST || self.included > MOST {
            return Err(format!("{place}: models include each other more than {DEEPEST} deep, or {MOST} times"));
        }
        // The folder of the file is the model's; its neighbours are the others.
        let folder = file.parent().map(Path::to_path_buf).unwrap_or_default();
        let included = folder.join("..").join(name).join("model.sdf");
        let of_it = |what: String| format!("{place}: {}: {what}", included.display());
        let text = scenario::text::read(&included).map_err(|error| {
            of_it(format!("cannot be read: {error}; put the included model there: without it mass is not known"))
        })?;
        let document = document(&text).map_err(of_it)?;
        let model = model_of(&document.root_element()).map_err(of_it)?;
        // Where the include does not say where, the model does itself.
        let says = if child(include, "pose").is_some() { include } else { &model };
        let frame = self.frame(says, stands).map_err(of_it)?;
        self.add(&model, &frame, &included, depth + 1).map_err(of_it)
    }

    /// Where an element with a `<pose>` stands: in the frame at `stands`, or relative to a link that is there already.
    fn frame(&self, node: &Node, stands: &Isometry3<f64>) -> Result<Isometry3<f64>, String> {
        let (relative_to, pose) = pose_of(node)?;
        let Some(link) = relative_to else { return Ok(stands * pose) };
        self.links.get(link).map(|frame| frame * pose).ok_or_else(|| {
            format!(
                "{}: relative_to={link:?}: must be a link before it, or be left out for the model's frame",
                place(node)
            )
        })
    }
}

/// `<pose>` of an element, and the link that it is relative to if not to its model.
fn pose_of<'a>(node: &Node<'a, '_>) -> Result<(Option<&'a str>, Isometry3<f64>), String> {
    let Some(element) = child(node, "pose") else { return Ok((None, Isometry3::identity())) };
    let relative_to = element.attribute("relative_to").filter(|frame| !["", "__model__"].contains(frame));
    let written = text(&element);
    if written.is_empty() {
        return Ok((relative_to, Isometry3::identity()));
    }
    if element.attribute("rotation_format") == Some("quat_xyzw") {
        let [x, y, z, i, j, k, w] = numbers(&element, "", written)?;
        let rotation = UnitQuaternion::try_new(Quaternion::new(w, i, j, k), 1e-6)
            .ok_or_else(|| format!("{}: the quaternion must not be zero", place(&element)))?;
        return Ok((relative_to, Isometry3::from_parts(Translation3::new(x, y, z), rotation)));
    }
    let [x, y, z, angles @ ..]: [f64; 6] = numbers(&element, "", written)?;
    let is_degrees = element.attribute("degrees") == Some("true");
    Ok((relative_to, pose([x, y, z], if is_degrees { angles.map(f64::to_radians) } else { angles })))
}

/// What a link weighs, in its own frame.
fn part(link: &Node) -> Result<Part, String> {
    let inertial = child(link, "inertial");
    let given = inertial.as_ref().and_then(|inertial| Some((child(inertial, "mass")?, child(inertial, "inertia")?)));
    let (Some(inertial), Some((weight, moments))) = (inertial, given) else {
        return Err(format!(
            "{}: no <inertial> with <mass> and <inertia>: Gazebo would take 1 kg and 1 kg m^2; say what the link weighs",
            place(link)
        ));
    };
    let weight = mass(&weight, numbers(&weight, "", text(&weight)).map(|[kg]| kg)?)?;
    let mut values = [0.0; 6];
    for (value, name) in values.iter_mut().zip(["ixx", "iyy", "izz", "ixy", "ixz", "iyz"]) {
        *value = match child_number(&moments, name)? {
            Some(value) => value,
            None if ["ixx", "iyy", "izz"].contains(&name) => return Err(format!("{}: no <{name}>", place(&moments))),
            None => 0.0,
        };
    }
    let own = Part { mass: weight, centre: Vector3::zeros(), inertia: inertia(values) };
    match pose_of(&inertial)? {
        (None, pose) => Ok(own.placed(&pose)),
        (Some(frame), _) => {
            Err(format!("{}: relative_to={frame:?}: must be in the link's own frame", place(&inertial)))
        }
    }
}

fn motor(plugin: &Node) -> Result<Motor, String> {
    let required = |name: &str| child(plugin, name).ok_or_else(|| format!("{}: no <{name}>", place(plugin)));
    let [link, turns, number] = ["linkName", "turningDirection", "motorNumber"].map(required);
    let (link, turns, number) = (link?, turns?, number?);
    let number = numbers(&number, "", text(&number)).map(|[number]| number)?;
    let place = format!("{} of motor {number}", place(plugin));
    let spin = match text(&turns) {
        "cw" => Spin::Clockwise,
        "ccw" => Spin::CounterClockwise,
        other => return Err(format!("{place}: turningDirection: must be cw or ccw, found {other:?}")),
    };
    let mut stated = [None; NUMBERS.len()];
    for (value, name) in stated.iter_mut().zip(NUMBERS) {
        *value = child_number(plugin, name)?;
        if let Some(value) = value.filter(|value| *value < 0.0) {
            return Err(format!("{place}: {name}: must not be negative, found {value}"));
        }
    }
    // In an included model a link is called MODEL::LINK.
    let link = text(&link).rsplit("::").next().unwrap_or_default().to_owned();
    Ok(Motor { place, link, number, spin, numbers: stated })
}
