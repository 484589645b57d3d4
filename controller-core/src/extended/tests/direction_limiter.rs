//! How the thrust direction turns, driven for long.

use super::Random;
use crate::attitude_reference::DesiredAttitude;
use crate::extended::budget::TORQUE_THRUST_SHARE;
use crate::extended::defaults::NOTHING_GIVEN;
use crate::extended::direction_limiter::{DirectionLimiter, PUSH_ACROSS_MAX_M_PER_S2};
use crate::extended::parameters::ExtendedParameters;
use crate::extended::position::{Filters, PositionLaw};
use crate::extended::tests::example::{Craft, greatest_accelerations};
use crate::heading::Heading;
use nalgebra::{Vector2, Vector3};

/// What a drive came to at worst.
#[derive(Debug, Default)]
struct Worst {
    /// The turning rate for each Omega.
    rate: f32,
    /// How far below the cosine of its cone rho_z came.
    beyond_cone: f32,
    /// |u| for each U.
    thrust: f32,
    /// Ticks in which something was changed.
    changed: u32,
}

/// The filters driven by a ubar that jumps about its envelope, while a tick has torque for anything between the reserve
/// and `alpha`, rad/s^2.
fn driven(craft: &Craft, p: &ExtendedParameters, alpha: f32, random: &mut Random) -> Worst {
    let (gravity, h) = (craft.vehicle.gravity, craft.period);
    let position = PositionLaw::new(p, gravity, h).unwrap();
    let limit = DirectionLimiter::new(p, alpha, h);
    let [max, _] = greatest_accelerations(craft, p);
    let (held, smoothing) = ((1.0 - (-p.k_s * h).exp()) / h, 1.0 - (-p.k_d * h).exp());
    let mut filter = Filters::at(Vector3::zeros());
    let (mut ubar, mut torque) = (Vector3::zeros(), 0.0);
    let mut worst = Worst::default();
    for tick in 0..5_000 {
        if random.below(40) == 0 {
            let (sin, cos) = random.between(0.0, core::f32::consts::TAU).sin_cos();
            let lift = gravity + random.between(-p.a_down, max - gravity);
            let left = (max * max - lift * lift).max(0.0).sqrt();
            let reach = p.a_across.min(0.95 * left).min(0.95 * lift * p.tilt_max.tan());
            ubar = Vector3::new(reach * cos, reach * sin, lift - gravity);
        }
        if random.below(30) == 0 {
            torque = alpha * random.signed();
        }
        let Filters { command: c, intermediate: x, smoothed: y } = filter;
        let smoothed = y + (ubar - y) * smoothing;
        let drive = (smoothed - x) * held;
        let rate = (x - c) * p.k_f;
        let wanted = (drive - rate) * p.k_f;
        let command = Vector3::new(c.x, c.y, c.z + gravity);
        let desired = DesiredAttitude::new(&command, &Heading::FORWARD);
        let (turn, up) = (desired.direction_motion(&rate, &wanted), desired.up());
        let q = limit.limited(&turn, &up);
        assert!(q.norm() <= alpha * (1.0 + 1e-5), "{craft:?} {tick}");
        // The tick's budget: never less than the reserve.
        let share = (torque.max(p.turn_reserve) / q.norm()).min(1.0);
        let q: Vector2<f32> = if share < 1.0 { q * share } else { q };
        let change = limit.change(&turn, &q, &up, max, [c.z, rate.z, wanted.z]);
        worst.rate = worst.rate.max(turn.rate.norm() / p.turn_rate);
        worst.beyond_cone = worst.beyond_cone.max(p.tilt_max.cos() - up.z);
        worst.thrust = worst.thrust.max(command.norm() / max);
        worst.changed += u32::from(change.is_some());

        // What was added to u'' is what the drive makes of it, and the turn is the shortened one.
        let change = change.map_or(Vector3::zeros(), |change| desired.turned(&change));
        let made = desired.direction_motion(&rate, &(wanted + change)).acceleration;
        // Where the cone is not held, |u| may be beyond what single precision resolves.
        let resolved = command.norm() < 2.0 * max;
        let rounding = 1e-4 * (1.0 + turn.acceleration.norm());
        assert!(!resolved || (made - q).norm() <= rounding, "{craft:?} {tick}: {made} {q}");
        filter = position.advance(&filter, &smoothed, &(drive + change / p.k_f), f32::MAX);
        assert!(filter.command.z >= -p.a_down);
    }
    worst
}

