//! V_0 = 1/2 |z_2|^2 + the integral of s(phi(mu); M) . d mu of section 1, along the vertical and across, and what a
//! force error does.
//!
//! The filters' drive is the one wanted, in continuous time; the force is constant and known. The vertical decides
//! alone; across has a constant level once the vertical rests. The slowed law of section 13 is the same with other
//! constants and a level of its own.

use crate::support::extended::{law, random_configuration, random_parameters};
use crate::support::random::{self, ChaCha8Rng};
use controller_core::certificate::Certificate;
use controller_core::extended::fallback::{Slowed, slowed};
use controller_core::extended::parameters::ExtendedParameters;
use controller_core::extended::position::{FeedbackLimits, Filters, PositionFeedback, PositionLaw};
use controller_core::heading::Heading;
use controller_core::reference::{Reference, Trajectory, hover::Hover};
use controller_core::state::State;
use nalgebra::{Quaternion, Vector3};
use rand::RngExt;

/// Gravity; and ticks so short that holding the drive makes no difference.
const GRAVITY_M_PER_S2: f32 = 9.81;
const PERIOD_S: f32 = 1e-7;

/// Position and velocity errors, c, x and y.
#[derive(Debug, Clone, Copy)]
struct Translation {
    position: Vector3<f64>,
    velocity: Vector3<f64>,
    c: Vector3<f64>,
    x: Vector3<f64>,
    y: Vector3<f64>,
}

impl Translation {
    fn after(&self, flow: &Self, time: f64) -> Self {
        Self {
            position: self.position + flow.position * time,
            velocity: self.velocity + flow.velocity * time,
            c: self.c + flow.c * time,
            x: self.x + flow.x * time,
            y: self.y + flow.y * time,
        }
    }
}

/// The closed loop of one set of constants in one constant force.
struct Loop {
    p: ExtendedParameters,
    law: PositionLaw,
    /// D, and what is believed of it.
    force: Vector3<f64>,
    believed: Vector3<f32>,
    /// U, m/s^2.
    greatest: f32,
    most: FeedbackLimits,
}

impl Loop {
    fn random(rng: &mut ChaCha8Rng) -> Self {
        let configuration = random_configuration(rng);
        let formulas = law(&configuration).parameters;
        let p = random_parameters(rng, &formulas, configuration.vehicle());
        if rng.random_bool(0.2) { Self::slowed(&p, rng) } else { Self::draw(*p, FeedbackLimits::UNLIMITED, rng) }
    }

    fn slowed(p: &ExtendedParameters, rng: &mut ChaCha8Rng) -> Self {
        let level = Slowed::<f64>::new(p, GRAVITY_M_PER_S2).level as f32;
        Self::draw(slowed(p, GRAVITY_M_PER_S2), FeedbackLimits::each(level), rng)
    }

    fn draw(p: ExtendedParameters, most: FeedbackLimits, rng: &mut ChaCha8Rng) -> Self {
        let mut believed = random::vector(rng, 0.7 * p.force_across);
        believed.z = rng.random_range(-p.force_down..=p.force_up);
        // Thrust for the force and for turning against it.
        let needed = believed.xy().norm().hypot(GRAVITY_M_PER_S2 - believed.z);
        let greatest = needed * rng.random_range(1.5..5.0);
        let law = PositionLaw::new(&p, GRAVITY_M_PER_S2, PERIOD_S).unwrap();
        Self { p, law, force: believed.cast(), believed, greatest, most }
    }

    fn start(&self, rng: &mut ChaCha8Rng) -> Translation {
        let far = random::log_uniform(rng, 0.01, 100.0);
        let fast = random::log_uniform(rng, 0.01, 30.0);
        let mut filter = || random::vector(rng, 5.0).cast() - self.force;
        let [c, x, y] = [filter(), filter(), filter()];
        Translation { position: random::vector(rng, far).cast(), velocity: random::vector(rng, fast).cast(), c, x, y }
    }

