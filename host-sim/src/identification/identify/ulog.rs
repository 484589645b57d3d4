//! A flight from a ULog: the firmware's ticks, or PX4's topics.
//!
//! Fields are found by the file's own formats, so a recorder that comes to record more is read as well. Ticks on the
//! ground, without a state, or with motors that stand are no flight.

use super::flight_log::{FlightLog, Moment, Source, moment};
use super::px4;
use crate::identification::ulog::reader::{Series, Ulog};
use crate::identification::ulog::topics::TICK_TOPIC;
use controller_core::allocation::Rotors;

/// Reads the flight of a recording; what is to be known of PX4's is `rotors` and the `curve` of their thrust.
///
/// # Errors
/// The file's error, or what it lacks.
pub fn read(bytes: &[u8], rotors: &Rotors, curve: Option<f64>) -> Result<FlightLog, String> {
    let log = Ulog::read(bytes, &[&[TICK_TOPIC], &px4::TOPICS_READ[..]].concat())?;
    let flight = match log.topic(TICK_TOPIC) {
        Some(ticks) => own(ticks),
        None if px4::is_one(&log) => px4::read(&log, rotors, curve),
        None => Err("holds no record of a tick, nor PX4's actuator_motors or actuator_outputs".to_owned()),
    };
    let flight = flight.map_err(|what| format!("{what}{}", log.damage))?;
    Ok(FlightLog { damage: log.damage, ..flight })
}

/// The firmware's.
fn own(ticks: &Series) -> Result<FlightLog, String> {
    let field = |name: &str, count: usize| -> Result<Vec<Vec<f64>>, String> {
        let names: Vec<String> =
            (0..count).map(|index| if count == 1 { name.to_owned() } else { format!("{name}[{index}]") }).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        ticks.columns(&names).ok_or(format!("records have no {name}"))
    };
    let times = field("timestamp", 1)?;
    let mut rows: Vec<Vec<f64>> = times.iter().map(|time| vec![time[0] * 1e-6]).collect();
    let fields = ["velocity", "attitude", "angular_velocity", "thrust", "torque", "reference_velocity"];
    for (name, count) in fields.into_iter().zip([3, 4, 3, 1, 3, 3]) {
        rows.iter_mut().zip(field(name, count)?).for_each(|(row, numbers)| row.extend(numbers));
    }
    let (scales, motors, airborne) = (field("thrust_scale", 1)?, field("motors", 4)?, field("airborne", 1)?);
    let moments: Vec<Option<Moment>> = (0..rows.len())
        .map(|tick| {
            let scale = if scales[tick][0].is_finite() { scales[tick][0] } else { 1.0 };
            let turning = motors[tick].iter().any(|level| *level > 0.0);
            if airborne[tick][0] != 0.0 && turning { moment(&rows[tick], scale) } else { None }
        })
        .collect();
    FlightLog::longest(Source::Estimator, &moments)
}
