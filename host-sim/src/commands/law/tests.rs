//! The text interface against the controller it wraps.

use super::*;

/// A level vehicle, 1 m beside a hover reference, with `changes` to single numbers.
fn line(changes: &[(usize, &str)]) -> String {
    let mut words = vec!["0"; 33];
    words[1] = "0.01";
    words[2] = "1.0";
    words[11] = "1";
    for (index, word) in changes {
        words[*index] = word;
    }
    words.join(" ")
}

fn server() -> LawServer {
    LawServer::new(&Scenario::paper().unwrap()).unwrap()
}

#[test]
fn the_order_of_the_numbers_is_the_contracts() {
    let scenario = Scenario::paper().unwrap();
    let mut controller = flight::law(&scenario).unwrap();
    controller.set_period(0.02).unwrap();
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let state = State {
        position: Vector3::new(1.0, 2.0, 3.0),
        velocity: Vector3::new(4.0, 5.0, 6.0),
        attitude: Quaternion::new(half, 0.5, 0.3, -0.4),
        angular_velocity: Vector3::new(0.7, 0.8, 0.9),
    };
    let reference = Reference {
        position: Vector3::new(-1.0, -2.0, -3.0),
        velocity: Vector3::new(0.1, 0.2, 0.3),
        acceleration: Vector3::new(0.4, 0.5, 0.6),
        jerk: Vector3::new(0.11, 0.12, 0.13),
        snap: Vector3::new(0.14, 0.15, 0.16),
        heading: Heading::new(Vector2::new(2.0_f64.cos() as f32, 2.0_f64.sin() as f32), 0.3, -0.2).unwrap(),
    };
    let text = "12.5 0.02 1 2 3 4 5 6 0.5 0.3 -0.4 0.7071067811865476 0.7 0.8 0.9 -1 -2 -3 0.1 0.2 0.3 0.4 0.5 0.6 \
                0.11 0.12 0.13 0.14 0.15 0.16 2.0 0.3 -0.2";
    let mut server = server();
    for _ in 0..3 {
        let (expected, _) = controller.step(&state, &reference).unwrap();
        let answer = server.answer(text).unwrap();
        assert!((answer.thrust - expected.thrust).abs() < 1e-6);
        assert!((answer.torque - expected.torque).norm() < 1e-6);
    }
}

#[test]
fn a_line_that_cannot_be_used_is_named_and_changes_nothing() {
    let mut served = server();
    let mut disturbed = server();
    served.answer(&line(&[])).unwrap();
    disturbed.answer(&line(&[])).unwrap();
    for (changes, word) in [
        (vec![(0, "abc")], "t: must be a number"),
        (vec![(1, "0")], "dt"),
        (vec![(1, "0.1001")], "dt"),
        (vec![(1, "1e-30")], "dt: must be from 0.00025 to 0.1 s"),
        (vec![(1, "-0.01")], "dt"),
        (vec![(3, "nan")], "x[1]: must be finite"),
        (vec![(4, "inf")], "x[2]: must be finite"),
        (vec![(5, "1e300")], "v[0]: must be within"),
        (vec![(2, "1e20")], "x[0]: must be within ±1000000, found 1e20"),
        (vec![(6, "1e10")], "v[1]: must be within ±10000, found 1e10"),
        (vec![(14, "-1e8")], "omega[2]: must be within ±10000, found -1e8"),
        (vec![(18, "1e10")], "reference v[0]: must be within ±10000"),
        (vec![(11, "1.01")], "q: must have unit length"),
        (vec![(11, "0")], "q: must have unit length"),
        (vec![(8, "1e38"), (9, "1e38")], "q.x: must be within ±2"),
        (vec![(23, "-7.81")], "reference a[2]"),
        (vec![(23, "-9")], "reference a[2]"),
        (vec![(21, "1e9")], "reference a[0]: must be within ±10000"),
        (vec![(24, "1e9")], "reference j[0]: must be within ±1000000"),
        (vec![(31, "1e9")], "yaw_rate: must be within ±10000"),
    ] {
        let problem = disturbed.answer(&line(&changes)).unwrap_err();
        assert!(problem.contains(word) && !problem.contains('\n'), "{problem:?} does not say {word:?}");
    }
    for (text, found) in [("", "found 0"), ("1 2 3", "found 3"), (&format!("{} 7", line(&[])) as &str, "found 34")] {
        assert!(disturbed.answer(text).unwrap_err().contains(found));
    }
    let next = line(&[(2, "0.9")]);
    assert_eq!(served.answer(&next), disturbed.answer(&next));
}

