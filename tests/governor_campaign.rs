//! 100,000 random and adversarial setpoint streams against the reference governor.
//!
//! Each stream has its own bounds, limits, tick rate and start: at rest, on a circle or an oscillation inside the bounds,
//! or wherever another governor was when it was interrupted. Setpoints then come at 50 Hz or as the adversary likes, for a
//! few seconds, and end in a constant one. Checked at every tick, in double precision and without allowance:
//!
//! - every bound of Omega_r;
//! - that position to snap and psi to psi'' are one motion: each derivative integrates to the one below. Between ticks
//!   the reference is a spline with linear snap, so Euler and Maclaurin's corrected trapezoids are exact and the
//!   tolerance is the rounding of the numbers compared;
//! - that snap and psi'' move no faster than their ramps allow.
//!
//! And in the end: at rest, exactly on the setpoint; if it started from rest, without having passed it or turned back.

use controller_core::governor::{Governor, GovernorLimits, Motion, Setpoint, Turn};
use controller_core::prelude::{Heading, Reference, ReferenceBounds, Vector2, Vector3};
use core::f32::consts::{PI, TAU};

const STREAMS: u64 = 100_000;
/// No arrival takes longer, s; the slowest bounds drawn need most of it.
const PATIENCE: f32 = 150.0;

struct Random(u64);

impl Random {
    fn new(seed: u64) -> Self {
        Self(seed.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0 >> 16
    }

    /// One of 0..count.
    fn below(&mut self, count: u64) -> u64 {
        self.next() % count
    }

    fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * (self.below(1 << 24) as f32 / 16_777_216.0)
    }

    /// Log-uniform.
    fn sized(&mut self, low: f32, high: f32) -> f32 {
        low * (high / low).powf(self.between(0.0, 1.0))
    }

    fn vector(&mut self, size: f32) -> Vector3<f32> {
        Vector3::new(self.between(-size, size), self.between(-size, size), self.between(-size, size))
    }

    fn heading(&mut self) -> Vector2<f32> {
        let (sin, cos) = self.between(-PI, PI).sin_cos();
        Vector2::new(cos, sin)
    }
}

/// The conditions of one stream.
struct Case {
    bounds: ReferenceBounds,
    limits: GovernorLimits,
    period: f32,
}

impl Case {
    fn draw(random: &mut Random) -> Self {
        let typical = random.below(2) == 0;
        let bounds = if typical {
            ReferenceBounds {
                horizontal_acceleration: 2.5,
                vertical_acceleration: 0.5,
                jerk: 4.0,
                snap: 10.0,
                heading_rate: 1.3,
                heading_second_derivative: 1.8,
            }
        } else {
            ReferenceBounds {
                horizontal_acceleration: random.sized(0.5, 6.0),
                vertical_acceleration: random.sized(0.3, 4.0),
                jerk: random.sized(1.0, 30.0),
                snap: random.sized(4.0, 200.0),
                heading_rate: random.sized(0.3, 4.0),
                heading_second_derivative: random.sized(0.4, 8.0),
            }
        };
        let limits = GovernorLimits {
            horizontal_speed: random.sized(1.0, 10.0),
            vertical_speed: random.sized(0.5, 4.0),
            ..GovernorLimits::default()
        };
        let period = [0.01, 0.01, 0.02, 0.005][random.below(4) as usize];
        Self { bounds, limits, period }
    }

    /// The lengths of the two long averages, as anyone can work them out, in ticks.
    fn windows(&self) -> [u32; 2] {
        let b = &self.bounds;
        let diameter = 2.0 * b.horizontal_acceleration.hypot(b.vertical_acceleration);
        let first = (diameter / b.jerk).max((2.0 * diameter / b.snap).sqrt());
        let second = 2.0 * diameter / (b.snap * first);
        [first, second].map(|window| (window / self.period).ceil() as u32)
    }

    fn resting(&self, random: &mut Random) -> Reference {
        let zero = Vector3::zeros();
        Reference {
            position: random.vector(20.0),
            velocity: zero,
            acceleration: zero,
            jerk: zero,
            snap: zero,
            heading: Heading::new(random.heading(), 0.0, 0.0).unwrap(),
        }
    }

