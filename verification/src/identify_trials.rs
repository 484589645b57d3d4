//! Flights of vehicles that are not what their file says, for asking how often identification is right.
//!
//! Each trial draws a vehicle: mass, inertia by 20 %, thrust by 5 %, lag by 30 %, delay, centre of mass by 5 mm, drag;
//! and its air: steady wind, turbulence, a gust. It flies the manoeuvre of `scenarios/identify.toml` on the estimator,
//! with a BMI088 and poses 20 ms late, and leaves what `fly` leaves: log.csv.

use host_sim::flight::Flight;
use host_sim::identification::identify::bench::{Bench, Measured};
use host_sim::identification::identify::quantities::{Quantities, Quantity};
use host_sim::reports::log;
use rand::rngs::Xoshiro256PlusPlus;
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use scenario::Scenario;
use toml_edit::{Array, DocumentMut, Table, value};

/// The manoeuvre.
pub const MANOEUVRE: &str = include_str!("../../scenarios/identify.toml");

/// How much younger the body rates are that the law gets at a tick than a scenario with an estimator counts at most,
/// s: the last sample of the IMU came now, not a millisecond ago.
pub const RATES_YOUNGER_S: f64 = 0.001;

/// RotorPy's coefficients of the Hummingbird's rotors: kg/rad, kg/rad, N/(m/s)^2.
const AT_HUBS: [(&str, f64); 3] =
    [("rotor_across", 1.19e-4), ("rotor_along", 2.32e-4), ("translational_lift", 3.39e-3)];

/// The standard uncertainty of a trial's scale, as a part of the mass.
const MASS_UNCERTAINTY_SHARE: f64 = 1e-3;

/// How the air pulls at a vehicle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Drag {
    /// As a whole, and linearly: what is found is what is.
    Whole,
    /// At the frame and at each rotor's hub, as RotorPy has it for the Hummingbird, each number drawn by 50 %. Nothing
    /// that is reported is its drag.
    AtHubs,
}

/// One vehicle as it really is, its file and its log.
#[derive(Debug, Clone)]
pub struct Trial {
    /// The file, with the truth in it.
    pub text: String,
    /// Its log.
    pub log: String,
    /// Its mass on a scale.
    pub bench: Bench,
    truths: Truths,
    drag: Drag,
}

/// Numbers by the names of [`Trial::truths`].
#[derive(Debug, Clone, Copy, Default)]
struct Truths {
    mass: f64,
    thrust_scale: f64,
    inertia: [f64; 3],
    lag: f64,
    delay: f64,
    centre: [f64; 2],
    drag: [f64; 3],
}

impl Trial {
    /// Number `seed` of the vehicles like `file`'s, in an air that pulls at it like `drag`; `delay`, s, in place of the
    /// one drawn.
    ///
    /// # Errors
    /// If `file` is no scenario with rotors, or the flight fails.
    pub fn flown(file: &str, seed: u64, drag: Drag, delay: Option<f64>) -> Result<Self, String> {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
        let mut document: DocumentMut = file.parse().map_err(|error| format!("{error}"))?;
        let manoeuvre: DocumentMut = MANOEUVRE.parse().map_err(|error| format!("{error}"))?;
        for section in ["duration", "initial", "reference"] {
            document[section] = manoeuvre[section].clone();
        }
        let model = Scenario::parse(file, "trial").map_err(|error| error.to_string())?;
        let mut truths = Truths::drawn(&model, &mut random);
        truths.delay = delay.unwrap_or(truths.delay);
        truths.write(&mut document);
        for section in ["drag", "wind", "estimator", "sampling"] {
            document[section] = toml_edit::Item::Table(Table::new());
        }
        let mut within = |reach: f64| random.random_range(-reach..reach);
        match drag {
            Drag::Whole => document["drag"]["linear"] = list(&truths.drag),
            Drag::AtHubs => {
                for (key, usual) in AT_HUBS {
                    document["drag"][key] = value(usual * (1.0 + within(0.5)));
                }
                document["drag"]["frame"] = list(&[5e-3, 5e-3, 1e-2]);
            }
        }
        document["wind"]["steady"] = list(&[within(3.0), within(3.0), 0.0]);
        let mut gust = Table::new();
        gust.insert("kind", value("one-cosine"));
        gust.insert("start", value(20.0));
        gust.insert("duration", value(1.0));
        gust.insert("velocity", list(&[within(3.0), within(3.0), 0.0]));
        document["wind"]["gust"] = toml_edit::Item::Table(gust);
        let mut turbulence = Table::new();
        turbulence.insert("wind_at_20_feet", value(5.0));
        turbulence.insert("altitude", value(10.0));
        turbulence.insert("seed", value(seed as i64));
        document["wind"]["turbulence"] = toml_edit::Item::Table(turbulence);
        document["estimator"]["seed"] = value(seed as i64);
        document["sampling"]["delay"] = value(truths.delay);
        let text = document.to_string();
        let log = fly(&text)?;
        let normal: f64 = StandardNormal.sample(&mut random);
        let weighed = truths.mass * (1.0 + MASS_UNCERTAINTY_SHARE * normal);
        let bench = Bench {
            mass: Some(Measured { value: weighed, uncertainty: MASS_UNCERTAINTY_SHARE * weighed }),
            ..Bench::default()
        };
        Ok(Self { text, log, bench, truths, drag })
    }

