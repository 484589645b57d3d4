//! URDF in the dialect of gym-pybullet-drones: `<properties>` beside the links of ordinary URDF.
//!
//! All links are put together as they stand at zero joint angles. Links called `prop0_link`, `prop1_link`, … are
//! rotors, where their own inertial frames stand. `kf` and `km` are per (revolution/minute)^2 and become per (rad/s)^2;
//! the greatest speed is the one that lifts `thrust2weight` times the weight; `drag_coeff_xy` and `drag_coeff_z` are
//! kg/rad per rotor. Which rotor turns which way is not in the file but in the simulator: the torque of prop0 is about
//! -z, and they alternate; of the robot `racer` the other way round.

use super::numbers::{Actuation, RotorNumbers, Thrust, VehicleNumbers};
use super::rigid::{Part, inertia, pose, upright};
use super::xml::{attribute, attribute_numbers, child, children, mass, number, place};
use controller_core::allocation::Spin;
use nalgebra::Isometry3;
use roxmltree::Node;
use std::collections::HashMap;
use std::f64::consts::TAU;

/// rad/s of a revolution a minute.
const PER_MINUTE: f64 = TAU / 60.0;
/// `thrust2weight` counts a weight with it.
const WEIGHT_GRAVITY_M_PER_S2: f64 = 9.81;
const LINKS_MAX: usize = 200;
/// The robot whose rotors turn the other way.
const RACER_ROBOT: &str = "racer";

/// Reads the document of `robot`.
///
/// # Errors
/// Names the element.
pub fn read(robot: &Node) -> Result<VehicleNumbers, String> {
    if robot.descendants().any(|node| node.tag_name().namespace().is_some()) {
        return Err("is a xacro file, a program that makes a URDF: run `xacro FILE > FILE.urdf` first".to_owned());
    }
    let mut parts = Vec::new();
    let mut rotors = Vec::new();
    for (link, stands) in links(robot)? {
        let Some(inertial) = child(&link, "inertial") else { continue };
        let frame = stands * origin(&inertial)?;
        let given = |name: &str| child(&inertial, name).ok_or_else(|| format!("{}: no <{name}>", place(&inertial)));
        let weight = given("mass")?;
        let weight = mass(&weight, number(&weight, "value", attribute(&weight, "value")?)?)?;
        let moments = given("inertia")?;
        let mut values = [0.0; 6];
        for (value, name) in values.iter_mut().zip(["ixx", "iyy", "izz", "ixy", "ixz", "iyz"]) {
            *value = number(&moments, name, attribute(&moments, name)?)?;
        }
        let part = Part { mass: weight, centre: nalgebra::Vector3::zeros(), inertia: inertia(values) };
        parts.push(part.placed(&frame));
        if let Some(index) = rotor_index(link.attribute("name").unwrap_or_default()) {
            rotors.push((index, upright(&place(&link), &frame)?));
        }
    }
    let whole = Part::together(&parts);
    rotors.sort_by_key(|(index, _)| *index);
    let centre = whole.map(|whole| whole.centre).unwrap_or_default();
    let position: Vec<_> = rotors.iter().map(|(_, position)| position - centre).collect();
    let is_racer = robot.attribute("name") == Some(RACER_ROBOT);
    let properties = child(robot, "properties");
    let spin = position.iter().enumerate().map(|(index, _)| match (index % 2 == 0) ^ is_racer {
        true => Spin::CounterClockwise,
        false => Spin::Clockwise,
    });
    let spin = properties.map(|_| spin.collect::<Vec<_>>()).filter(|spin| !spin.is_empty());
    let has_spin = spin.is_some();
    let thrust = thrust(properties.as_ref(), whole.map(|whole| whole.mass), position.len())?;
    let position = Some(position).filter(|position| !position.is_empty());
    let rotors = RotorNumbers { position, spin, thrust, lag: None };
    let mut vehicle = VehicleNumbers::new("URDF of gym-pybullet-drones' kind", Actuation::Rotors(rotors));
    (vehicle.mass, vehicle.inertia) = (whole.map(|whole| whole.mass), whole.map(|whole| whole.inertia));
    if has_spin {
        let which = if is_racer { "prop0 turns cw, as of its racer" } else { "prop0 turns ccw" };
        vehicle.notes.push((
            "rotors.spin",
            format!("not in the source: gym-pybullet-drones' own convention, {which}, and they alternate"),
        ));
    }
    if let Some(properties) = properties {
        let coefficient = |name: &str| attribute_numbers(&properties, name, [0.0]).map(|[value]| value);
        vehicle.drag.rotor_across = coefficient("drag_coeff_xy")?;
        vehicle.drag.rotor_along = coefficient("drag_coeff_z")?;
    }
    Ok(vehicle)
}

