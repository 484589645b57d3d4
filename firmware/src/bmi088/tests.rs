//! The driver against a sensor that follows the data sheet, or fails in every way it can.

mod bench;

use super::*;
use crate::registers::RESTART_AFTER_FAILURES;
use crate::tests::bench::{Jumping, Pin, X_LEFT, on_one_bus};
use bench::{Bench, Part, Registers, bench};
use core::cell::Cell;
use core::future::{Future, pending};
use core::pin::pin;
use core::task::{Context, Waker};
use std::rc::Rc;

fn writes(device: &Part) -> Vec<(u8, u8)> {
    device.0.borrow().written.iter().map(|written| (written.register, written.value)).collect()
}

/// When the write after that of `register` came, less its own time.
fn pause_after(device: &Part, register: u8) -> u64 {
    let device = device.0.borrow();
    let index = device.written.iter().position(|written| written.register == register).unwrap();
    device.written[index + 1].time - device.written[index].time
}

#[test]
fn power_up_writes_the_data_sheets_registers_in_order() {
    let mut bench = bench(&Mounting::ALIGNED);
    bench.sample().unwrap();
    assert_eq!(writes(&bench.accelerometer), [(0x7E, 0xB6), (0x7C, 0x00), (0x7D, 0x04), (0x40, 0x8C), (0x41, 0x03)]);
    let gyroscope = [(0x14, 0xB6), (0x0F, 0x00), (0x10, 0x82), (0x16, 0x0D), (0x18, 0x01), (0x15, 0x80)];
    assert_eq!(writes(&bench.gyroscope), gyroscope);
}

#[test]
fn power_up_waits_as_long_as_the_devices_need() {
    let mut bench = bench(&Mounting::ALIGNED);
    bench.sample().unwrap();
    assert!(bench.accelerometer.0.borrow().written[0].time >= 1_000);
    assert!(pause_after(&bench.accelerometer, ACCELEROMETER_RESET) >= 1_000);
    assert!(pause_after(&bench.accelerometer, 0x7C) >= 5_000);
    assert!(pause_after(&bench.accelerometer, 0x7D) >= 50_000);
    assert!(pause_after(&bench.gyroscope, GYROSCOPE_RESET) >= 30_000);
}

#[test]
fn power_up_ends_before_the_task_loses_patience() {
    let mut bench = bench(&Mounting::ALIGNED);
    bench.sample().unwrap();
    assert!(bench.clock.now() + 10_000 < crate::imu::SAMPLE_TIMEOUT_US, "{} us", bench.clock.now());
}

#[test]
fn a_running_sensor_is_not_powered_up_again() {
    let mut bench = bench(&Mounting::ALIGNED);
    bench.sample().unwrap();
    let before = (writes(&bench.accelerometer), writes(&bench.gyroscope));
    bench.sample().unwrap();
    assert_eq!(before, (writes(&bench.accelerometer), writes(&bench.gyroscope)));
}

#[test]
fn full_scale_counts_are_two_thousand_degrees_a_second_and_24_g() {
    let mut bench = bench(&Mounting::ALIGNED);
    bench.gyroscope.load(GYROSCOPE.data, &[0x00, 0x80, 0xFF, 0x7F, 0x01, 0x00]);
    bench.accelerometer.load(ACCELEROMETER.data, &[0xFF, 0x7F, 0x00, 0x80, 0x55, 0x05]);
    let sample = bench.sample().unwrap();
    let rates = sample.angular_velocity.map(f64::from);
    let full = 2000.0_f64.to_radians();
    assert!((rates.x + full).abs() < 1e-5 && (rates.y - full * 32767.0 / 32768.0).abs() < 1e-5, "{rates}");
    assert!((rates.z - full / 32768.0).abs() < 1e-9, "{rates}");
    let force = sample.specific_force.unwrap().map(f64::from);
    let full = 24.0 * 9.806_65;
    assert!((force.x - full * 32767.0 / 32768.0).abs() < 1e-4 && (force.y + full).abs() < 1e-4, "{force}");
    // At rest: 1365 counts are one gravity.
    assert!((force.z - 9.806_65).abs() < 0.01, "{force}");
}

#[test]
fn the_mounting_turns_both_measurements() {
    let mut bench = bench(&X_LEFT);
    bench.gyroscope.load(GYROSCOPE.data, &[0x00, 0x10, 0, 0, 0, 0]);
    bench.accelerometer.load(ACCELEROMETER.data, &[0x00, 0x10, 0, 0, 0, 0]);
    let sample = bench.sample().unwrap();
    assert_eq!(sample.angular_velocity, Vector3::new(0.0, 4096.0 * RATE_PER_COUNT, 0.0));
    assert_eq!(sample.specific_force, Some(Vector3::new(0.0, 4096.0 * ACCELERATION_PER_COUNT, 0.0)));
}