#[test]
fn the_thrust_direction_turns_within_its_acceleration_and_rate_and_never_falls_too_fast() {
    let mut random = Random(51);
    for number in 0..60 {
        let craft = if number == 0 { Craft::example() } else { Craft::random(&mut random) };
        let p = craft.constants(&NOTHING_GIVEN);
        let worst = driven(&craft, &p, 8.0 * p.turn_reserve, &mut random);
        assert!(worst.changed > 500, "{worst:?}");
        // What is decided at a tick holds for all of it: u and p turn meanwhile.
        assert!(worst.rate < 1.15, "{craft:?}: {worst:?}");
        // Even where rho leaves its cone: what a tick adds to |u| is well within what is left of the thrust.
        assert!(worst.thrust * (1.0 - TORQUE_THRUST_SHARE as f32) < 1.0, "{craft:?}: {worst:?}");
    }
}

/// With less, a rate along the cone's edge takes more than alpha_0.
#[test]
fn the_thrust_direction_stays_in_its_cone_and_below_u_where_the_reserve_bends_the_greatest_rate() {
    let mut random = Random(52);
    for _ in 0..60 {
        let craft = Craft::random(&mut random);
        let p = craft.constants(&NOTHING_GIVEN);
        // Omega^2 <= alpha_0.
        let p = ExtendedParameters { turn_rate: p.turn_rate.min(p.turn_reserve.sqrt()), ..p };
        let worst = driven(&craft, &p, p.turn_reserve, &mut random);
        // What is decided at a tick holds for all of it: half a period allows for that.
        assert!(worst.beyond_cone < 0.5 * craft.period && worst.thrust < 1.001, "{craft:?}: {worst:?}");
    }
}

#[test]
fn a_wanted_turn_is_kept_in_its_direction_and_cut_to_alpha_and_to_its_rate() {
    let p = ExtendedParameters { turn_rate: 2.0, ..Craft::example().constants(&NOTHING_GIVEN) };
    let upright = DesiredAttitude::new(&Vector3::new(0.0, 0.0, 9.81), &Heading::FORWARD);
    let turned = |alpha: f32, rate: Vector3<f32>, wanted: Vector3<f32>| {
        DirectionLimiter::new(&p, alpha, 0.01).limited(&upright.direction_motion(&rate, &wanted), &upright.up())
    };
    let still = Vector3::zeros();
    let found = turned(12.0, still, Vector3::new(0.0, 2_000.0, 0.0));
    assert!((found - Vector2::new(0.0, 12.0)).norm() < 1e-4, "{found}");
    let wanted = Vector3::new(20.0, -30.0, 7.0);
    assert!((turned(12.0, still, wanted) - wanted.xy() / 9.81).norm() < 1e-5);
    // At Omega nothing further along it.
    let fast = Vector3::new(2.0 * 9.81, 0.0, 0.0);
    let found = turned(12.0, fast, Vector3::new(900.0, 0.0, 0.0));
    assert!(found.norm() < 1e-3, "{found}");
}

#[test]
fn thrust_takes_at_once_what_the_vertical_wants_but_for_what_would_push_across() {
    let craft = Craft::example();
    let limit = DirectionLimiter::new(&craft.constants(&NOTHING_GIVEN), 100.0, craft.period);
    let (n, max) = (12.0, 60.0);
    for angle in [0.0_f32, 0.2, 0.6, 1.0] {
        let up = Vector3::new(angle.sin(), 0.0, angle.cos());
        for more in [-30.0_f32, -2.0, 0.5, 3.0, 30.0] {
            let change = limit.length(n, more, &up, max) - n;
            let across = change * angle.sin();
            assert!(across.abs() <= PUSH_ACROSS_MAX_M_PER_S2 * 1.0001 && change >= -n && change <= max - n);
            let is_whole = more.abs() * angle.tan() < PUSH_ACROSS_MAX_M_PER_S2 && more / angle.cos() > -n;
            assert!(!is_whole || (change * angle.cos() - more).abs() < 1e-4, "{angle} {more}: {change}");
        }
    }
    assert!(limit.length(n, 1e3, &Vector3::z(), max) <= max);
}