    fn core(&self, x: &Translation) -> PositionFeedback {
        let state = State {
            position: x.position.cast(),
            velocity: x.velocity.cast(),
            attitude: Quaternion::identity(),
            angular_velocity: Vector3::zeros(),
        };
        let filters = Filters { command: x.c.cast(), intermediate: x.x.cast(), smoothed: x.y.cast() };
        self.law.feedback(&state, &origin(), &filters, &self.believed, self.greatest, &self.most)
    }

    /// The core's feedback and drive with a force that is `more` than what is believed.
    fn flow(&self, x: &Translation, more: &Vector3<f64>) -> Translation {
        let feedback = self.core(x).feedback.cast::<f64>();
        // Along the vertical the thrust takes y at once.
        let pushed = Vector3::new(x.c.x, x.c.y, x.y.z);
        Translation {
            position: x.velocity,
            velocity: pushed + self.force + more,
            c: (x.x - x.c) * f64::from(self.p.k_f),
            x: (x.y - x.x) * f64::from(self.p.k_s),
            y: (feedback - x.y) * f64::from(self.p.k_d),
        }
    }

    /// The state `step` seconds later, by one step of Runge and Kutta.
    fn later(&self, x: &Translation, step: f64) -> Translation {
        let (still, half) = (Vector3::zeros(), 0.5 * step);
        let a = self.flow(x, &still);
        let b = self.flow(&x.after(&a, half), &still);
        let c = self.flow(&x.after(&b, half), &still);
        let d = self.flow(&x.after(&c, step), &still);
        x.after(&a, step / 6.0).after(&b, step / 3.0).after(&c, step / 3.0).after(&d, step / 6.0)
    }

    /// |rho'| and rho'' without its radial part, for a reference at rest.
    fn turning(&self, x: &Translation) -> [f64; 2] {
        let [k_f, k_s] = [self.p.k_f, self.p.k_s].map(f64::from);
        let u = x.c + Vector3::z() * f64::from(GRAVITY_M_PER_S2);
        let rate = (x.x - x.c) * k_f;
        let second = ((x.y - x.x) * k_s - rate) * k_f;
        let (n, rho) = (u.norm(), u.normalize());
        let across = |v: Vector3<f64>| v - rho * rho.dot(&v);
        let p = across(rate) / n;
        [p.norm(), ((across(second) - p * (2.0 * rho.dot(&rate))) / n).norm()]
    }

    /// 1/k_f, 1/k_s and 1/k_d of the axes, s: along the vertical the last alone.
    fn lags(&self) -> [Vector3<f64>; 3] {
        let across = Vector3::new(1.0, 1.0, 0.0);
        let [f, s, d] = [self.p.k_f, self.p.k_s, self.p.k_d].map(|bandwidth| 1.0 / f64::from(bandwidth));
        [across * f, across * s, Vector3::repeat(d)]
    }

    /// z_1 and z_2 in double precision.
    fn z(&self, x: &Translation) -> [Vector3<f64>; 2] {
        let [f, s, d] = self.lags();
        let [c, driven, smoothed] = [x.c, x.x, x.y].map(|filter| filter + self.force);
        let times = |a: Vector3<f64>, b: Vector3<f64>| a.component_mul(&b);
        let z_1 = x.position + times(x.velocity, f + s + d) + times(c, times(f, s + d)) + times(driven, times(s, d));
        [z_1, x.velocity + times(c, f) + times(driven, s) + times(smoothed, d)]
    }

    /// The vertical's level in either direction.
    fn level(&self, upwards: bool) -> f64 {
        let d = self.force.z;
        let level = if upwards {
            f64::from(self.greatest) - f64::from(GRAVITY_M_PER_S2) + d
        } else {
            f64::from(self.p.a_down) - d
        };
        level.max(0.3).min(self.most())
    }

    fn most(&self) -> f64 {
        self.most.across.into()
    }