    /// Where a governor is that was sent about at random for a while.
    fn interrupted(&self, random: &mut Random, mut governor: Governor) -> Reference {
        let mut last = governor.tick();
        for _ in 0..1 + random.below(3) {
            let motion = Motion::Velocity(random.vector(5.0));
            governor.accept(&Setpoint { motion, turn: Turn::Rate(random.between(-2.0, 2.0)) }).unwrap();
            for _ in 0..random.below(100) {
                last = governor.tick();
            }
        }
        last
    }

    /// A moment of an ellipse in space, somewhere up to its bounds, with a heading that turns and swings.
    fn orbiting(&self, random: &mut Random) -> Reference {
        let b = &self.bounds;
        let rate = random.sized(0.2, 6.0);
        let (cosine, sine) = (random.vector(1.0), random.vector(1.0));
        let horizontal = cosine.xy().norm().hypot(sine.xy().norm());
        let vertical = cosine.z.hypot(sine.z);
        let all = cosine.norm().hypot(sine.norm());
        let size = (b.horizontal_acceleration / (horizontal * rate.powi(2)))
            .min(b.vertical_acceleration / (vertical * rate.powi(2)))
            .min(b.jerk / (all * rate.powi(3)))
            .min(b.snap / (all * rate.powi(4)))
            .min(6.0 / (all * rate))
            * random.between(0.0, 0.999);
        let (sin, cos) = random.between(-PI, PI).sin_cos();
        let wave = (cosine * cos + sine * sin) * size;
        let slope = (sine * cos - cosine * sin) * (size * rate);
        // psi' = r cos, psi'' = -r w sin, with r^4 + (r w)^2 within the bound.
        let share = random.between(0.0, 0.99);
        let swing = (b.heading_rate * share).min((0.9 * b.heading_second_derivative * share).sqrt());
        let left = (b.heading_second_derivative.powi(2) * share - swing.powi(4)).max(0.0).sqrt();
        let (sin, cos) = random.between(-PI, PI).sin_cos();
        Reference {
            position: random.vector(20.0),
            velocity: slope,
            acceleration: -wave * rate.powi(2),
            jerk: -slope * rate.powi(2),
            snap: wave * rate.powi(4),
            heading: Heading::new(random.heading(), swing * cos, -left * sin).unwrap(),
        }
    }
}

/// What is sent at each tick.
#[derive(Clone, Copy)]
enum Adversary {
    /// Anything, at 50 Hz.
    Jumps,
    /// Opposite accelerations in step with the averages' windows.
    Resonance { first: u32, second: u32 },
    /// A velocity reversed whenever it has been reached, or just not.
    Reversals { ticks: u32 },
    /// A million metres this way and that.
    Far,
    /// Micrometres.
    Tiny,
    /// Duplicates, gaps, NaN.
    Broken,
    /// Feed-forward true, false or absurd.
    Moving { kind: u64 },
    /// Angles on both sides of ±180 degrees, and rates.
    Antipodes,
    /// One setpoint from the start.
    Constant,
}

impl Adversary {
    fn draw(random: &mut Random, case: &Case) -> Self {
        let [first, second] = case.windows();
        match random.below(9) {
            0 => Self::Jumps,
            1 => Self::Resonance { first, second },
            2 => Self::Reversals { ticks: random.sized(1.0, 200.0) as u32 },
            3 => Self::Far,
            4 => Self::Tiny,
            5 => Self::Broken,
            6 => Self::Moving { kind: random.below(4) },
            7 => Self::Antipodes,
            _ => Self::Constant,
        }
    }

