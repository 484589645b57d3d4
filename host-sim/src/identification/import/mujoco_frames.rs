//! MuJoCo's settings, defaults, frames and weights: what stands in a file once and holds for many elements, where
//! elements stand in their body, and what a body weighs.

use super::rigid::{Part, inertia};
use super::xml::{attribute_numbers, child, children, mass, number, numbers, place};
use nalgebra::{Isometry3, Matrix3, Quaternion, Translation3, UnitQuaternion, Vector3};
use roxmltree::Node;
use std::f64::consts::PI;

/// MuJoCo's density of a geom that states neither mass nor density.
const DENSITY_KG_PER_M3: f64 = 1000.0;
/// Ways to write an orientation that are not read.
const NOT_READ: [&str; 2] = ["xyaxes", "zaxis"];

/// What holds for a whole file.
pub struct Settings<'a, 'input> {
    /// The outermost `<default>`.
    defaults: Option<Node<'a, 'input>>,
    is_degrees: bool,
    /// Whether geoms count although there is an `<inertial>`; whether they count without it.
    from_geoms: (bool, bool),
    /// m/s^2, downwards.
    pub gravity: Option<f64>,
}

impl<'a, 'input> Settings<'a, 'input> {
    /// Reads `<compiler>`, `<option>` and `<default>`.
    ///
    /// # Errors
    /// Names the element that is not understood.
    pub fn read(mujoco: &Node<'a, 'input>) -> Result<Self, String> {
        let compilers: Vec<_> = children(mujoco, "compiler").collect();
        let set = |name: &str| compilers.iter().rev().find_map(|node| Some((node, node.attribute(name)?)));
        for (name, usual) in [("coordinate", "local"), ("eulerseq", "xyz")] {
            if let Some((node, other)) = set(name).filter(|(_, value)| *value != usual) {
                return Err(format!("{}: {name}: must be {usual:?} here, found {other:?}", place(node)));
            }
        }
        let from_geoms = match set("inertiafromgeom").map(|(_, value)| value) {
            Some("true") => (true, true),
            Some("false") => (false, false),
            _ => (false, true),
        };
        let is_degrees = set("angle").is_none_or(|(_, unit)| unit != "radian");
        let mut gravity = None;
        for option in children(mujoco, "option").filter(|option| option.has_attribute("gravity")) {
            let [x, y, z] = attribute_numbers(&option, "gravity", [0.0; 3])?;
            if !(x == 0.0 && y == 0.0 && z < 0.0) {
                return Err(format!("{}: gravity: must point down, found {x} {y} {z}", place(&option)));
            }
            gravity = Some(-z);
        }
        Ok(Self { defaults: child(mujoco, "default"), is_degrees, from_geoms, gravity })
    }

    /// An attribute of an element, its own or the one of its class.
    pub fn attribute(&self, node: &Node<'a, 'input>, name: &str) -> Option<&'a str> {
        let inherited = || node.ancestors().skip(1).find_map(|body| body.attribute("childclass"));
        node.attribute(name).or_else(|| {
            let outermost = self.defaults?;
            let class = node.attribute("class").or_else(inherited);
            let chosen = class.and_then(|class| {
                outermost.descendants().find(|n| n.has_tag_name("default") && n.attribute("class") == Some(class))
            });
            // From the class outwards.
            let classes = chosen.unwrap_or(outermost).ancestors().take_while(|n| n.has_tag_name("default"));
            classes
                .flat_map(|class| children(&class, node.tag_name().name()).collect::<Vec<_>>())
                .find_map(|element| element.attribute(name))
        })
    }
}

