//! A model of SDF with what it includes: links, their frames, and motors.
//!
//! `model://NAME` is looked for where PX4's repositories have it, in the folder `NAME` beside the folder of the file:
//! in the file that `model.config` names there, else in `model.sdf`. An included model is nested under its name, or
//! under the one that the include gives it; with `merge="true"` its content is the including model's own.

use super::rigid::{Part, inertia, pose};
use super::sdf_frames::{Frames, Stands};
use super::sdf_motor::{Motor, is_motor, motor};
use super::xml::{attribute, child, child_number, children, document, mass, numbers, place, text};
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};
use roxmltree::Node;
use std::path::{Path, PathBuf};

/// How deep models may include each other.
const DEPTH_MAX: usize = 8;
/// The most links, and the most included models, of a vehicle.
const COUNT_MAX: usize = 200;

/// A model with what it includes.
#[derive(Default)]
pub struct Model {
    /// Where everything stands.
    pub frames: Frames,
    /// What weighs something.
    pub links: Vec<Link>,
    /// What pushes.
    pub motors: Vec<Motor>,
    included: usize,
}

pub struct Link {
    /// Its frame's.
    pub whole_name: String,
    /// What errors call it.
    pub place: String,
    /// What it weighs, in its own frame.
    pub part: Part,
}

/// The model of a document: its own, or the first of its world with a motor.
fn model_of<'a, 'input>(sdf: &Node<'a, 'input>) -> Result<Node<'a, 'input>, String> {
    let worlds = children(sdf, "world").flat_map(|world| world.children().filter(|node| node.has_tag_name("model")));
    let mut models = children(sdf, "model").chain(worlds);
    let first = models.next().ok_or_else(|| {
        "<sdf>: no <model> in it: give the model's own file, not that of a world that includes it".to_owned()
    })?;
    Ok(std::iter::once(first).chain(models).find(|model| model.descendants().any(|n| is_motor(&n))).unwrap_or(first))
}

impl Model {
    /// Reads the document of `sdf`, which stands in `file`.
    ///
    /// # Errors
    /// Names the element, of an included file as well.
    pub fn read(sdf: &Node, file: &Path) -> Result<Self, String> {
        let mut model = Self::default();
        model.add(&model_of(sdf)?, ["", ""], file, 0)?;
        Ok(model)
    }

    /// Adds a `<model>` of `file`. Its names count in the `scope`, a model's whole name; its poses are relative to its
    /// `frame`, which is another one only where it is merged into the scope.
    fn add(&mut self, model: &Node, [scope, frame]: [&str; 2], file: &Path, depth: usize) -> Result<(), String> {
        for nested in children(model, "model") {
            let name = Frames::whole_name(scope, attribute(&nested, "name")?);
            let placement_frame = nested.attribute("placement_frame").map(str::to_owned);
            self.stand(&nested, &name, [scope, frame], placement_frame, None)?;
            self.add(&nested, [&name, &name], file, depth)?;
        }
        children(model, "include").try_for_each(|include| self.include(&include, [scope, frame], file, depth))?;
        for link in children(model, "link") {
            let whole_name = Frames::whole_name(scope, link.attribute("name").unwrap_or_default());
            self.stand(&link, &whole_name, [scope, frame], None, None)?;
            self.links.push(Link { whole_name, place: place(&link), part: part(&link)? });
            if self.links.len() > COUNT_MAX {
                return Err(format!("{}: more than {COUNT_MAX} links", place(&link)));
            }
        }
        for joint in children(model, "joint") {
            let child = child(&joint, "child").map(|child| text(&child).to_owned());
            let name = Frames::whole_name(scope, attribute(&joint, "name")?);
            // In older versions a joint may be called as a link is, whose frame is then meant.
            if !self.frames.contains(&name) {
                self.stand(&joint, &name, [scope, frame], None, child)?;
            }
        }
        for explicit in children(model, "frame") {
            let attached_to = explicit.attribute("attached_to").map(str::to_owned);
            let name = Frames::whole_name(scope, attribute(&explicit, "name")?);
            self.stand(&explicit, &name, [scope, frame], None, attached_to)?;
        }
        for plugin in model.children().filter(is_motor) {
            self.motors.push(motor(&plugin, scope)?);
        }
        Ok(())
    }