    fn send(self, tick: u32, random: &mut Random, governor: &mut Governor, now: &Reference, period: f32) {
        let often = (0.02 / period).round().max(1.0) as u32;
        let along = Vector3::new(0.8, -0.6, 1.0);
        let sided = |positive: bool| if positive { along } else { -along };
        let side = |positive: bool| if positive { 1.0 } else { -1.0 };
        let anywhere = |random: &mut Random| match random.below(3) {
            0 => Motion::Position(now.position + random.vector(10.0)),
            1 => Motion::Velocity(random.vector(8.0)),
            _ => Motion::PositionVelocityAcceleration {
                position: now.position + random.vector(5.0),
                velocity: random.vector(5.0),
                acceleration: random.vector(3.0),
            },
        };
        let turn = |random: &mut Random| match random.below(3) {
            0 => Turn::Keep,
            1 => Turn::Angle { angle: random.between(-10.0, 10.0), rate: random.between(-1.0, 1.0) },
            _ => Turn::Rate(random.between(-3.0, 3.0)),
        };
        let setpoint = match self {
            Self::Jumps if tick % often == 0 => Setpoint { motion: anywhere(random), turn: turn(random) },
            Self::Resonance { first, second } => {
                // The signs that make snap's second difference greatest: windows' blocks alternate.
                let positive = (tick / second.max(1) + tick / first.max(1)) % 2 == 0;
                Setpoint { motion: Motion::Velocity(sided(positive) * 100.0), turn: Turn::Rate(side(positive) * 9.0) }
            }
            Self::Reversals { ticks } => {
                let positive = (tick / ticks) % 2 == 0;
                Setpoint { motion: Motion::Velocity(sided(positive) * 100.0), turn: Turn::Rate(side(positive) * 9.0) }
            }
            Self::Far if tick % (often * 10) == 0 => {
                Setpoint { motion: Motion::Position(random.vector(1e6)), turn: turn(random) }
            }
            Self::Tiny if tick % often == 0 => {
                let size = random.sized(1e-6, 1e-2);
                let angle = now.heading.direction().y.atan2(now.heading.direction().x) + random.between(-size, size);
                let motion = Motion::Position(now.position + random.vector(size));
                Setpoint { motion, turn: Turn::Angle { angle, rate: 0.0 } }
            }
            Self::Broken if random.below(20) == 0 => {
                let sent = Setpoint { motion: anywhere(random), turn: turn(random) };
                for _ in 0..random.below(4) {
                    governor.accept(&sent).unwrap();
                }
                let mut position = random.vector(3.0);
                position[random.below(3) as usize] = [f32::NAN, f32::INFINITY, 1e30][random.below(3) as usize];
                let refused = governor.accept(&Setpoint { motion: Motion::Position(position), turn: Turn::Rate(1.0) });
                assert!(refused.is_err());
                return;
            }
            Self::Moving { kind } if tick % often == 0 => {
                let (rate, time) = (TAU * 0.25, tick as f32 * period);
                let (sin, cos) = (rate * time).sin_cos();
                let (position, velocity) = (Vector3::new(cos, sin, 1.0), Vector3::new(-sin, cos, 0.0) * rate);
                let acceleration = Vector3::new(cos, sin, 0.0) * (-rate * rate);
                let motion = match kind {
                    0 => Motion::PositionVelocityAcceleration { position, velocity, acceleration },
                    1 => Motion::PositionVelocityAcceleration { position, velocity: -velocity, acceleration },
                    2 => Motion::PositionVelocityAcceleration {
                        position,
                        velocity: random.vector(1e6),
                        acceleration: random.vector(1e6),
                    },
                    _ => Motion::PositionVelocityAcceleration {
                        position: position * 0.0,
                        velocity: Vector3::zeros(),
                        acceleration: random.vector(20.0),
                    },
                };
                Setpoint { motion, turn: Turn::Angle { angle: rate * time, rate } }
            }
            Self::Antipodes if tick % often == 0 => {
                let here = now.heading.direction().y.atan2(now.heading.direction().x);
                let angle = here + PI + random.between(-0.01, 0.01);
                let rate = [0.0, 100.0, -100.0, 1e6][random.below(4) as usize];
                Setpoint { motion: anywhere(random), turn: Turn::Angle { angle, rate } }
            }
            _ => return,
        };
        governor.accept(&setpoint).unwrap();
    }
}

