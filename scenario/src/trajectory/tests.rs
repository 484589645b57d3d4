use crate::Scenario;
use crate::reference::ReferenceKind;
use crate::trajectory::{Route, RouteWay};
use controller_core::reference::ReferenceBounds;
use nalgebra::Vector3;
use std::fmt::Write;

mod corpus;

/// The Hummingbird on this reference.
fn on(reference: &str) -> Result<Scenario, String> {
    on_in(reference, "a test")
}

/// The Hummingbird on this reference, in a file of this name.
fn on_in(reference: &str, file: &str) -> Result<Scenario, String> {
    let hummingbird = include_str!("../../../vehicles/hummingbird.toml");
    let (head, _) = hummingbird.split_once("\n[reference]").unwrap();
    let head = head.lines().filter(|line| !line.starts_with("duration")).collect::<Vec<_>>().join("\n");
    Scenario::parse(&format!("{head}\n[reference]\n{reference}\n"), file).map_err(|error| error.to_string())
}

fn route(scenario: &Scenario) -> &Route {
    let ReferenceKind::Route(route) = &scenario.reference else { panic!("no route") };
    route
}

/// An eight of 2 m by 1 m in 7.4 s, at so many instants, as text.
fn eight(instants: u32, noise: f64) -> String {
    let mut text = "t,x,y,z\n".to_owned();
    for i in 0..instants {
        let time = 7.4 * f64::from(i) / f64::from(instants - 1);
        let angle = std::f64::consts::TAU * time / 7.4;
        // Two incommensurate waves do for noise.
        let [dx, dy] = [91.3, 57.1].map(|rate| noise * f64::from(i * i % 97) / 97.0 * (rate * time).sin());
        writeln!(text, "{time:.4},{:.4},{:.4},1.5", angle.sin() + dx, 0.5 * (2.0 * angle).sin() + dy).unwrap();
    }
    text
}

#[test]
fn every_row_of_a_file_is_passed_within_the_distance_that_is_stated() {
    for (instants, noise, within) in [(100, 0.0, 0.02), (740, 0.004, 0.02), (100, 0.0, 0.001), (30, 0.0, 0.01)] {
        let data = eight(instants, noise);
        let scenario = on(&format!("kind = \"trajectory\"\nwithin = {within}\ndata = '''\n{data}'''")).unwrap();
        let route = route(&scenario);
        let RouteWay::Near { farthest, lead_in } = route.way else { panic!("{:?}", route.way) };
        assert!(lead_in > 0.0, "the eight begins in motion");
        let mut most: f64 = 0.0;
        for point in &route.points {
            let there = scenario.trajectory.at((point.time * 1e6).round() as u64).position.map(f64::from);
            most = most.max((there - Vector3::from(point.position)).norm());
        }
        assert!(most <= within, "{instants} rows, {noise} m of noise: {most} m off");
        assert!((most - farthest.0).abs() < 1e-5, "{most} m off, said {} m", farthest.0);
        // At rest before and afterwards.
        for time in [0, (route.duration() * 1e6) as u64] {
            let reference = scenario.trajectory.at(time);
            assert!(reference.velocity.norm() < 1e-6 && reference.acceleration.norm() < 1e-6, "{reference:?}");
        }
    }
}

#[test]
fn noise_is_left_out_as_far_as_the_distance_allows() {
    let bounds = |within: f64| -> ReferenceBounds {
        let data = eight(740, 0.004);
        on(&format!("kind = \"trajectory\"\nwithin = {within}\ndata = '''\n{data}'''")).unwrap().trajectory.bounds()
    };
    let (loose, strict) = (bounds(0.02), bounds(0.003));
    // The eight itself takes 1.5 m/s^2 and 4.2 m/s^4.
    assert!(loose.horizontal_acceleration < 2.5 && loose.snap < 15.0, "{loose:?}");
    assert!(strict.snap > 3.0 * loose.snap, "{strict:?} {loose:?}");
}

