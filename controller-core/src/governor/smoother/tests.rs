extern crate std;
use super::super::averages::Averages;
use super::super::tests::TYPICAL;
use super::super::{GovernorLimits, tests::Random};
use super::*;
use std::vec::Vec;

fn windows() -> Windows {
    Windows::design(&TYPICAL, &GovernorLimits::default(), 0.01).unwrap()
}

/// The whole filter: commands in, knots out.
struct Filter {
    averages: Averages,
    smoother: Smoother,
}

impl Filter {
    fn push(&mut self, command: &Vector3<i32>) {
        let snap = self.averages.push(command);
        self.smoother.push(&snap);
    }

    /// As if always in these steady motions.
    fn start(&mut self, steady: &[Steady; 3], windows: &Windows) {
        let [x, y, z] = steady;
        let acceleration = Vector3::new(x.acceleration, y.acceleration, z.acceleration).map(|whole| whole as i32);
        let commanded = Vector3::new(x.commanded, y.commanded, z.commanded);
        self.averages.start(commanded, Vector3::new(x.speed, y.speed, z.speed), acceleration);
        self.smoother.start(steady, windows);
    }

    fn at_rest(&self) -> bool {
        self.smoother.at_rest(self.averages.commanded())
    }
}

/// At rest at the origin.
fn filter(windows: &Windows) -> Filter {
    let mut filter = Filter { averages: Averages::NONE, smoother: Smoother::NONE };
    filter.averages.design(windows);
    filter.smoother.design(windows, 0.01);
    filter
}

/// Three averages of the commands, run one after another in floating point.
fn averaged(commands: &[f64], lengths: [usize; 3]) -> Vec<f64> {
    let mut signal = commands.to_vec();
    for length in lengths {
        signal = (0..signal.len())
            .map(|k| (0..length).map(|i| if k >= i { signal[k - i] } else { 0.0 }).sum::<f64>() / length as f64)
            .collect();
    }
    signal
}

#[test]
fn the_comb_and_its_sums_are_three_moving_averages() {
    let windows = windows();
    let mut filter = filter(&windows);
    let mut random = Random::new(5);
    let commands: Vec<i32> = (0..1_500).map(|_| (random.signed() * 8e6) as i32).collect();
    let expected = averaged(&commands.iter().map(|&c| f64::from(c)).collect::<Vec<_>>(), windows.lengths);
    for (command, expected) in commands.iter().zip(&expected) {
        filter.push(&Vector3::new(*command, -command, 0));
        let average = filter.smoother.axes[0].difference[1] as f64 / windows.product() as f64;
        assert!((average - expected).abs() < 1e-4, "{average} against {expected}");
    }
}

#[test]
fn a_steady_motion_comes_out_as_it_went_in() {
    let windows = windows();
    let mut filter = filter(&windows);
    let unit = windows.per_metre as i64;
    let speed = unit / 50;
    let moving = Steady { commanded: 0, speed, acceleration: 0 };
    let resting = |commanded| Steady { commanded, speed: 0, acceleration: 0 };
    filter.start(&[resting(3 * unit), moving, resting(-unit)], &windows);
    let start = filter.smoother.knot().position.y;
    // It trails by half of what the averages span.
    assert!((start + 0.02 * 0.5 * (windows.span() + 1) as f32).abs() < 1e-6, "{start}");
    for tick in 0..2_000 {
        let knot = filter.smoother.knot();
        assert_eq!((knot.position.x, knot.position.z), (3.0, -1.0));
        assert!((knot.position.y - start - 0.02 * tick as f32).abs() < 1e-5, "{} at {tick}", knot.position.y);
        assert!((knot.velocity.y - 2.0).abs() < 1e-6 && knot.acceleration.norm() == 0.0);
        filter.push(&Vector3::zeros());
    }
}

#[test]
fn a_steady_acceleration_goes_on_from_what_was_summed_up_of_it() {
    let windows = windows();
    let mut summed = filter(&windows);
    let acceleration = Vector3::new(1_000_004, -12_345_676, 4);
    for _ in 0..2 * windows.span() {
        summed.push(&acceleration);
    }
    let mut started = filter(&windows);
    let steady = summed.smoother.steady(&windows);
    started.start(&steady, &windows);
    assert_eq!(started.averages.commanded(), summed.averages.commanded());
    for _ in 0..super::super::limits::HISTORY_TICKS {
        assert_eq!(started.smoother.knot(), summed.smoother.knot());
        assert_eq!(started.smoother.axes.map(|axis| axis.difference), summed.smoother.axes.map(|axis| axis.difference));
        summed.push(&acceleration);
        started.push(&acceleration);
    }
}

#[test]
fn a_million_ticks_of_noise_leave_no_trace() {
    let windows = windows();
    let mut filter = filter(&windows);
    let mut random = Random::new(6);
    for _ in 0..1_000_000 {
        let speed = filter.averages.speed().x as f32 / 1e9;
        filter.push(&Vector3::new(((random.signed() - speed) * 4e6) as i32, 0, 0));
    }
    let steps = 100;
    let (whole, rest) = (filter.averages.speed().x / steps, filter.averages.speed().x % steps);
    for step in 0..steps {
        filter.push(&Vector3::new(-(whole + i64::from(step == 0) * rest) as i32, 0, 0));
    }
    for _ in 0..super::super::limits::HISTORY_TICKS {
        filter.push(&Vector3::zeros());
    }
    assert!(filter.at_rest());
}
