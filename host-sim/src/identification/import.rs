//! A vehicle's numbers from the files that people have, as a vehicle file of ours: `host-sim vehicle`.
//!
//! | module | what it holds |
//! |---|---|
//! | [`numbers`] | what a source says of a vehicle: numbers, each of which may be missing |
//! | [`rotorpy`], [`literal`], [`value`] | RotorPy's dictionaries, the Python that they are written in, and its values |
//! | [`urdf`] | URDF of gym-pybullet-drones' kind |
//! | [`sdf`], [`sdf_model`], [`sdf_frames`], [`sdf_motor`] | SDF of Gazebo with its motor model |
//! | [`mujoco`], [`mujoco_frames`] | MuJoCo's XML |
//! | [`px4`] | PX4's rotor geometry |
//! | [`xml`], [`rigid`] | what the XML formats share; bodies put together |
//! | [`written`], [`existing`] | the vehicle file, with what is missing marked; one that is there already |
//!
//! `docs/import.md` has each format's frames and units beside ours.

pub mod existing;
pub mod literal;
pub mod mujoco;
pub mod mujoco_frames;
pub mod numbers;
pub mod px4;
pub mod rigid;
pub mod rotorpy;
pub mod sdf;
pub mod sdf_frames;
pub mod sdf_model;
pub mod sdf_motor;
pub mod urdf;
pub mod value;
pub mod written;
pub mod xml;

use numbers::VehicleNumbers;
use std::path::Path;

/// What a source can be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// RotorPy's dictionary in a Python file, or as JSON.
    Rotorpy,
    /// URDF.
    Urdf,
    /// SDF.
    Sdf,
    /// MuJoCo's XML.
    Mujoco,
    /// PX4's parameters.
    Px4,
}

impl Format {
    /// Every format, by its name.
    pub const ALL: [(&str, Self); 5] = [
        ("rotorpy", Self::Rotorpy),
        ("urdf", Self::Urdf),
        ("sdf", Self::Sdf),
        ("mujoco", Self::Mujoco),
        ("px4", Self::Px4),
    ];

    /// The format that `text` looks like.
    ///
    /// # Errors
    /// If it looks like none.
    pub fn detect(text: &str) -> Result<Self, String> {
        let all = Self::ALL.map(|(name, _)| name).join(", ");
        let text = text.trim_start_matches('\u{feff}').trim_start();
        if text.starts_with('<') {
            let root = xml::document(text)?.root_element().tag_name().name().to_owned();
            return match root.as_str() {
                "robot" => Ok(Self::Urdf),
                "sdf" => Ok(Self::Sdf),
                "mujoco" => Ok(Self::Mujoco),
                "model" => Err("<model>: is a model.config: give the file that its <sdf> names".to_owned()),
                _ => Err(format!("<{root}>: must be <robot> (URDF), <sdf> or <mujoco>")),
            };
        }
        if text.contains("rotor_pos") {
            Ok(Self::Rotorpy)
        } else if text.contains("CA_ROTOR") {
            Ok(Self::Px4)
        } else {
            Err(format!("looks like none of the formats {all}; --format says which one it is"))
        }
    }
}

/// The vehicle of `text`, which stands in `file`, in `format` or in the one it looks like.
///
/// # Errors
/// Names line or element, the reason and a remedy, but not the file.
pub fn read(text: &str, file: &Path, format: Option<Format>) -> Result<VehicleNumbers, String> {
    let text = text.trim_start_matches('\u{feff}');
    let format = format.map_or_else(|| Format::detect(text), Ok)?;
    let rooted = |name: &str, read: &dyn Fn(&roxmltree::Node) -> Result<VehicleNumbers, String>| {
        let document = xml::document(text)?;
        let root = document.root_element();
        let found = root.tag_name().name();
        if found == name { read(&root) } else { Err(format!("<{found}>: must be <{name}> in this format")) }
    };
    match format {
        Format::Rotorpy if text.trim_start().starts_with('{') => rotorpy::read_json(text),
        Format::Rotorpy => rotorpy::read(text),
        Format::Urdf => rooted("robot", &|root| urdf::read(root)),
        Format::Sdf => rooted("sdf", &|root| sdf::read(root, file)),
        Format::Mujoco => rooted("mujoco", &|root| mujoco::read(root)),
        Format::Px4 => px4::read(text),
    }
}