#[test]
fn a_file_with_few_rows_and_their_velocities_is_followed_between_them() {
    let mut data = "t,x,y,z,vx,vy,vz\n".to_owned();
    for i in 0..12 {
        let (sin, cos) = (0.6 * f64::from(i)).sin_cos();
        writeln!(data, "{},{cos},{sin},1,{},{},0", 0.8 * f64::from(i), -0.75 * sin, 0.75 * cos).unwrap();
    }
    let scenario = on(&format!("kind = \"trajectory\"\nwithin = 0.01\ndata = '''\n{data}'''")).unwrap();
    let RouteWay::Near { lead_in, .. } = route(&scenario).way else { panic!() };
    for i in 0..=880 {
        let time = lead_in + 0.01 * f64::from(i);
        let radius = scenario.trajectory.at((time * 1e6) as u64).position.xy().norm();
        assert!((radius - 1.0).abs() < 0.02, "radius {radius} m at {time} s");
    }
}

#[test]
fn pieces_are_flown_as_their_polynomials_say() {
    // x = t - t^2/4 from 0 to 1, then back; y = 0; z = 1; no yaw.
    let zeros = |count: usize| ",0".repeat(count);
    let header = "duration,".to_owned()
        + &["x", "y", "z"]
            .map(|axis| (0..8).map(|power| format!("{axis}^{power}")).collect::<Vec<_>>().join(","))
            .join(",");
    let first = format!("2,0,1,-0.25{}{},1{}", zeros(5), zeros(8), zeros(7));
    let second = format!("2,1,0,-0.25{}{},1{}", zeros(5), zeros(8), zeros(7));
    let scenario = on(&format!("kind = \"trajectory\"\ndata = '''\n{header}\n{first}\n{second}\n'''")).unwrap();
    let RouteWay::Near { lead_in, .. } = route(&scenario).way else { panic!() };
    for (time, x) in [(0.0, 0.0), (1.0, 0.75), (2.0, 1.0), (3.0, 0.75), (4.0, 0.0)] {
        let there = scenario.trajectory.at(((lead_in + time) * 1e6) as u64).position;
        assert!((f64::from(there.x) - x).abs() < 0.02 && (there.z - 1.0).abs() < 0.02, "{there} at {time} s");
    }
}

#[test]
fn times_are_stretched_as_asked() {
    let at = |stretch: f64| {
        let data = eight(100, 0.0);
        on(&format!("kind = \"trajectory\"\nstretch = {stretch}\ndata = '''\n{data}'''")).unwrap().trajectory.bounds()
    };
    let (own, slower) = (at(1.0), at(2.0));
    let speeds = own.horizontal_speed / slower.horizontal_speed;
    // Getting there and stopping is no slower.
    assert!((speeds - 2.0).abs() < 0.1 && slower.jerk < 0.9 * own.jerk, "{own:?} {slower:?}");
}

#[test]
fn eighteen_points_with_times_are_passed_at_these() {
    let point = |i: u32| {
        let (sin, cos) = (0.9 * f64::from(i)).sin_cos();
        format!("{{ t = {}, position = [{}, {}, 2.0] }}", 2 * i, 2.0 * cos, 2.0 * sin)
    };
    let points = (0..18).map(point).collect::<Vec<_>>().join(", ");
    let scenario = on(&format!("kind = \"waypoints\"\npoints = [{points}]")).unwrap();
    for i in 0..18_u32 {
        let (sin, cos) = (0.9 * f64::from(i)).sin_cos();
        let there = scenario.trajectory.at(u64::from(2_000_000 * i)).position.map(f64::from);
        assert!((there - Vector3::new(2.0 * cos, 2.0 * sin, 2.0)).norm() < 1e-4, "{there}");
    }
    // Without a duration it flies to the end and 5 s on.
    assert!((scenario.timing.duration() - 39.0).abs() < 1e-9);
}

