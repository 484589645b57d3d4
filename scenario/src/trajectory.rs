//! `[reference]` from points: given in the file itself or in another one, passed exactly or followed closely.
//!
//! | module | |
//! |---|---|
//! | `row`, `table`, `pieces` | rows from a file |
//! | `source` | where the rows are, and from which origin they count |
//! | `slips` | what rows are probably not meant to say |
//! | `fit`, `band`, `lead` | a smooth path near rows, which begins and ends at rest |
//! | `pace` | the quickest path through points that have no times |
//! | [`mod@stretch`] | by how much times must grow for a path's derivatives to fit |

mod band;
mod fit;
mod lead;
mod pace;
mod pieces;
mod row;
mod slips;
mod source;
pub mod stretch;
mod table;
pub mod vehicle;

use crate::key::{Bounds, Key, Layout, Values};
use crate::section::{FieldError, Section};
use controller_core::error::ParameterError;
use controller_core::reference::inside;
use controller_core::reference::knot::Knot;
use controller_core::reference::spline::{self, Stage};
use controller_core::reference::waypoints::Waypoint;
use pace::limits::Limits;
use pace::merge::Point;
use pace::{Paced, Problem};
use row::Row;
pub use source::Directory;
use source::Source;
use vehicle::Vehicle;

const KIND: &str = "kind";

/// The key that says of which kind a reference is.
pub const fn kind(names: &'static [&'static str]) -> Key {
    Key::new(KIND, Values::Choice(names), "How the reference is given.")
}

/// How far a flight may stray from its reference once it is there.
pub const TOLERANCE: Key =
    Key::number("tolerance", Bounds::positive("m"), "How far a flight may stray from it once it is there.").or(0.5);

/// The force that is kept free along a reference.
pub const FORCE_KEPT: Key = Key::number(
    "force_kept",
    Bounds::not_negative("m/s^2"),
    "The force per mass, in any direction, that is kept free along it.",
)
.or(controller_core::certificate::path::FORCE_KEPT_M_PER_S2 as f64);

/// A path through points.
pub const WAYPOINTS: Layout = Layout {
    name: "reference",
    about: "A path through every point.",
    keys: &[
        kind(&["waypoints"]),
        TOLERANCE,
        FORCE_KEPT,
        Key::new(source::POINTS.name, Values::Tables(&source::POINTS), source::POINTS.about).optional(),
        source::FILE,
        source::DATA,
        source::ORIGIN,
        Key::choice("path", &["smooth", "inside"], "Between points with times; left out: the smoothest."),
        Key::number("speed", Bounds::positive("m/s"), "The greatest, of points without times.").optional(),
        Key::number("corridor", Bounds::positive("m"), "From the straight legs; with speed only.").or(0.3),
    ],
};

/// A path near rows.
pub const TRAJECTORY: Layout = Layout {
    name: "reference",
    about: "A path near rows that say when to be where.",
    keys: &[
        kind(&["trajectory"]),
        TOLERANCE,
        FORCE_KEPT,
        source::FILE,
        source::DATA,
        source::ORIGIN,
        Key::number("within", Bounds::positive("m"), "How near the path is to every row.").or(0.02),
        Key::number("stretch", Bounds::positive(""), "The rows' times are multiplied by this.").or(1.0),
    ],
};

/// A path through or near points.
#[derive(Debug, Clone)]
pub struct Route {
    /// The points, at the times at which they are passed.
    pub points: Vec<Waypoint>,
    /// How it is passed along.
    pub knots: Vec<Knot>,
    /// Which way between the points.
    pub way: Way,
    /// The field that has them, with the name of the file if they are in one.
    pub name: String,
    /// What there is to say of where they come from.
    pub remarks: Vec<String>,
}

/// Two are equal that are flown alike, wherever they come from.
impl PartialEq for Route {
    fn eq(&self, other: &Self) -> bool {
        (&self.points, &self.knots, self.way) == (&other.points, &other.knots, other.way)
    }
}

impl Route {
    /// Until the path is at rest at its end, s.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.knots.last().map_or(0.0, |last| last.time_us as f64 * 1e-6)
    }
}