    /// The level across while the vertical rests.
    fn level_across(&self) -> f64 {
        let (lift, greatest) = (f64::from(GRAVITY_M_PER_S2) - self.force.z, f64::from(self.greatest));
        let tangent = f64::from(self.p.tilt_max).tan();
        let left = (greatest * greatest - lift * lift).sqrt();
        let reach = f64::from(self.p.a_across).min(0.95 * lift * tangent).min(0.95 * left);
        (reach - self.force.xy().norm()).max(0.3).min(self.most())
    }

    /// V_0 of the vertical: above the reference it descends.
    fn vertical(&self, x: &Translation) -> f64 {
        let [z_1, z_2] = self.z(x).map(|z| z.z);
        let (k_p, k_v) = (f64::from(self.p.k_p_vertical), f64::from(self.p.k_v_vertical));
        let speed = f64::from(if z_1 > 0.0 { self.p.v_down } else { self.p.v_up });
        let braking = f64::from(self.p.braking_vertical) * self.level(z_1 > 0.0);
        let approach = Approach { k_v, answering: k_v / k_p, braking, speed };
        0.5 * z_2 * z_2 + approach.potential(z_1.abs(), self.level(z_1 < 0.0))
    }

    /// V_0 across.
    fn across(&self, x: &Translation) -> f64 {
        let [z_1, z_2] = self.z(x).map(|z| z.xy().norm());
        let (k_p, k_v) = (f64::from(self.p.k_p_across), f64::from(self.p.k_v_across));
        let (level, speed) = (self.level_across(), f64::from(self.p.v_across));
        let braking = f64::from(self.p.braking_across) * level;
        let approach = Approach { k_v, answering: k_v / k_p, braking, speed };
        0.5 * z_2 * z_2 + approach.potential(z_1, level)
    }

    /// `x` with the vertical at rest.
    fn resting(&self, x: &Translation) -> Translation {
        let mut still = *x;
        (still.position.z, still.velocity.z) = (0.0, 0.0);
        (still.c.z, still.x.z, still.y.z) = (-self.force.z, -self.force.z, -self.force.z);
        still
    }
}

fn origin() -> Reference {
    Hover::new(Vector3::zeros(), Heading::FORWARD).unwrap().at(0)
}

/// phi along a half-line.
struct Approach {
    k_v: f64,
    /// t, s, a, m/s^2, and v_c, m/s.
    answering: f64,
    braking: f64,
    speed: f64,
}

impl Approach {
    /// s(phi(mu); M).
    fn pull(&self, mu: f64, level: f64) -> f64 {
        let s = |x: f64, level: f64| level * x / level.hypot(x);
        let Self { k_v, answering: t, braking: a, speed } = *self;
        s(k_v * s(a * ((t * t + 2.0 * mu / a).sqrt() - t), speed), level)
    }

    /// Its integral from zero: substituted so that neither end is steep, by Simpson's rule.
    fn potential(&self, to: f64, level: f64) -> f64 {
        // mu = scale sinh x, with the lesser of the distances over which v and s bend.
        let bend = 0.5 * self.braking * self.answering * self.answering;
        let scale = bend.min(level.min(self.k_v * self.speed) * self.answering / self.k_v);
        let end = (to / scale).asinh();
        let steps = 400;
        let width = end / f64::from(steps);
        let f = |x: f64| self.pull(scale * x.sinh(), level) * scale * x.cosh();
        (0..steps)
            .map(|i| {
                let left = width * f64::from(i);
                (f(left) + 4.0 * f(left + 0.5 * width) + f(left + width)) * width / 6.0
            })
            .sum()
    }
}