#[test]
fn what_cannot_be_flown_is_refused_by_line_and_column_or_key() {
    let table = |text: &str| on(&format!("kind = \"trajectory\"\ndata = '''\n{text}'''")).err().unwrap();
    for (text, expected) in [
        ("t,x,y\n0,0,0\n", "reference.data: line 1: column z is missing"),
        ("t,x,y,z,px\n0,0,0,0,0\n", "reference.data: line 1: columns x and px both say x: leave one out"),
        ("t,x,y,z,vx\n0,0,0,0,0\n", "reference.data: line 1: column vy is missing"),
        ("t,x,y,z\n0,0,0,1\n0,0,0,2\n", "reference.data: line 3, column t: must be after 0, found 0; leave one out"),
        ("t,x,y,z\n0,0,0,1\n1,0,nan,1\n", "reference.data: line 3, column y: must be a finite number, found \"nan\""),
        ("t,x,y,z\n0,0,0,1\n1,0,1\n", "reference.data: line 3: has 3 cells, and there are 4 names of columns"),
        ("t,x,y,z\n", "reference.data: has no row below its header"),
        ("x,y,z\n0,0,1\n1,0,1\n", "needs two rows or more, each with its time t"),
        ("t,x,y,z,speed\n0,0,0,1,2\n1,1,0,1,2\n", "reference.data[0].speed: goes with points without times"),
        ("duration,x^0\n1,2\n", "line 2: a piece has 25 numbers, or 33 with yaw, found 2"),
    ] {
        let refused = table(text);
        assert!(refused.contains(expected), "{refused}\ninstead of {expected}");
    }
    for (reference, expected) in [
        ("kind = \"trajectory\"", "reference.file: needs one of file and data"),
        ("kind = \"trajectory\"\nfile = \"nowhere.csv\"", "reference.file: nowhere.csv: cannot be read"),
        (
            "kind = \"waypoints\"\npoints = [{ position = [0, 0, 1] }]",
            "reference.points[0].t: missing; give every point a time, or speed for all of them",
        ),
        (
            "kind = \"waypoints\"\nspeed = 1.0\npoints = [{ t = 0, position = [0, 0, 1] }]",
            "reference.speed: chooses the times",
        ),
        (
            "kind = \"waypoints\"\nspeed = 1.0\npoints = [{ position = [0, 0, 1] }, { position = [0, 0, 1] }]",
            "reference.points[1]: is the same as the one before",
        ),
        (
            "kind = \"waypoints\"\npoints = [{ position = [0, 0, 1], speed = 1.0 }, { position = [1, 0, 1] }, { position = [2, 0, 1] }]",
            "reference.points[1].speed: missing; give every point a speed, or one for all of them",
        ),
        (
            "kind = \"waypoints\"\npoints = [{ t = 0, position = [0, 0, 1], speed = 1.0 }]",
            "reference.points[0].speed: goes with points without times",
        ),
        (
            "kind = \"waypoints\"\ncorridor = 0.3\ndata = '''\nx,y,z,speed\n0,0,1,0\n1,0,1,1\n'''",
            "reference.data: line 2, column speed: must be positive",
        ),
        (
            "kind = \"waypoints\"\nspeed = -1.0\npoints = [{ position = [0, 0, 1] }]",
            "reference.speed: must be positive",
        ),
    ] {
        let refused = on(reference).err().unwrap();
        assert!(refused.contains(expected), "{refused}\ninstead of {expected}");
    }
}

#[test]
fn three_columns_without_names_are_points() {
    let scenario = on("kind = \"waypoints\"\nspeed = 1.0\ndata = '''\n0.0 0.0 1.0\n0.5 0.0 1.0\n'''").unwrap();
    let route = route(&scenario);
    let positions: Vec<_> = route.points.iter().map(|point| point.position).collect();
    assert_eq!(positions, [[0.0, 0.0, 1.0], [0.5, 0.0, 1.0]]);
    assert_eq!(route.remarks, ["rows without a header are read as x,y,z"]);
}

