//! Flights of the page, tick by tick.

use crate::indi;
use crate::tasks::{self, FlightRequest, LawName};
use crate::vehicle_file::VehicleFile;
use controller_core::certificate::Certificate;
use host_sim::flight::tasks::WIND_START_S;
use host_sim::flight::{Flight, Tick};
use scenario::Scenario;
use scenario::verdict::Verdict;
use serde::Serialize;

/// The least time between two rows.
const ROW_PERIOD_US: u64 = 10_000;
/// Within this distance for good a vehicle has settled.
const SETTLED_M: f64 = 0.1;
/// Where the vehicle is to hold a place, the flight ends so long after all laws have settled, and not before this time.
const AFTER_SETTLING_S: f64 = 3.0;
const SHORTEST_S: f64 = 6.0;

/// The answer.
#[derive(Debug, Serialize)]
pub struct Flights {
    /// One a law.
    pub flights: Vec<Flown>,
    /// Where the reference goes, m, a row a tick.
    pub reference: Vec<[f32; 3]>,
    /// Of the commands.
    pub bounds: Bounds,
    /// m/s, world, while it blows.
    pub wind: [f64; 3],
    /// When it sets in, s.
    pub wind_start: f64,
}

/// The limits.
#[derive(Debug, Serialize)]
pub struct Bounds {
    /// N.
    pub thrust_max: f32,
    /// N m.
    pub torque_max: [f32; 3],
    /// Of a rotor, N, least and greatest.
    pub rotor: Option<[f32; 2]>,
    /// What our law never exceeds.
    pub proven: Option<Proven>,
}

/// What is proven of our law's commands.
#[derive(Debug, Serialize)]
pub struct Proven {
    /// N.
    pub thrust: [f64; 2],
    /// N m.
    pub torque: [f64; 3],
}

/// A flight.
#[derive(Debug, Serialize)]
pub struct Flown {
    /// The law.
    pub law: LawName,
    /// Where its gains come from; may be empty.
    pub note: &'static str,
    /// Why it ended early.
    pub ended: Option<String>,
    /// s.
    pub t: Vec<f32>,
    /// m, world.
    pub position: Vec<[f32; 3]>,
    /// Scalar first.
    pub attitude: Vec<[f32; 4]>,
    /// m.
    pub position_error: Vec<f32>,
    /// Degrees, of the body's z from the vertical.
    pub tilt: Vec<f32>,
    /// Commanded, N.
    pub thrust: Vec<f32>,
    /// Commanded, N m.
    pub torque: Vec<[f32; 3]>,
    /// Commanded of each rotor, N.
    pub rotors: Vec<Vec<f32>>,
    /// Whether a limit or a rotor's range cut something.
    pub cut: Vec<bool>,
    /// In short.
    pub figures: Figures,
}

/// A flight in short.
#[derive(Debug, Serialize)]
pub struct Figures {
    /// m.
    pub height_lost: f64,
    /// s.
    pub settled: Option<f64>,
    /// m.
    pub end_error: f64,
    /// Ticks.
    pub cut: usize,
}

/// A law's ticks, and why it ended early.
struct Ticks {
    law: LawName,
    note: &'static str,
    ticks: Vec<Tick>,
    ended: Option<String>,
}

/// Flies what `request` says.
///
/// # Errors
/// One line: the file or the field, and what is wrong.
pub fn fly(file: &VehicleFile, request: &FlightRequest) -> Result<Flights, String> {
    let vehicle = tasks::vehicle(file)?;
    let (scenario, holds) = tasks::scenario(&vehicle, file, request)?;
    let said = |what: String| format!("{}: {what}", file.file);
    let mut laws: Vec<Ticks> = Vec::new();
    for &law in &request.laws {
        laws.push(ticks(&vehicle, &scenario, law).map_err(said)?);
    }
    let end = if holds { end(&scenario, &laws) } else { usize::MAX };
    let every = ROW_PERIOD_US.div_ceil(scenario.timing.period_us) as usize;
    let longest = laws.iter().map(|law| &law.ticks).max_by_key(|ticks| ticks.len());
    let reference = longest.into_iter().flatten().take(end).step_by(every);
    Ok(Flights {
        reference: reference.map(|tick| tick.reference.position.into()).collect(),
        bounds: bounds(&scenario).map_err(said)?,
        wind: [request.wind, 0.0, 0.0],
        wind_start: WIND_START_S,
        flights: laws.into_iter().map(|law| flown(law, end, every)).collect(),
    })
}