#[test]
fn v_0_never_rises_along_flows() {
    let mut rng = random::generator(311);
    let mut falls = [0; 2];
    for number in 0..5_000 {
        let flying = Loop::random(&mut rng);
        let x = flying.start(&mut rng);
        let level = flying.level(true).max(flying.level(false)).max(flying.level_across());
        let p = &flying.p;
        let gain = f64::from(p.k_p_across.max(p.k_p_vertical));
        let rate = f64::from(p.k_v_across.max(p.k_v_vertical));
        for (vertical, falls) in [true, false].into_iter().zip(&mut falls) {
            let x = if vertical { x } else { flying.resting(&x) };
            let v_0 = |x: &Translation| if vertical { flying.vertical(x) } else { flying.across(x) };
            let along = flying.flow(&x, &Vector3::zeros());
            let step = 1e-5;
            let v_dot = (v_0(&x.after(&along, step)) - v_0(&x.after(&along, -step))) / (2.0 * step);
            let [_, z_2] = flying.z(&x);
            // Differences, and the core's rounding of z: where the feedback is steep, k_p of a rounding of 100 m.
            let [f, s, d] = flying.lags();
            let filtered = x.c.norm() * f.x + x.x.norm() * s.x + x.y.norm() * d.x;
            let steep = 6e-8 * (gain * (x.position.norm() + x.velocity.norm()) + rate * filtered);
            let forced = level + flying.force.norm() + f64::from(GRAVITY_M_PER_S2);
            let allowed = z_2.norm() * (2e-6 * forced + 4.0 * steep) + 1e-15 * v_0(&x) / step;
            assert!(
                v_dot <= allowed,
                "case {number}, {vertical}: V_0' = {v_dot:e} beyond {allowed:e} at {x:?} with {p:?}"
            );
            *falls += u32::from(v_dot < -100.0 * allowed);
        }
    }
    println!("V_0 falls beyond doubt in {falls:?} of 5000");
    assert!(falls.iter().all(|falls| *falls > 3_000), "{falls:?}");
}

#[test]
fn v_0_never_rises_on_flights_under_a_constant_force_and_they_arrive() {
    let mut rng = random::generator(312);
    let mut flown = 0;
    while flown < 20 {
        let configuration = random_configuration(&mut rng);
        let flying = Loop::draw(*law(&configuration).parameters, FeedbackLimits::UNLIMITED, &mut rng);
        // With little more than the force takes, swinging in takes minutes.
        if flying.level_across() < 2.0 {
            continue;
        }
        flown += 1;
        let mut x = flying.start(&mut rng);
        let (mut vertical, mut across, step) = (f64::INFINITY, f64::INFINITY, 1e-3);
        for tick in 0..60_000 {
            x = flying.later(&x, step);
            if tick % 20 == 0 {
                let after = flying.vertical(&x);
                assert!(after <= vertical * (1.0 + 1e-6) + 1e-8, "V_0 rises from {vertical} to {after} at {tick}");
                vertical = after;
                // The level across is constant once the vertical rests.
                if vertical < 1e-8 {
                    let after = flying.across(&x);
                    assert!(after <= across * (1.0 + 1e-4) + 1e-8, "V_0 rises from {across} to {after} at {tick}");
                    across = after;
                }
            }
        }
        assert!(across.is_finite() && x.position.norm() < 1e-3, "{x:?}");
    }
}

/// A slowed loop of a certified vehicle in a force that leaves room for M_s, and the vehicle's own constants.
fn certified_and_slowed(rng: &mut ChaCha8Rng) -> (Loop, ExtendedParameters) {
    loop {
        let configuration = random_configuration(rng);
        let own = law(&configuration).parameters;
        let flying = Loop::slowed(&own, rng);
        let levels = [flying.level_across(), flying.level(true), flying.level(false)];
        if Certificate::new(&configuration).unwrap().holds() && levels.iter().all(|level| *level >= 1.0) {
            return (flying, *own);
        }
    }
}

/// At rest in the filters, anywhere else.
fn slowed_from(flying: &Loop, rng: &mut ChaCha8Rng) -> Translation {
    let rest = -flying.force;
    Translation { c: rest, x: rest, y: rest, ..flying.start(rng) }
}