/// How near to its bounds the streams of a thread came (as shares, take-overs apart), and how they fared.
#[derive(Clone, Copy, Default)]
struct Tally {
    ticks: u64,
    /// Starts in motion: on orbits, and where another governor was.
    orbiting: u64,
    interrupted: u64,
    /// Of these, what was refused.
    refused: [u64; 2],
    nearest: [f64; 6],
    longest: f32,
}

impl Tally {
    fn merged(mut self, other: &Self) -> Self {
        self.ticks += other.ticks;
        self.orbiting += other.orbiting;
        self.interrupted += other.interrupted;
        for (refused, theirs) in self.refused.iter_mut().zip(other.refused) {
            *refused += theirs;
        }
        self.longest = self.longest.max(other.longest);
        for (nearest, theirs) in self.nearest.iter_mut().zip(other.nearest) {
            *nearest = nearest.max(theirs);
        }
        self
    }
}

/// Watches one stream from tick to tick.
struct Witness<'a> {
    case: &'a Case,
    last: Reference,
    /// Ticks left of a take-over, whose polynomials have corners within ticks.
    crossing: u32,
}

impl Witness<'_> {
    fn see(&mut self, next: Reference, tally: &mut Tally) {
        self.bounds(&next, tally);
        self.continuity(&next);
        self.last = next;
        self.crossing = self.crossing.saturating_sub(1);
        tally.ticks += 1;
    }

    fn bounds(&self, next: &Reference, tally: &mut Tally) {
        let b = &self.case.bounds;
        let [a, j, s] = [next.acceleration, next.jerk, next.snap].map(|vector| vector.map(f64::from));
        let (rate, turning) = (f64::from(next.heading.rate()), f64::from(next.heading.acceleration()));
        let shares = [
            a.xy().norm() / f64::from(b.horizontal_acceleration),
            a.z.abs() / f64::from(b.vertical_acceleration),
            j.norm() / f64::from(b.jerk),
            s.norm() / f64::from(b.snap),
            rate.abs() / f64::from(b.heading_rate),
            (turning * turning + rate.powi(4)).sqrt() / f64::from(b.heading_second_derivative),
        ];
        for (share, nearest) in shares.iter().zip(&mut tally.nearest) {
            assert!(*share <= 1.0, "outside by {shares:?}: {next:?}");
            if self.crossing == 0 {
                *nearest = nearest.max(*share);
            }
        }
    }

    fn continuity(&self, next: &Reference) {
        let last = &self.last;
        let (b, t) = (&self.case.bounds, f64::from(self.case.period));
        let double = |vector: Vector3<f32>| vector.map(f64::from);
        let [p0, v0, a0, j0, s0] = [last.position, last.velocity, last.acceleration, last.jerk, last.snap].map(double);
        let [p1, v1, a1, j1, s1] = [next.position, next.velocity, next.acceleration, next.jerk, next.snap].map(double);
        let rounding = f64::from(f32::EPSILON);
        // Within one tick of a take-over snap strays from a line between its ends by at most twice its bound.
        let stray = if self.crossing > 0 { 2.0 * f64::from(b.snap) } else { 0.0 };
        // Its polynomials' coefficients sum, in magnitude, to 1, 7, 31 and 120 from position to jerk, times an amplitude over
        // its duration; jerk is at least a 64th of that sum where it matters.
        let acceleration = f64::from(b.horizontal_acceleration + b.vertical_acceleration);
        let span = 4.0 * f64::from(self.case.windows()[0]) * t;
        let fades = if self.crossing > 0 { 1.0 } else { 0.0 };
        let near = |excess: Vector3<f64>, scale: f64, fade: f64, order: i32, what: &str| {
            let room = 4.0 * rounding * (scale + fades * fade + 1e-3) + stray * t.powi(order);
            assert!(excess.norm() <= room, "{what}: {excess} beyond {room:e}\n{last:?}\n{next:?}");
        };
        let (jerk, snap) = (f64::from(b.jerk), f64::from(b.snap));
        near(j1 - j0 - (s0 + s1) * (t / 2.0), jerk + t * snap, 16.0 * jerk, 1, "jerk");
        let corrected = (j0 + j1) * (t / 2.0) - (s1 - s0) * (t * t / 12.0);
        near(a1 - a0 - corrected, acceleration + t * jerk, 8.0 * acceleration, 2, "acceleration");
        let corrected = (a0 + a1) * (t / 2.0) - (j1 - j0) * (t * t / 12.0);
        near(v1 - v0 - corrected, v0.norm() + t * acceleration, 2.0 * acceleration * span, 3, "velocity");
        let corrected = (v0 + v1) * (t / 2.0) - (a1 - a0) * (t * t / 12.0) + (s1 - s0) * (t.powi(4) / 720.0);
        near(p1 - p0 - corrected, p0.norm() + t * v0.norm(), acceleration * span * span, 4, "position");
        let [h0, h1] = [last.heading, next.heading];
        let [d0, d1] = [h0.direction(), h1.direction()].map(|direction| direction.map(f64::from));
        let [r0, r1, w0, w1] = [h0.rate(), h1.rate(), h0.acceleration(), h1.acceleration()].map(f64::from);
        let second = f64::from(b.heading_second_derivative);
        let excess = r1 - r0 - (w0 + w1) * (t / 2.0);
        let room = 4.0 * rounding * (f64::from(b.heading_rate) + t * second + 1e-3);
        assert!(excess.abs() <= room, "heading rate: {excess:e} beyond {room:e}");
        let turned = (d0.x * d1.y - d0.y * d1.x).atan2(d0.dot(&d1));
        let excess = turned - (r0 + r1) * (t / 2.0) + (w1 - w0) * (t * t / 12.0);
        // Sine and cosine carry absolute errors of 1.2e-7 each.
        assert!(excess.abs() <= 8.0 * rounding, "heading: {excess:e}");
        let ramp = |bound: f32, ramp: f32| 2.0 * f64::from(bound * self.case.period / ramp) * (1.0 + 1e-6);
        if self.crossing == 0 {
            let most = ramp(b.snap, self.case.limits.snap_ramp);
            assert!((s1 - s0).norm() <= most, "snap jumps by {} > {most}", (s1 - s0).norm());
        }
        let most = ramp(b.heading_second_derivative, self.case.limits.heading_ramp);
        // A take-over may have less time for psi'' than the ramp.
        assert!(self.crossing > 0 || (w1 - w0).abs() <= most, "psi'' jumps by {}", w1 - w0);
    }
}

