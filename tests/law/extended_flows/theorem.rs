//! The theorem of section 13 as far as it can be flown: constant force and thrust scale, actuators that deliver at
//! once, from far away, fast and tumbling. A reference that says it moves and stays where it is takes every flight's
//! progress first, so that the law is slowed. Then it rests.

use crate::support::body::Body;
use crate::support::extended::{law, vehicle, with_constants, with_ideal_actuators};
use crate::support::random::{self, ChaCha8Rng};
use controller_core::law::Law as Flown;
use controller_core::reference::Reference;
use controller_core::state::Wrench;
use nalgebra::Vector3;
use rand::RngExt;

const PERIOD_S: f32 = 0.01;

/// When the reference rests, and the flight's end, s.
const REFERENCE_RESTS_AT: u32 = 150;
const FLIGHT_ENDS_AT: u32 = 560;

/// When the vehicle is thrown far away: the slowed law flies then.
const THROWN_AT: u32 = 145;

/// What a flight showed: how often the law was slowed, and how much of Omega and of alpha_0 the slowed law needed.
struct Shown {
    times: u32,
    needed: [f64; 2],
}

fn fly(name: &str, rng: &mut ChaCha8Rng) -> Shown {
    let configuration = with_ideal_actuators(&vehicle(name).configuration);
    let configuration = with_constants(&configuration, |p| p.drag_across = 0.0);
    let (p, vehicle) = (law(&configuration).parameters, configuration.vehicle());
    let Flown::Extended(mut controller) = Flown::uncertified(&configuration, PERIOD_S).unwrap() else {
        panic!("another law")
    };
    let scale = rng.random_range(p.scale_least..p.scale_greatest);
    let across = random::vector(rng, 0.3 * p.force_across);
    let force = Vector3::new(across.x, across.y, 0.5 * p.force_up * rng.random_range(-1.0..1.0)).cast::<f64>();
    let heading = random::heading_at_rest(rng);
    let anywhere = |rng: &mut ChaCha8Rng| {
        let mut body = Body::resting(random::vector(rng, 30.0).cast(), random::attitude(rng).cast());
        body.velocity = random::vector(rng, 5.0).cast();
        body.angular_velocity = random::vector(rng, 10.0).cast();
        body
    };
    let (mut body, mut shown, mut nearest) = (anywhere(rng), Shown { times: 0, needed: [0.0; 2] }, f64::INFINITY);
    let ticks = |seconds: u32| (seconds as f32 / PERIOD_S).round() as u32;
    for tick in 0..ticks(FLIGHT_ENDS_AT) {
        if tick == ticks(THROWN_AT) {
            assert!(controller.memory().fallback.is_slow(), "{name}: not slowed");
            body = anywhere(rng);
        }
        let velocity = if tick < ticks(REFERENCE_RESTS_AT) { Vector3::x() * 1.0 } else { Vector3::zeros() };
        let reference = Reference { velocity, ..Reference::resting(Vector3::zeros(), heading) };
        // From a second on, when the force is known.
        let slow = controller.memory().fallback.is_slow();
        let (wrench, diagnostics) = controller.step(&body.state(), &reference).unwrap();
        if slow && tick > ticks(THROWN_AT) {
            let (w, change) = (diagnostics.desired_angular_velocity, diagnostics.desired_angular_acceleration);
            let q = Vector3::new(change.y + w.x * w.z, w.y * w.z - change.x, 0.0);
            let needed = [w.xy().norm() / p.turn_rate, q.norm() / p.turn_reserve].map(f64::from);
            shown.needed = [shown.needed[0].max(needed[0]), shown.needed[1].max(needed[1])];
        }
        let e = body.position.norm().hypot(body.velocity.norm());
        nearest = f64::min(nearest, e);
        // Once its own bandwidths fly for good: near in every window.
        if tick % ticks(20) == 0 {
            assert!(tick < ticks(FLIGHT_ENDS_AT - 80) || nearest < 0.5, "{name}: {nearest} m at the nearest");
            nearest = f64::INFINITY;
        }
        let acting = Wrench { thrust: wrench.thrust * scale, torque: wrench.torque * scale }
            .scaled(1.0 / controller.thrust_scale());
        let kick = force * (0.5 * f64::from(PERIOD_S));
        body.velocity += kick;
        body.advance(vehicle, &acting, PERIOD_S.into(), 4);
        body.velocity += kick;
    }
    let fallback = &controller.memory().fallback;
    shown.times = fallback.times();
    assert!(!fallback.is_slow() && body.position.norm() < 2e-3, "{name}: {body:?} {fallback:?}");
    shown
}

#[test]
fn what_makes_no_progress_is_slowed_and_arrives_for_good_once_its_reference_rests() {
    let mut rng = random::generator(331);
    for name in ["hummingbird", "study", "published/x500", "published/iris", "published/cf2x-pybullet"] {
        let (mut times, mut needed) = (0, [0.0_f64; 2]);
        for _ in 0..3 {
            let shown = fly(name, &mut rng);
            times = times.max(shown.times);
            needed = [needed[0].max(shown.needed[0]), needed[1].max(shown.needed[1])];
        }
        println!("{name}: slowed {times} times; then {:.2} of Omega, {:.2} of alpha_0", needed[0], needed[1]);
        assert!((1..=2).contains(&times), "{name}");
    }
}