#[test]
fn nonsense_on_one_line_does_not_reach_the_lines_after_it() {
    // The extended law remembers more than the paper's: estimates, and a fallback for references that it cannot fly.
    let extended = || LawServer::new(&Scenario::parse(scenario::STUDY, "study").unwrap()).unwrap();
    for (field, value) in [(1, "1e-30"), (5, "1e10"), (2, "1e10"), (12, "1e8"), (18, "1e10"), (21, "1e9"), (24, "1e9")]
    {
        let (mut served, mut disturbed) = (extended(), extended());
        for i in 0..200 {
            if i == 100 {
                disturbed.answer(&line(&[(field, value)])).unwrap_err();
            }
            assert_eq!(served.answer(&line(&[])), disturbed.answer(&line(&[])), "{field} {value}");
        }
    }
}

#[test]
fn a_quaternion_near_unit_length_is_normalised() {
    let (mut exact, mut stretched) = (server(), server());
    let tilted = [(8, "0.6"), (11, "0.8")];
    let longer = [(8, "0.60054"), (11, "0.80072")];
    let (a, b) = (exact.answer(&line(&tilted)).unwrap(), stretched.answer(&line(&longer)).unwrap());
    assert!((a.torque - b.torque).norm() < 1e-6);
}

#[test]
fn each_line_gets_one_line_even_without_a_final_newline() {
    let input = format!("{}\r\nrubbish\n\n\u{fffd}\n{}", line(&[]), line(&[]));
    let mut output = Vec::new();
    server().serve(input.as_bytes(), &mut output).unwrap();
    let text = String::from_utf8(output).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 5);
    let wrench: Result<Vec<f32>, _> = lines[0].split(' ').map(str::parse).collect();
    assert_eq!(wrench.unwrap().len(), 4);
    assert!(lines[1..4].iter().all(|line| line.starts_with("error: ")));
    assert!(!lines[4].starts_with("error"));
}

#[test]
fn filters_advance_by_each_lines_own_dt() {
    let (mut once, mut twice) = (server(), server());
    once.answer(&line(&[(1, "0.02")])).unwrap();
    twice.answer(&line(&[])).unwrap();
    twice.answer(&line(&[])).unwrap();
    let (a, b) = (once.answer(&line(&[])).unwrap(), twice.answer(&line(&[])).unwrap());
    assert!(a.thrust > 4.5126 && (a.thrust - b.thrust).abs() < 1e-3 && (a.torque - b.torque).norm() < 0.05);
    let mut not_at_all = server();
    assert!((not_at_all.answer(&line(&[])).unwrap().torque - a.torque).norm() > 1e-3);
}

#[test]
fn every_number_of_a_line_has_a_name_of_its_own() {
    let name = |bad| {
        let words: Vec<&str> = (0..INPUT_NUMBERS).map(|place| if place == bad { "x" } else { "0" }).collect();
        parse(&words.join(" ")).unwrap_err().split(": ").next().unwrap().to_owned()
    };
    let names: std::collections::BTreeSet<String> = (0..INPUT_NUMBERS).map(name).collect();
    assert_eq!(names.len(), INPUT_NUMBERS, "{names:?}");
    for name in ["t", "dt", "x[0]", "q.w", "omega[2]", "reference s[2]", "yaw", "yaw_rate", "yaw_acceleration"] {
        assert!(names.contains(name), "{name}");
    }
}
