//! The lines, and the share that statistics prove.

use super::super::many::DOUBT_PROBABILITY;
use super::super::tests::{hummingbird, sets};
use super::super::{Orders, recovery};
use super::*;
use crate::output::interrupt::Interrupt;

#[test]
fn the_share_is_the_one_that_so_many_flights_would_miss_with_the_doubt() {
    for flights in [1, 10, 20_000, 100_000_000] {
        let p = share_beyond(flights);
        let missed = (flights as f64 * (-p).ln_1p()).exp();
        assert!((missed / DOUBT_PROBABILITY - 1.0).abs() < 1e-6, "{flights}: {p}");
    }
    assert_eq!((1.0 / share_beyond(20_000)) as u64, 1_448);
}

#[test]
fn thousands_are_apart() {
    assert_eq!([0, 999, 1_000, 1_234_567].map(grouped), ["0", "999", "1,000", "1,234,567"]);
}

fn report() -> Report {
    let orders = Orders { flights: 20, search: 4, seed: 1 };
    recovery(&hummingbird(), &sets(), &orders, &Interrupt::default()).unwrap()
}

fn line(text: &str, start: &str) -> String {
    text.lines().find(|line| line.starts_with(start)).unwrap_or_else(|| panic!("no {start:?} in\n{text}")).to_owned()
}

#[test]
fn height_and_time_say_that_they_are_not_proven_and_what_is() {
    let report = report();
    let text = report.to_string();
    for (start, unit) in [("H ", "m"), ("T ", "s")] {
        let line = line(&text, start);
        assert_eq!(line.split(' ').nth(2), Some(unit), "{line}");
        assert!(line.contains("from S: ") && line.contains("NOT proven for every start"), "{line}");
        assert!(line.contains("of 20 random flights") && line.contains("fewer than 1 in 2 "), "{line}");
    }
    let radius = line(&text, "r ");
    assert_eq!(radius.split(' ').nth(2), Some("m"), "{radius}");
    assert!(radius.contains("PROVEN") && radius.contains("greatest gust"), "{radius}");
    assert!(report.reason().contains("H and T are NOT proven"));
    let height: f64 = line(&text, "H ").split(' ').nth(1).unwrap().parse().unwrap();
    assert!(height >= report.height.worst() && height < report.height.worst() + 0.01, "{text}");
}

#[test]
fn a_gust_without_a_radius_is_said_with_the_reason_and_the_greatest_that_has_one() {
    let orders = Orders { flights: 5, search: 0, seed: 1 };
    let strong = Sets { gust: 5.0, ..sets() };
    let report = recovery(&hummingbird(), &strong, &orders, &Interrupt::default()).unwrap();
    let text = report.to_string();
    let radius = line(&text, "r ");
    assert!(
        radius.starts_with("r none is proven for S: lateral x: ") && radius.contains("T counts with within 0.5 m"),
        "{radius}"
    );
    assert!(report.reason().contains("no r is proven") && report.gust_max > 0.3 && report.gust_max < 1.0);
}

#[test]
fn flights_that_are_not_back_are_counted_and_prove_no_time() {
    let mut report = report();
    (report.not_arrived, report.fell_back) = (3, 2);
    let text = report.to_string();
    let time = line(&text, "T ");
    assert!(time.contains("3 of 20 random flights are not back after 20 s") && !time.contains("fewer"), "{time}");
    assert!(text.contains("in 2 of 20 random flights the law's fallback comes\n"), "{text}");
}
