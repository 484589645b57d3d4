//! A campaign beside the same flights one by one.

use super::*;
use crate::course::Course;

const HUMMINGBIRD: &str = include_str!("../../../vehicles/hummingbird-paper-law.toml");

fn short(sections: &str) -> Scenario {
    let text = format!("{HUMMINGBIRD}\n{sections}").replace("duration = 40.0", "duration = 2.0");
    Scenario::parse(&text, "f").unwrap()
}

#[test]
fn a_campaign_is_its_flights_one_by_one_in_order() {
    let sections =
        "[drag]\nframe = [0.005, 0.005, 0.01]\n[wind]\nsteady = [1, 0, 0]\n[sensors]\nposition_noise = 0.002\n";
    let scenario = short(sections);
    let certified = Certified::new(scenario.configuration.clone()).unwrap();
    let circumstances = |number: u64| {
        let mut case = scenario.clone();
        case.initial.velocity.y = 0.1 * number as f64;
        if let Some(sensors) = &mut case.reality.sensors {
            sensors.seed = number;
        }
        case
    };
    let course = |scenario: &Scenario, flight| Course::over(scenario, flight, 0.1).unwrap();
    let all = fly_all(Some(&certified), 12, circumstances, course).unwrap();
    let one_by_one: Vec<Course> = (0..12)
        .map(|number| course(&circumstances(number), Flight::certified(&circumstances(number), &certified).unwrap()))
        .collect();
    assert_eq!(all, one_by_one);
    assert!(all.windows(2).all(|pair| pair[0] != pair[1]));
}

#[test]
fn a_quantile_is_the_value_at_its_place() {
    let values = [3.0, 1.0, 2.0, f64::NAN, 4.0];
    assert_eq!([0.0, 0.25, 0.5, 0.75].map(|part| quantile(&values, part)), [1.0, 2.0, 3.0, 4.0].map(Some));
    assert!(quantile(&values, 1.0).unwrap().is_nan());
    assert_eq!(quantile(&[], 0.5), None);
}
