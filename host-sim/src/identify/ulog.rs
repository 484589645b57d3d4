//! The recorder's ULog, read back ([`firmware::recorder`]): messages of 2 bytes of length, 1 of kind, and what follows.
//!
//! F says which fields a record has, A which number records of `tick` have, D is one record. Fields are found by the
//! file's own format, so a recorder that comes to record more is read as well. Ticks on the ground, without a state, or
//! with motors that stand are no flight.

use super::flight_log::{FlightLog, Moment, Source, moment};

/// The first bytes of every ULog.
pub const MAGIC: [u8; 7] = *b"ULog\x01\x12\x35";

/// Bytes before the first message: magic, version, time.
const HEAD: usize = 16;

/// What follows these words in a file's message F is the format.
const NAME: &str = "tick";

/// A field of a record: its name, where it begins, the size of its numbers.
struct Field {
    name: String,
    at: usize,
}

/// Reads the flight of a recording.
///
/// # Errors
/// The file's error, and at which byte.
pub fn read(bytes: &[u8]) -> Result<FlightLog, String> {
    let mut fields: Option<Vec<Field>> = None;
    let mut subscription: Option<[u8; 2]> = None;
    let mut moments: Vec<Option<Moment>> = Vec::new();
    let mut at = HEAD;
    while let Some(head) = bytes.get(at..at + 3) {
        let length = usize::from(u16::from_le_bytes([head[0], head[1]]));
        // A recording that was cut short ends in the middle of a message.
        let Some(body) = bytes.get(at + 3..at + 3 + length) else { break };
        match head[2] {
            b'F' => {
                if let Some(found) = format(body) {
                    fields = Some(found.map_err(|what| format!("byte {at}: {what}"))?);
                }
            }
            b'A' if body.get(3..) == Some(NAME.as_bytes()) => subscription = Some([body[1], body[2]]),
            b'D' if subscription.is_some_and(|number| body.starts_with(&number)) => {
                let fields = fields.as_ref().ok_or(format!("byte {at}: a record before its format"))?;
                moments.push(record(fields, &body[2..]).map_err(|what| format!("byte {at}: {what}"))?);
            }
            _ => {}
        }
        at += 3 + length;
    }
    if moments.is_empty() {
        return Err("holds no record of a tick".to_owned());
    }
    FlightLog::longest(Source::Estimator, &moments)
}

/// The fields of records of ticks; none if the format is another's.
fn format(body: &[u8]) -> Option<Result<Vec<Field>, String>> {
    let text = std::str::from_utf8(body).ok()?;
    let fields = text.strip_prefix(NAME)?.strip_prefix(':')?;
    let mut at = 0;
    let read = fields.split_terminator(';').map(|field| {
        let (kind, name) = field.split_once(' ').ok_or(format!("the format's field {field:?} has no name"))?;
        let (kind, count) = kind.split_once('[').map_or((kind, "1"), |(kind, rest)| (kind, rest.trim_end_matches(']')));
        let size = match kind {
            "uint64_t" | "int64_t" | "double" => 8,
            "uint32_t" | "int32_t" | "float" => 4,
            "uint16_t" | "int16_t" => 2,
            "uint8_t" | "int8_t" | "char" | "bool" => 1,
            _ => return Err(format!("the format's field {field:?} has no known type")),
        };
        let count: usize = count.parse().map_err(|_| format!("the format's field {field:?} has no length"))?;
        let found = Field { name: name.to_owned(), at };
        at += size * count;
        Ok(found)
    });
    Some(read.collect())
}

/// A record's moment of flight; none on the ground, or without a state.
fn record(format: &[Field], bytes: &[u8]) -> Result<Option<Moment>, String> {
    let place = |name: &str| {
        format.iter().find(|field| field.name == name).map(|field| field.at).ok_or(format!("records have no {name}"))
    };
    let part = |from: usize, length: usize| bytes.get(from..from + length).ok_or("a record is cut short".to_owned());
    let floats = |name: &str, count: usize| -> Result<Vec<f64>, String> {
        let bytes = part(place(name)?, 4 * count)?;
        let number = |four: &[u8]| four.try_into().map_or(f64::NAN, |four| f64::from(f32::from_le_bytes(four)));
        Ok(bytes.chunks(4).map(number).collect())
    };
    let time = part(place("timestamp")?, 8)?.try_into().map_or(0, u64::from_le_bytes);
    let mut numbers = vec![time as f64 * 1e-6];
    let fields = ["velocity", "attitude", "angular_velocity", "thrust", "torque", "reference_velocity"];
    for (name, count) in fields.into_iter().zip([3, 4, 3, 1, 3, 3]) {
        numbers.extend(floats(name, count)?);
    }
    let scale = floats("thrust_scale", 1)?[0];
    let scale = if scale.is_finite() { scale } else { 1.0 };
    let motors = floats("motors", 4)?;
    let airborne = part(place("airborne")?, 1)?[0] != 0;
    let turning = motors.iter().any(|level| *level > 0.0);
    Ok(if airborne && turning { moment(&numbers, scale) } else { None })
}
