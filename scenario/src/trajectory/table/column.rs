//! The names that columns have, in files of many programs, and the units behind them: `x`, `p_x`, `x [mm]`, `t(s)`,
//! `time_ms`, `field.pose.position.x`.

/// What a column holds; components are counted from 0, a quaternion's from its scalar.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// s.
    Time,
    /// m, world.
    Position(usize),
    /// rad.
    Heading,
    /// m/s, world.
    Velocity(usize),
    /// m/s^2, world.
    Acceleration(usize),
    /// Body to world.
    Quaternion(usize),
    /// The greatest up to the next row, m/s.
    Speed,
    /// Of a polynomial piece, s.
    Duration,
}

/// The names of what has no components.
const SCALAR_NAMES: [(Quantity, &[&str]); 4] = [
    (Quantity::Time, &["t", "time", "timestamp", "time_stamp", "stamp", "sec", "secs", "seconds", "elapsed_time"]),
    (Quantity::Heading, &["yaw", "psi", "heading"]),
    (Quantity::Speed, &["speed", "v_max"]),
    (Quantity::Duration, &["duration"]),
];

/// The components of vectors, and their names with `*` in a component's place.
type Vector = (fn(usize) -> Quantity, &'static str, &'static [&'static str]);
const VECTOR_NAMES: [Vector; 4] = [
    (Quantity::Position, "xyz", &["*", "p*", "p_*", "pos_*", "position_*", "t*", "translation_*", "p_rs_r_*"]),
    (Quantity::Velocity, "xyz", &["v*", "v_*", "vel_*", "velocity_*", "*dot", "*_dot", "v_rs_r_*"]),
    (Quantity::Acceleration, "xyz", &["a*", "a_*", "acc_*", "acceleration_*", "a_lin_*", "*ddot"]),
    (Quantity::Quaternion, "wxyz", &["q*", "q_*", "quat_*", "orientation_*", "rotation_*", "q_rs_*"]),
];

/// What stands before a name in columns made of messages of ROS.
const MESSAGE_PREFIXES: [&str; 3] = ["field_", "pose_", "transform_"];

/// What a unit measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Dimension {
    Time,
    Length,
    Angle,
    Speed,
    Acceleration,
    None,
}

/// Units without blanks, what they measure, and how much they are in s, m and rad.
const UNITS: [(&str, Dimension, f64); 31] = [
    ("s", Dimension::Time, 1.0),
    ("sec", Dimension::Time, 1.0),
    ("seconds", Dimension::Time, 1.0),
    ("ms", Dimension::Time, 1e-3),
    ("us", Dimension::Time, 1e-6),
    ("µs", Dimension::Time, 1e-6),
    ("μs", Dimension::Time, 1e-6),
    ("ns", Dimension::Time, 1e-9),
    ("nsec", Dimension::Time, 1e-9),
    ("m", Dimension::Length, 1.0),
    ("cm", Dimension::Length, 1e-2),
    ("mm", Dimension::Length, 1e-3),
    ("km", Dimension::Length, 1e3),
    ("rad", Dimension::Angle, 1.0),
    ("radians", Dimension::Angle, 1.0),
    ("deg", Dimension::Angle, std::f64::consts::PI / 180.0),
    ("degrees", Dimension::Angle, std::f64::consts::PI / 180.0),
    ("°", Dimension::Angle, std::f64::consts::PI / 180.0),
    ("m/s", Dimension::Speed, 1.0),
    ("m_s", Dimension::Speed, 1.0),
    ("mps", Dimension::Speed, 1.0),
    ("ms^-1", Dimension::Speed, 1.0),
    ("cm/s", Dimension::Speed, 1e-2),
    ("mm/s", Dimension::Speed, 1e-3),
    ("m/s^2", Dimension::Acceleration, 1.0),
    ("m/s2", Dimension::Acceleration, 1.0),
    ("m/s²", Dimension::Acceleration, 1.0),
    ("m_s2", Dimension::Acceleration, 1.0),
    ("ms^-2", Dimension::Acceleration, 1.0),
    ("cm/s^2", Dimension::Acceleration, 1e-2),
    ("mm/s^2", Dimension::Acceleration, 1e-3),
];

impl Quantity {
    fn dimension(self) -> Dimension {
        match self {
            Self::Time | Self::Duration => Dimension::Time,
            Self::Position(_) => Dimension::Length,
            Self::Heading => Dimension::Angle,
            Self::Velocity(_) | Self::Speed => Dimension::Speed,
            Self::Acceleration(_) => Dimension::Acceleration,
            Self::Quaternion(_) => Dimension::None,
        }
    }

    /// Of what it is one, or what it is itself.
    #[must_use]
    pub fn what(self) -> &'static str {
        match self {
            Self::Time | Self::Duration => "a time",
            Self::Position(_) => "a position",
            Self::Heading => "a heading",
            Self::Velocity(_) | Self::Speed => "a speed",
            Self::Acceleration(_) => "an acceleration",
            Self::Quaternion(_) => "a quaternion",
        }
    }

    /// The name that this project gives it.
    #[must_use]
    pub fn name(self) -> String {
        let component = |names: &str, number: usize| names.split(' ').nth(number).unwrap_or_default().to_owned();
        match self {
            Self::Time => "t".to_owned(),
            Self::Position(axis) => component("x y z", axis),
            Self::Heading => "yaw".to_owned(),
            Self::Velocity(axis) => component("vx vy vz", axis),
            Self::Acceleration(axis) => component("ax ay az", axis),
            Self::Quaternion(axis) => component("qw qx qy qz", axis),
            Self::Speed => "speed".to_owned(),
            Self::Duration => "duration".to_owned(),
        }
    }
}

