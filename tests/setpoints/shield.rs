//! Policies that mean harm, behind the shield: a thousand short flights of a Hummingbird and of two published vehicles,
//! the Hummingbird and one more in wind, and a thousand on the boards' estimator with poses that come late. No command
//! is beyond a rotor or a limit, and no vehicle leaves its box by more than [`OUTSIDE_MAX_M`]. The same policies on the
//! law alone, within the same limits, crash.
//! `cargo test -p host-sim shield -- --nocapture` prints the table that stands in `docs/shield.md`.

use crate::support::random::{self, ChaCha8Rng};
use controller_core::extended::measured::Measured;
use controller_core::heading::Heading;
use controller_core::reference::Reference;
use controller_core::shield::{Demand, Reason, Settings, Shield};
use controller_core::state::State;
use host_sim::flight;
use host_sim::flight::estimation::velocity_late;
use host_sim::flight::sensed_vehicle::SensedVehicle;
use host_sim::vehicle::SimulatedVehicle;
use host_sim::vehicle::actuators::ActuatorDemand;
use nalgebra::{Quaternion, Vector3};
use rand::RngExt;
use scenario::Scenario;
use std::f32::consts::TAU;
use std::path::Path;

/// How far outside of its box a vehicle may come.
const OUTSIDE_MAX_M: f64 = 0.1;

const BOX_LOW_M: Vector3<f32> = Vector3::new(-4.0, -4.0, 0.5);
const BOX_HIGH_M: Vector3<f32> = Vector3::new(4.0, 4.0, 5.0);

const FLIGHT_S: f64 = 5.0;

/// Vehicles, and what they fly in.
type Vehicles = &'static [(&'static str, &'static [Air])];

const KNOWN: Vehicles = &[
    ("hummingbird", &[Air::Still, Air::Wind(1.5), Air::Wind(3.0), Air::Rough]),
    ("published/x500", &[Air::Still, Air::Wind(3.0), Air::Rough]),
    ("published/cf2x-pybullet", &[Air::Still]),
];

/// On the boards' estimator.
const ESTIMATED: Vehicles = &[
    ("hummingbird", &[Air::Estimated, Air::Late, Air::RoughLate]),
    ("published/x500", &[Air::Estimated, Air::Late, Air::RoughLate]),
    ("published/cf2x-pybullet", &[Air::Estimated, Air::Late]),
];

/// What a vehicle flies in.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Air {
    Still,
    /// A steady wind, m/s.
    Wind(f64),
    /// 2 m/s of wind with turbulence, noisy states, and rotors that give 5 % less than is commanded.
    Rough,
    /// Still, on the estimator: a BMI088, and 100 poses a second with 1 mm and 0.3 degrees of noise, 20 ms late.
    Estimated,
    /// The same with 50 poses a second of 5 mm and 0.5 degrees, 100 ms late, of which a tenth never arrives.
    Late,
    /// Wind, turbulence and rotors as in `Rough`, on the estimator as in `Late`.
    RoughLate,
}

const LATE_POSES: &str = "[estimator]
pose_rate = 50.0
pose_delay = 0.1
position_noise = 0.005
attitude_noise_deg = 0.5
dropout = 0.1
";

const TURBULENCE: &str = "turbulence = { wind_at_20_feet = 5.0, altitude = 10.0, seed = 1 }
[truth]
thrust_scale = 0.95
";

impl Air {
    fn section(self) -> String {
        let steady = |wind: f64| format!("\n[wind]\nsteady = [{}, {}, 0.0]\n", 0.8 * wind, 0.6 * wind);
        match self {
            Self::Still => String::new(),
            Self::Wind(wind) => steady(wind),
            Self::Rough => {
                steady(2.0)
                    + TURBULENCE
                    + "[sensors]
gyro_noise = 0.01
position_noise = 0.003
attitude_noise_deg = 0.2
velocity_noise = 0.03
"
            }
            Self::Estimated => "\n[estimator]\n".to_owned(),
            Self::Late => format!("\n{LATE_POSES}"),
            Self::RoughLate => steady(2.0) + TURBULENCE + LATE_POSES,
        }
    }
}

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
    /// NaNs, among other numbers.
    NotFinite,
    /// Nothing more to say after a while.
    Silent,
    /// Any speeds of the rotors, others now and then.
    RotorNoise,
    /// The rotors of one side at their greatest speed, those of the other at their least; the other way now and then.
    Flipping,
    /// All rotors at their least speed.
    Falling,
    /// All rotors at their greatest speed.
    Climbing,
    /// The rotors of one diagonal at their greatest speed.
    Twisting,
}

