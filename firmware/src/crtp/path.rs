//! Paths that a command begins: to a place, or along pieces that were uploaded.

use super::pieces::{Definition, Pieces};
use super::polynomial::{Moving, Point, Segment};
use micromath::F32Ext;
use nalgebra::Vector3;

/// A path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Path {
    /// To rest at a place, m, with a yaw, rad, as fast as the governor goes.
    Place(Vector3<f32>, f32),
    /// To rest at a place within a time.
    Segment(Segment),
    /// Along pieces in memory.
    Pieces(Along),
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
    fn at(&self, time: f32, pieces: &Pieces<'_>) -> Option<Point> {
        let run = time / self.timescale;
        let (run, sign) = if self.is_reversed { (self.length - run, -1.0) } else { (run, 1.0) };
        let Point { axes: [x, y, z], yaw } = pieces.at(&self.definition, run)?;
        // Good to 2e-3 of the way, and the same along all of it.
        let (sine, cosine) = (F32Ext::sin(self.turn), F32Ext::cos(self.turn));
        let shifted = |of: Moving, shift: f32| {
            let of = of.paced(sign / self.timescale);
            Moving { value: of.value + shift, ..of }
        };
        let (across, other) = (x.mixed(cosine, &y, -sine), x.mixed(sine, &y, cosine));
        let axes = [shifted(across, self.shift.x), shifted(other, self.shift.y), shifted(z, self.shift.z)];
        Some(Point { axes, yaw: shifted(yaw, self.turn) })
    }
}

impl Path {
    /// How long it takes, s; none where the governor knows.
    pub fn duration(&self) -> Option<f32> {
        match self {
            Self::Place(..) => None,
            Self::Segment(segment) => Some(segment.duration),
            Self::Pieces(along) => Some(along.length * along.timescale),
        }
    }

    /// Where it is at `time`, s, and not beyond its end; none where its pieces are gone.
    pub fn at(&self, time: f32, pieces: &Pieces<'_>) -> Option<Point> {
        let time = time.clamp(0.0, self.duration().unwrap_or(0.0));
        match self {
            Self::Place(place, yaw) => Some(Point::resting(place, *yaw)),
            Self::Segment(segment) => Some(segment.at(time)),
            Self::Pieces(along) => along.at(time, pieces),
        }
    }
}

#[cfg(test)]
mod tests;
