//! The same flights with control at other rates than 100 Hz: the rate is the file's, poses come as they come.

use super::flight::Flight;
use super::landing::check_landed;
use firmware::boot;
use firmware::configuration::LOOPS;
use firmware::parameters::tuned::Built;
use flight::Mode;
use nalgebra::UnitQuaternion;
use scenario::{Scenario, board};

/// The file that the firmware embeds.
const EMBEDDED: &str = include_str!("../../../vehicles/study.toml");

/// The embedded vehicle, booted from its file with control at so many hertz and a sample of delay.
fn boot_at(rate: u32) -> Flight {
    let text = EMBEDDED.replace("rate = 100.0 ", &format!("rate = {rate}.0 "));
    let text = text.replace("delay = 0.010 ", &format!("delay = {} ", 1.0 / f64::from(rate)));
    let scenario = Scenario::parse(&text, "a test").unwrap();
    assert_eq!(board::check(&scenario, "a test"), Ok(None));
    let period = scenario.timing.period_us;
    assert_eq!(period, u64::from(1_000_000 / rate));
    // Nothing is tuned on board here, so which choices could be does not matter.
    let (motor, configuration) = (scenario.motor(), scenario.configuration);
    let built = Built { configuration, motor, loops: &LOOPS, identity: 0, period, follows_rotors: false };
    Flight::with(|shared| boot::start_with(Box::leak(Box::new(boot::Place::new())), shared.for_boot(), built).unwrap())
}

#[test]
fn it_goes_up_steps_hovers_and_lands_at_50_to_1000_hz() {
    for rate in [50, 100, 250, 500, 1_000] {
        let mut flight = boot_at(rate);
        flight.pass(2.0);
        flight.go_up();
        assert!(flight.distance([0.0, 0.0, 1.0]) < 0.05, "{rate} Hz: {}", flight.hardware.pose().position);
        flight.station.go_to([1.0, 0.0, 1.0]);
        // On the way there the estimate is put to the test.
        let (mut slip, mut turn) = (0.0_f32, 0.0_f32);
        for _ in 0..300 {
            flight.pass(0.02);
            let (truth, estimated) = (flight.hardware.pose(), flight.report().state.unwrap());
            let [there, here] = [truth, estimated].map(|state| UnitQuaternion::new_unchecked(state.attitude));
            slip = slip.max((estimated.velocity - truth.velocity).norm());
            turn = turn.max(there.angle_to(&here));
        }
        println!("{rate} Hz: velocity within {slip:.4} m/s, attitude within {turn:.5} rad of the truth");
        assert!(slip < 0.02 && turn < 0.002, "{rate} Hz: {slip} m/s, {turn} rad");
        assert!(flight.distance([1.0, 0.0, 1.0]) < 0.01, "{rate} Hz: {}", flight.hardware.pose().position);
        flight.station.land();
        check_landed(&mut flight, 10.0);
        let timing = flight.report().timing;
        assert_eq!((timing.period, timing.missed, timing.worst_jitter), (u64::from(1_000_000 / rate), 0, 0));
        // Control got every increment of the IMU, each beginning where the one before it ended.
        assert_eq!((timing.gaps, flight.shared.lost_increments.get()), (0, 0), "{rate} Hz");
    }
}

#[test]
fn a_timeout_takes_as_long_at_50_to_1000_hz() {
    let mut all = Vec::new();
    for rate in [50, 100, 500, 1_000] {
        let mut flight = boot_at(rate);
        flight.pass(2.0);
        flight.station.arm(true);
        let armed = flight.until("Armed: idling", 0.1);
        let idled = flight.until("Disarmed: nothing commanded for 10 s", 11.0) - armed;
        flight.pass(3.0);
        flight.go_up();
        flight.poses(false);
        let last = flight.now();
        let lost = flight.until("Pose lost: levelling for 1 s, then going down", 2.0) - last;
        flight.pass(0.5);
        assert_eq!(flight.report().mode, Mode::Descending);
        let landed = flight.until("Landed", 10.0) - last - lost;
        println!("{rate} Hz: idled for {idled} us, coasted for {lost} us, came down within {landed} us");
        all.push([idled, lost]);
        assert!((2_000_000..6_000_000).contains(&landed), "{rate} Hz: {landed}");
    }
    // To a tick and a frame of the link.
    let spread =
        |what: usize| all.iter().map(|one| one[what]).max().unwrap() - all.iter().map(|one| one[what]).min().unwrap();
    assert!(spread(0) <= 40_000 && spread(1) <= 40_000, "{all:?}");
}
