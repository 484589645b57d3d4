//! Each claim holds where it should and can fail.

use super::*;
use crate::flight::Flight;

fn judged(scenario: &Scenario, flown: &FlightExtremes) -> Vec<Claim> {
    claims(scenario, &Verdict::judge(scenario).unwrap(), flown)
}

fn flown(scenario: &Scenario) -> FlightExtremes {
    FlightExtremes::gather(scenario, Flight::new(scenario).unwrap()).unwrap()
}

#[test]
fn theorem_1_gives_the_papers_published_interval() {
    let thrust = Certificate::new(&Scenario::paper().unwrap().configuration).unwrap().paper().unwrap().printed.thrust;
    assert!((thrust.min - 3.51).abs() < 0.005 && (thrust.max - 6.19).abs() < 0.005, "{thrust:?}");
}

#[test]
fn only_the_papers_scenario_carries_the_published_figures() {
    let paper = Scenario::paper().unwrap();
    let renamed = Scenario { name: "mine".into(), ..paper.clone() };
    let mut other = paper.clone();
    other.initial.position.x += 1.0;
    let count = |scenario: &Scenario| {
        let claims = judged(scenario, &FlightExtremes::new(scenario));
        claims.iter().filter(|claim| claim.claim.contains("published")).count()
    };
    assert_eq!((count(&paper), count(&renamed), count(&other)), (4, 4, 0));
}

#[test]
fn each_claim_can_fail() {
    let paper = Scenario::paper().unwrap();
    let good = flown(&paper);
    assert!(all_hold(&judged(&paper, &good)), "{}", table(&judged(&paper, &good)));
    let broken: [fn(&mut FlightExtremes); 10] = [
        |flown| flown.strayed = Some((0.51, 20.0)),
        |flown| flown.steady_position_error = 1.1e-3,
        |flown| flown.steady_mrp_error = 1.1e-4,
        |flown| flown.thrust = (3.5, 6.0),
        |flown| flown.thrust = (3.6, 6.2),
        |flown| flown.torque = [0.3, 0.1, 0.1],
        |flown| flown.torque = [0.1, 0.34, 0.1],
        |flown| flown.torque = [0.1, 0.1, 0.49],
        |flown| flown.filter = 2.000_001,
        |flown| flown.clipped = 1,
    ];
    for spoil in broken {
        let mut flown = good.clone();
        spoil(&mut flown);
        assert!(!all_hold(&judged(&paper, &flown)), "{flown:?}");
    }
}

#[test]
fn what_a_weak_vehicle_cannot_deliver_is_counted_and_fails() {
    let text = scenario::PAPER.replace("thrust_max = 7.0", "thrust_max = 4.9");
    let weak = Scenario::parse(&text, "weak").unwrap();
    let seen = flown(&weak);
    assert!(seen.clipped > 100, "{seen:?}");
    let failed: Vec<String> =
        judged(&weak, &seen).into_iter().filter(|c| c.holds == Some(false)).map(|c| c.claim).collect();
    let late = "within 0.2 m of the reference for good";
    let refused = "commands, certificate";
    assert_eq!(failed, [refused, late, "thrust, vehicle's limit", "ticks with a clipped command"]);
}

#[test]
fn a_flight_that_is_not_certified_fails_by_the_inequality_that_fails() {
    let text = scenario::PAPER.replace("torque_max = [0.5, 0.5, 0.5]", "torque_max = [0.5, 0.5, 0.3]");
    let weak = Scenario::parse(&text, "weak").unwrap();
    let claims = judged(&weak, &flown(&weak));
    let failing: Vec<&Claim> = claims.iter().filter(|claim| claim.holds == Some(false)).collect();
    let [only] = failing[..] else { panic!("{}", table(&claims)) };
    assert_eq!((only.claim.as_str(), only.required.as_str()), ("commands, certificate", "every inequality"));
    assert!(only.flown.contains("T2 yaw torque"), "{only:?}");
    assert_eq!(verdict_line(&claims), "NOT every claim holds (commands, certificate)");
}

#[test]
fn a_flight_that_strays_from_its_path_fails_by_the_files_own_tolerance() {
    let gust = r#"
[wind]
gust = { kind = "pulse", start = 24.0, velocity = [5.0, 0.0, 0.0], duration = 3.0 }
[drag]
linear = [0.3, 0.3, 0.0]
"#;
    let with = |tolerance: &str| {
        let text = scenario::PAPER.replace("kind = \"harmonic\"", &format!("kind = \"harmonic\"{tolerance}"));
        let scenario = Scenario::parse(&(text + gust), "gusty").unwrap_or_else(|error| panic!("{error}"));
        judged(&scenario, &flown(&scenario)).into_iter().find(|claim| claim.claim.starts_with("farthest")).unwrap()
    };
    let strayed = with("");
    assert!(strayed.holds == Some(false) && strayed.required == "<= 0.5 m", "{strayed:?}");
    assert_eq!(with("\ntolerance = 50.0").holds, Some(true));
}

#[test]
fn a_flight_that_starts_on_its_path_and_leaves_it_at_once_fails_even_if_it_returns() {
    let hover = "kind = \"hover\"\nposition = [0.0, 0.0, 5.0]";
    let (head, _) = scenario::PAPER.split_once("[initial]").unwrap();
    let text = format!(
        "{head}[reference]\n{hover}\n[drag]\nlinear = [0.3, 0.3, 0.0]\n[wind]\n\
         gust = {{ kind = \"pulse\", start = 0.1, velocity = [8.0, 0.0, 0.0], duration = 3.0 }}\n"
    );
    let scenario = Scenario::parse(&text, "swept").unwrap_or_else(|error| panic!("{error}"));
    let seen = flown(&scenario);
    assert!(seen.position_reached().is_some_and(|reached| reached < 36.0), "{seen:?}");
    let strayed = judged(&scenario, &seen).into_iter().find(|claim| claim.claim.starts_with("farthest")).unwrap();
    assert_eq!(strayed.holds, Some(false), "{strayed:?}");
}