    /// Says where `node` stands, by its `<pose>`; relative to `otherwise`, or its model's frame, if that does not say.
    fn stand(
        &mut self,
        node: &Node,
        whole_name: &str,
        [scope, frame]: [&str; 2],
        placement_frame: Option<String>,
        otherwise: Option<String>,
    ) -> Result<(), String> {
        let (relative_to, pose) = pose_of(node)?;
        let relative_to = relative_to.or(otherwise).filter(|name| name != "__model__");
        let (model, frame) = (scope.to_owned(), frame.to_owned());
        let stands = Stands { pose, relative_to, model, frame, placement_frame };
        self.frames.add(whole_name.to_owned(), stands).map_err(|what| format!("{}: {what}", place(node)))
    }

    fn include(&mut self, include: &Node, [scope, frame]: [&str; 2], file: &Path, depth: usize) -> Result<(), String> {
        let place = place(include);
        let uri = child(include, "uri").map(|uri| text(&uri).to_owned()).unwrap_or_default();
        let folder = uri.strip_prefix("model://").unwrap_or(&uri).trim_end_matches('/');
        if !is_plain(folder) {
            return Err(format!(
                "{place}: uri: must be model://NAME, the folder NAME beside the file's own, found {uri:?}"
            ));
        }
        self.included += 1;
        if depth >= DEPTH_MAX || self.included > COUNT_MAX {
            return Err(format!("{place}: models include each other more than {DEPTH_MAX} deep, or {COUNT_MAX} times"));
        }
        // The folder of the file is the model's; its neighbours are the others.
        let beside = file.parent().map(Path::to_path_buf).unwrap_or_default().join("..").join(folder);
        let included = model_file(&beside).map_err(|what| format!("{place}: {what}"))?;
        let of_it = |what: String| format!("{place}: {}: {what}", included.display());
        let text_of_it = scenario::text::read(&included).map_err(|error| {
            of_it(format!("cannot be read: {error}; put the included model there: without it mass is not known"))
        })?;
        let document = document(&text_of_it).map_err(of_it)?;
        let model = model_of(&document.root_element()).map_err(of_it)?;
        let own_name = model.attribute("name").unwrap_or(folder);
        let name = child(include, "name").map_or(own_name.to_owned(), |name| text(&name).to_owned());
        let placement_frame = child(include, "placement_frame").map(|frame| text(&frame).to_owned());
        let placement_frame = placement_frame.or_else(|| model.attribute("placement_frame").map(str::to_owned));
        // Where the include does not say where, the model does itself.
        let says = if child(include, "pose").is_some() { include } else { &model };
        let is_merged = include.attribute("merge") == Some("true");
        // What is merged keeps a frame of its own, under a name that no file has.
        let name = if is_merged { format!("{name} of {place}") } else { name };
        let whole_name = Frames::whole_name(scope, &name);
        self.stand(says, &whole_name, [scope, frame], placement_frame, None).map_err(of_it)?;
        let within = if is_merged { scope } else { &whole_name };
        self.add(&model, [within, &whole_name], &included, depth + 1).map_err(of_it)
    }
}

/// Whether a name leads nowhere but to its own folder.
fn is_plain(name: &str) -> bool {
    !(name.is_empty() || name.contains(['/', '\\']) || name.starts_with('.'))
}

/// The file of the model in `folder`: of those in its `model.config` the one for the newest SDF; without such a file
/// `model.sdf`.
fn model_file(folder: &Path) -> Result<PathBuf, String> {
    let path = folder.join("model.config");
    let Ok(config) = scenario::text::read(&path) else { return Ok(folder.join("model.sdf")) };
    let of_it = |what: String| format!("{}: {what}", path.display());
    let config = document(&config).map_err(of_it)?;
    let root = config.root_element();
    let version = |sdf: &Node| -> Vec<u32> {
        sdf.attribute("version").into_iter().flat_map(|version| version.split('.')).flat_map(str::parse).collect()
    };
    let newest = children(&root, "sdf").max_by_key(version);
    let name = newest.map(|sdf| text(&sdf).to_owned()).unwrap_or_default();
    if is_plain(&name) { Ok(folder.join(name)) } else { Err(of_it(format!("<sdf>: must name a file, found {name:?}"))) }
}

/// `<pose>` of an element, and the frame that it is relative to if not to its model's.
fn pose_of(node: &Node) -> Result<(Option<String>, Isometry3<f64>), String> {
    let Some(element) = child(node, "pose") else { return Ok((None, Isometry3::identity())) };
    let relative_to = element.attribute("relative_to").filter(|frame| !frame.is_empty()).map(str::to_owned);
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
        (Some(frame), _) if link.attribute("name") != Some(&frame) => {
            Err(format!("{}: relative_to={frame:?}: must be in the link's own frame", place(&inertial)))
        }
        (_, pose) => Ok(own.placed(&pose)),
    }
}