/// Flies `scenario` with a law that knows of the vehicle what `vehicle` says.
fn ticks(vehicle: &Scenario, scenario: &Scenario, law: LawName) -> Result<Ticks, String> {
    let (mut flight, note) = match law {
        LawName::Ours => (Flight::new(scenario).map_err(|error| error.to_string())?, ""),
        LawName::Indi => {
            let (rival, note) = indi::on_vehicle(vehicle).ok_or("INDI is undefined on this vehicle")?;
            (Flight::of_rival(scenario, rival), note)
        }
    };
    let (mut ticks, mut ended) = (Vec::new(), None);
    for _ in 0..scenario.timing.ticks {
        match flight.tick() {
            Ok(tick) => ticks.push(tick),
            Err(error) => {
                ended = Some(error.to_string());
                break;
            }
        }
    }
    Ok(Ticks { law, note, ticks, ended })
}

/// m.
fn distance(tick: &Tick) -> f64 {
    (tick.state.position - tick.reference.position.map(f64::from)).norm()
}

/// Since which tick a vehicle has been near for good.
fn settled(ticks: &[Tick]) -> Option<usize> {
    let last_away = ticks.iter().rposition(|tick| distance(tick) > SETTLED_M);
    let since = last_away.map_or(0, |tick| tick + 1);
    (since < ticks.len()).then_some(since)
}

/// Where all have settled for a while.
fn end(scenario: &Scenario, laws: &[Ticks]) -> usize {
    let of_time = |time: f64| (time / scenario.timing.period()) as usize;
    let last = laws.iter().map(|law| settled(&law.ticks).unwrap_or(law.ticks.len())).max().unwrap_or(0);
    (last + of_time(AFTER_SETTLING_S)).max(of_time(SHORTEST_S))
}

fn flown(Ticks { law, note, ticks, ended }: Ticks, end: usize, every: usize) -> Flown {
    let flown = &ticks[..end.min(ticks.len())];
    let start = flown.first().map_or(0.0, |tick| tick.state.position.z);
    let lowest = flown.iter().map(|tick| tick.state.position.z).fold(start, f64::min);
    let seconds = |tick: &Tick| tick.time_us as f64 * 1e-6;
    let figures = Figures {
        height_lost: start - lowest,
        settled: settled(flown).and_then(|tick| flown.get(tick)).map(seconds),
        end_error: flown.last().map_or(f64::NAN, distance),
        cut: flown.iter().filter(|tick| tick.clipped).count(),
    };
    let rows: Vec<&Tick> = flown.iter().step_by(every).collect();
    let attitude = |tick: &Tick| tick.state.attitude;
    let upright = |tick: &Tick| 1.0 - 2.0 * (attitude(tick).i.powi(2) + attitude(tick).j.powi(2));
    Flown {
        law,
        note,
        // Where the rows end earlier, its end is no part of them.
        ended: ended.filter(|_| end >= ticks.len()),
        t: rows.iter().map(|tick| seconds(tick) as f32).collect(),
        position: rows.iter().map(|tick| tick.state.position.map(|p| p as f32).into()).collect(),
        attitude: rows.iter().map(|tick| attitude(tick)).map(|q| [q.w, q.i, q.j, q.k].map(|q| q as f32)).collect(),
        position_error: rows.iter().map(|tick| distance(tick) as f32).collect(),
        tilt: rows.iter().map(|tick| upright(tick).clamp(-1.0, 1.0).acos().to_degrees() as f32).collect(),
        thrust: rows.iter().map(|tick| tick.wrench.thrust).collect(),
        torque: rows.iter().map(|tick| tick.wrench.torque.into()).collect(),
        rotors: rows.iter().map(|tick| tick.rotor_thrusts.iter().copied().collect()).collect(),
        // Also one that was cut between two rows.
        cut: flown.chunks(every).map(|ticks| ticks.iter().any(|tick| tick.clipped)).collect(),
        figures,
    }
}

fn bounds(scenario: &Scenario) -> Result<Bounds, String> {
    let configuration = &scenario.configuration;
    let limits = configuration.limits();
    let verdict = Verdict::judge(scenario).map_err(|error| error.to_string())?;
    let proven = verdict.certified().map(|certified| match certified.certificate() {
        Certificate::Paper(certificate) => {
            let form = &certificate.sharp;
            Proven { thrust: [form.thrust.min, form.thrust.max], torque: form.torque.into() }
        }
        Certificate::Extended(certificate) => {
            let bounds = &certificate.bounds;
            Proven { thrust: [bounds.thrust.min, bounds.thrust.max], torque: bounds.torque.into() }
        }
    });
    let range = |rotors: &controller_core::allocation::Rotors| {
        let least = rotors.iter().map(|rotor| rotor.thrust_min).fold(f32::INFINITY, f32::min);
        let greatest = rotors.iter().map(|rotor| rotor.thrust_max).fold(0.0, f32::max);
        [least, greatest]
    };
    Ok(Bounds {
        thrust_max: limits.thrust_max,
        torque_max: limits.torque_max.into(),
        rotor: configuration.rotors().map(range),
        proven,
    })
}