#[test]
fn another_chips_identity_is_a_fault_of_the_gyroscope_and_silence_of_the_accelerometer() {
    let mut other = bench(&Mounting::ALIGNED);
    other.accelerometer.load(CHIP_ID, &[0x1F]);
    assert_eq!(other.sample().unwrap().specific_force, None);
    let mut other = bench(&Mounting::ALIGNED);
    other.gyroscope.load(CHIP_ID, &[0x0E]);
    assert_eq!(other.sample(), Err(Fault));
}

#[test]
fn a_bus_that_fails_at_once_leaves_time_for_other_tasks() {
    let mut other = bench(&Mounting::ALIGNED);
    other.gyroscope.0.borrow_mut().line.fails = true;
    for _ in 0..100 {
        let before = other.clock.now();
        assert_eq!(other.sample(), Err(Fault));
        assert!(other.clock.now() - before >= 1_000);
    }
}

#[test]
fn settings_are_written_again_one_by_one_until_they_stick() {
    // Every setting of either device may be lost seven times; the eighth must stick.
    for device in [0, 1] {
        for lost in [1, 7] {
            let mut bench = bench(&Mounting::ALIGNED);
            let part = if device == 0 { &bench.accelerometer } else { &bench.gyroscope }.clone();
            part.0.borrow_mut().deaf_per_setting = lost;
            assert!(bench.sample().unwrap().specific_force.is_some(), "device {device}, {lost} lost");
            let resets = writes(&part).iter().filter(|(_, value)| *value == SOFT_RESET).count();
            assert_eq!(resets, 1, "one power-up: {:x?}", writes(&part));
            let steps = if device == 0 { ACCELEROMETER.power_up } else { GYROSCOPE.power_up };
            let settings = steps.iter().filter(|step| matches!(step.2, Set(_)));
            let values = part.0.borrow().values;
            assert!(settings.into_iter().all(|(register, value, _)| values[usize::from(*register)] == *value));
            assert!(bench.clock.now() < crate::imu::SAMPLE_TIMEOUT_US, "{} us", bench.clock.now());
        }
    }
}

#[test]
fn a_setting_that_never_sticks_is_a_fault_of_the_gyroscope_and_silence_of_the_accelerometer() {
    let mut other = bench(&Mounting::ALIGNED);
    other.gyroscope.0.borrow_mut().deaf_per_setting = 8;
    assert_eq!(other.sample(), Err(Fault));
    let mut other = bench(&Mounting::ALIGNED);
    other.accelerometer.0.borrow_mut().deaf_per_setting = 8;
    assert_eq!(other.sample().unwrap().specific_force, None);
}

#[test]
fn a_stuck_bus_in_flight_is_no_vehicle_at_rest() {
    for level in [0x00, 0xFF] {
        let mut bench = bench(&Mounting::ALIGNED);
        bench.sample().unwrap();
        bench.accelerometer.0.borrow_mut().stuck = Some(level);
        assert_eq!(bench.sample().unwrap().specific_force, None, "level {level:#x}");
        bench.gyroscope.0.borrow_mut().stuck = Some(level);
        assert_eq!(bench.sample(), Err(Fault), "level {level:#x}");
    }
}

#[test]
fn the_gyro_is_delivered_while_the_accelerometer_fails_and_is_powered_up_between_its_samples() {
    type Disturbed = fn(&mut Registers, bool);
    let disturbances: [Disturbed; 3] =
        [|part, on| part.line.fails = on, |part, on| part.line.hangs = on, |part, on| part.stuck = on.then_some(0xFF)];
    for disturb in disturbances {
        let mut bench = bench(&Mounting::ALIGNED);
        bench.gyroscope.load(GYROSCOPE.data, &[0x00, 0x10, 0, 0, 0, 0]);
        bench.sample().unwrap();
        let resets = |part: &Part| writes(part).iter().filter(|(_, value)| *value == SOFT_RESET).count();
        disturb(&mut bench.accelerometer.0.borrow_mut(), true);
        let begin = bench.clock.now();
        let mut last = begin;
        while bench.clock.now() < begin + 500_000 {
            // Edges come in no time here; a sample is 1 ms later.
            bench.clock.jump(last + 1_000);
            let sample = bench.sample().unwrap();
            assert_eq!((sample.angular_velocity.x, sample.specific_force), (4096.0 * RATE_PER_COUNT, None));
            assert!(bench.clock.now() - last <= 1_000 + 2 * ACCESS_TIMEOUT_US, "{} us", bench.clock.now() - last);
            last = bench.clock.now();
        }
        disturb(&mut bench.accelerometer.0.borrow_mut(), false);
        let back = (0..400).position(|_| {
            bench.clock.jump(bench.clock.now() + 1_000);
            bench.sample().unwrap().specific_force.is_some()
        });
        assert!(back.is_some_and(|samples| samples < 250), "{back:?}");
        assert_eq!(resets(&bench.gyroscope), 1, "the gyroscope was left alone");
    }
}

