//! Policies that mean harm, behind the shield: a thousand short flights of a Hummingbird and of two published vehicles,
//! the Hummingbird and one more in wind. No command is beyond a rotor or a limit, and no vehicle leaves its box by more
//! than [`OUTSIDE`]. The same policies on the law alone, within the same limits, crash.
//! `cargo test -p host-sim shield -- --nocapture` prints the table that stands in `docs/shield.md`.

use crate::support::random::{self, ChaCha8Rng};
use controller_core::heading::Heading;
use controller_core::reference::Reference;
use controller_core::shield::{Demand, Reason, Settings, Shield};
use controller_core::state::State;
use host_sim::flight;
use host_sim::vehicle::SimulatedVehicle;
use nalgebra::{Quaternion, Vector3};
use rand::RngExt;
use scenario::Scenario;
use std::f32::consts::TAU;
use std::path::Path;

/// How far outside of its box a vehicle may come, m.
const OUTSIDE: f64 = 0.1;

/// The box, m.
const LOW: Vector3<f32> = Vector3::new(-4.0, -4.0, 0.5);
const HIGH: Vector3<f32> = Vector3::new(4.0, 4.0, 5.0);

/// The time of a flight, s.
const DURATION: f64 = 5.0;

/// Vehicles, and the winds that they fly in, m/s.
const VEHICLES: [(&str, &[f64]); 3] =
    [("hummingbird", &[0.0, 1.5, 3.0]), ("published/x500", &[0.0, 3.0]), ("published/cf2x-pybullet", &[0.0])];

/// A policy.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    /// Any acceleration, another one now and then.
    Random,
    /// All there is, one way and the other.
    BangBang,
    /// Down.
    Floor,
    /// Straight on.
    Wall,
    /// Attitudes that swing beyond a right angle, with any thrust.
    Swinging,
    /// Upside down.
    Upturned,
    /// Numbers that are none, among others.
    NotFinite,
    /// Nothing more to say after a while.
    Silent,
}

const KINDS: [Kind; 8] = [
    Kind::Random,
    Kind::BangBang,
    Kind::Floor,
    Kind::Wall,
    Kind::Swinging,
    Kind::Upturned,
    Kind::NotFinite,
    Kind::Silent,
];

struct Malicious {
    kind: Kind,
    rng: ChaCha8Rng,
    weight: f32,
    direction: Vector3<f32>,
    /// 1/s.
    frequency: f32,
    kept: Vector3<f32>,
}

fn any(rng: &mut ChaCha8Rng) -> Vector3<f32> {
    Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0))
}

impl Malicious {
    fn new(kind: Kind, weight: f32, mut rng: ChaCha8Rng) -> Self {
        let (direction, frequency) = (any(&mut rng).normalize(), rng.random_range(0.3..4.0));
        Self { kind, rng, weight, direction, frequency, kept: Vector3::zeros() }
    }

    fn act(&mut self, time: f32) -> Option<Demand> {
        let phase = (TAU * self.frequency * time).sin();
        let yaw_rate = 5.0 * phase;
        let accelerate = |acceleration| Some(Demand::Acceleration { acceleration, yaw_rate });
        let point = |angle: f32, thrust| {
            let (sin, cos) = (0.5 * angle).sin_cos();
            Some(Demand::Attitude { attitude: Quaternion::from_parts(cos, self.direction * sin), thrust })
        };
        match self.kind {
            Kind::Random | Kind::NotFinite => {
                if self.rng.random_bool(0.05) {
                    self.kept = any(&mut self.rng) * 30.0;
                }
                let broken = self.kind == Kind::NotFinite && self.rng.random_bool(0.02);
                accelerate(if broken { Vector3::repeat(f32::NAN) } else { self.kept })
            }
            Kind::BangBang => accelerate(self.direction * 100.0 * phase.signum()),
            Kind::Floor => accelerate(Vector3::new(3.0 * self.direction.x, 3.0 * self.direction.y, -50.0)),
            Kind::Wall => accelerate(self.direction * 50.0),
            Kind::Swinging => point(2.5 * phase, self.weight * self.rng.random_range(0.0..2.0)),
            Kind::Upturned => point(3.1, 2.0 * self.weight),
            Kind::Silent if time > 0.5 => None,
            Kind::Silent => accelerate(self.direction * 8.0),
        }
    }
}

fn read(name: &str, wind: f64) -> Scenario {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../vehicles/{name}.toml"));
    let mut text = std::fs::read_to_string(file).unwrap();
    if wind > 0.0 {
        text += &format!("\n[wind]\nsteady = [{}, {}, 0.0]\n", 0.8 * wind, 0.6 * wind);
    }
    Scenario::parse(&text, name).unwrap()
}

/// What flights showed.
#[derive(Debug, Default)]
struct Shown {
    flights: u32,
    ticks: u32,
    by_policy: u32,
    /// The farthest outside of the box, m, and the lowest, m.
    outside: f64,
    lowest: f64,
    fastest: f64,
    hand_overs: u32,
    crashed: u32,
}