#[test]
fn the_slowed_law_arrives_from_everywhere() {
    let mut rng = random::generator(314);
    for number in 0..20 {
        let (flying, _) = certified_and_slowed(&mut rng);
        let mut x = slowed_from(&flying, &mut rng);
        for _ in 0..100_000 {
            x = flying.later(&x, 5e-3);
        }
        assert!(x.position.norm() < 1e-3 && x.velocity.norm() < 1e-3, "{number}: {x:?} with {:?}", flying.p);
    }
}

/// A fifth of Omega and of alpha_0, along the vertical and across at once, however feedback is thrown about. The
/// bound does not count on the third filter, which leaves a tenth of that.
#[test]
fn the_slowed_law_never_turns_faster_than_its_share_of_the_reserve() {
    let mut rng = random::generator(315);
    let mut most = [0.0_f64; 2];
    for number in 0..200 {
        let (mut flying, own) = certified_and_slowed(&mut rng);
        // The least |u|: upwards, the greatest force.
        flying.believed = Vector3::z() * own.force_up;
        flying.force = flying.believed.cast();
        let mut x = slowed_from(&flying, &mut rng);
        // So long that the filters follow.
        let swing = 10.0_f64.powf(rng.random_range(-0.7..0.7)) / f64::from(flying.p.k_f.max(flying.p.k_s));
        let way = random::direction(&mut rng).cast::<f64>() * 100.0;
        for tick in 0..2_000 {
            let [rate, second] = flying.turning(&x);
            let shares = [rate / f64::from(own.turn_rate), second / f64::from(own.turn_reserve)];
            assert!(shares.iter().all(|share| *share <= 0.2 * 2.0_f64.sqrt()), "{number}: {shares:?} at {x:?}");
            most = [most[0].max(shares[0]), most[1].max(shares[1])];
            x = flying.later(&x, swing / 50.0);
            x.velocity = if (tick / 100) % 2 == 0 { way } else { -way };
            x.position = Vector3::zeros();
        }
    }
    println!("at most {:.3} of Omega, {:.3} of alpha_0", most[0], most[1]);
    assert!(most.iter().all(|share| *share > 0.02), "{most:?}");
}

#[test]
fn under_a_force_error_z_1_moves_by_it_as_well() {
    let mut rng = random::generator(313);
    for _ in 0..5_000 {
        let flying = Loop::random(&mut rng);
        let x = flying.start(&mut rng);
        let x = Translation { position: x.position / x.position.norm(), velocity: x.velocity / x.velocity.norm(), ..x };
        let more = random::vector(&mut rng, 5.0).cast::<f64>();
        let along = flying.flow(&x, &more);
        let [z_1, z_2] = flying.z(&x);
        let core = flying.core(&x);
        let size = 1.0 + z_1.norm() + z_2.norm() + flying.force.norm();
        assert!(
            (core.errors.z_1.cast::<f64>() - z_1).norm() < 1e-5 * size
                && (core.errors.z_2.cast::<f64>() - z_2).norm() < 1e-5 * size
        );
        // z is linear in the state, so that any step will do.
        let [after, before] = [0.5, -0.5].map(|time| flying.z(&x.after(&along, time)));
        let [z_1_dot, z_2_dot] = [after[0] - before[0], after[1] - before[1]];
        let lags = flying.lags();
        let moved = more.component_mul(&lags.iter().sum());
        assert!((z_1_dot - z_2 - moved).norm() < 1e-9 * (1.0 + z_1_dot.norm()), "{z_1_dot} {z_2} {moved}");
        // The core's drive is y less x, in ticks without an end.
        let drive = core.drive.cast::<f64>() / f64::from(flying.p.k_s) + x.x;
        let feedback = core.feedback.cast::<f64>();
        assert!((drive - x.y).norm() < 1e-4 * (1.0 + feedback.norm() + x.x.norm() + x.y.norm()));
        let pushed = feedback + flying.force + more;
        assert!((z_2_dot - pushed).norm() < 1e-9 * (1.0 + z_2_dot.norm()), "{z_2_dot} {pushed}");
    }
}