const POLICY_KINDS: [Kind; 8] = [
    Kind::Random,
    Kind::BangBang,
    Kind::Floor,
    Kind::Wall,
    Kind::Swinging,
    Kind::Upturned,
    Kind::NotFinite,
    Kind::Silent,
];

const ROTOR_KINDS: [Kind; 5] = [Kind::RotorNoise, Kind::Flipping, Kind::Falling, Kind::Climbing, Kind::Twisting];

struct Malicious {
    kind: Kind,
    rng: ChaCha8Rng,
    weight: f32,
    direction: Vector3<f32>,
    /// 1/s.
    frequency: f32,
    kept: Vector3<f32>,
    speeds: [f32; 4],
}

fn any(rng: &mut ChaCha8Rng) -> Vector3<f32> {
    Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0))
}

impl Malicious {
    fn new(kind: Kind, weight: f32, mut rng: ChaCha8Rng) -> Self {
        let (direction, frequency) = (any(&mut rng).normalize(), rng.random_range(0.3..4.0));
        Self { kind, rng, weight, direction, frequency, kept: Vector3::zeros(), speeds: [0.0; 4] }
    }

    fn act(&mut self, time: f32) -> Option<Demand> {
        let phase = (TAU * self.frequency * time).sin();
        let yaw_rate = 5.0 * phase;
        let accelerate = |acceleration| Some(Demand::Acceleration { acceleration, yaw_rate });
        let point = |angle: f32, thrust| {
            let (sin, cos) = (0.5 * angle).sin_cos();
            Some(Demand::Attitude { attitude: Quaternion::from_parts(cos, self.direction * sin), thrust })
        };
        let turn = |speeds| Some(Demand::Rotors { speeds });
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
            Kind::RotorNoise => {
                if self.rng.random_bool(0.1) {
                    self.speeds = std::array::from_fn(|_| self.rng.random_range(-1.0..1.0));
                }
                turn(self.speeds)
            }
            Kind::Flipping => {
                let sides = if self.direction.x > 0.0 { [1.0, 1.0, -1.0, -1.0] } else { [1.0, -1.0, -1.0, 1.0] };
                turn(sides.map(|side| side * phase.signum()))
            }
            Kind::Falling => turn([-1.0; 4]),
            Kind::Climbing => turn([1.0; 4]),
            Kind::Twisting => turn([1.0, -0.2, 1.0, -0.2]),
            Kind::Silent if time > 0.5 => None,
            Kind::Silent => accelerate(self.direction * 8.0),
        }
    }
}

fn read(name: &str, air: Air) -> Scenario {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../vehicles/{name}.toml"));
    let text = std::fs::read_to_string(file).unwrap() + &air.section();
    Scenario::parse(&text, name).unwrap()
}

/// What flights showed.
#[derive(Debug, Default)]
struct Shown {
    flights: u32,
    ticks: u32,
    by_policy: u32,
    /// The farthest outside of the box, m, less than zero inside; and the lowest, m.
    outside: f64,
    lowest: f64,
    fastest: f64,
    /// The greatest errors of the state that is flown on, m and m/s.
    misplaced: f64,
    misjudged: f64,
    hand_overs: u32,
    crashed: u32,
}