/// Every link, and where it stands in the frame of the root.
fn links<'a, 'input>(robot: &Node<'a, 'input>) -> Result<Vec<(Node<'a, 'input>, Isometry3<f64>)>, String> {
    if let Some(link) = children(robot, "link").nth(LINKS_MAX) {
        return Err(format!("{}: more than {LINKS_MAX} links", place(&link)));
    }
    let mut joints = HashMap::new();
    for joint in children(robot, "joint") {
        let link = |name: &str| {
            let end = child(&joint, name).ok_or_else(|| format!("{}: no <{name}>", place(&joint)))?;
            attribute(&end, "link")
        };
        if joints.insert(link("child")?, (link("parent")?, origin(&joint)?)).is_some() {
            return Err(format!("{}: its child hangs on another joint already", place(&joint)));
        }
    }
    let mut stands = Vec::new();
    for link in children(robot, "link") {
        let (mut at, mut pose) = (attribute(&link, "name")?, Isometry3::identity());
        let mut steps = 0;
        while let Some((parent, origin)) = joints.get(at) {
            (at, pose) = (parent, origin * pose);
            steps += 1;
            if steps > joints.len() {
                return Err(format!("{}: its joints lead round in a circle", place(&link)));
            }
        }
        stands.push((link, pose));
    }
    Ok(stands)
}

/// `<origin>` of an element.
fn origin(node: &Node) -> Result<Isometry3<f64>, String> {
    let Some(origin) = child(node, "origin") else { return Ok(Isometry3::identity()) };
    let [xyz, rpy] = ["xyz", "rpy"].map(|name| attribute_numbers(&origin, name, [0.0; 3]));
    Ok(pose(xyz?, rpy?))
}

/// N of `propN_link`.
fn rotor_index(link: &str) -> Option<u32> {
    link.strip_prefix("prop")?.strip_suffix("_link")?.parse().ok()
}

fn thrust(properties: Option<&Node>, mass: Option<f64>, rotors: usize) -> Result<Thrust, String> {
    let Some(properties) = properties else {
        return Ok(Thrust::Greatest { thrust_min: 0.0, thrust_max: None, torque_per_thrust: None });
    };
    let positive = |name: &str| -> Result<Option<f64>, String> {
        let Some(text) = properties.attribute(name) else { return Ok(None) };
        match number(properties, name, text)? {
            value if value > 0.0 => Ok(Some(value)),
            value => Err(format!("{}: {name}: must be greater than zero, found {value}", place(properties))),
        }
    };
    let (kf, km, lift) = (positive("kf")?, positive("km")?, positive("thrust2weight")?);
    let greatest = kf.zip(mass).zip(lift).filter(|_| rotors > 0).map(|((kf, mass), lift)| {
        let each = lift * mass * WEIGHT_GRAVITY_M_PER_S2 / rotors as f64;
        (each / kf).sqrt() * PER_MINUTE
    });
    Ok(Thrust::BySpeed {
        thrust_coefficient: kf.map(|kf| kf / PER_MINUTE.powi(2)),
        drag_coefficient: km.map(|km| km / PER_MINUTE.powi(2)),
        speed: greatest.map(|greatest| [0.0, greatest]),
    })
}
