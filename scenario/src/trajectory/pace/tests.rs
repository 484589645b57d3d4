use super::merge::Point;
use super::*;
use crate::Scenario;
use crate::reference::ReferenceKind;
use crate::trajectory::Route;
use crate::verdict::Verdict;

/// A vehicle of 0.62 kg with seven times its weight in thrust at 11 N a rotor.
fn vehicle(rotor: f64) -> String {
    format!(
        "name = \"test\"\n[vehicle]\nmass = 0.62\ninertia = [0.0025, 0.0029, 0.0048]\n[rotors]\n\
         position = [[0.08, 0.08, 0.0], [0.08, -0.08, 0.0], [-0.08, -0.08, 0.0], [-0.08, 0.08, 0.0]]\n\
         spin = [\"cw\", \"ccw\", \"cw\", \"ccw\"]\nthrust_max = {rotor}\ntorque_per_thrust = 0.013\nlag = 0.025\nidle = 0.0\n"
    )
}

/// Seven gates of a race.
const RACE_GATES: [[f64; 3]; 7] = [
    [0.0, 0.0, 1.2],
    [6.0, 2.0, 1.5],
    [11.0, 0.0, 2.2],
    [15.0, -4.0, 1.2],
    [13.0, -9.0, 1.2],
    [8.0, -11.0, 2.8],
    [2.0, -10.0, 1.2],
];
/// Three lanes, a metre and a half apart.
const LAWN_LANES: [[f64; 3]; 6] =
    [[0.0, 0.0, 3.0], [12.0, 0.0, 3.0], [12.0, 1.5, 3.0], [0.0, 1.5, 3.0], [0.0, 3.0, 3.0], [12.0, 3.0, 3.0]];

/// Rows of x, y and z.
fn table(points: &[[f64; 3]]) -> String {
    let rows = points.iter().map(|[x, y, z]| format!("{x},{y},{z}\n"));
    format!("x,y,z\n{}", rows.collect::<String>())
}

fn read(vehicle: &str, table: &str, keys: &str) -> Result<Scenario, String> {
    let text = format!("{vehicle}\n[reference]\nkind = \"waypoints\"\n{keys}\ndata = '''\n{table}'''\n");
    Scenario::parse(&text, "a test").map_err(|error| error.to_string())
}

fn route(scenario: &Scenario) -> &Route {
    let ReferenceKind::Route(route) = &scenario.reference else { panic!("no route") };
    route
}

/// How long the path through `points` takes, s.
fn duration(vehicle: &str, points: &[[f64; 3]], speed: f64, corridor: f64) -> f64 {
    route(&read(vehicle, &table(points), &format!("speed = {speed}\ncorridor = {corridor}")).unwrap()).duration()
}

/// Whether no number is above the one before it.
fn falls(numbers: &[f64]) -> bool {
    numbers.windows(2).all(|pair| pair[1] <= pair[0])
}

#[test]
fn a_wider_corridor_never_takes_longer() {
    for (points, speed) in [(RACE_GATES.as_slice(), 10.0), (&LAWN_LANES, 3.0)] {
        let durations = [0.05, 0.1, 0.25, 0.3, 1.0].map(|corridor| duration(&vehicle(11.0), points, speed, corridor));
        println!("{durations:?}");
        assert!(falls(&durations), "{durations:?}");
        assert!(durations[4] < 0.97 * durations[0], "{durations:?}");
    }
}

#[test]
fn a_higher_speed_never_takes_longer() {
    for points in [RACE_GATES.as_slice(), &LAWN_LANES] {
        let durations = [1.0, 2.0, 5.0, 10.0, 20.0, 1e9].map(|speed| duration(&vehicle(11.0), points, speed, 0.3));
        println!("{durations:?}");
        assert!(falls(&durations), "{durations:?}");
        // The way is as long as it is.
        assert!(durations[2] < 0.3 * durations[0], "{durations:?}");
    }
}

/// With more thrust and all else as it is: the formulas would have more torque and feedback kept free as well.
#[test]
fn more_thrust_never_takes_longer() {
    let same = "[control]\nlaw = \"extended\"\n[limits]\ntorque_max = [0.5, 0.5, 0.2]\n\
                [gains]\nturn_reserve = 20.0\nturn_rate = 5.0\nyaw_acceleration = 4.0\ntilt_max = 1.2\n";
    for points in [RACE_GATES.as_slice(), &LAWN_LANES] {
        let durations = [3.5, 5.0, 8.0, 11.0].map(|rotor| duration(&(vehicle(rotor) + same), points, 10.0, 0.3));
        println!("{durations:?}");
        assert!(falls(&durations), "{durations:?}");
    }
}

