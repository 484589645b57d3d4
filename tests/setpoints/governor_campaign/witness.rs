//! Who watches the reference: bounds, continuity and approach, in double precision.

use super::case::Case;
use controller_core::prelude::{Reference, Vector3};

/// How near to its bounds the streams of a thread came (as shares), and how they fared.
#[derive(Clone, Copy, Default)]
pub struct Tally {
    pub ticks: u64,
    /// Starts in motion.
    pub moving: u64,
    /// Ticks of undisturbed paths, and how many of them the reference was on.
    pub sent: u64,
    pub followed: u64,
    pub nearest: [f64; 6],
    pub longest: f32,
}

impl Tally {
    pub fn merged(mut self, other: &Self) -> Self {
        self.ticks += other.ticks;
        self.moving += other.moving;
        self.sent += other.sent;
        self.followed += other.followed;
        self.longest = self.longest.max(other.longest);
        for (nearest, theirs) in self.nearest.iter_mut().zip(other.nearest) {
            *nearest = nearest.max(theirs);
        }
        self
    }
}

/// Watches one stream from tick to tick.
pub struct Witness<'a> {
    pub case: &'a Case,
    pub last: Reference,
}

impl Witness<'_> {
    /// The first tick goes on from `start`, to a unit of the governor's lengths and to what snap makes of one tick.
    pub fn start(&self, start: &Reference, tally: &mut Tally) {
        let (b, t, knots) = (&self.case.bounds, self.case.period, self.case.knots());
        let unit = b.horizontal_acceleration.max(b.vertical_acceleration) * knots * knots / 65_536.0 * 3.0_f32.sqrt();
        let velocity = (self.last.velocity - start.velocity).norm();
        let rounding = 4.0 * f32::EPSILON;
        let room = unit / knots + b.snap * knots.powi(3) + rounding * start.velocity.norm();
        assert!(velocity <= room, "starts {velocity:e} m/s off, beyond {room:e}");
        let position = (self.last.position - start.position - start.velocity * t).norm();
        let room = 2.0 * unit + b.snap * knots.powi(4) + rounding * start.position.norm();
        assert!(position <= room, "starts {position:e} m off, beyond {room:e}");
        self.bounds(&self.last, tally);
    }

    pub fn see(&mut self, next: Reference, tally: &mut Tally) {
        self.bounds(&next, tally);
        self.continuity(&next);
        self.last = next;
        tally.ticks += 1;
    }

    pub fn bounds(&self, next: &Reference, tally: &mut Tally) {
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
            *nearest = nearest.max(*share);
        }
    }

    pub fn continuity(&self, next: &Reference) {
        let last = &self.last;
        // What a tick reports is worked out from the knot that it is on the way to: so far away, which its rounding
        // knows.
        let (b, t, away) = (&self.case.bounds, f64::from(self.case.period), f64::from(self.case.knots()));
        let double = |vector: Vector3<f32>| vector.map(f64::from);
        let [p0, v0, a0, j0, s0] = [last.position, last.velocity, last.acceleration, last.jerk, last.snap].map(double);
        let [p1, v1, a1, j1, s1] = [next.position, next.velocity, next.acceleration, next.jerk, next.snap].map(double);
        let rounding = f64::from(f32::EPSILON);
        let acceleration = f64::from(b.horizontal_acceleration + b.vertical_acceleration);
        let near = |excess: Vector3<f64>, scale: f64, what: &str| {
            let room = 4.0 * rounding * (scale + 1e-3);
            assert!(excess.norm() <= room, "{what}: {excess} beyond {room:e}\n{last:?}\n{next:?}");
        };
        let (jerk, snap) = (f64::from(b.jerk), f64::from(b.snap));
        near(j1 - j0 - (s0 + s1) * (t / 2.0), jerk + away * snap, "jerk");
        let corrected = (j0 + j1) * (t / 2.0) - (s1 - s0) * (t * t / 12.0);
        near(a1 - a0 - corrected, acceleration + away * jerk, "acceleration");
        let corrected = (a0 + a1) * (t / 2.0) - (j1 - j0) * (t * t / 12.0);
        near(v1 - v0 - corrected, v0.norm() + away * acceleration, "velocity");
        let corrected = (v0 + v1) * (t / 2.0) - (a1 - a0) * (t * t / 12.0) + (s1 - s0) * (t.powi(4) / 720.0);
        near(p1 - p0 - corrected, p0.norm() + away * v0.norm(), "position");
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
        let most = ramp(b.snap, self.case.limits.snap_ramp);
        assert!((s1 - s0).norm() <= most, "snap jumps by {} > {most}", (s1 - s0).norm());
        let most = ramp(b.heading_second_derivative, self.case.limits.heading_ramp);
        assert!((w1 - w0).abs() <= most, "psi'' jumps by {}", w1 - w0);
    }
}

/// Whether a point travels along the segment without turning back or passing its end.
pub struct Approach {
    pub from: Vector3<f64>,
    pub to: Vector3<f64>,
    pub along: f64,
    /// Greatest distance from the segment, relative to its length. Commands are cut to whole units, of which an
    /// acceleration bound has at least 65,536 where it is greatest: each tick may point aside by one on each axis.
    pub aside: f64,
}

impl Approach {
    pub fn see(&mut self, position: &Vector3<f32>) {
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
