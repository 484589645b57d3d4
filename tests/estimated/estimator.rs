//! The estimator on a BMI088's samples at 1 kHz and a camera system's poses, with noise, biases and their walk: how
//! well it knows the state, whether it knows how well, and how long it does without poses.
//! `cargo test -p host-sim estimator -- --nocapture` prints the figures that stand in `docs/measured.md`.

mod run;
mod sensors;
mod truth;

use crate::support::random;
use estimation::estimator::{EstimatorParameters, Rejected};
use nalgebra::{UnitQuaternion, Vector3};
use rayon::prelude::*;
use run::{Meddle, Shown};
use truth::{Moment, Truth};

const FLIGHTS_OF_EACH_KIND: u64 = 100;

/// Of chi-square with 15 degrees of freedom, the mean of 100: 95 % lie between these (the quantiles of 1500 degrees,
/// over 100).
const NEES_BAND: (f64, f64) = (13.946, 16.092);

/// Root of the mean square.
fn rms(squares: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = squares.fold((0.0, 0.0), |(sum, count), square| (sum + square, count + 1.0));
    f64::sqrt(sum / count)
}

/// All flights of one kind.
struct Campaign {
    shown: Vec<Shown>,
}

impl Campaign {
    fn fly(truth: &Truth, parameters: &EstimatorParameters) -> Self {
        Self::lied_to(truth, parameters, &|_, moment| moment)
    }

    fn lied_to(truth: &Truth, parameters: &EstimatorParameters, meddle: Meddle) -> Self {
        let fly = |seed| run::fly(truth, parameters, meddle, &mut random::generator(seed));
        Self { shown: (0..FLIGHTS_OF_EACH_KIND).into_par_iter().map(fly).collect() }
    }

    /// RMS of the position on all three axes, m, and of the attitude, degrees.
    fn errors(&self) -> (f64, f64) {
        let ticks = || self.shown.iter().flat_map(|shown| &shown.ticks);
        (rms(ticks().map(|tick| tick.position)), rms(ticks().map(|tick| tick.attitude)).to_degrees())
    }

    /// The greatest error of position and of attitude at any tick, m and degrees.
    fn worst(&self) -> (f64, f64) {
        let ticks = || self.shown.iter().flat_map(|shown| &shown.ticks);
        let greatest = |squares: f64, square: f64| squares.max(square);
        let (p, q) = (ticks().map(|tick| tick.position), ticks().map(|tick| tick.attitude));
        (p.fold(0.0, greatest).sqrt(), q.fold(0.0, greatest).sqrt().to_degrees())
    }

    /// The mean over all flights at each instant.
    fn nees(&self) -> Vec<f64> {
        let instants = self.shown[0].nees.len();
        (0..instants)
            .map(|n| self.shown.iter().map(|shown| shown.nees[n]).sum::<f64>() / FLIGHTS_OF_EACH_KIND as f64)
            .collect()
    }

    /// RMS and worst drift after 0.5 s and after 2 s without poses, m.
    fn drift(&self) -> [(f64, f64); 2] {
        [0, 1].map(|n| {
            let all = || self.shown.iter().map(|shown| shown.drift[n]);
            (rms(all().map(|drift| drift * drift)), all().fold(0.0, f64::max))
        })
    }

    /// Poses refused, of all.
    fn refused(&self) -> (u32, u32) {
        self.shown.iter().fold((0, 0), |sum, shown| (sum.0 + shown.counts.1, sum.1 + shown.counts.0 + shown.counts.1))
    }
}

/// What the sensors are, exactly: the noise that is synthesised, and stamps that are right.
const EXACT_PARAMETERS: EstimatorParameters = EstimatorParameters { time_noise: 0.0, ..EstimatorParameters::BMI088 };