/// One flight, behind the shield or on the law alone.
fn fly(scenario: &Scenario, kind: Kind, rng: &mut ChaCha8Rng, shielded: bool, shown: &mut Shown) {
    let mut scenario = scenario.clone();
    let inside = |axis: usize| rng.random_range(BOX_LOW_M[axis] + 1.0..BOX_HIGH_M[axis] - 1.0);
    let start = [0, 1, 2].map(inside);
    scenario.initial.position = Vector3::from(start).cast();
    let period = scenario.timing.period() as f32;
    if let Some(turbulence) = scenario.reality.wind.as_mut().and_then(|wind| wind.turbulence.as_mut()) {
        turbulence.seed = rng.random();
    }
    if let Some(estimator) = &mut scenario.reality.estimator {
        estimator.seed = rng.random();
    }
    let configuration = &scenario.configuration;
    let mut vehicle = SensedVehicle::new(&scenario, configuration);
    let mut law = flight::law(&scenario).unwrap();
    let law = law.extended().unwrap();
    let late = velocity_late(&scenario);
    let usual = Settings::new(BOX_LOW_M, BOX_HIGH_M);
    let settings = Settings { late, patience: 0.2, patience_greatest: 0.2, hand_overs: 100, ..usual };
    let mut shield = Shield::new(configuration, &settings, period).unwrap();
    let weight = configuration.vehicle().mass * configuration.vehicle().gravity;
    let mut policy = Malicious::new(kind, weight, random::generator(rng.random()));
    let level = Reference::resting(Vector3::zeros(), Heading::FORWARD);
    let mut last = Demand::Acceleration { acceleration: Vector3::zeros(), yaw_rate: 0.0 };
    let mut outside = f64::MIN;
    let mut lowest = f64::MAX;
    for tick in 0..(FLIGHT_S / scenario.timing.period()) as u32 {
        let known = vehicle.known().unwrap();
        let state: State = known.map_or_else(|| vehicle.vehicle().state().measured(), |known| known.state);
        if let Some(known) = known {
            law.measured(&Measured { acceleration: known.acceleration, ..Measured::default() });
            if known.jumped {
                law.hold_estimates();
            }
        }
        let truth = vehicle.vehicle().state();
        shown.misplaced = shown.misplaced.max((truth.position - state.position.cast()).norm());
        shown.misjudged = shown.misjudged.max((truth.velocity - state.velocity.cast()).norm());
        let offers = policy.act(tick as f32 * period);
        let wrench = if shielded {
            let flown = shield.step(law, &state, offers.as_ref()).unwrap();
            shown.by_policy += u32::from(flown.reason.is_none());
            flown.wrench
        } else {
            last = offers.filter(|demand| demand.check().is_ok()).unwrap_or(last);
            law.step_on_demand(&state, &level, &last).unwrap().0
        };
        let (clipped, _) = vehicle.hold(&ActuatorDemand::Wrench(wrench.scaled(1.0 / law.thrust_scale()))).unwrap();
        assert!(!clipped, "{kind:?} {tick}: {wrench:?} is beyond the rotors or the limits");
        let body = vehicle.vehicle().state();
        let place = body.position;
        outside = outside.max((BOX_LOW_M.cast() - place).max()).max((place - BOX_HIGH_M.cast()).max());
        lowest = lowest.min(place.z);
        shown.fastest = shown.fastest.max(body.velocity.norm());
        shown.ticks += 1;
    }
    assert!(!shielded || outside <= OUTSIDE_MAX_M, "{kind:?} in {}: {outside} m outside", scenario.name);
    shown.outside = shown.outside.max(outside);
    shown.lowest = shown.lowest.min(lowest);
    shown.crashed += u32::from(outside > 1.0 || lowest <= 0.0);
    shown.hand_overs += shield.hand_overs();
    shown.flights += 1;
}

/// Flights of each of these policies on each vehicle in each wind.
fn campaign(
    vehicles: Vehicles,
    kinds: &[Kind],
    each: u32,
    seed: u64,
    shielded: bool,
) -> Vec<(&'static str, Air, Kind, Shown)> {
    let mut rng = random::generator(seed);
    let mut all = Vec::new();
    for (name, airs) in vehicles {
        for air in *airs {
            let scenario = read(name, *air);
            for kind in kinds {
                let mut shown = Shown { outside: f64::MIN, lowest: f64::MAX, ..Shown::default() };
                for _ in 0..each {
                    fly(&scenario, *kind, &mut rng, shielded, &mut shown);
                }
                all.push((*name, *air, *kind, shown));
            }
        }
    }
    all
}

