//! Paths that a command begins: to a place, around a spiral, along pieces that were uploaded.

use super::pieces::{Definition, Pieces};
use super::polynomial::{Moving, Point, Segment};
use micromath::F32Ext;
use nalgebra::Vector3;

/// A path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Path {
    /// To rest at a place.
    Segment(Segment),
    /// Around.
    Spiral(Spiral),
    /// Along pieces in memory.
    Pieces(Along),
}

/// Around a centre, the radius changing evenly with the angle.
///
/// ```text
/// p(s) = centre + r(s) (cos, sin)(begin + angle s),   r(s) = r_0 + (r_F - r_0) s,   z(s) = z_0 + ascent s,   s = t / T
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spiral {
    /// m.
    pub centre: Vector3<f32>,
    /// Where it begins, rad counter-clockwise from x.
    pub begin: f32,
    /// How far around, rad; negative clockwise.
    pub angle: f32,
    /// At the beginning and at the end, m.
    pub radii: (f32, f32),
    /// m.
    pub ascent: f32,
    /// The yaw at its beginning, rad. It turns as the way does.
    pub yaw: f32,
    /// s.
    pub duration: f32,
}

impl Spiral {
    /// At `time`, s, and not beyond its end.
    pub fn at(&self, time: f32) -> Point {
        let share = (time / self.duration).clamp(0.0, 1.0);
        let (first, last) = self.radii;
        let (radius, growth) = (first + (last - first) * share, (last - first) / self.duration);
        let (angle, turning) = (self.begin + self.angle * share, self.angle / self.duration);
        // Good to 2e-3 of the radius, and the governor smooths what it is given.
        let (sine, cosine) = (F32Ext::sin(angle), F32Ext::cos(angle));
        let across = |outward: f32, around: f32, centre: f32| Moving {
            value: centre + radius * outward,
            rate: growth * outward + radius * turning * around,
            acceleration: 2.0 * growth * turning * around - radius * turning * turning * outward,
        };
        let climb = self.ascent / self.duration;
        let height = Moving { value: self.centre.z + self.ascent * share, rate: climb, acceleration: 0.0 };
        let yaw = Moving { value: self.yaw + self.angle * share, rate: turning, acceleration: 0.0 };
        Point { axes: [across(cosine, -sine, self.centre.x), across(sine, cosine, self.centre.y), height], yaw }
    }
}

/// Pieces as they are flown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Along {
    /// Which.
    pub definition: Definition,
    /// How long they take as they were uploaded, s.
    pub length: f32,
    /// How many times as long they are to take.
    pub timescale: f32,
    /// Whether they are flown from their end to their beginning.
    pub is_reversed: bool,
    /// What is added to their places, m, and how far they are turned about the vertical before, rad.
    pub shift: Vector3<f32>,
    /// See [`Self::shift`].
    pub turn: f32,
}

impl Along {
    fn at(&self, time: f32, pieces: &Pieces) -> Option<Point> {
        let run = time / self.timescale;
        let (run, sign) = if self.is_reversed { (self.length - run, -1.0) } else { (run, 1.0) };
        let Point { axes: [x, y, z], yaw } = pieces.at(&self.definition, run)?;
        let (sine, cosine) = (F32Ext::sin(self.turn), F32Ext::cos(self.turn));
        let rate = sign / self.timescale;
        let slowed = |of: Moving, shift: f32| Moving {
            value: of.value + shift,
            rate: of.rate * rate,
            acceleration: of.acceleration * rate * rate,
        };
        let across = |along: f32, other: f32| Moving {
            value: along * x.value + other * y.value,
            rate: along * x.rate + other * y.rate,
            acceleration: along * x.acceleration + other * y.acceleration,
        };
        let axes = [across(cosine, -sine), across(sine, cosine), z];
        let [x, y, z] = axes;
        let axes = [slowed(x, self.shift.x), slowed(y, self.shift.y), slowed(z, self.shift.z)];
        Some(Point { axes, yaw: slowed(yaw, self.turn) })
    }
}

impl Path {
    /// How long it takes, s.
    pub fn duration(&self) -> f32 {
        match self {
            Self::Segment(segment) => segment.duration,
            Self::Spiral(spiral) => spiral.duration,
            Self::Pieces(along) => along.length * along.timescale,
        }
    }

    /// Where it is at `time`, s, and not beyond its end; none where its pieces are gone.
    pub fn at(&self, time: f32, pieces: &Pieces) -> Option<Point> {
        let time = time.clamp(0.0, self.duration());
        match self {
            Self::Segment(segment) => Some(segment.at(time)),
            Self::Spiral(spiral) => Some(spiral.at(time)),
            Self::Pieces(along) => along.at(time, pieces),
        }
    }
}

#[cfg(test)]
mod tests;