/// What a column named `name` holds, and what its unit is in s, m and rad, if the name has one; none for other columns.
///
/// # Errors
/// If the unit measures something else.
pub fn recognised(name: &str) -> Result<Option<(Quantity, Option<f64>)>, String> {
    let lower = name.to_lowercase();
    let (own, unit) = lower.split_once(['[', '(']).unwrap_or((&lower, ""));
    let own = plain(own);
    let unit: String = unit.trim_end_matches([']', ')']).chars().filter(|c| !c.is_whitespace()).collect();
    if let Some(quantity) = quantity(&own) {
        let dimension = quantity.dimension();
        let known = UNITS.iter().find(|(text, of, _)| *text == unit && *of == dimension);
        return match known {
            _ if unit.is_empty() || dimension == Dimension::None => Ok(Some((quantity, None))),
            Some((_, _, factor)) => Ok(Some((quantity, Some(*factor)))),
            None => {
                let of = UNITS.iter().filter(|(_, of, _)| *of == dimension).map(|(text, _, _)| *text);
                let of = of.collect::<Vec<_>>().join(", ");
                Err(format!("column {name:?}: {unit} is no unit of {} here (allowed: {of})", quantity.what()))
            }
        };
    }
    let ending = UNITS.iter().find_map(|(text, dimension, factor)| {
        let quantity = quantity(own.strip_suffix(text)?.strip_suffix('_')?)?;
        (quantity.dimension() == *dimension).then_some((quantity, Some(*factor)))
    });
    Ok(ending)
}

/// A name in letters, digits and single lines between them, without the messages that it stands in.
fn plain(name: &str) -> String {
    let parts = name.split(|c: char| !c.is_alphanumeric()).filter(|part| !part.is_empty());
    let joined = parts.collect::<Vec<_>>().join("_");
    let ends = MESSAGE_PREFIXES.iter().filter_map(|message| Some(joined.rfind(message)? + message.len()));
    joined[ends.max().unwrap_or(0)..].to_owned()
}

fn quantity(name: &str) -> Option<Quantity> {
    let scalar = SCALAR_NAMES.iter().find(|(_, names)| names.contains(&name)).map(|(quantity, _)| *quantity);
    scalar.or_else(|| {
        VECTOR_NAMES.iter().find_map(|(quantity, components, patterns)| {
            let number = components.chars().position(|component| {
                patterns.iter().any(|pattern| pattern.replace('*', &component.to_string()) == name)
            })?;
            Some(quantity(number))
        })
    })
}
