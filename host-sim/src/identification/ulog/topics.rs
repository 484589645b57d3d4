//! The firmware's ticks as topics of PX4, which Flight Review and PlotJuggler's PX4 layouts plot.
//!
//! PX4's frames are north, east, down and forward, right, down; ours are z up, and forward, left, up. So y and z change
//! their signs, of vectors as of quaternions, and our world's x counts as north. A record has no desired attitude and
//! no raw inertial sample, so there is neither `vehicle_attitude_setpoint` nor `sensor_combined`: a plot of them stays
//! empty. Of a battery only the voltage is known.

use super::reader::Ulog;
use super::writer::{Topic, Writer};
use flight::Mode;

/// The firmware's topic.
pub const TICK_TOPIC: &str = "tick";

/// What is read of it, field by field.
const TICK_FIELDS: [(&str, usize); 11] = [
    ("timestamp", 1),
    ("position", 3),
    ("velocity", 3),
    ("attitude", 4),
    ("angular_velocity", 3),
    ("reference_position", 3),
    ("reference_velocity", 3),
    ("motors", 4),
    ("voltage", 1),
    ("mode", 1),
    ("airborne", 1),
];

/// What is written, with PX4's names.
const TOPICS_WRITTEN: [Topic; 11] = [
    Topic { name: "vehicle_attitude", fields: "uint64_t timestamp;uint64_t timestamp_sample;float[4] q;" },
    Topic { name: "vehicle_angular_velocity", fields: "uint64_t timestamp;uint64_t timestamp_sample;float[3] xyz;" },
    Topic {
        name: "vehicle_local_position",
        fields: "uint64_t timestamp;uint64_t timestamp_sample;float x;float y;float z;float vx;float vy;float vz;\
                 bool xy_valid;bool z_valid;bool v_xy_valid;bool v_z_valid;",
    },
    Topic {
        name: "vehicle_local_position_setpoint",
        fields: "uint64_t timestamp;float x;float y;float z;float vx;float vy;float vz;",
    },
    Topic { name: "trajectory_setpoint", fields: "uint64_t timestamp;float[3] position;float[3] velocity;" },
    Topic { name: "actuator_motors", fields: "uint64_t timestamp;uint64_t timestamp_sample;float[12] control;" },
    Topic { name: "battery_status", fields: "uint64_t timestamp;float voltage_v;float current_a;float remaining;" },
    Topic { name: "vehicle_status", fields: "uint64_t timestamp;uint8_t nav_state;uint8_t arming_state;" },
    Topic { name: "vehicle_land_detected", fields: "uint64_t timestamp;bool landed;" },
    Topic {
        name: "esc_status",
        fields: "uint64_t timestamp;uint16_t counter;uint8_t esc_count;uint8_t esc_connectiontype;\
                 uint8_t esc_online_flags;uint8_t esc_armed_flags;esc_report[4] esc;",
    },
    // What that holds of each; no record is of it alone.
    Topic { name: "esc_report", fields: "uint64_t timestamp;int32_t esc_rpm;" },
];

/// The place of `esc_status` among them.
const ESC_STATUS: u16 = 9;

/// PX4's `esc_connectiontype` of DShot.
const CONNECTED_BY_DSHOT: u8 = 5;

/// How fast the rotors turn, where the firmware records it, rad/s.
const SPEED_FIELDS: [&str; 4] = ["rotor_speeds[0]", "rotor_speeds[1]", "rotor_speeds[2]", "rotor_speeds[3]"];

/// PX4's `arming_state`.
const ARMED_STATE: u8 = 2;
const DISARMED_STATE: u8 = 1;

/// PX4's number of the mode that comes nearest, `nav_state`.
fn nav_state(mode: Mode) -> u8 {
    match mode {
        Mode::TakingOff => 17,
        Mode::Flying => 14,
        Mode::Landing | Mode::Descending => 18,
        _ => 4,
    }
}

