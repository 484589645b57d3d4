//! The commands about real flights, from files to reports: `identify --columns`, `replay-model`, `replay-estimator` and
//! `replay-law`.

use super::columns::{ColumnMap, NANOBENCH};
use super::estimation::{self, GAPS_EVERY_S, PoseStream};
use super::flown::{Flown, PERIOD_S};
use super::forces::Forces;
use super::law::{LawBeside, beside, rewritten_by};
use super::model::FoundVehicle;
use super::prediction::{HORIZONS_S, Way, foretold};
use super::recording::Recording;
use super::regression::Shown;
use super::setpoint_path::SetpointPath;
use super::suspicions;
use super::torques::{moments_of_speed, turnings};
use crate::output::table::{aligned, short};
use controller_core::allocation::Rotors;
use scenario::Scenario;
use std::path::PathBuf;

/// What every one of them reads.
#[derive(Debug, Clone)]
pub struct Task {
    /// A CSV.
    pub log: PathBuf,
    /// A file, or `nanobench`; none if the log's own columns shall tell.
    pub columns: Option<PathBuf>,
    /// The scenario's text, and how errors call it.
    pub original: String,
    /// See [`Self::original`].
    pub file: String,
}

/// Why there is no report.
#[derive(Debug)]
pub enum Refused {
    /// A file cannot be used.
    Input(String),
    /// The files can be read, but the flight is not what they say it is, or does not show what was asked.
    NotShown(String),
}

/// A flight that was read and checked.
pub struct Read {
    scenario: Scenario,
    recording: Recording,
    flown: Flown,
    head: String,
}

impl Read {
    /// Reads the files, and looks for what cannot be.
    ///
    /// # Errors
    /// [`Refused`].
    pub fn new(task: &Task) -> Result<Self, Refused> {
        let scenario =
            Scenario::parse(&task.original, &task.file).map_err(|error| Refused::Input(error.to_string()))?;
        let (map, columns) = map(task)?;
        let rotors = rotors(&scenario).map_err(|what| Refused::Input(format!("{}: {what}", task.file)))?;
        let recording = Recording::read(&task.log, &map).map_err(Refused::Input)?;
        let not_shown = |lines: &[String]| {
            let lines = lines.join("\n  ");
            Refused::NotShown(format!("{}: is not what {} says\n  {lines}", task.log.display(), columns))
        };
        let wrong = suspicions::of_turning(&recording, &map);
        if !wrong.is_empty() {
            return Err(not_shown(&wrong));
        }
        let flown = Flown::new(&recording, rotors)
            .map_err(|what| Refused::NotShown(format!("{}: {what}", task.log.display())))?;
        let vehicle = scenario.configuration.vehicle();
        let weight = f64::from(vehicle.mass * vehicle.gravity);
        let wrong = suspicions::of_flight(&recording, &flown, &map, rotors, weight);
        if !wrong.is_empty() {
            return Err(not_shown(&wrong));
        }
        let head = format!(
            "{}: {:.1} s in the air, on the vehicle of {}\n{}{}",
            task.log.display(),
            flown.seconds(),
            task.file,
            recording.described(),
            suspicions::remarks(&flown)
        );
        Ok(Self { scenario, recording, flown, head })
    }

    fn gravity(&self) -> f64 {
        f64::from(self.scenario.configuration.vehicle().gravity)
    }

    fn forces(&self, task: &Task) -> Result<Forces, Refused> {
        Forces::new(&self.flown, self.recording.measure, self.gravity())
            .map_err(|what| Refused::NotShown(format!("{}: {what}", task.log.display())))
    }
}

/// Which column is what, and what that is called.
fn map(task: &Task) -> Result<(ColumnMap, String), Refused> {
    const NAME: &str = "nanobench";
    let in_file = |name: &str, what: String| Refused::Input(format!("{name}: {what}"));
    let Some(path) = task.columns.as_deref().filter(|path| path.to_str() != Some(NAME)) else {
        let map = ColumnMap::parse(NANOBENCH).map_err(|what| in_file(NAME, what))?;
        return Ok((map, format!("{NAME}.toml, built in,")));
    };
    let name = path.display().to_string();
    let text = scenario::text::read(path).map_err(|error| in_file(&name, format!("cannot be read: {error}")))?;
    Ok((ColumnMap::parse(&text).map_err(|what| in_file(&name, what))?, name))
}

