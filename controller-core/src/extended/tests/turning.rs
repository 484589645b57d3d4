//! The limiter of the frame's turning, driven for long.

use super::Random;
use crate::attitude_reference::DesiredAttitude;
use crate::extended::budget::{RATE_BEYOND, THRUST_LEFT};
use crate::extended::defaults::NOTHING_GIVEN;
use crate::extended::parameters::ExtendedParameters;
use crate::extended::position::{Filters, PositionLaw};
use crate::extended::tests::example::{Craft, greatest_accelerations};
use crate::extended::turning::{Circumstances, TURNED, TurningLimit};
use crate::heading::Heading;
use nalgebra::{Vector2, Vector3};

/// What a drive came to at worst.
#[derive(Debug, Default)]
struct Worst {
    /// The turning rate for each Omega.
    rate: f32,
    /// |W| |p| for each third of alpha.
    carried: f32,
    /// How far below the cosine of its cone rho_z came.
    beyond_cone: f32,
    /// |u| for each U.
    thrust: f32,
    /// Ticks in which something was changed.
    changed: u32,
}

/// The filters driven by a ubar that jumps about its envelope, while the budget jumps down to the reserve and the
/// heading turns.
fn driven(craft: &Craft, p: &ExtendedParameters, random: &mut Random) -> Worst {
    let (gravity, h) = (craft.vehicle.gravity, craft.period);
    let position = PositionLaw::new(p, gravity, h).unwrap();
    let limit = TurningLimit::new(p, h);
    let [greatest, _] = greatest_accelerations(craft, p);
    let (held, smoothing) = ((1.0 - (-p.k_s * h).exp()) / h, 1.0 - (-p.k_d * h).exp());
    let mut filter = Filters::at(Vector3::zeros());
    let (mut ubar, mut budget, mut heading) = (Vector3::zeros(), 0.0, 0.0);
    let (mut fastest, mut before) = (f32::MAX, f32::MAX);
    let mut worst = Worst::default();
    for tick in 0..5_000 {
        if random.below(40) == 0 {
            let (sin, cos) = random.between(0.0, core::f32::consts::TAU).sin_cos();
            let lift = gravity + random.between(-p.a_down, greatest - gravity);
            let left = (greatest * greatest - lift * lift).max(0.0).sqrt();
            let reach = p.a_across.min(0.95 * left).min(0.95 * lift * p.tilt_max.tan());
            ubar = Vector3::new(reach * cos, reach * sin, lift - gravity);
        }
        if random.below(30) == 0 {
            budget = p.turn_acceleration * random.signed();
            heading = p.yaw_rate * random.signed();
        }
        let Filters { command: c, intermediate: x, smoothed: y } = filter;
        let smoothed = y + (ubar - y) * smoothing;
        let drive = (smoothed - x) * held;
        let yaw_rate = f32::clamp(heading, -fastest, fastest);
        let rate = (x - c) * p.k_f;
        let wanted = (drive - rate) * p.k_f;
        let command = Vector3::new(c.x, c.y, c.z + gravity);
        let desired = DesiredAttitude::new(&command, &Heading::FORWARD);
        let turn = desired.turn(&rate, &wanted);
        let up = desired.up();
        let vertical = [c.z, rate.z, wanted.z];
        let limited = limit.limited(&turn, &Circumstances { budget, yaw_rate, up, greatest, vertical });

        let whole = limited.acceleration + Vector2::new(turn.rate.y, -turn.rate.x) * yaw_rate;
        assert!(whole.norm() <= budget.max(p.turn_reserve) * (1.0 + 1e-5), "{craft:?} {tick}");
        // W keeps to its part of the last tick's alpha, but for what that tick added to |p|.
        let carried = yaw_rate.abs() * turn.rate.norm() / before - h * yaw_rate.abs();
        worst.carried = worst.carried.max(carried / (1.0 - TURNED));
        (fastest, before) = (limited.yaw_rate, budget.max(p.turn_reserve));
        worst.rate = worst.rate.max(turn.rate.norm() / p.turn_rate);
        worst.beyond_cone = worst.beyond_cone.max(p.tilt_max.cos() - up.z);
        worst.thrust = worst.thrust.max(command.norm() / greatest);
        worst.changed += u32::from(limited.change.is_some());

        // What was added to u'' is what the drive makes of it, and the turn is the limited one.
        let change = limited.change.map_or(Vector3::zeros(), |change| desired.turned(&change));
        let made = desired.turn(&rate, &(wanted + change)).acceleration;
        // Where the cone is not held, |u| may be beyond what single precision resolves.
        let resolved = command.norm() < 2.0 * greatest;
        let rounding = 1e-4 * (1.0 + turn.acceleration.norm());
        assert!(!resolved || (made - limited.acceleration).norm() <= rounding, "{craft:?} {tick}: {made} {limited:?}");
        filter = position.advance(&filter, &smoothed, &(drive + change / p.k_f));
        assert!(filter.command.z >= -p.a_down);
    }
    worst
}

