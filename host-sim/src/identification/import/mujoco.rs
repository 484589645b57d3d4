//! MuJoCo's XML (MJCF): the free body of the model, with all that hangs on it, and its `<motor>` or `<general>`
//! actuators at sites.
//!
//! An actuator whose gear pushes along its site's z is a rotor: its thrust is gear times control, its torque about z is
//! `gear[5]` over `gear[2]` of that, positive for a rotor that turns clockwise seen from above. One that pushes, and
//! three that only turn, are the whole vehicle's thrust and torque: the model has no rotors then. MuJoCo knows neither
//! speeds nor a lag of rotors. Its fluid (`density`, `viscosity`) is not carried over.
//!
//! Without `<inertial>` a body weighs what its geoms do; meshes are not read, so one that weighs anything leaves mass
//! and inertia missing.

use super::mujoco_frames::{Settings, frame, weight};
use super::numbers::{Actuation, RotorNumbers, Thrust, VehicleNumbers, alike};
use super::rigid::{Part, upright};
use super::xml::{children, number, numbers, place};
use controller_core::allocation::Spin;
use nalgebra::{Isometry3, Vector3};
use roxmltree::Node;
use std::collections::HashMap;

/// What actuators can be that push or turn at a site.
const ACTUATOR_ELEMENTS: [&str; 2] = ["motor", "general"];

/// Reads the document of `mujoco`.
///
/// # Errors
/// Names the element.
pub fn read(mujoco: &Node) -> Result<VehicleNumbers, String> {
    let settings = Settings::read(mujoco)?;
    let mut bodies =
        children(mujoco, "worldbody").flat_map(|world| world.children().filter(|n| n.has_tag_name("body")));
    let Some(vehicle) = bodies.find(is_free) else {
        if let Some(include) = children(mujoco, "include").next() {
            return Err(format!("{}: holds the vehicle, and is not read: give that file", place(&include)));
        }
        return Err("<mujoco>: no body in <worldbody> with a <freejoint>: nothing in it flies".to_owned());
    };
    let mut body = Body::default();
    body.add(&vehicle, &Isometry3::identity(), &settings)?;
    let whole = Part::together(&body.parts).filter(|_| body.unknown.is_none());
    let mut actuators = Vec::new();
    for node in children(mujoco, "actuator").flat_map(|list| list.children()) {
        if ACTUATOR_ELEMENTS.contains(&node.tag_name().name()) {
            actuators.extend(Actuator::read(&node, &body, &settings)?);
        }
    }
    let centre = whole.map(|whole| whole.centre).unwrap_or_default();
    let pushing = actuators.iter().filter(|actuator| actuator.gear[2] != 0.0).count();
    let mut numbers = VehicleNumbers::new("MuJoCo's XML", actuation(&actuators, pushing, &centre)?);
    (numbers.mass, numbers.inertia) = (whole.map(|whole| whole.mass), whole.map(|whole| whole.inertia));
    numbers.gravity = settings.gravity;
    if let Some(place) = body.unknown {
        numbers
            .notes
            .push(("vehicle.mass", format!("not known from the source: {place} is a mesh, which is not read")));
    }
    Ok(numbers)
}

fn is_free(body: &Node) -> bool {
    body.children()
        .any(|n| n.has_tag_name("freejoint") || n.has_tag_name("joint") && n.attribute("type") == Some("free"))
}

/// The vehicle, put together in the frame of its outermost body.
#[derive(Default)]
struct Body {
    parts: Vec<Part>,
    sites: HashMap<String, Isometry3<f64>>,
    /// A mesh that weighs something.
    unknown: Option<String>,
}

impl Body {
    fn add(&mut self, body: &Node, stands: &Isometry3<f64>, settings: &Settings) -> Result<(), String> {
        for site in children(body, "site") {
            let name = site.attribute("name").unwrap_or_default().to_owned();
            self.sites.insert(name, stands * frame(&site, settings)?);
        }
        match weight(body, settings) {
            Ok(parts) => self.parts.extend(parts.iter().map(|part| part.placed(stands))),
            Err(Ok(mesh)) => self.unknown = Some(mesh),
            Err(Err(problem)) => return Err(problem),
        }
        for child in children(body, "body") {
            self.add(&child, &(stands * frame(&child, settings)?), settings)?;
        }
        Ok(())
    }
}

/// One actuator at a site of the vehicle.
struct Actuator {
    place: String,
    stands: Isometry3<f64>,
    gear: [f64; 6],
    /// Least and greatest, N or N m for a gear of 1.
    range: Option<[f64; 2]>,
}

