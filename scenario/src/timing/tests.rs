//! The paper's clock, and times that do not fit.

use super::*;

fn read(text: &str) -> Result<Timing, FieldError> {
    Timing::read(&Section::root(&text.parse().unwrap()))
}

#[test]
fn the_papers_clock_ticks_4000_times() {
    let timing = read("duration = 40.0\ncontrol.rate = 100\nplant.step = 0.001").unwrap();
    assert_eq!(timing, Timing { ticks: 4000, period_us: 10_000, steps_per_tick: 10 });
    assert_eq!(read("duration = 40.0").unwrap(), timing);
    assert!((timing.duration() - 40.0).abs() < 1e-12 && (timing.step() - 1e-3).abs() < 1e-18);
}

#[test]
fn a_period_between_microseconds_is_refused_with_the_nearest_rate() {
    let error = read("duration = 1\ncontrol.rate = 300").unwrap_err();
    assert_eq!(error.field, "control.rate");
    assert!(error.problem.contains("nearest: 300.03"), "{error}");
    // A third of a microsecond short of one, not beyond.
    assert!(read("duration = 1\ncontrol.rate = 299.97").unwrap_err().problem.contains("nearest: 299.94"));
}

#[test]
fn a_duration_of_whole_periods_has_them_all_whatever_rounding_makes_of_it() {
    for (duration, ticks) in [("0.29", 29), ("0.58", 58), ("0.299", 29)] {
        assert_eq!(read(&format!("duration = {duration}")).unwrap().ticks, ticks, "{duration} s");
    }
}

#[test]
fn a_step_that_does_not_divide_the_period_is_refused_with_the_nearest_step() {
    let error = read("duration = 1\ncontrol.rate = 400\nplant.step = 0.001").unwrap_err();
    assert_eq!(error.field, "plant.step");
    let error = read("duration = 1\nplant.step = 0.02").unwrap_err();
    assert!(error.field == "plant.step" && error.problem.contains("nearest: 1e-2 s"), "{error}");
}

#[test]
fn zero_and_negative_times_are_refused_by_name() {
    for (text, field) in [
        ("duration = 0", "duration"),
        ("duration = -1", "duration"),
        ("duration = 0.001", "duration"),
        ("duration = 1e8", "duration"),
        ("duration = 1\ncontrol.rate = 0", "control.rate"),
        ("duration = 1\ncontrol.rate = -100", "control.rate"),
        ("duration = 1\ncontrol.rate = 5", "control.rate"),
        ("duration = 1\ncontrol.rate = 5000", "control.rate"),
        ("duration = 1\ncontrol.rate = 1e6", "control.rate"),
        ("duration = 1\nplant.step = 0", "plant.step"),
        ("duration = 1\nplant.step = -0.001", "plant.step"),
        ("duration = 1\nplant.step = 1e-12", "plant.step"),
    ] {
        assert_eq!(read(text).unwrap_err().field, field, "{text}");
    }
}

#[test]
fn the_default_step_divides_any_period() {
    let timing = read("duration = 1\ncontrol.rate = 400").unwrap();
    assert_eq!((timing.period_us, timing.steps_per_tick), (2500, 3));
}

#[test]
fn a_period_given_by_the_tick_has_the_range_of_the_rate() {
    for period in [2.5e-4, 0.01, 0.1] {
        assert_eq!(check_period(period), Ok(()));
    }
    for period in [1e-30, 2.4e-4, 0.101, 0.0, -0.01, f64::NAN] {
        let expected = format!("must be from 0.00025 to 0.1 s, found {period}");
        assert_eq!(check_period(period), Err(expected));
    }
}