/// Flies each policy so often, prints what came out, and holds it to the limits. Returns how many flew.
fn flights_inside_the_box(vehicles: Vehicles, kinds: &[Kind], each: u32, seed: u64) -> u32 {
    let head = "to the walls, m | fastest, m/s | state off, m, m/s";
    println!("| vehicle | air | policy | flights | by policy, % | hand-overs | {head} |");
    println!("|---|---|---|---|---|---|---|---|---|");
    let mut flights = 0;
    for (name, air, kind, shown) in campaign(vehicles, kinds, each, seed, true) {
        let Shown { outside, lowest, fastest, misplaced, misjudged, .. } = shown;
        let off = format!("{misplaced:.3}, {misjudged:.2}");
        let share = 100.0 * f64::from(shown.by_policy) / f64::from(shown.ticks);
        println!(
            "| {name} | {air:?} | {kind:?} | {} | {share:.0} | {} | {:.2} | {fastest:.1} | {off} |",
            shown.flights, shown.hand_overs, -outside
        );
        assert!(lowest > 0.3 && shown.by_policy > 0 && shown.hand_overs >= shown.flights, "{name} {kind:?} {shown:?}");
        flights += shown.flights;
    }
    flights
}

#[test]
fn no_policy_leaves_the_box_touches_the_ground_or_overloads_a_rotor() {
    assert!(flights_inside_the_box(KNOWN, &POLICY_KINDS, 16, 301) >= 1_000);
}

#[test]
fn no_policy_that_turns_the_rotors_leaves_the_box_touches_the_ground_or_overloads_a_rotor() {
    assert!(flights_inside_the_box(KNOWN, &ROTOR_KINDS, 16, 303) >= 600);
}

#[test]
fn nor_on_the_estimators_states_with_late_poses() {
    assert!(flights_inside_the_box(ESTIMATED, &POLICY_KINDS, 16, 303) >= 1_000);
}

/// To one place after the other, at 2 m/s and 3 m/s^2 at most.
#[test]
fn a_calm_policy_flies_without_a_hand_over() {
    let mut rng = random::generator(302);
    for name in ["hummingbird", "published/cf2x-pybullet"] {
        let scenario = read(name, Air::Still);
        let period = scenario.timing.period() as f32;
        for _ in 0..10 {
            let mut scenario = scenario.clone();
            let mut anywhere = || {
                Vector3::from(
                    [0, 1, 2].map(|axis: usize| rng.random_range(BOX_LOW_M[axis] + 1.0..BOX_HIGH_M[axis] - 1.0)),
                )
            };
            scenario.initial.position = anywhere().cast();
            let mut vehicle = SimulatedVehicle::new(&scenario, &scenario.configuration);
            let mut law = flight::law(&scenario).unwrap();
            let law = law.extended().unwrap();
            let mut shield =
                Shield::new(&scenario.configuration, &Settings::new(BOX_LOW_M, BOX_HIGH_M), period).unwrap();
            let mut goal = anywhere();
            let at_most = |v: Vector3<f32>, length: f32| v * (length / v.norm().max(length));
            for tick in 0..1_500 {
                if tick % 400 == 399 {
                    assert!((vehicle.state().position.cast() - goal).norm() < 0.3, "{name}");
                    goal = anywhere();
                }
                let state = vehicle.state().measured();
                let wanted = at_most((goal - state.position) * 0.8, 2.0);
                let acceleration = at_most((wanted - state.velocity) * 2.5, 3.0);
                let demand = Demand::Acceleration { acceleration, yaw_rate: 0.0 };
                let flown = shield.step(law, &state, Some(&demand)).unwrap();
                assert_eq!(flown.reason, None, "{name} {tick} {state:?}");
                let wrench = flown.wrench.scaled(1.0 / law.thrust_scale());
                vehicle.hold(&ActuatorDemand::Wrench(wrench), scenario.timing.steps_per_tick).unwrap();
            }
        }
    }
}

/// The law alone keeps its limits and goes wherever it is sent.
#[test]
fn without_the_monitor_the_same_policies_crash() {
    for (name, air, kind, shown) in campaign(KNOWN, &POLICY_KINDS, 2, 301, false) {
        // A hover without another demand stays where it is.
        let harmless = matches!(kind, Kind::BangBang | Kind::Random | Kind::NotFinite | Kind::Swinging);
        assert!(harmless || shown.crashed == shown.flights, "{name} {air:?} {kind:?} {shown:?}");
    }
}

#[test]
fn every_reason_of_the_table_is_documented() {
    let page = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/shield.md")).unwrap();
    let rows: Vec<&str> = page.lines().filter_map(|line| line.strip_prefix("| `")?.split('`').next()).collect();
    assert_eq!(rows, Reason::ALL.map(Reason::word));
}
