//! Another program's file as a vehicle file of ours.

use crate::vehicle_file::VehicleFile;
use host_sim::identification::import::written::{Wishes, written};
use host_sim::identification::import::{self, Format};
use serde::Serialize;
use std::path::Path;

/// The name of a vehicle whose file has none that serves.
const DEFAULT_NAME: &str = "vehicle";

/// A vehicle file.
#[derive(Debug, Serialize)]
pub struct Imported {
    /// What the source was.
    pub format: &'static str,
    /// The file.
    pub text: String,
    /// What the source does not say, as dotted paths.
    pub missing: Vec<String>,
}

/// The file as it is if it is one of ours, otherwise read by the importer of the format that it looks like.
///
/// # Errors
/// One line: the file, the element, and what is wrong.
pub fn import(VehicleFile { file, text }: &VehicleFile) -> Result<Imported, String> {
    let path = Path::new(file);
    let is_toml = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml"));
    if is_toml || text.lines().any(|line| line.trim() == "[vehicle]") {
        return Ok(Imported { format: "toml", text: text.clone(), missing: Vec::new() });
    }
    let said = |what: String| format!("{file}: {what}");
    let format = Format::detect(text).map_err(|_| said(NO_FORMAT.to_owned()))?;
    let numbers = import::read(text, path, Some(format)).map_err(said)?;
    let name = path.file_stem().and_then(|stem| stem.to_str()).filter(|name| scenario::check_name(name).is_ok());
    let wishes = Wishes::default();
    let vehicle = written(&numbers, name.unwrap_or(DEFAULT_NAME), file, &wishes).map_err(said)?;
    let names = Format::ALL.iter();
    let format = names.clone().find(|(_, known)| *known == format).map_or("toml", |(name, _)| name);
    Ok(Imported { format, text: vehicle.text, missing: vehicle.missing })
}

/// Said of a file that nothing reads.
const NO_FORMAT: &str = "is no vehicle file; expected TOML with a section [vehicle], URDF, SDF, MuJoCo's XML, \
    RotorPy's dictionary in Python or JSON, or PX4's parameters";
