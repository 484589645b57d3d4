//! Where a path's rows come from: the scenario itself, or a file that it names; and the origin from which they count.
//!
//! Single precision is too coarse far away ([`crate::resolution`]). So `origin` is subtracted from all positions of the
//! file, and the flight, its log and its reports count from there.

use super::row::Row;
use super::slips::{self, TooSlow};
use super::table;
use crate::key::{Bounds, Key, Layout, Values};
use crate::resolution;
use crate::section::{FieldError, Section};
use nalgebra::Vector3;
use std::path::Path;

/// The keys of a point.
pub const POINTS: Layout = Layout {
    name: "points",
    about: "The points, in order.",
    keys: &[
        Key::number("t", Bounds::any("s"), "When it is passed; left out beside a speed.").optional(),
        Key::vector("position", Bounds::any("m"), "World."),
        Key::number("heading_deg", Bounds::any("degrees"), "From world x.").or(0.0),
        Key::number("speed", Bounds::positive("m/s"), "The greatest up to the next point.").optional(),
    ],
};

/// The name of another file.
pub const FILE: Key =
    Key::new("file", Values::Text, "Beside this file: rows with t, x, y, z and more, or polynomial pieces.").optional();

/// The text of another file.
pub const DATA: Key = Key::new("data", Values::Text, "The text of such a file.").optional();

/// Where positions count from.
pub const ORIGIN: Key = Key::vector("origin", Bounds::any("m"), "Is subtracted from every position.").or(0.0);

/// Where files that a scenario names lie: beside the scenario's own.
pub type Directory<'a> = Option<&'a Path>;

/// Who says what times are counted in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum TimeUnit {
    /// The scenario's key.
    Key,
    /// The file's header.
    Header,
    /// Nobody.
    Unsaid,
}

/// The rows of a path.
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    /// One or more, in their order.
    pub rows: Vec<Row>,
    /// The field, which errors of single rows begin with.
    pub field: String,
    /// The field with the name of the file.
    pub name: String,
    /// Who says what times are counted in.
    unit: TimeUnit,
    /// What there is to say of them.
    pub remarks: Vec<String>,
}

impl Source {
    /// The rows that `section` has or names.
    ///
    /// # Errors
    /// Names the field and what is wrong.
    pub fn read(section: &Section, directory: Directory) -> Result<Self, FieldError> {
        let mut source = if section.has("points") { points(section)? } else { file(section, directory)? };
        let origin = section.vector("origin")?;
        if origin != Vector3::zeros() {
            source.rows.iter_mut().for_each(|row| row.position -= origin);
            let [x, y, z] = origin.into();
            source.remarks.push(format!("positions count from origin, ({x}, {y}, {z}) m of the file"));
        }
        for row in &source.rows {
            resolution::check(&source.name, &row.position, &near(&(source.rows[0].position + origin)))?;
        }
        Ok(source)
    }

    /// Refuses what cannot be meant where rows have times, which are multiplied by `stretch`.
    ///
    /// # Errors
    /// If they have speeds as well, or are slower than anybody flies and do not say in which unit.
    pub fn check_times(&mut self, stretch: f64) -> Result<(), FieldError> {
        if let Some(number) = self.rows.iter().position(|row| row.speed.is_some()) {
            let problem = "goes with points without times; leave it out, or the times";
            return Err(FieldError::new(format!("{}[{number}].speed", self.field), problem));
        }
        match (TooSlow::find(&self.rows, stretch), self.unit) {
            (Some(TooSlow { what, unit }), TimeUnit::Unsaid) => {
                let remedy = format!("name its times t_{unit} if that is what they are, t_s if they are seconds");
                return Err(FieldError::new(self.name.as_str(), format!("{what}: {remedy}")));
            }
            (Some(TooSlow { what, unit }), TimeUnit::Key) => {
                self.remarks.push(format!("{what}; are its times {unit}, and not s?"));
            }
            _ => {}
        }
        Ok(())
    }
}

/// What to write where `first`, m, is far away.
fn near(first: &Vector3<f64>) -> String {
    let far =
        first.map(|value| if value.abs() < resolution::DISTANCE_MAX_M { 0.0 } else { (value / 100.0).floor() * 100.0 });
    format!("write origin = {}, from which the flight then counts", crate::number::array(far.as_slice()))
}

/// The points that stand in the scenario itself.
fn points(section: &Section) -> Result<Source, FieldError> {
    let read = |point: &Section| {
        Ok(Row {
            time: point.optional_number("t")?,
            position: point.vector("position")?,
            heading: point.number("heading_deg")?.to_radians(),
            velocity: None,
            acceleration: None,
            speed: point.optional_number("speed")?,
        })
    };
    let field = section.path_of("points");
    let rows: Vec<Row> = section.tables(&POINTS)?.iter().map(read).collect::<Result<_, _>>()?;
    if rows.is_empty() {
        return Err(FieldError::new(field, "needs at least 1 element"));
    }
    let slip = slips::radians_as_degrees(rows.iter().map(|row| row.heading.to_degrees()));
    let remarks = slip.map(|slip| format!("heading_deg {slip}")).into_iter().collect();
    Ok(Source { rows, name: field.clone(), field, unit: TimeUnit::Key, remarks })
}

/// The rows of the file that is named, or of the text that stands in its place.
fn file(section: &Section, directory: Directory) -> Result<Source, FieldError> {
    let (key, text) = match (section.has("file"), section.has("data")) {
        (true, false) => ("file", beside(section, directory)?),
        (false, true) => ("data", section.text("data")?.to_owned()),
        _ => return Err(FieldError::new(section.path_of("file"), "needs one of file and data")),
    };
    let field = section.path_of(key);
    let name = if key == "file" { format!("{field}: {}", section.text("file")?) } else { field.clone() };
    let table::Table { mut rows, has_time_unit, remarks } = table::read(&text, &name)?;
    // Clocks begin anywhere.
    let start = rows[0].time;
    rows.iter_mut().for_each(|row| row.time = row.time.zip(start).map(|(time, start)| time - start));
    let unit = if has_time_unit { TimeUnit::Header } else { TimeUnit::Unsaid };
    Ok(Source { rows, field, name, unit, remarks })
}

/// The text of the file that `file` names.
fn beside(section: &Section, directory: Directory) -> Result<String, FieldError> {
    let file = section.text("file")?;
    let path = directory.unwrap_or_else(|| Path::new("")).join(file);
    crate::text::read(&path).map_err(|error| {
        FieldError::new(section.path_of("file"), format!("{}: cannot be read: {error}", path.display()))
    })
}