fn rotors(scenario: &Scenario) -> Result<&Rotors, String> {
    scenario.configuration.rotors().ok_or_else(|| "rotors: is missing; a log's motors need a model".to_owned())
}

/// What the flight shows of the vehicle, and the scenario's text with it.
///
/// # Errors
/// [`Refused`].
pub fn identified(task: &Task) -> Result<(String, String), Refused> {
    let read = Read::new(task)?;
    let forces = read.forces(task)?;
    let rotors = rotors(&read.scenario).map_err(Refused::Input)?;
    let vehicle = read.scenario.configuration.vehicle();
    let mass = f64::from(vehicle.mass);
    let row = |name: &str, shown: &Shown, factor: f64, file: Option<f64>, unit: &str| {
        let [least, greatest] = shown.interval().map(|end| short(end * factor));
        let file = file.map_or("-".to_owned(), short);
        [name.to_owned(), short(shown.value * factor), least, greatest, file, unit.to_owned()].to_vec()
    };
    let drag = read.scenario.reality.drag.map(|drag| drag.linear);
    let mut rows = vec![["", "shown", "from", "to", "file", ""].map(str::to_owned).to_vec()];
    rows.push(row("thrust scale / mass", &forces.strength, 1.0, Some(1.0 / mass), "1/kg"));
    rows.push(row("thrust scale", &forces.strength, mass, Some(1.0), ""));
    rows.push(row("of a change of thrust", &forces.response, 1.0, Some(1.0), ""));
    if let Some([up, down]) = &forces.lags {
        rows.push(row("rotor lag up", up, 1.0, Some(read.scenario.rotor_lag), "s"));
        rows.push(row("rotor lag down", down, 1.0, Some(read.scenario.rotor_lag), "s"));
    }
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let file = drag.map(|drag| drag[axis]);
        rows.push(row(&format!("linear drag {name}"), &forces.drag[axis], mass, file, "kg/s"));
    }
    for (name, moment) in ["moment of speed along y about x", "moment of speed along x about y"]
        .into_iter()
        .zip(moments_of_speed(&read.flown, rotors, forces.lag_values()))
    {
        rows.push(row(name, &moment, forces.strength.value * mass, None, "N m s/m"));
    }
    let mut reasons = Vec::new();
    let log_rate = 1.0 / read.recording.motors.period();
    let inertia = vehicle.inertia.map(f64::from);
    for (axis, turning) in turnings(&read.flown, rotors, forces.lag_values()).iter().enumerate() {
        let name = ["x", "y", "z"][axis];
        match turning.inertia(log_rate, read.recording.loop_rate) {
            Ok((value, [least, greatest])) => {
                let scale = forces.strength.value * mass;
                let numbers = [value, least, greatest].map(|number| short(number * scale));
                let file = short(inertia[axis]);
                let [value, least, greatest] = numbers;
                rows.push(vec![format!("inertia {name}"), value, least, greatest, file, "kg m^2".to_owned()]);
            }
            Err(why) => reasons.push(format!("the log cannot show inertia {name}: {why}\n")),
        }
    }
    let parts = forces.strengths.iter().map(|part| short(part * mass)).collect::<Vec<_>>().join(", ");
    let [left, was] = forces.left;
    let report = format!(
        "{}\n{}intervals: 95 %; of thrust scale, where a part of a next flight would be\n\
         thrust scale, part by part: {parts}\n\
         mass {} kg is the file's: a flight shows thrust scale over mass alone\n\
         of {:.3} m/s^2 that thrust along z varies by, {:.3} are left{}\n{}",
        read.head,
        aligned(&rows),
        short(mass),
        was,
        left,
        if read.flown.is_felt {
            format!("; the accelerometer shows {:.4} of gravity", forces.accelerometer_scale)
        } else {
            String::new()
        },
        reasons.concat()
    );
    let text = rewritten_by(&task.original, &read.scenario, &forces)
        .map_err(|what| Refused::Input(format!("{}: {what}", task.file)))?;
    Ok((report, text))
}