/// The way between points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Way {
    /// The smoothest.
    Smooth,
    /// Inside the box of each leg's two points.
    Inside,
    /// The smoothest inside a corridor, m, at times that the bounds allow.
    Paced {
        /// Around the straight legs, m.
        corridor: f64,
    },
    /// Near the points.
    Near {
        /// The greatest distance, m, and of which point, s.
        farthest: (f64, f64),
        /// How long after the start the first point is passed, s: what it takes to get there in motion.
        lead_in: f64,
    },
}

/// What the vehicle may fly, which is worked out only where it matters.
pub type Allowed<'a> = &'a dyn Fn() -> Result<Vehicle, FieldError>;

/// Reads a `[reference]` of points that are passed; what the bounds `allow` matters where only a speed is given.
///
/// # Errors
/// Names the field and what is wrong.
pub fn read_waypoints(section: &Section, directory: Directory, allow: Allowed) -> Result<Route, FieldError> {
    let mut source = Source::read(section, directory)?;
    if section.has("speed") || source.rows.iter().any(|row| row.time.is_none() && row.speed.is_some()) {
        return paced(section, source, &allow()?);
    }
    source.check_times(1.0)?;
    let Source { rows, field, name, remarks, .. } = source;
    let way = if section.has("path") && section.choice("path")? == "inside" { Way::Inside } else { Way::Smooth };
    if section.has("corridor") {
        let problem = "goes with speed; points with times are passed at these, on the way that path says";
        return Err(FieldError::new(section.path_of("corridor"), problem));
    }
    let mut points = Vec::with_capacity(rows.len());
    let mut knots: Vec<Knot> = Vec::with_capacity(rows.len());
    for (i, row) in rows.iter().enumerate() {
        let Some(time) = row.time else {
            let problem = "missing; give every point a time, or speed for all of them";
            return Err(FieldError::new(format!("{field}[{i}].t"), problem));
        };
        let point = Waypoint { time, position: row.position.into(), heading: row.heading };
        let knot = point.knot(knots.last(), ["t", "position", "heading_deg"]);
        knots.push(knot.map_err(|error| refused(section, &format!("{field}[{i}]"), &error))?);
        points.push(point);
    }
    match way {
        Way::Inside => inside::solve(&mut knots),
        _ => {
            let mut stages = vec![Stage::EMPTY; knots.len()];
            spline::solve(&mut knots, &mut stages);
        }
    }
    Ok(Route { points, knots, way, name, remarks })
}

/// A refusal of a field of the point at `place`, with the value that the file has there.
fn refused(section: &Section, place: &str, error: &ParameterError) -> FieldError {
    let field = format!("{place}.{}", error.field);
    let key = field.strip_prefix("reference.").unwrap_or(&field);
    let found = section.lookup(key).map_or(String::new(), |value| format!(", found {value}"));
    FieldError::new(field.clone(), format!("{}{found}", error.reason))
}

