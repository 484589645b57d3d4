use super::*;
use scenario::PAPER;
use scenario::verdict::Verdict;

const HUMMINGBIRD: &str = include_str!("../../../../../vehicles/hummingbird.toml");

/// A file with a circle of 3 m in place of its reference.
fn circling(text: &str, speed: f64) -> Scenario {
    let (head, rest) = text.split_once("\n[reference]").unwrap();
    let bounds = rest.split_once("\n[reference_bounds]").map_or("", |(_, bounds)| bounds);
    let bounds = if bounds.is_empty() || text == PAPER { String::new() } else { format!("[reference_bounds]{bounds}") };
    let turn = speed / 3.0;
    let reference = format!(
        "kind = \"harmonic\"\ncenter = [0.0, 0.0, 2.0]\namplitude = [3.0, 3.0, 0.0]\n\
         frequency = [{turn}, {turn}, 0.0]\nphase = [0.0, -1.57079633, 0.0]\n"
    );
    Scenario::parse(&format!("{head}\n[reference]\n{reference}{bounds}"), "f").unwrap()
}

#[test]
fn the_circle_that_is_promised_certifies_and_a_faster_one_does_not() {
    for text in [HUMMINGBIRD, include_str!("../../../../../vehicles/published/pelican.toml"), PAPER] {
        let text = if text.contains("[reference]") { text.to_owned() } else { format!("{text}\n[reference]\n") };
        let speed = circle(&circling(&text, 0.1)).unwrap().speed;
        let refusal = |speed: f64| Verdict::judge(&circling(&text, speed)).unwrap().refusal();
        assert_eq!(refusal(0.995 * speed), None, "{speed}");
        assert!(refusal(1.005 * speed).is_some(), "{speed}");
    }
}

#[test]
fn the_last_line_is_about_the_circle_and_a_vehicle_that_may_not_hover_may_fly_none() {
    let lines = |text: &str| lines(&Scenario::parse(text, "f").unwrap());
    let last = |text: &str| lines(text).lines().last().unwrap().to_owned();
    assert!(last(HUMMINGBIRD).starts_with("3 m circle: 8.4") && last(HUMMINGBIRD).ends_with("; tilt limits it"));
    assert!(lines(HUMMINGBIRD).starts_with("a known path beside a force of 1 m/s^2: "), "{}", lines(HUMMINGBIRD));
    assert!(last(PAPER).starts_with("3 m circle: ") && lines(PAPER).lines().count() == 1, "{}", lines(PAPER));
    let weak = PAPER.replace("torque_max = [0.5, 0.5, 0.5]", "torque_max = [0.2, 0.2, 0.2]");
    assert_eq!(last(&weak), "3 m circle: none certifies, not even at rest");
}