/// A file of PX4's topics with what `log` has of ticks; its information, parameters and texts are kept.
///
/// # Errors
/// If it has no ticks, or they lack a field.
pub fn written(log: &Ulog) -> Result<Vec<u8>, String> {
    let ticks = log.topic(TICK_TOPIC).ok_or("holds no record of a tick: --ulog converts the firmware's own logs")?;
    let names: Vec<String> = TICK_FIELDS
        .iter()
        .flat_map(|(name, count)| {
            (0..*count).map(move |index| if *count == 1 { (*name).to_owned() } else { format!("{name}[{index}]") })
        })
        .collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let rows = ticks.columns(&names).ok_or("the records of ticks lack a field: they are of another firmware")?;
    let information: Vec<(&str, &str)> =
        log.information.iter().map(|(key, text)| (key.as_str(), text.as_str())).collect();
    let parameters: Vec<(&str, f64)> = log.parameters.iter().map(|(name, value)| (name.as_str(), *value)).collect();
    let mut writer = Writer::new(log.start, &TOPICS_WRITTEN, &information, &parameters);
    let mut texts = log.texts.iter().peekable();
    // Older firmware recorded none.
    let mut speeds = ticks.columns(&SPEED_FIELDS).into_iter().flatten();
    for row in &rows {
        let tick = Record(row);
        while let Some(text) = texts.next_if(|text| text.time <= tick.time()) {
            writer.text(text.level, text.time, &text.words);
        }
        tick.write(&mut writer);
        if let Some(speeds) = speeds.next().filter(|speeds| speeds.iter().any(|speed| speed.is_finite())) {
            writer.record(ESC_STATUS, tick.time(), &tick.esc_status(&speeds));
        }
    }
    texts.for_each(|text| writer.text(text.level, text.time, &text.words));
    Ok(writer.finish())
}

/// A tick's numbers in the order of [`TICK_FIELDS`].
struct Record<'r>(&'r [f64]);

impl Record<'_> {
    fn time(&self) -> u64 {
        self.0[0] as u64
    }

    /// The numbers of a field.
    fn field(&self, name: &str) -> &[f64] {
        let (mut at, mut length) = (0, 0);
        for (field, count) in TICK_FIELDS {
            if field == name {
                length = count;
                break;
            }
            at += count;
        }
        &self.0[at..at + length]
    }

    /// A vector in PX4's axes, or a quaternion between them.
    fn in_px4_axes(&self, name: &str) -> Vec<f64> {
        let numbers = self.field(name);
        let kept = numbers.len() - 2;
        numbers.iter().enumerate().map(|(at, number)| if at < kept { *number } else { -number }).collect()
    }

    /// The rotors' speeds, rad/s, as their controllers' report.
    fn esc_status(&self, speeds: &[f64]) -> Vec<u8> {
        let mode = Mode::ALL.get(self.field("mode")[0] as usize).copied().unwrap_or(Mode::Boot);
        let all = (1_u8 << speeds.len()) - 1;
        let online = speeds.iter().rev().fold(0, |bits, speed| bits << 1 | u8::from(speed.is_finite()));
        let head = [0, 0, speeds.len() as u8, CONNECTED_BY_DSHOT, online, if mode.is_armed() { all } else { 0 }];
        let rpm = |speed: &f64| (speed * 60.0 / std::f64::consts::TAU).round() as i32;
        let reports =
            speeds.iter().flat_map(|speed| self.time().to_le_bytes().into_iter().chain(rpm(speed).to_le_bytes()));
        head.into_iter().chain(reports).collect()
    }

    /// In the order of [`TOPICS_WRITTEN`].
    fn write(&self, writer: &mut Writer) {
        let time = self.time();
        let sampled = time.to_le_bytes();
        let [position, velocity, attitude, rates] =
            ["position", "velocity", "attitude", "angular_velocity"].map(|name| self.in_px4_axes(name));
        let [to, at] = ["reference_position", "reference_velocity"].map(|name| self.in_px4_axes(name));
        let mut motors = self.field("motors").to_vec();
        motors.resize(12, f64::NAN);
        let known = [&position, &velocity].map(|vector| u8::from(vector.iter().all(|number| number.is_finite())));
        let mode = Mode::ALL.get(self.field("mode")[0] as usize).copied().unwrap_or(Mode::Boot);
        let airborne = self.field("airborne")[0] != 0.0;
        let setpoint = floats(&[&to[..], &at].concat());
        let bodies = [
            [&sampled[..], &floats(&attitude)].concat(),
            [&sampled[..], &floats(&rates)].concat(),
            [&sampled[..], &floats(&[&position[..], &velocity].concat()), &[known[0], known[0], known[1], known[1]]]
                .concat(),
            setpoint.clone(),
            setpoint,
            [&sampled[..], &floats(&motors)].concat(),
            floats(&[self.field("voltage")[0], -1.0, -1.0]),
            vec![nav_state(mode), if mode.is_armed() { ARMED_STATE } else { DISARMED_STATE }],
            vec![u8::from(!airborne)],
        ];
        (0..).zip(&bodies).for_each(|(number, body)| writer.record(number, time, body));
    }
}

fn floats(numbers: &[f64]) -> Vec<u8> {
    numbers.iter().flat_map(|number| (*number as f32).to_le_bytes()).collect()
}