/// Times for points that are to be passed with a speed at most.
fn paced(section: &Section, source: Source, vehicle: &Vehicle) -> Result<Route, FieldError> {
    let Source { rows, field, name, remarks, .. } = source;
    let corridor = section.number("corridor")?;
    let speed = section.number_or("speed", f64::INFINITY)?;
    if section.has("path") {
        return Err(FieldError::new(section.path_of("path"), "goes with times; with speed there is corridor"));
    }
    if rows.iter().any(|row| row.time.is_some()) {
        let problem = "chooses the times: leave it out, or the points' own times";
        return Err(FieldError::new(section.path_of("speed"), problem));
    }
    if let Some(number) = rows.iter().take(rows.len() - 1).position(|row| row.speed.is_none() && speed.is_infinite()) {
        let problem = "missing; give every point a speed, or one for all of them";
        return Err(FieldError::new(format!("{field}[{number}].speed"), problem));
    }
    let rows = slowed(&rows, 1.0);
    let place = |row: &Row| row.position.push(row.heading);
    if let Some(same) = rows.windows(2).position(|pair| place(&pair[0]) == place(&pair[1])) {
        let problem = "is the same as the one before: leave it out or, to wait, give times in place of speed";
        return Err(FieldError::new(format!("{field}[{}]", same + 1), problem));
    }
    let limits = Limits::for_vehicle(vehicle);
    if limits.bounds().values().iter().any(|bound| *bound <= 0.0) {
        let problem =
            "needs bounds that the path is to keep: write [reference_bounds]; the paper's law has none of its own";
        return Err(FieldError::new(section.path_of("speed"), problem));
    }
    let own = |row: &Row| row.speed.map_or(speed, |own| own.min(speed));
    let points: Vec<Point> = rows.iter().map(|row| Point { place: place(row), speed: own(row) }).collect();
    let greatest = points.iter().map(|point| point.speed).filter(|speed| speed.is_finite()).fold(0.0, f64::max);
    let Paced { knots, times } = pace::paced(&points, corridor, greatest, &limits).map_err(|problem| {
        let problem = match problem {
            Problem::Legs(legs) => format!(
                "has {legs} straight legs, and at most {} can be searched: widen the corridor, leave points out, or \
                 give them times",
                pace::LEGS_MAX
            ),
            Problem::Rest => "no path keeps to what the vehicle may fly, however slow it is".to_owned(),
        };
        FieldError::new(field, problem)
    })?;
    let points = times.into_iter().zip(&rows).map(|(time, row)| waypoint(time, row)).collect();
    Ok(Route { points, knots, way: Way::Paced { corridor }, name, remarks })
}

fn waypoint(time: f64, row: &Row) -> Waypoint {
    Waypoint { time, position: row.position.into(), heading: row.heading }
}

/// Reads a `[reference]` of rows that are followed; a path that begins or ends in motion gets a beginning and an end
/// inside the bounds that the vehicle is to `allow`.
///
/// # Errors
/// Names the field and what is wrong.
pub fn read_trajectory(section: &Section, directory: Directory, allow: Allowed) -> Result<Route, FieldError> {
    let (near, stretch) = (section.number("within")?, section.number("stretch")?);
    let mut source = Source::read(section, directory)?;
    source.check_times(stretch)?;
    let Source { rows, name, remarks, .. } = source;
    let times: Option<Vec<f64>> = rows.iter().map(|row| row.time).collect();
    let (Some(times), true) = (times, rows.len() > 1) else {
        let problem =
            "needs two rows or more, each with its time t; without times take kind = \"waypoints\" with speed";
        return Err(FieldError::new(name, problem));
    };
    let timed: Vec<(f64, Row)> = times.iter().map(|time| time * stretch).zip(slowed(&rows, stretch)).collect();
    let found = fit::fit(&timed, near).map_err(|nearest| {
        let (distance, time) = nearest.farthest;
        let problem = format!(
            "no smooth path is within {near} m of every row: the nearest is {distance:.3} m off at {time:.2} s; \
             raise within"
        );
        FieldError::new(name.as_str(), problem)
    })?;
    let mut knots = found.knots;
    let led_in = lead::lead(&mut knots, allow()?.configuration.bounds())
        .map_err(|error| FieldError::new(name.as_str(), error.to_string()))? as f64
        * 1e-6;
    let points = timed.iter().map(|(time, row)| waypoint(led_in + time, row));
    Ok(Route {
        points: points.collect(),
        knots,
        way: Way::Near { farthest: found.farthest, lead_in: led_in },
        name,
        remarks,
    })
}

/// The rows with headings that go the shorter way from each to the next, and flown `stretch` times as slowly.
fn slowed(rows: &[Row], stretch: f64) -> Vec<Row> {
    let mut heading = rows.first().map_or(0.0, |row| row.heading);
    let slowed = rows.iter().map(|row| {
        let turn = (row.heading - heading + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU);
        heading += turn - std::f64::consts::PI;
        Row {
            heading,
            velocity: row.velocity.map(|velocity| velocity / stretch),
            acceleration: row.acceleration.map(|acceleration| acceleration / (stretch * stretch)),
            ..*row
        }
    });
    slowed.collect()
}

#[cfg(test)]
mod tests;