#[test]
fn position_and_attitude_are_known_in_hover_circle_and_recovery_and_coasting_lasts() {
    println!(
        "{FLIGHTS_OF_EACH_KIND} flights each: BMI088 noise, bias and walk; poses 100 Hz, 1 mm, 0.3 degrees, 20 ms late"
    );
    println!(
        "{:<10} {:>14} {:>18} {:>16} {:>16} {:>12} {:>9}",
        "flight", "position RMS", "attitude RMS", "0.5 s no poses", "2 s no poses", "mean NEES", "in band"
    );
    for truth in [Truth::hover(), Truth::circle(), Truth::recovery()] {
        let campaign = Campaign::fly(&truth, &EXACT_PARAMETERS);
        let ((position, attitude), worst) = (campaign.errors(), campaign.worst());
        let [(short, short_worst), (long, long_worst)] = campaign.drift();
        let nees = campaign.nees();
        let mean = nees.iter().sum::<f64>() / nees.len() as f64;
        let within = nees.iter().filter(|nees| (NEES_BAND.0..=NEES_BAND.1).contains(nees)).count();
        let (refused, poses) = campaign.refused();
        println!(
            "{:<10} {:>11.3} mm {:>14.4} deg {:>13.4} m {:>14.3} m {:>12.2} {:>4}/{:<4}",
            truth.name,
            position * 1e3,
            attitude,
            short,
            long,
            mean,
            within,
            nees.len()
        );
        println!(
            "{:<10} {:>11.3} mm {:>14.4} deg {:>13.4} m {:>14.3} m   worst; {refused} of {poses} poses refused",
            "",
            worst.0 * 1e3,
            worst.1,
            short_worst,
            long_worst
        );
        assert!(position < 2e-3 && attitude < 0.3, "{}: {position} m, {attitude} degrees", truth.name);
        assert!(short_worst < 0.1 && long_worst < 1.0, "{}: {short_worst} m, {long_worst} m", truth.name);
        assert!((NEES_BAND.0..=NEES_BAND.1).contains(&mean), "{}: NEES {mean}", truth.name);
        // 95 % of the means are within; means of neighbouring instants are alike, so that fewer may be, or all.
        assert!(within as f64 >= 0.85 * nees.len() as f64, "{}: {within} of {}", truth.name, nees.len());
        assert!(f64::from(refused) < 1e-4 * f64::from(poses), "{}: {refused} of {poses}", truth.name);
    }
}

#[test]
fn sensors_a_quarter_noisier_than_they_are_said_to_be_leave_the_band() {
    let said = EstimatorParameters {
        position_noise: 0.8 * EXACT_PARAMETERS.position_noise,
        attitude_noise: 0.8 * EXACT_PARAMETERS.attitude_noise,
        ..EXACT_PARAMETERS
    };
    let campaign = Campaign::fly(&Truth::hover(), &said);
    let nees = campaign.nees();
    let mean = nees.iter().sum::<f64>() / nees.len() as f64;
    println!("mean NEES {mean:.2}");
    assert!(mean > NEES_BAND.1, "{mean}");
}

#[test]
fn a_vehicle_that_shakes_is_known_as_well() {
    let campaign = Campaign::fly(&Truth::circle().shaken(), &EstimatorParameters::BMI088);
    let ((position, attitude), [(short, _), (long, _)]) = (campaign.errors(), campaign.drift());
    let (refused, poses) = campaign.refused();
    println!("shaken: {:.3} mm, {attitude:.4} deg; {short:.4} m, {long:.3} m; {refused} of {poses}", position * 1e3);
    assert!(position < 2e-3 && attitude < 0.3, "{position} m, {attitude} degrees");
    assert!(short < 0.1 && long < 1.0, "{short} m, {long} m");
}

#[test]
fn poses_that_lie_for_their_last_half_second_move_the_estimate_by_millimetres() {
    let truth = Truth::circle();
    // The lie begins half a second before the poses end, and errors count until then.
    let began = truth.milliseconds() - 2_000 - 520;
    let frozen = truth.moments[began];
    type Lie = Box<dyn Fn(usize, Moment) -> Moment + Sync>;
    let displaced = |by: f64| -> Lie {
        Box::new(move |_, moment| Moment { position: moment.position + Vector3::x() * by, ..moment })
    };
    let turned = |axis: Vector3<f64>| -> Lie {
        let turn = UnitQuaternion::from_scaled_axis(axis * std::f64::consts::PI);
        Box::new(move |_, moment| Moment { attitude: turn * moment.attitude, ..moment })
    };
    let drifting: Lie = Box::new(move |n, moment| {
        let seconds = (n - began) as f64 * 1e-3;
        Moment { position: moment.position + Vector3::new(0.3, 0.4, 0.0) * seconds, ..moment }
    });
    for (what, lie, most) in [
        ("0.3 m off", displaced(0.3), 0.01),
        ("5 m off", displaced(5.0), 0.01),
        ("100 m off", displaced(100.0), 0.01),
        ("half a turn about the vertical", turned(Vector3::z()), 0.01),
        ("half a turn about x", turned(Vector3::x()), 0.01),
        ("drifting at 0.5 m/s", drifting, 0.01),
        ("where it was", Box::new(move |_, _| frozen), 0.01),
    ] {
        let meddle = |n: usize, moment: Moment| if n < began { moment } else { lie(n, moment) };
        let campaign = Campaign::lied_to(&truth, &EstimatorParameters::BMI088, &meddle);
        let (worst, _) = campaign.worst();
        println!("{what:<32} worst {:.2} mm", worst * 1e3);
        assert!(worst < most, "{what}: {worst} m");
        for shown in &campaign.shown {
            assert!(matches!(shown.last, Some(Err(why)) if why != Rejected::Repeated), "{what}: {:?}", shown.last);
        }
    }
}