/// One half foretold by the other.
///
/// # Errors
/// [`Refused`].
pub fn replayed_model(task: &Task) -> Result<String, Refused> {
    let read = Read::new(task)?;
    let rotors = rotors(&read.scenario).map_err(Refused::Input)?;
    let half = read.flown.samples.len() / 2;
    let first = Flown { samples: read.flown.samples[..half].to_vec(), ..read.flown.clone() };
    let not_shown = |what: String| Refused::NotShown(format!("{}: its first half {what}", task.log.display()));
    let forces = Forces::new(&first, read.recording.measure, read.gravity()).map_err(not_shown)?;
    let log_rate = 1.0 / read.recording.motors.period();
    let turns = turnings(&first, rotors, forces.lag_values())
        .map(|turning| turning.inertia(log_rate, read.recording.loop_rate).is_ok());
    let vehicle = FoundVehicle::new(&first, &forces, rotors, read.gravity(), turns).map_err(not_shown)?;
    let hidden: Vec<&str> = (0..3).filter(|axis| !turns[*axis]).map(|axis| ["x", "y", "z"][axis]).collect();
    let hidden = match hidden.as_slice() {
        [] => String::new(),
        hidden => format!("; not about {}, which this log does not show (identify says why)", hidden.join(", ")),
    };
    let foretold = foretold(&read.flown, half, &vehicle, rotors);
    let head = ["", "ahead", "position", "velocity", "attitude", "rates"].map(str::to_owned).to_vec();
    let mut rows = vec![head];
    for (way, errors) in Way::ALL.into_iter().zip(&foretold.errors) {
        for (horizon, errors) in HORIZONS_S.iter().zip(errors) {
            rows.push(vec![
                way.name().to_owned(),
                format!("{horizon} s"),
                format!("{} m", short(errors.position)),
                format!("{} m/s", short(errors.velocity)),
                format!("{} degrees", short(errors.attitude.to_degrees())),
                if way == Way::Gyro { "-".to_owned() } else { format!("{} rad/s", short(errors.rates)) },
            ]);
        }
    }
    Ok(format!(
        "{}\nfound in the first {:.1} s, foretold from {} states of the other half; errors, RMS\n{}\
         commands: thrust and turning by the model{hidden}. gyro: thrust by the model, turning as measured.\n\
         hover: thrust carries the weight, turning goes on, no drag\n",
        read.head,
        half as f64 * PERIOD_S,
        foretold.starts,
        aligned(&rows)
    ))
}

/// What boards believe: poses of 1 mm, 0.3 degrees, 1 ms, and a BMI088 of their own.
const AS_BOARDS: PoseStream = PoseStream {
    every: 5,
    late: 0.02,
    gap: 0.0,
    aligned: true,
    time_noise: 1e-3,
    position_noise: 1e-3,
    attitude_noise: 5.2e-3,
    imu_noise: [1.0, 1.0],
};
/// What an IMU deserves that a radio logged 100 times a second with times that are off by tens of milliseconds, and
/// markers on a vehicle as small as a hand: 2 mm, 1 degree, 10 ms.
const AS_LOGGED: PoseStream = PoseStream {
    time_noise: 1e-2,
    position_noise: 2e-3,
    attitude_noise: 1.7e-2,
    imu_noise: [100.0, 30.0],
    ..AS_BOARDS
};

/// An estimate that is so far off is lost, m.
const LOST_M: f64 = 5.0;

/// Streams of poses that the estimator is tried on.
const STREAMS: [(&str, PoseStream); 5] = [
    ("20 poses a second, 20 ms late; noise as boards believe", AS_BOARDS),
    ("the same; noise as a radio's log deserves", AS_LOGGED),
    ("the same, without poses for 0.5 s of 4", PoseStream { gap: 0.5, ..AS_LOGGED }),
    ("the same, without poses for 1 s of 4", PoseStream { gap: 1.0, ..AS_LOGGED }),
    ("20 poses a second, with the file's times", PoseStream { aligned: false, time_noise: 0.03, ..AS_LOGGED }),
];