/// One flight, behind the shield or on the law alone.
fn fly(scenario: &Scenario, kind: Kind, rng: &mut ChaCha8Rng, shielded: bool, shown: &mut Shown) {
    let mut scenario = scenario.clone();
    let inside = |axis: usize| rng.random_range(LOW[axis] + 1.0..HIGH[axis] - 1.0);
    let start = [0, 1, 2].map(inside);
    scenario.initial.position = Vector3::from(start).cast();
    let configuration = &scenario.configuration;
    let period = scenario.timing.period() as f32;
    let mut vehicle = SimulatedVehicle::new(&scenario, configuration);
    let mut law = flight::law(&scenario).unwrap();
    let law = law.extended().unwrap();
    let settings = Settings { patience: 0.2, patience_greatest: 0.2, hand_overs: 100, ..Settings::new(LOW, HIGH) };
    let mut shield = Shield::new(configuration, &settings, period).unwrap();
    let weight = configuration.vehicle().mass * configuration.vehicle().gravity;
    let mut policy = Malicious::new(kind, weight, random::generator(rng.random()));
    let level = Reference::resting(Vector3::zeros(), Heading::FORWARD);
    let mut last = Demand::Acceleration { acceleration: Vector3::zeros(), yaw_rate: 0.0 };
    let mut outside = 0.0_f64;
    for tick in 0..(DURATION / scenario.timing.period()) as u32 {
        let state: State = vehicle.state().measured();
        let offers = policy.act(tick as f32 * period);
        let wrench = if shielded {
            let flown = shield.step(law, &state, offers.as_ref()).unwrap();
            shown.by_policy += u32::from(flown.reason.is_none());
            flown.wrench
        } else {
            last = offers.filter(|demand| demand.check().is_ok()).unwrap_or(last);
            law.step_on_demand(&state, &level, &last).unwrap().0
        };
        let (clipped, _) =
            vehicle.hold(&wrench.scaled(1.0 / law.thrust_scale()), scenario.timing.steps_per_tick).unwrap();
        assert!(!clipped, "{kind:?} {tick}: {wrench:?} is beyond the rotors or the limits");
        let body = vehicle.state();
        let place = body.position;
        outside = outside.max((LOW.cast() - place).max()).max((place - HIGH.cast()).max());
        shown.lowest = shown.lowest.min(place.z);
        shown.fastest = shown.fastest.max(body.velocity.norm());
        shown.ticks += 1;
    }
    assert!(!shielded || outside <= OUTSIDE, "{kind:?} in {}: {outside} m outside", scenario.name);
    shown.outside = shown.outside.max(outside);
    shown.crashed += u32::from(outside > 1.0 || shown.lowest <= 0.0);
    shown.hand_overs += shield.hand_overs();
    shown.flights += 1;
}

/// Flights of each policy on each vehicle in each wind.
fn campaign(each: u32, shielded: bool) -> Vec<(&'static str, f64, Kind, Shown)> {
    let mut rng = random::generator(301);
    let mut all = Vec::new();
    for (name, winds) in VEHICLES {
        for wind in winds {
            let scenario = read(name, *wind);
            for kind in KINDS {
                let mut shown = Shown { lowest: f64::MAX, ..Shown::default() };
                for _ in 0..each {
                    fly(&scenario, kind, &mut rng, shielded, &mut shown);
                }
                all.push((name, *wind, kind, shown));
            }
        }
    }
    all
}

#[test]
fn no_policy_leaves_the_box_touches_the_ground_or_overloads_a_rotor() {
    println!(
        "| vehicle | wind, m/s | policy | flights | by policy, % | hand-overs | outside, m | lowest, m | fastest, m/s |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    let mut flights = 0;
    for (name, wind, kind, shown) in campaign(21, true) {
        let Shown { outside, lowest, fastest, .. } = shown;
        let share = 100.0 * f64::from(shown.by_policy) / f64::from(shown.ticks);
        println!(
            "| {name} | {wind} | {kind:?} | {} | {share:.0} | {} | {outside:.2} | {lowest:.2} | {fastest:.1} |",
            shown.flights, shown.hand_overs
        );
        assert!(lowest > 0.3 && shown.by_policy > 0 && shown.hand_overs >= shown.flights, "{name} {kind:?} {shown:?}");
        flights += shown.flights;
    }
    assert!(flights >= 1_000);
}

/// The law alone keeps its limits and goes wherever it is sent.
#[test]
fn without_the_monitor_the_same_policies_crash() {
    for (name, wind, kind, shown) in campaign(2, false) {
        // A hover that nobody contradicts stays where it is.
        let harmless = matches!(kind, Kind::BangBang | Kind::Random | Kind::NotFinite | Kind::Swinging);
        assert!(harmless || shown.crashed == shown.flights, "{name} {wind} {kind:?} {shown:?}");
    }
}

#[test]
fn every_reason_of_the_table_is_documented() {
    let page = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/shield.md")).unwrap();
    let rows: Vec<&str> = page.lines().filter_map(|line| line.strip_prefix("| `")?.split('`').next()).collect();
    assert_eq!(rows, Reason::ALL.map(Reason::word));
}