#[test]
fn the_frame_turns_within_its_budget_and_rate_and_never_falls_too_fast() {
    let mut random = Random(51);
    for number in 0..60 {
        let craft = if number == 0 { Craft::example() } else { Craft::random(&mut random) };
        let worst = driven(&craft, &craft.constants(&NOTHING_GIVEN), &mut random);
        assert!(worst.changed > 1_000, "{worst:?}");
        // A tick's q is that of its start, and alpha is cut after Omega.
        assert!(worst.rate < RATE_BEYOND as f32, "{craft:?}: {worst:?}");
        // A tick's end is not its start: measured, half a percent in ticks of 10 ms.
        assert!(worst.carried < 1.0 + craft.period, "{craft:?}: {worst:?}");
        // Even where rho leaves its cone: what a tick adds to |u| is well within what is left of the thrust.
        assert!(worst.thrust * (1.0 - THRUST_LEFT as f32) < 1.0, "{craft:?}: {worst:?}");
    }
}

/// With less, a rate along the cone's edge, or a heading that turns meanwhile, takes more than alpha_0.
#[test]
fn the_thrust_direction_stays_in_its_cone_and_below_u_where_the_reserve_bends_the_greatest_rate() {
    let mut random = Random(52);
    for _ in 0..60 {
        let craft = Craft::random(&mut random);
        let p = craft.constants(&NOTHING_GIVEN);
        // What is decided at a tick holds for all of it: half a period allows for that.
        // Omega (Omega + W_max) <= alpha_0.
        let bent = 0.5 * ((p.yaw_rate * p.yaw_rate + 4.0 * p.turn_reserve).sqrt() - p.yaw_rate);
        let p = ExtendedParameters { turn_rate: p.turn_rate.min(bent), ..p };
        let worst = driven(&craft, &p, &mut random);
        assert!(
            worst.beyond_cone < 0.5 * craft.period && worst.thrust < 1.001,
            "{craft:?}: {worst:?} Om {} a0 {}",
            p.turn_rate,
            p.turn_reserve
        );
    }
}

#[test]
fn a_sudden_turn_gets_its_part_of_alpha_and_the_heading_the_rest() {
    let limit = TurningLimit::new(
        &ExtendedParameters { turn_reserve: 3.0, ..Craft::example().constants(&NOTHING_GIVEN) },
        0.01,
    );
    let upright = DesiredAttitude::new(&Vector3::new(0.0, 0.0, 9.81), &Heading::FORWARD);
    let turn = upright.turn(&Vector3::new(4.0, 0.0, 0.0), &Vector3::new(0.0, 2_000.0, 0.0));
    for (budget, alpha) in [(12.0, 12.0), (-1.0, 3.0)] {
        let circumstances =
            Circumstances { budget, yaw_rate: 0.0, up: upright.up(), greatest: 40.0, vertical: [0.0; 3] };
        let limited = limit.limited(&turn, &circumstances);
        assert!((limited.acceleration.norm() / (TURNED * alpha) - 1.0).abs() < 1e-5, "{limited:?}");
        assert!((limited.yaw_rate * turn.rate.norm() / ((1.0 - TURNED) * alpha) - 1.0).abs() < 1e-5, "{limited:?}");
    }
}