    /// The name of each quantity, its estimate, and its true value.
    #[must_use]
    pub fn truths(&self, identified: &Quantities) -> Vec<(&'static str, Quantity, f64)> {
        let t = &self.truths;
        let mut truths = vec![
            ("mass", identified.mass, t.mass),
            ("thrust scale", identified.thrust_scale, t.thrust_scale),
            ("inertia x", identified.inertia[0], t.inertia[0]),
            ("inertia y", identified.inertia[1], t.inertia[1]),
            ("inertia z", identified.inertia[2], t.inertia[2]),
            ("lag and delay", identified.whole_delay, t.lag + t.delay - RATES_YOUNGER_S),
            ("lag", identified.lag, t.lag),
            // No estimate is below zero.
            ("delay", identified.delay, (t.delay - RATES_YOUNGER_S).max(0.0)),
            ("centre of mass x", identified.centre_of_mass[0], t.centre[0]),
            ("centre of mass y", identified.centre_of_mass[1], t.centre[1]),
            ("drag x", identified.drag[0], t.drag[0]),
            ("drag y", identified.drag[1], t.drag[1]),
            ("drag z", identified.drag[2], t.drag[2]),
        ];
        if self.drag == Drag::AtHubs {
            truths.truncate(truths.len() - identified.drag.len());
        }
        truths
    }
}

impl Truths {
    fn drawn(model: &Scenario, random: &mut Xoshiro256PlusPlus) -> Self {
        let vehicle = model.configuration.vehicle();
        let mut about = |part: f64| 1.0 + random.random_range(-part..part);
        let mass = f64::from(vehicle.mass) * about(0.2);
        let inertia = loop {
            let drawn: [f64; 3] = std::array::from_fn(|axis| f64::from(vehicle.inertia[axis]) * about(0.2));
            let greatest = drawn.iter().copied().fold(0.0, f64::max);
            // A body that can exist.
            if 2.0 * greatest < drawn.iter().sum::<f64>() {
                break drawn;
            }
        };
        let delay = (1e3 * (model.delay() + 0.003) * about(0.6)).round() * 1e-3;
        Self {
            mass,
            inertia,
            thrust_scale: about(0.05),
            lag: model.rotor_lag * about(0.3),
            delay,
            centre: [0, 1].map(|_| 0.005 * (about(0.999) - 1.0)),
            drag: [0.25, 0.25, 0.15].map(|usual| usual * about(0.6)),
        }
    }

    fn write(&self, document: &mut DocumentMut) {
        let mut truth = Table::new();
        truth.insert("mass", value(self.mass));
        truth.insert("inertia", list(&self.inertia));
        truth.insert("thrust_scale", value(self.thrust_scale));
        truth.insert("lag", value(self.lag));
        truth.insert("centre_of_mass", list(&[self.centre[0], self.centre[1], 0.0]));
        document["truth"] = toml_edit::Item::Table(truth);
    }
}

fn list(numbers: &[f64]) -> toml_edit::Item {
    value(numbers.iter().copied().collect::<Array>())
}

/// Flies a scenario and returns its log.csv.
///
/// # Errors
/// If it is no scenario, or cannot be flown to its end.
pub fn fly(text: &str) -> Result<String, String> {
    let scenario = Scenario::parse(text, "trial").map_err(|error| error.to_string())?;
    let mut flight = Flight::new(&scenario).map_err(|error| error.to_string())?;
    let rotors = scenario.configuration.rotors().map_or(0, |rotors| rotors.len());
    let header =
        log::header(rotors, scenario.configuration.paper().is_none()) + &log::reality_header(&scenario.reality);
    let mut out = header.into_bytes();
    out.push(b'\n');
    for _ in 0..scenario.timing.ticks {
        let tick = flight.tick().map_err(|error| error.to_string())?;
        log::write_row(&mut out, &tick).map_err(|error| error.to_string())?;
    }
    String::from_utf8(out).map_err(|error| error.to_string())
}