impl Actuator {
    /// None if it is at no site of the vehicle.
    fn read(node: &Node, body: &Body, settings: &Settings) -> Result<Option<Self>, String> {
        let get = |name: &str| settings.attribute(node, name);
        let site = get("site");
        let Some(stands) = site.and_then(|site| body.sites.get(site)) else { return Ok(None) };
        let gear = numbers(node, "gear", get("gear").unwrap_or("1 0 0 0 0 0"))?;
        let gain = match get("gainprm").filter(|_| node.has_tag_name("general")) {
            Some(text) => text.split_whitespace().next().map_or(Ok(1.0), |first| number(node, "gainprm", first))?,
            None => 1.0,
        };
        let range = |name: &str| get(name).map(|text| numbers::<2>(node, name, text)).transpose();
        let range = match (range("ctrlrange")?.map(|range| range.map(|end| gain * end)), range("forcerange")?) {
            (Some([least, greatest]), Some([floor, ceiling])) => Some([least.max(floor), greatest.min(ceiling)]),
            (one, other) => one.or(other),
        };
        if range.is_some_and(|[least, greatest]| least >= greatest) {
            return Err(format!("{}: its range must rise", place(node)));
        }
        Ok(Some(Self { place: place(node), stands: *stands, gear, range }))
    }

    /// What it gives along or about an axis of its gear, least and greatest.
    fn given(&self, axis: usize) -> Result<[f64; 2], String> {
        let range = self.range.ok_or_else(|| format!("{}: no ctrlrange: its greatest is not known", self.place))?;
        let ends = range.map(|end| end * self.gear[axis]);
        Ok([ends[0].min(ends[1]), ends[0].max(ends[1])])
    }
}

/// What `actuators` are together, of which some are `pushing`.
fn actuation(actuators: &[Actuator], pushing: usize, centre: &Vector3<f64>) -> Result<Actuation, String> {
    if let Some(across) = actuators.iter().find(|actuator| actuator.gear[0] != 0.0 || actuator.gear[1] != 0.0) {
        return Err(format!("{}: gear: must push along its site's z alone, [0, 0, push, …]", across.place));
    }
    if pushing == 1 {
        return wrench(actuators);
    }
    let mut position = Vec::new();
    let mut spin = Vec::new();
    let (mut least, mut greatest, mut ratio) = (Vec::new(), Vec::new(), Vec::new());
    for actuator in actuators {
        let Actuator { place, gear, stands, .. } = actuator;
        if gear[2] <= 0.0 || gear[3] != 0.0 || gear[4] != 0.0 {
            return Err(format!("{place}: gear: of a rotor must be [0, 0, push, 0, 0, turn], push above zero"));
        }
        position.push(upright(place, stands)? - centre);
        let [from, to] = actuator.given(2)?;
        least.push((place.clone(), from));
        greatest.push((place.clone(), to));
        ratio.push((place.clone(), gear[5].abs() / gear[2]));
        spin.push(if gear[5] > 0.0 { Spin::Clockwise } else { Spin::CounterClockwise });
    }
    let ratio = alike("gear[5] / gear[2]", &ratio)?.filter(|ratio| *ratio > 0.0);
    Ok(Actuation::Rotors(RotorNumbers {
        spin: Some(spin).filter(|_| ratio.is_some()),
        position: Some(position).filter(|position| !position.is_empty()),
        thrust: Thrust::Greatest {
            thrust_min: alike("the least thrust", &least)?.unwrap_or(0.0).max(0.0),
            thrust_max: alike("the greatest thrust", &greatest)?,
            torque_per_thrust: ratio,
        },
        lag: None,
    }))
}

/// One actuator that pushes the whole vehicle and three that turn it.
fn wrench(actuators: &[Actuator]) -> Result<Actuation, String> {
    let mut thrust_max = 0.0;
    let mut torque_max = Vector3::zeros();
    for actuator in actuators {
        upright(&actuator.place, &actuator.stands)?;
        let driven: Vec<usize> = (2..6).filter(|&axis| actuator.gear[axis] != 0.0).collect();
        let &[axis] = driven.as_slice() else {
            return Err(format!("{}: gear: must push or turn along one axis, as its neighbours do", actuator.place));
        };
        let [least, greatest] = actuator.given(axis)?;
        match axis {
            2 => thrust_max = greatest,
            _ => torque_max[axis - 3] = greatest.min(-least),
        }
    }
    if thrust_max > 0.0 && torque_max.min() > 0.0 {
        return Ok(Actuation::Wrench { thrust_max, torque_max });
    }
    Err("<actuator>: one actuator pushes the vehicle, so one each must turn it about x, y and z, to either side"
        .to_owned())
}