/// Our estimator, and the vehicle's own.
///
/// # Errors
/// [`Refused`].
pub fn replayed_estimator(task: &Task) -> Result<String, Refused> {
    let read = Read::new(task)?;
    let vehicle = read.scenario.configuration.vehicle();
    let head = ["", "position", "greatest", "attitude", "velocity", "NIS", "poses refused"].map(str::to_owned).to_vec();
    let mut rows = vec![head];
    let centimetres = |metres: f64| {
        if metres < LOST_M { format!("{} cm", short(100.0 * metres)) } else { "LOST".to_owned() }
    };
    for (name, stream) in STREAMS {
        let run = estimation::estimated(&read.flown, &read.recording, &stream, vehicle)
            .map_err(|what| Refused::NotShown(format!("{}: {what}", task.log.display())))?;
        let (fused, refused) = run.counts;
        rows.push(vec![
            name.to_owned(),
            centimetres(run.off.position),
            centimetres(run.off.greatest),
            format!("{} degrees", short(run.off.degrees)),
            format!("{} m/s", short(run.off.velocity)),
            format!("{} {}", short(run.nis[0]), short(run.nis[1])),
            format!("{refused} of {}", fused + refused),
        ]);
        if run.missing > 0 {
            rows.push(vec![format!("  no state at {} samples", run.missing)]);
        }
    }
    for (name, aligned) in [("the vehicle's own filter", true), ("the same, with the file's times", false)] {
        if let Some(off) = estimation::own(&read.recording, &read.flown, aligned) {
            rows.push(vec![
                name.to_owned(),
                centimetres(off.position),
                centimetres(off.greatest),
                format!("{} degrees", short(off.degrees)),
                "-".to_owned(),
                "-".to_owned(),
                "-".to_owned(),
            ]);
        }
    }
    Ok(format!(
        "{}\nestimates against all poses, RMS; NIS of positions and attitudes: 3 where noise is as believed\n{}\
         gaps begin every {GAPS_EVERY_S} s. With the file's times, the truth is the row of the same time.\n",
        read.head,
        aligned(&rows)
    ))
}

/// Our law beside the one that flew.
///
/// # Errors
/// [`Refused`].
pub fn replayed_law(task: &Task) -> Result<(String, LawBeside), Refused> {
    let read = Read::new(task)?;
    let forces = read.forces(task)?;
    let not_shown = |what: String| Refused::NotShown(format!("{}: {what}", task.log.display()));
    let text = rewritten_by(&task.original, &read.scenario, &forces).map_err(Refused::Input)?;
    let path = SetpointPath::new(&read.flown.samples, &text, &task.file).map_err(not_shown)?;
    let estimated = (read.recording.pose.is_some() && read.flown.is_felt).then(|| {
        estimation::estimated(&read.flown, &read.recording, &AS_LOGGED, path.scenario.configuration.vehicle())
    });
    let estimated = estimated.transpose().map_err(not_shown)?;
    let result = beside(&read.flown, &forces, &path, estimated.as_ref()).map_err(not_shown)?;
    let head = ["", "RMS", "greatest", "best shift of time", "RMS then"].map(str::to_owned).to_vec();
    let row = |name: &str, tracking: &super::law::Tracking| {
        vec![
            name.to_owned(),
            format!("{} m", short(tracking.rms)),
            format!("{} m", short(tracking.greatest)),
            format!("{} s", short(tracking.late)),
            format!("{} m", short(tracking.rms_late)),
        ]
    };
    let rows = [
        head,
        row("the law that flew", &result.flown),
        row("the path near them", &result.reference),
        row("ours, simulated", &result.ours),
    ];
    let [was, ours, apart] = result.thrust;
    let report = format!(
        "{}\nsetpoints without a jump: {:.1} s; the path is within {} m of each; vehicle and path are {}certified\n\
         distance from the setpoints\n{}\
         a rotor's command was cut in {} of {} ticks\n\
         on the recorded states our thrust is {} of the weight, flown were {}; {} apart, RMS;\n\
         our wanted direction of thrust is {} degrees from the flown, RMS\n",
        read.head,
        path.samples.len() as f64 * PERIOD_S,
        short(path.within),
        if result.certified { "" } else { "NOT " },
        aligned(&rows),
        result.clipped,
        result.ticks,
        short(ours),
        short(was),
        short(apart),
        short(result.degrees),
    );
    Ok((report, result))
}