#[test]
fn what_single_precision_is_too_coarse_for_is_refused_with_the_remedy() {
    let far = "must be within 16 km of the origin, found (0, 5427000, 1) m, where single precision is 500 mm coarse; ";
    let (nearby, origin) = (
        "count all positions from an origin nearby",
        "write origin = [0.0, 5427000.0, 0.0], from which the flight then counts",
    );
    let point = "{ t = 0, position = [0, 5427000, 1] }";
    for (reference, field, remedy) in [
        ("kind = \"hover\"\nposition = [0, 5427000, 1]", "reference.position", nearby),
        (
            "kind = \"harmonic\"\ncenter = [0, 5427000, 1]\namplitude = [1, 1, 0]\nfrequency = [1, 1, 0]",
            "reference.center",
            nearby,
        ),
        (&format!("kind = \"waypoints\"\npoints = [{point}]"), "reference.points", origin),
        ("kind = \"trajectory\"\ndata = '''\nt,x,y,z\n0,0,5427000,1\n1,0,5427001,1\n'''", "reference.data", origin),
    ] {
        assert_eq!(on(reference).err().unwrap(), format!("a test: {field}: {far}{remedy}"));
    }
    let scenario = on(&format!("kind = \"waypoints\"\norigin = [0, 5427000, 0]\npoints = [{point}]")).unwrap();
    assert_eq!(scenario.trajectory.at(0).position.z, 1.0);
    assert_eq!(scenario.trajectory.at(0).position.y, 0.0);
}

#[test]
fn a_path_below_zero_is_flown_where_the_ground_is_as_low() {
    let points = "kind = \"waypoints\"\npoints = [{ t = 0, position = [0, 0, -1] }, { t = 2, position = [1, 0, -2] }]";
    let refused = on(points).err().unwrap();
    assert!(refused.contains("reference.points: lies below zero, from z = -2.00 to -1.00 m"), "{refused}");
    let ground = "[initial]\nposition = [0.0, 0.0, -1.0]\n[ground]\nheight = -3.0";
    let text = include_str!("../../../vehicles/hummingbird.toml");
    let (head, _) = text.split_once("\n[initial]").unwrap();
    Scenario::parse(&format!("{head}\n[reference]\n{points}\n{ground}\n"), "a test").unwrap();
}

#[test]
fn headings_in_radians_are_suspected_where_degrees_are_asked_for() {
    let points = "{ t = 0, position = [0, 0, 1] }, { t = 4, position = [1, 0, 1], heading_deg = 1.5708 }";
    let scenario = on(&format!("kind = \"waypoints\"\npoints = [{points}]")).unwrap();
    let [remark] = &route(&scenario).remarks[..] else { panic!("{:?}", route(&scenario).remarks) };
    assert!(remark.starts_with("heading_deg stays between 0 and 1.57") && remark.ends_with("radians"), "{remark}");
}

#[test]
fn points_and_pieces_that_seem_to_be_in_other_units_are_said() {
    let points = "{ t = 0, position = [0, 0, 1] }, { t = 4000, position = [1, 0, 1] }";
    let scenario = on(&format!("kind = \"waypoints\"\npoints = [{points}]")).unwrap();
    assert_eq!(route(&scenario).remarks, ["takes 4000 s for 1.0 m, 0.250 mm/s at most; are its times ms, and not s?"]);
    let zeros = |count: usize| ",0".repeat(count);
    let piece = format!("2,0,1,-0.25{}{},1{},90{}", zeros(5), zeros(8), zeros(7), zeros(7));
    let scenario = on(&format!("kind = \"trajectory\"\ndata = \"\"\"\nduration\n{piece}\"\"\"")).unwrap();
    assert_eq!(route(&scenario).remarks, ["yaw is in rad, and reaches 90.0: divide it by 57.3 if in degrees"]);
}

#[test]
fn angles_of_a_harmonic_in_degrees_are_refused() {
    let circle = "kind = \"harmonic\"\ncenter = [0, 0, 1]\namplitude = [1, 1, 0]\nfrequency = [1, 1, 0]";
    for (line, field) in [("phase = [0, -90, 0]", "phase"), ("heading = { offset = 90 }", "heading.offset")] {
        let refused = on(&format!("{circle}\n{line}")).err().unwrap();
        let expected = format!("a test: reference.{field}: is in rad, and at most 2 turns, found 90");
        assert!(refused.starts_with(&expected), "{refused}");
    }
}