/// Where an element stands in its body.
///
/// # Errors
/// Names the attribute.
pub fn frame(node: &Node, settings: &Settings) -> Result<Isometry3<f64>, String> {
    if let Some(name) = NOT_READ.into_iter().find(|name| node.has_attribute(*name)) {
        return Err(format!("{}: {name}: is not read: write the orientation as quat=\"w x y z\"", place(node)));
    }
    let [x, y, z] = attribute_numbers(node, "pos", [0.0; 3])?;
    let angle = |written: f64| if settings.is_degrees { written.to_radians() } else { written };
    let refused = |name: &str| format!("{}: {name}: must not be zero", place(node));
    let rotation = if let Some(text) = node.attribute("quat") {
        let [w, i, j, k] = numbers(node, "quat", text)?;
        UnitQuaternion::try_new(Quaternion::new(w, i, j, k), 1e-6).ok_or_else(|| refused("quat"))?
    } else if let Some(text) = node.attribute("euler") {
        // Each turn about the axes that the turns before it left.
        let [x, y, z] = numbers::<3>(node, "euler", text)?.map(angle);
        let about = |axis: Vector3<f64>| UnitQuaternion::new(axis);
        about(Vector3::x() * x) * about(Vector3::y() * y) * about(Vector3::z() * z)
    } else if let Some(text) = node.attribute("axisangle") {
        let [i, j, k, turn] = numbers(node, "axisangle", text)?;
        let axis = Vector3::new(i, j, k).try_normalize(1e-6).ok_or_else(|| refused("axisangle"))?;
        UnitQuaternion::new(axis * angle(turn))
    } else {
        UnitQuaternion::identity()
    };
    Ok(Isometry3::from_parts(Translation3::new(x, y, z), rotation))
}

/// What a body weighs, in its own frame and without those that hang on it.
///
/// # Errors
/// The place of a mesh that weighs something; or what is wrong.
pub fn weight(body: &Node, settings: &Settings) -> Result<Vec<Part>, Result<String, String>> {
    let (always, otherwise) = settings.from_geoms;
    match child(body, "inertial") {
        Some(inertial) if !always => Ok(vec![stated(&inertial, settings).map_err(Err)?]),
        None if !otherwise => Ok(Vec::new()),
        _ => {
            let parts = children(body, "geom").map(|geom| of_geom(&geom, settings)).collect::<Result<Vec<_>, _>>();
            Ok(parts?.into_iter().flatten().collect())
        }
    }
}

/// `<inertial>`.
fn stated(inertial: &Node, settings: &Settings) -> Result<Part, String> {
    let [kg] = numbers(inertial, "mass", super::xml::attribute(inertial, "mass")?)?;
    let matrix = match (inertial.attribute("fullinertia"), inertial.attribute("diaginertia")) {
        (Some(text), _) => inertia(numbers(inertial, "fullinertia", text)?),
        (None, Some(text)) => Matrix3::from_diagonal(&Vector3::from(numbers::<3>(inertial, "diaginertia", text)?)),
        (None, None) => return Err(format!("{}: neither diaginertia nor fullinertia", place(inertial))),
    };
    let own = Part { mass: mass(inertial, kg)?, centre: Vector3::zeros(), inertia: matrix };
    Ok(own.placed(&frame(inertial, settings)?))
}

/// What a geom weighs; none for what has no weight.
fn of_geom(geom: &Node, settings: &Settings) -> Result<Option<Part>, Result<String, String>> {
    let get = |name: &str| settings.attribute(geom, name);
    let given = |name: &str| get(name).map(|text| number(geom, name, text)).transpose().map_err(Err);
    let (kg, density) = (given("mass")?, given("density")?.unwrap_or(DENSITY_KG_PER_M3));
    let kind = get("type").unwrap_or(if geom.has_attribute("mesh") { "mesh" } else { "sphere" });
    if kg == Some(0.0) || kg.is_none() && density == 0.0 || matches!(kind, "plane" | "hfield") {
        return Ok(None);
    }
    if matches!(kind, "mesh" | "sdf") {
        return Err(Ok(place(geom)));
    }
    if geom.has_attribute("fromto") {
        return Err(Err(format!("{}: fromto: is not read: write pos, quat and size", place(geom))));
    }
    let size = get("size").unwrap_or_default();
    let shape = shape(geom, kind, size).map_err(Err)?;
    let kg = mass(geom, kg.unwrap_or(density * shape.volume)).map_err(Err)?;
    let own = Part { mass: kg, centre: Vector3::zeros(), inertia: Matrix3::from_diagonal(&(kg * shape.moments)) };
    Ok(Some(own.placed(&frame(geom, settings).map_err(Err)?)))
}

/// A body of even density about its middle.
struct Shape {
    /// m^3.
    volume: f64,
    /// Of 1 kg of it, m^2.
    moments: Vector3<f64>,
}