/// The path of `scenario` certifies, is at rest at both ends, passes all `points` in their order within the corridor
/// and never leaves the straight legs between them farther than that.
fn assert_kept(scenario: &Scenario, points: &[[f64; 3]], speed: f64, corridor: f64) {
    let along = Verdict::judge(scenario).unwrap().along().copied().unwrap();
    assert!(along.holds(), "{along}");
    let route = route(scenario);
    let at = |time: f64| scenario.trajectory.at((time * 1e6).round() as u64);
    for time in [0.0, route.duration()] {
        assert!(at(time).velocity.norm() < 1e-3 && at(time).acceleration.norm() < 1e-2, "{:?}", at(time));
    }
    assert_eq!(route.points.len(), points.len());
    for (passed, point) in route.points.iter().zip(points) {
        let off = (at(passed.time).position.map(f64::from) - Vector3::from(*point)).norm();
        assert!(off <= 1.001 * corridor, "{off} m off {point:?}");
    }
    let legs: Vec<Leg> = points
        .windows(2)
        .map(|pair| {
            let [from, to] = [pair[0], pair[1]].map(|point| Vector3::from(point).push(0.0));
            Leg { from, to, corridor, speed }
        })
        .collect();
    for i in 0..=4000 {
        let reference = at(route.duration() * f64::from(i) / 4000.0);
        assert!(f64::from(reference.velocity.norm()) <= 1.0001 * speed, "{reference:?}");
        let place = reference.position.map(f64::from);
        let off = legs.iter().map(|leg| leg.off(&place).norm()).fold(f64::INFINITY, f64::min);
        assert!(off <= 1.001 * corridor, "{off} m off all legs at {place}");
    }
}

#[test]
fn a_path_certifies_and_keeps_to_its_corridor_and_speed_at_every_instant() {
    for (points, speed, corridor) in [(RACE_GATES.as_slice(), 6.0, 0.3), (&LAWN_LANES, 3.0, 0.07)] {
        let scenario =
            read(&vehicle(11.0), &table(points), &format!("speed = {speed}\ncorridor = {corridor}")).unwrap();
        assert_kept(&scenario, points, speed, corridor);
        // None of these is near the line between others: each is passed exactly.
        for (passed, point) in route(&scenario).points.iter().zip(points) {
            let place = scenario.trajectory.at((passed.time * 1e6).round() as u64).position.map(f64::from);
            assert!((place - Vector3::from(*point)).norm() < 1e-4, "{place} {point:?}");
        }
    }
}

/// Numbers between 0 and 1 of no pattern.
fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}

#[test]
fn a_path_through_random_points_certifies_and_keeps_to_its_corridor() {
    let mut random = random(7);
    for _ in 0..8 {
        let size = 0.3 * 30.0_f64.powf(random());
        let count = 2 + (6.0 * random()) as usize;
        let points: Vec<[f64; 3]> =
            (0..count).map(|_| [size * random(), size * random(), 20.0 + 0.3 * size * random()]).collect();
        let (speed, corridor) = (1.0 + 10.0 * random(), 0.05 + 0.5 * random());
        let keys = format!("speed = {speed}\ncorridor = {corridor}");
        let scenario = read(&vehicle(5.0 + 10.0 * random()), &table(&points), &keys).unwrap();
        assert_kept(&scenario, &points, speed, corridor);
    }
}

#[test]
fn dense_points_and_points_near_each_other_do_not_make_it_slower() {
    let mut random = random(3);
    let mut dense = Vec::new();
    for pair in LAWN_LANES.windows(2) {
        let [from, to] = [pair[0], pair[1]].map(Vector3::from);
        dense.push(pair[0]);
        let count = ((to - from).norm() / 0.2) as u32;
        for i in 1..count {
            // Off the line by 2 cm at most.
            let noise = Vector3::from_fn(|_, _| 0.02 * (2.0 * random() - 1.0));
            dense.push((from + (to - from) * (f64::from(i) / f64::from(count)) + noise).into());
        }
    }
    dense.push(LAWN_LANES[5]);
    let few = duration(&vehicle(11.0), &LAWN_LANES, 3.0, 0.3);
    let scenario = read(&vehicle(11.0), &table(&dense), "speed = 3.0\ncorridor = 0.3").unwrap();
    let many = route(&scenario).duration();
    println!("{} points {many} s, {} points {few} s", dense.len(), LAWN_LANES.len());
    assert!(many < 1.02 * few, "{many} s, {few} s");
    assert_kept(&scenario, &dense, 3.0, 0.3);
    // A gate as two points, a hand apart.
    let double: Vec<[f64; 3]> =
        LAWN_LANES.iter().flat_map(|[x, y, z]| [[*x, *y, *z], [x + 0.1, *y, z + 0.05]]).collect();
    let twice = duration(&vehicle(11.0), &double, 3.0, 0.3);
    assert!(twice < 1.03 * few, "{twice} s, {few} s");
}

