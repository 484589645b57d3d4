//! A simulator's samples at 1 kHz: they become what a sensor's would, whatever the line does to their order and number.

use crate::support::PERIOD_US;
use crate::support::line::Live;
use crate::support::receiver::{Local, texts};
use crate::support::simulator::{Hil, command, sensor};
use crate::support::{Simulated, v2};
use core::cell::Cell;
use estimation::estimator::Increment;
use estimation::imu::ImuParameters;
use firmware::hardware::{Clock, Fault, Imu, RawImu};
use firmware::{frames, hil, imu};
use flight::{ImuSample, Stamped};
use mavlink::dialects::common::HIL_SENSOR_DATA;
use nalgebra::Vector3;

/// Between two samples, us.
const SAMPLE_PERIOD_US: u64 = 1_000;

/// The first command is given a period after boot, the last one this many later.
const FLIGHT_TICKS: u64 = 50;

/// A motion that never repeats itself, about every axis.
fn motion(time: u64) -> ImuSample {
    let t = time as f32 * 1e-6;
    let angular_velocity = Vector3::new((31.0 * t).sin(), (47.0 * t).cos(), 0.5 * (200.0 * t).sin());
    let specific_force = Vector3::new((53.0 * t).sin(), 2.0 * (29.0 * t).cos(), 9.8 + (71.0 * t).sin());
    ImuSample { angular_velocity, specific_force }
}

/// The simulator's word on that motion at `time`.
fn sensor_at(time: u64) -> Vec<u8> {
    let ImuSample { angular_velocity, specific_force } = motion(time);
    let (gyro, force) = (frames::body(&angular_velocity), frames::body(&specific_force));
    let rates = HIL_SENSOR_DATA { xgyro: gyro.x, ygyro: gyro.y, zgyro: gyro.z, ..sensor(time) };
    v2(1, &HIL_SENSOR_DATA { xacc: force.x, yacc: force.y, zacc: force.z, ..rates })
}

/// The times of a command's ten samples, us.
fn times(commanded: u64) -> impl Iterator<Item = u64> {
    (1..=10).map(move |sample| commanded + sample * SAMPLE_PERIOD_US)
}

/// What control gets.
struct Got {
    increments: Vec<Increment>,
    newest: Stamped<ImuSample>,
    texts: Vec<String>,
}

fn drain(shared: &Local, increments: &mut Vec<Increment>) {
    increments.extend(std::iter::from_fn(|| shared.increments.take()));
}

/// What control gets from a simulator that sends `answer` to the command of a time.
fn simulated(answer: impl Fn(u64) -> Vec<u8>) -> Got {
    let (clock, shared, line, hil) = (Simulated::default(), Local::new(), Live::default(), Hil::new());
    let mut increments = Vec::new();
    clock.run(
        (FLIGHT_TICKS + 2) * PERIOD_US,
        hil::receive(&hil, line.clone(), &clock, shared.for_simulator(), PERIOD_US),
        |now| {
            drain(&shared, &mut increments);
            if now % PERIOD_US == 0 && (PERIOD_US..=FLIGHT_TICKS * PERIOD_US).contains(&now) {
                // The answer to the command before was whole.
                assert!(!hil.awaiting(), "{now}");
                command(&hil, now);
                line.say(&answer(now));
            }
        },
    );
    assert!(!hil.awaiting());
    Got { increments, newest: shared.imu.get().unwrap(), texts: texts(&shared) }
}

/// A sensor that feels the motion, each millisecond from after the first command on.
struct Real<'a> {
    clock: &'a Simulated,
    last: &'a Cell<u64>,
}

impl Imu for Real<'_> {
    async fn sample(&mut self) -> Result<RawImu, Fault> {
        let time = self.last.get() + SAMPLE_PERIOD_US;
        self.clock.until(time).await;
        self.last.set(time);
        let ImuSample { angular_velocity, specific_force } = motion(time);
        Ok(RawImu { time, angular_velocity, specific_force: Some(specific_force) })
    }

    fn parameters(&self) -> ImuParameters {
        ImuParameters::PROMPT
    }

    fn is_polled(&self) -> bool {
        false
    }
}

/// What control gets from that sensor.
fn real() -> Got {
    let (clock, shared, last) = (Simulated::default(), Local::new(), Cell::new(PERIOD_US));
    let mut increments = Vec::new();
    let end = (FLIGHT_TICKS + 1) * PERIOD_US + SAMPLE_PERIOD_US / 2;
    clock.run(end, imu::run(shared.for_imu(), &clock, &mut Real { clock: &clock, last: &last }, PERIOD_US), |_| {
        drain(&shared, &mut increments);
    });
    drain(&shared, &mut increments);
    Got { increments, newest: shared.imu.get().unwrap(), texts: texts(&shared) }
}

#[test]
fn ten_samples_a_tick_are_integrated_and_filtered_as_a_sensors() {
    let (simulated, real) = (simulated(|now| times(now).flat_map(sensor_at).collect()), real());
    assert_eq!(real.newest.time, (FLIGHT_TICKS + 1) * PERIOD_US);
    assert_eq!(simulated.increments, real.increments);
    assert_eq!(simulated.newest, real.newest);
    // Two a tick; the first sample begins the first of them.
    assert_eq!(real.increments.len() as u64, 2 * FLIGHT_TICKS - 1);
    assert_eq!((simulated.texts, real.texts), (vec![], vec![]));
}

#[test]
fn repeated_out_of_order_and_future_samples_change_nothing() {
    let clean = simulated(|now| times(now).flat_map(sensor_at).collect());
    let twice = |time: u64| [sensor_at(time), sensor_at(time)].concat();
    let repeated = simulated(|now| times(now).flat_map(twice).collect());
    // The third comes again behind the fifth, then one of the period before, as old as that command.
    let behind = |time: u64, now: u64| match (time - now) / SAMPLE_PERIOD_US {
        5 => [sensor_at(time), sensor_at(time - 2 * SAMPLE_PERIOD_US)].concat(),
        7 => [sensor_at(time), sensor_at(now - 4 * SAMPLE_PERIOD_US), sensor_at(now)].concat(),
        _ => sensor_at(time),
    };
    let overtaken = simulated(|now| times(now).flat_map(|time| behind(time, now)).collect());
    for got in [repeated, overtaken] {
        assert_eq!(got.increments, clean.increments);
        assert_eq!(got.newest, clean.newest);
        assert_eq!(got.texts, ["IMU: samples out of order"]);
    }
    // A microsecond beyond the period, and a period: not taken in the first place.
    let early = |now: u64| [sensor_at(now + PERIOD_US + 1), sensor_at(now + 2 * PERIOD_US)].concat();
    let hasty = simulated(|now| early(now).into_iter().chain(times(now).flat_map(sensor_at)).collect());
    assert_eq!((hasty.increments, hasty.newest), (clean.increments, clean.newest));
    assert_eq!(hasty.texts, [""; 0]);
}