/// Whether a point travels along the segment without turning back or passing its end.
struct Approach {
    from: Vector3<f64>,
    to: Vector3<f64>,
    along: f64,
    /// Greatest distance from the segment, relative to its length. Commands are cut to whole units, of which an
    /// acceleration bound has at least 65,536 where it is greatest: each tick may point aside by one on each axis.
    aside: f64,
}

impl Approach {
    fn see(&mut self, position: &Vector3<f32>) {
        let path = self.to - self.from;
        let (length, travelled) = (path.norm(), position.map(f64::from) - self.from);
        let along = travelled.dot(&path) / length;
        // The rounding of positions of up to 50 m, twice, and of the command's whole units.
        let room = 2e-5;
        assert!(along >= self.along - room, "turns back at {along} after {}", self.along);
        assert!(along <= length + room, "overshoots: {along} of {length}");
        assert!((travelled - path * (along / length)).norm() <= room + self.aside * length, "leaves the segment");
        self.along = self.along.max(along);
    }
}

fn fly(seed: u64, tally: &mut Tally) {
    let mut random = Random::new(seed);
    let case = Case::draw(&mut random);
    let adversary = Adversary::draw(&mut random, &case);
    let resting = case.resting(&mut random);
    let mut start = resting;
    let mut governor = Governor::new(case.bounds, case.limits, case.period, &resting).unwrap();
    if !matches!(adversary, Adversary::Constant) && random.below(3) > 0 {
        let interrupted = random.below(2) == 0;
        start = if interrupted { case.interrupted(&mut random, governor.clone()) } else { case.orbiting(&mut random) };
        *(if interrupted { &mut tally.interrupted } else { &mut tally.orbiting }) += 1;
        if governor.restart(&start).is_err() {
            // Allowed, but it must be rare: counted.
            tally.refused[usize::from(interrupted)] += 1;
            start = resting;
        }
    }
    // The longest take-over lasts three and a half windows.
    let crossing = if start == resting { 0 } else { 4 * case.windows()[0] + 2 };
    let mut witness = Witness { case: &case, last: start, crossing };
    let busy =
        if matches!(adversary, Adversary::Constant) { 0 } else { (random.between(1.0, 5.0) / case.period) as u32 };
    for tick in 0..busy {
        let now = witness.last;
        adversary.send(tick, &mut random, &mut governor, &now, case.period);
        witness.see(governor.tick(), tally);
    }
    let size = random.sized(1e-3, 20.0);
    let target = witness.last.position + random.vector(size);
    let angle = random.between(-PI, PI);
    let ending = random.below(8);
    if ending == 0 {
        governor.stop();
    } else if ending == 1 && busy > 0 {
        // Silence: what was sent last runs out or is arrived at, unless it is a million metres away.
        let motion = Motion::Velocity(random.vector(2.0));
        governor.accept(&Setpoint { motion, turn: Turn::Rate(0.5) }).unwrap();
    } else {
        let turn = Turn::Angle { angle, rate: 0.0 };
        governor.accept(&Setpoint { motion: Motion::Position(target), turn }).unwrap();
    }
    let mut approach = (busy == 0 && start == resting && ending > 1).then(|| Approach {
        from: start.position.map(f64::from),
        to: target.map(f64::from),
        along: 0.0,
        aside: {
            let (horizontal, vertical) = (case.bounds.horizontal_acceleration, case.bounds.vertical_acceleration);
            3.0_f64.sqrt() / 65_536.0 * f64::from((horizontal / vertical).max(vertical / horizontal))
        },
    });
    let mut time = 0.0;
    while !governor.at_rest() {
        let reference = governor.tick();
        witness.see(reference, tally);
        if let Some(approach) = &mut approach {
            approach.see(&reference.position);
        }
        time += case.period;
        assert!(time < PATIENCE, "no arrival: {reference:?} for {target}");
    }
    tally.longest = tally.longest.max(time);
    if ending > 1 {
        let there = governor.tick();
        // A length unit is a 65,536th part or less of the acceleration bound times period squared: 4e-8 m at the coarsest.
        let miss = (there.position - target).abs();
        assert!(miss.iter().zip(&target).all(|(miss, to)| *miss <= 4e-8 + f32::EPSILON * to.abs()), "off by {miss}");
        let (sin, cos) = angle.sin_cos();
        assert!((there.heading.direction() - Vector2::new(cos, sin)).norm() < 1e-6);
        assert_eq!((there.velocity, there.heading.rate()), (Vector3::zeros(), 0.0));
    }
}

#[test]
fn a_hundred_thousand_streams_never_leave_the_bounds_and_all_arrive() {
    let threads = std::thread::available_parallelism().map_or(2, usize::from).min(8) as u64;
    let tally = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads)
            .map(|thread| {
                scope.spawn(move || {
                    let mut tally = Tally::default();
                    for seed in (thread..STREAMS).step_by(threads as usize) {
                        let outcome = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| fly(seed, &mut tally)));
                        assert!(outcome.is_ok(), "stream {seed} failed");
                    }
                    tally
                })
            })
            .collect();
        workers.into_iter().map(|worker| worker.join().unwrap()).fold(Tally::default(), |all, one| all.merged(&one))
    });
    let Tally { ticks, orbiting, interrupted, refused, .. } = tally;
    println!("{ticks} ticks; {orbiting} starts on orbits, {interrupted} mid-way; {refused:?} refused");
    println!("nearest to the bounds (shares): {:.4?}; longest arrival {:.1} s", tally.nearest, tally.longest);
    // Adversaries that stay far inside prove nothing.
    assert!(tally.nearest.iter().all(|nearest| *nearest > 0.99), "{:?}", tally.nearest);
}