#[test]
fn without_data_ready_edges_the_sensor_is_polled_a_thousand_times_a_second() {
    let mut bench = bench(&Mounting::ALIGNED);
    bench.sample().unwrap();
    assert!(!bench.imu.is_polled());
    bench.data_ready.set(false);
    let before = bench.clock.now();
    // The first missing edge is waited for.
    assert_eq!(bench.sample().unwrap().time - before, 2_500);
    for n in 1..=100 {
        assert_eq!(bench.sample().unwrap().time - before, 2_500 + n * 1_000);
    }
    assert!(bench.imu.is_polled());
    bench.data_ready.set(true);
    bench.sample().unwrap();
    assert!(!bench.imu.is_polled());
}

#[test]
fn a_gyroscope_that_hangs_is_a_fault_within_500_us() {
    let mut bench = bench(&Mounting::ALIGNED);
    bench.sample().unwrap();
    bench.gyroscope.0.borrow_mut().line.hangs = true;
    let before = bench.clock.now();
    assert_eq!(bench.sample(), Err(Fault));
    assert_eq!(bench.clock.now() - before, 500);
}

#[test]
fn chip_selects_are_high_after_an_access_however_it_ends() {
    type Disturbed = fn(&mut Registers);
    let disturbances: [Disturbed; 3] = [|_| (), |part| part.line.fails = true, |part| part.line.hangs = true];
    for disturb in disturbances {
        for broken in [0, 1] {
            let mut bench = bench(&Mounting::ALIGNED);
            bench.sample().unwrap();
            let devices = [bench.accelerometer.clone(), bench.gyroscope.clone()];
            disturb(&mut devices[broken].0.borrow_mut());
            let _ = bench.sample();
            assert!(devices.iter().all(|device| !device.0.borrow().line.selected));
        }
    }
}

#[test]
fn chip_selects_are_high_after_a_sample_that_is_dropped_half_way() {
    /// What bounds an access never comes.
    struct Patient(Jumping);
    impl Clock for Patient {
        fn now(&self) -> u64 {
            self.0.now()
        }

        async fn until(&self, time: u64) {
            if time == self.now() + ACCESS_TIMEOUT_US {
                pending().await
            }
            self.0.jump(time);
        }
    }
    let Bench { accelerometer, gyroscope, .. } = bench(&Mounting::ALIGNED);
    accelerometer.0.borrow_mut().line.hangs = true;
    let parts = [accelerometer, gyroscope];
    let pin = Pin { rises: Rc::new(Cell::new(true)), late: 0, clock: Jumping::default() };
    let devices = on_one_bus([parts[0].0.clone(), parts[1].0.clone()]);
    let mut imu = Bmi088::new(devices, pin, Patient(Jumping::default()), &Mounting::ALIGNED);
    {
        let mut sample = pin!(imu.sample());
        assert!(sample.as_mut().poll(&mut Context::from_waker(Waker::noop())).is_pending());
        assert!(parts[0].0.borrow().line.selected);
    }
    assert!(parts.iter().all(|device| !device.0.borrow().line.selected));
}

#[test]
fn one_fault_costs_one_sample_and_many_power_the_gyroscope_up_anew() {
    let mut bench = bench(&Mounting::ALIGNED);
    bench.sample().unwrap();
    let writes_of_one_power_up = writes(&bench.gyroscope).len();
    bench.gyroscope.0.borrow_mut().line.fails = true;
    bench.sample().unwrap_err();
    bench.gyroscope.0.borrow_mut().line.fails = false;
    bench.sample().unwrap();
    assert_eq!(writes(&bench.gyroscope).len(), writes_of_one_power_up);
    bench.gyroscope.0.borrow_mut().line.fails = true;
    for _ in 0..RESTART_AFTER_FAILURES {
        bench.sample().unwrap_err();
    }
    bench.gyroscope.0.borrow_mut().line.fails = false;
    bench.sample().unwrap();
    assert_eq!(writes(&bench.gyroscope).len(), 2 * writes_of_one_power_up);
}
