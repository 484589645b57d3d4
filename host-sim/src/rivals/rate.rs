//! A scenario under a law of another rate: the same plant, the same flights, another clock.
//!
//! Sensors keep their times: poses come and everything is late as before, in whole numbers of the new period.

use scenario::Scenario;

/// `scenario` at a control rate of so many Hz.
pub fn at(scenario: &Scenario, rate: f64) -> Result<Scenario, String> {
    let (own, timing) = (scenario.timing.period_us, scenario.timing.at_rate(rate)?);
    let mut other = Scenario { timing, ..scenario.clone() };
    let reality = &mut other.reality;
    let whole = |what: &str, time_us: u64| {
        let fits = time_us.is_multiple_of(timing.period_us);
        fits.then(|| time_us / timing.period_us)
            .ok_or_else(|| format!("{what}, {time_us} us, must be a whole number of periods, found {rate} Hz"))
    };
    if let Some(sensors) = &mut reality.sensors {
        sensors.pose_every = whole("the time between poses of [sensors]", sensors.pose_every * own)?;
        sensors.delay_ticks = whole("sensors.delay", sensors.delay_ticks * own)?;
    }
    if reality.estimator.is_some() && !timing.period_us.is_multiple_of(1_000) {
        return Err(format!("with [estimator] 1/rate must be whole milliseconds, found {rate} Hz"));
    }
    Ok(other)
}

#[cfg(test)]
mod tests {
    use super::*;

    const HUMMINGBIRD: &str = include_str!("../../../vehicles/hummingbird.toml");

    #[test]
    fn flights_last_as_long_and_sensors_keep_their_times() {
        let sensors = "[sensors]\npose_rate = 50.0\ndelay = 0.02\n";
        let scenario = Scenario::parse(&format!("{HUMMINGBIRD}\n{sensors}"), "h.toml").unwrap();
        let quick = at(&scenario, 500.0).unwrap();
        assert_eq!(
            (quick.timing.duration(), quick.timing.step()),
            (scenario.timing.duration(), scenario.timing.step())
        );
        assert_eq!((quick.timing.period_us, quick.timing.steps_per_tick), (2_000, 2));
        let sensors = quick.reality.sensors.unwrap();
        assert_eq!((sensors.pose_every, sensors.delay_ticks), (10, 10));
    }

    #[test]
    fn a_rate_between_steps_or_samples_is_refused_with_the_reason() {
        let file = Scenario::parse(HUMMINGBIRD, "h.toml").unwrap();
        let refused = |scenario: &Scenario, rate: f64| at(scenario, rate).err().unwrap();
        assert!(refused(&file, 300.0).contains("1/rate must be a whole number of microseconds, found 300 Hz"));
        let steps = "1/rate must be a whole number of plant steps of 0.001 s, found 400 Hz = 0.0025 s";
        assert_eq!(refused(&file, 400.0), steps);
        assert_eq!(refused(&file, 5.0), "must be from 10 to 4000 Hz, found 5");
        let sensed = format!("{HUMMINGBIRD}\n[sensors]\ndelay = 0.01\n");
        let sensed = Scenario::parse(&sensed, "h.toml").unwrap();
        assert!(refused(&sensed, 50.0).contains("must be a whole number of periods"));
    }
}