/// The shape of a geom with half sizes in `size`.
fn shape(geom: &Node, kind: &str, size: &str) -> Result<Shape, String> {
    let across = |[x, y, z]: [f64; 3]| Vector3::new(y * y + z * z, x * x + z * z, x * x + y * y);
    let shape = match kind {
        "sphere" => {
            let [r] = numbers(geom, "size", size.split_whitespace().next().unwrap_or_default())?;
            Shape { volume: 4.0 / 3.0 * PI * r.powi(3), moments: across([r; 3]) / 5.0 }
        }
        "ellipsoid" => {
            let half: [f64; 3] = numbers(geom, "size", size)?;
            Shape { volume: 4.0 / 3.0 * PI * half.iter().product::<f64>(), moments: across(half) / 5.0 }
        }
        "box" => {
            let half: [f64; 3] = numbers(geom, "size", size)?;
            Shape { volume: 8.0 * half.iter().product::<f64>(), moments: across(half) / 3.0 }
        }
        "cylinder" | "capsule" => {
            let [r, h] = numbers(geom, "size", size)?;
            let (middle, ends) =
                (2.0 * PI * r * r * h, if kind == "capsule" { 4.0 / 3.0 * PI * r.powi(3) } else { 0.0 });
            let along = middle * r * r / 2.0 + ends * 0.4 * r * r;
            let over = middle * (r * r / 4.0 + h * h / 3.0) + ends * (0.4 * r * r + h * h + 0.75 * h * r);
            Shape { volume: middle + ends, moments: Vector3::new(over, over, along) / (middle + ends) }
        }
        other => return Err(format!("{}: type: {other:?} is not read; state the body's <inertial>", place(geom))),
    };
    if shape.volume > 0.0 && shape.volume.is_finite() && shape.moments.iter().all(|moment| moment.is_finite()) {
        return Ok(shape);
    }
    Err(format!("{}: size: must be greater than zero, found {size:?}", place(geom)))
}

#[cfg(test)]
mod tests {
    use super::super::xml::document;
    use super::*;

    fn weighed(text: &str) -> Part {
        let document = document(text).unwrap();
        let root = document.root_element();
        let settings = Settings::read(&root).unwrap();
        let body = root.descendants().find(|node| node.has_tag_name("body")).unwrap();
        Part::together(&weight(&body, &settings).unwrap()).unwrap()
    }

    #[test]
    fn a_capsule_weighs_and_turns_as_its_cylinder_and_its_two_halves_of_a_ball() {
        // Without a middle it is a ball, which has 2/5 m r^2; without its ends almost a rod, m (2h)^2 / 12.
        let ball = weighed("<mujoco><body><geom type=\"capsule\" size=\"0.1 1e-9\" mass=\"2\"/></body></mujoco>");
        assert!((ball.inertia - Matrix3::identity() * (0.4 * 2.0 * 0.01)).amax() < 1e-9, "{ball:?}");
        let rod = weighed("<mujoco><body><geom type=\"capsule\" size=\"1e-6 0.5\" mass=\"3\"/></body></mujoco>");
        assert!((rod.inertia[(0, 0)] - 0.25).abs() < 1e-5 && rod.inertia[(2, 2)] < 1e-9, "{rod:?}");
        let water = weighed("<mujoco><body><geom type=\"box\" size=\".5 .5 .5\"/></body></mujoco>");
        assert!((water.mass - 1000.0).abs() < 1e-9 && (water.inertia[(0, 0)] - 1000.0 / 6.0).abs() < 1e-9);
    }

    #[test]
    fn a_class_gives_what_an_element_leaves_out_and_the_inner_one_goes_first() {
        let text = "<mujoco><default><geom mass='9'/><default class='a'><geom mass='5' type='sphere' size='1'/>\
                    <default class='b'><geom mass='2'/></default></default></default>\
                    <body childclass='a'><geom/><geom class='b'/><geom mass='1'/></body></mujoco>";
        assert_eq!(weighed(text).mass, 8.0);
    }

    #[test]
    fn euler_angles_turn_about_the_turned_axes_in_degrees_unless_the_file_says_otherwise() {
        let text = "<mujoco><body><inertial mass='1' diaginertia='1 2 3' euler='0 0 90'/></body></mujoco>";
        assert!((weighed(text).inertia.diagonal() - Vector3::new(2.0, 1.0, 3.0)).amax() < 1e-12);
        let radian = text.replace("<mujoco>", "<mujoco><compiler angle='radian'/>").replace("90", "1.5707963267948966");
        assert!((weighed(&radian).inertia.diagonal() - Vector3::new(2.0, 1.0, 3.0)).amax() < 1e-12);
    }
}