#[test]
fn a_single_point_is_a_place_to_stay_and_too_many_corners_are_refused() {
    let alone = read(&vehicle(11.0), "x,y,z\n1,2,3\n", "speed = 1.0").unwrap();
    assert_eq!((route(&alone).duration(), alone.trajectory.at(5_000_000).position.y), (0.0, 2.0));
    let zigzag: Vec<[f64; 3]> = (0..400).map(|i| [f64::from(i), f64::from(i % 2), 1.0]).collect();
    let refused = read(&vehicle(11.0), &table(&zigzag), "speed = 1.0").err().unwrap();
    assert!(refused.contains("reference.data: has 399 straight legs, and at most 300 can be searched"), "{refused}");
}

#[test]
fn bounds_of_the_file_bound_the_path() {
    let bounds = "[reference_bounds]\nhorizontal_acceleration = 1.0\nvertical_acceleration = 0.3\njerk = 2.0\n\
                  snap = 6.0\nheading_rate = 0.5\nheading_second_derivative = 0.5\n";
    let scenario = read(&(vehicle(11.0) + bounds), &table(&LAWN_LANES[..3]), "speed = 9.0").unwrap();
    let (own, allowed) = (scenario.trajectory.bounds(), scenario.configuration.bounds());
    for (own, allowed) in own.values().iter().zip(allowed.values()) {
        assert!(*own <= allowed, "{own:?} {allowed:?}");
    }
    assert!(own.horizontal_acceleration > 0.9 && own.horizontal_speed > 2.0, "{own:?}");
}

#[test]
fn each_leg_keeps_to_its_own_speed() {
    let table = "x,y,z,speed\n0,0,2,5\n10,0,2,1\n12,0,2,5\n22,0,2,5\n";
    let scenario = read(&vehicle(11.0), table, "corridor = 0.3").unwrap();
    let route = route(&scenario);
    let speed = |time: f64| f64::from(scenario.trajectory.at((time * 1e6) as u64).velocity.norm());
    let most = |from: usize, to: usize| {
        let (from, to) = (route.points[from].time, route.points[to].time);
        (0..=200).map(|i| speed(from + (to - from) * f64::from(i) / 200.0)).fold(0.0, f64::max)
    };
    assert!(most(0, 1) > 4.5 && most(2, 3) > 4.5, "{} {}", most(0, 1), most(2, 3));
    assert!(most(1, 2) <= 1.001 && most(1, 2) > 0.9, "{}", most(1, 2));
    let slowed = read(&vehicle(11.0), table, "corridor = 0.3\nspeed = 2.0").unwrap();
    assert!(self::route(&slowed).duration() > route.duration());
}

#[test]
fn corridors_and_speeds_that_are_tried_are_round_and_no_greater_than_what_is_given() {
    assert_eq!(below(0.3, CORRIDOR_MIN_M).len(), 5);
    for (most, greatest) in [(0.3, 0.3), (0.29, 0.2), (1.5, 1.0), (1e3, 1e3), (0.004, 0.003)] {
        let found = below(most, 0.0);
        assert!((found[0] / greatest - 1.0).abs() < 1e-9, "{most} {found:?}");
        assert!(found.windows(2).all(|pair| pair[1] < pair[0]), "{found:?}");
    }
    assert_eq!(below(0.02, CORRIDOR_MIN_M), [0.02]);
}

#[test]
fn times_of_points_that_are_passed_near_are_where_the_path_is_nearest() {
    let points = [[0.0, 0.0, 1.0], [1.0, 0.05, 1.0], [3.0, 0.0, 1.0]];
    let points = points.map(|place| Point { place: Vector3::from(place).push(0.0), speed: 1.0 });
    let (kept, legs) = merged(&points, 0.3);
    let way = Way::stopping(legs, |_| 3.0);
    let times = times(&way, &points, &kept);
    assert_eq!((kept, times[0], times[2]), (vec![0, 2], 0.0, 3.0));
    // Before the middle: there it has come half of the way.
    assert!(times[1] > 1.0 && times[1] < 1.5, "{times:?}");
}
