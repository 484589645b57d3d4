//! What reading a vehicle is asked for, in clap's terms.

use clap::Args;
use clap::builder::PossibleValuesParser;
use host_sim::identification::import::Format;
use host_sim::identification::import::written::{Given, Wishes};
use scenario::check_name;
use std::path::PathBuf;

/// A source, and the vehicle file to write.
#[derive(Args)]
pub struct VehicleArguments {
    /// RotorPy's parameters (Python or JSON), a URDF, an SDF, MuJoCo's XML, a PX4 airframe script or parameter file
    pub source: PathBuf,
    /// Vehicle file to write; its name without .toml names the vehicle
    #[arg(long, value_name = "FILE.toml")]
    pub out: PathBuf,
    /// What the source is [default: what it looks like]
    #[arg(long, value_parser = PossibleValuesParser::new(Format::ALL.map(|(name, _)| name)))]
    format: Option<String>,
    /// A number of your own, in place of the source's or where it has none: rotors.lag=0.03; may be repeated
    #[arg(long = "with", value_name = "KEY=VALUE", value_parser = given)]
    given: Vec<Given>,
    /// Write over a file that is there, and lose the numbers and comments in it
    #[arg(long)]
    pub overwrite: bool,
    /// Write the diagonal of an inertia whose products are not zero
    #[arg(long)]
    neglect_products: bool,
}

/// What `vehicle --help` ends with.
pub const VEHICLE_HELP: &str = "\
The format is recognised by the content:
  rotorpy   a dictionary with rotor_pos, in a Python file (read, never run) or
            as JSON: everything
  sdf       <sdf> with Gazebo's motor model, as PX4's models: everything;
            included models are looked for beside its folder
  urdf      <robot> with gym-pybullet-drones' <properties>: everything but the
            rotors' lag
  mujoco    <mujoco> with a free body and motors at sites: everything but the
            rotors' lag
  px4       CA_ROTOR... parameters: where the rotors stand and which way they
            turn

What the source has not is marked, never guessed: key = \"missing\", below a
comment that says how to measure it. certify, fly and all other commands refuse
the file until a number stands there. --with gives one here:

  host-sim vehicle cf2x.urdf --with rotors.lag=0.05 --out cf2x.toml
  host-sim certify cf2x.toml
  host-sim fly cf2x.toml

A file that is there already is kept: it may hold what you measured.
--overwrite writes it all the same.

A vehicle's inertia is diagonal here. Products of inertia are written as they
are, and certify refuses them with the angles by which the axes are off;
--neglect-products leaves them out, and says so in the file. docs/import.md has
every format from source to certified flight, and how frames and units are
turned into ours.

Exit status: 0 if the file can be used, 1 if it is written but numbers are
missing or are refused, 2 if the source cannot be read or the file not written.";

impl VehicleArguments {
    /// The format that is asked for.
    pub fn format(&self) -> Option<Format> {
        let named = |name: &String| Format::ALL.into_iter().find(|(known, _)| known == name);
        self.format.as_ref().and_then(named).map(|(_, format)| format)
    }

    /// How the file is to be written.
    pub fn wishes(&self) -> Wishes {
        Wishes { given: self.given.clone(), neglect_products: self.neglect_products }
    }

    /// The vehicle's name.
    ///
    /// # Errors
    /// If the file's name is no scenario's.
    pub fn name(&self) -> Result<String, String> {
        let name = self.out.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        check_name(&name).map_err(|error| format!("--out: becomes the vehicle's name: {error}"))?;
        Ok(name)
    }
}

fn given(text: &str) -> Result<Given, String> {
    let (key, value) = text.split_once('=').ok_or_else(|| "must be KEY=VALUE, such as rotors.lag=0.03".to_owned())?;
    Ok((key.trim().to_owned(), value.trim().to_owned()))
}
