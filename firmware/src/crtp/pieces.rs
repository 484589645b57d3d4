//! Pieces of trajectories that a client uploads, in a memory of their own.
//!
//! | kind | in memory |
//! |---|---|
//! | 0 | for each piece the coefficients of x, y, z and yaw (4 x 8 floats) and how long it takes (float, s) |
//! | 1 | where it begins: x, y, z (mm), yaw (0.1 degrees), 2 bytes each; for each piece a byte with two bits for each of x, y, z, yaw, lowest first, how long it takes (2 bytes, ms), and control points of its Bezier curves, 2 bytes each: 0, 1, 3 or 7 of them, as the two bits say |
//!
//! A curve's first control point is the last one of the piece before, and one without others stays there.

use super::errors::{INVALID, NOT_THERE, UNKNOWN_COMMAND};
use super::fields::Fields;
use super::polynomial::{COEFFICIENTS, Point, Polynomial, Segment};

/// As much memory as Bitcraze's vehicles have: 31 pieces of kind 0.
pub const MEMORY_BYTES: usize = 4096;

/// Trajectories that are defined at a time.
const DEFINITIONS_MAX: usize = 10;

/// The longest that a piece may take, s.
const PIECE_MAX_S: f32 = 3_600.0;

/// How pieces are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Kind 0.
    Polynomials,
    /// Kind 1.
    Curves,
}

/// A trajectory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Definition {
    form: Form,
    /// Where it begins in memory.
    offset: usize,
    /// Pieces.
    count: u8,
}

/// The memory, and the trajectories in it.
pub struct Pieces<'m> {
    memory: &'m mut [u8],
    definitions: [Option<Definition>; DEFINITIONS_MAX],
}

impl<'m> Pieces<'m> {
    /// Nothing uploaded to this memory.
    pub const fn new(memory: &'m mut [u8]) -> Self {
        Self { memory, definitions: [None; _] }
    }

    /// Bytes of memory.
    pub fn size(&self) -> u32 {
        u32::try_from(self.memory.len()).unwrap_or(u32::MAX)
    }

    /// So many bytes from an address on, as far as it has all of them.
    pub fn read(&self, address: usize, count: usize) -> Option<&[u8]> {
        self.memory.get(address..address.checked_add(count)?)
    }

    /// Writes bytes from an address on, all of them or none; whether there was room.
    pub fn write(&mut self, address: usize, bytes: &[u8]) -> bool {
        let place = address.checked_add(bytes.len()).and_then(|end| self.memory.get_mut(address..end));
        place.is_some_and(|place| {
            place.copy_from_slice(bytes);
            true
        })
    }

    /// Defines a trajectory of pieces that were uploaded before.
    /// Errors: a number of [`super::errors`] where there is no such trajectory, or it cannot be flown.
    pub fn define(&mut self, number: u8, kind: u8, offset: u32, count: u8) -> Result<(), u8> {
        let form = match kind {
            0 => Form::Polynomials,
            1 => Form::Curves,
            _ => return Err(UNKNOWN_COMMAND),
        };
        let definition = Definition { form, offset: offset as usize, count };
        self.length(&definition).ok_or(INVALID)?;
        *self.definitions.get_mut(usize::from(number)).ok_or(NOT_THERE)? = Some(definition);
        Ok(())
    }

    /// A trajectory and how long it takes, s, as its pieces are now; none that is not defined or cannot be flown.
    pub fn defined(&self, number: u8) -> Option<(Definition, f32)> {
        let definition = (*self.definitions.get(usize::from(number))?)?;
        Some((definition, self.length(&definition)?))
    }

    /// How long its pieces take, s; none where one of them is not there or cannot be flown.
    fn length(&self, definition: &Definition) -> Option<f32> {
        let mut walk = Walk::new(self, definition)?;
        let mut length = 0.0;
        for _ in 0..definition.count {
            let segment = walk.next()?;
            if !(segment.is_finite() && segment.duration > 0.0 && segment.duration <= PIECE_MAX_S) {
                return None;
            }
            length += segment.duration;
        }
        (length > 0.0).then_some(length)
    }

    /// Where a trajectory is at `time`, s, from its beginning, and not beyond its ends.
    pub fn at(&self, definition: &Definition, time: f32) -> Option<Point> {
        let mut walk = Walk::new(self, definition)?;
        let mut rest = time.max(0.0);
        let mut segment = walk.next()?;
        for _ in 1..definition.count {
            if rest <= segment.duration {
                break;
            }
            rest -= segment.duration;
            segment = walk.next()?;
        }
        Some(segment.at(rest))
    }
}

/// Goes along the pieces of a trajectory.
struct Walk<'m> {
    form: Form,
    fields: Fields<'m>,
    /// Where the last curve ended: x, y and z, m, and yaw, rad.
    ends: [f32; 4],
}

/// What a unit of a curve's control points is: m, and rad.
const STEPS: [f32; 4] = [1e-3, 1e-3, 1e-3, 0.1 * core::f32::consts::PI / 180.0];

impl<'m> Walk<'m> {
    fn new(pieces: &'m Pieces<'_>, definition: &Definition) -> Option<Self> {
        let mut fields = Fields::new(pieces.memory.get(definition.offset..)?);
        let mut ends = [0.0; 4];
        if definition.form == Form::Curves {
            for (end, step) in ends.iter_mut().zip(STEPS) {
                *end = f32::from(fields.i16()?) * step;
            }
        }
        Some(Self { form: definition.form, fields, ends })
    }

    /// The next piece; none where memory ends.
    fn next(&mut self) -> Option<Segment> {
        match self.form {
            Form::Polynomials => {
                let mut next = || self.polynomial();
                let (axes, yaw) = ([next()?, next()?, next()?], next()?);
                Some(Segment { axes, yaw, duration: self.fields.f32()? })
            }
            Form::Curves => {
                let degrees = self.fields.u8()?;
                let duration = f32::from(self.fields.u16()?) * 1e-3;
                let mut next = |axis| self.curve(axis, degrees >> (2 * axis) & 3, duration);
                Some(Segment { axes: [next(0)?, next(1)?, next(2)?], yaw: next(3)?, duration })
            }
        }
    }

    fn polynomial(&mut self) -> Option<Polynomial> {
        let mut coefficients = [0.0; COEFFICIENTS];
        for coefficient in &mut coefficients {
            *coefficient = self.fields.f32()?;
        }
        Some(Polynomial(coefficients))
    }

    /// A Bezier curve of degree n with control points b_0 to b_n as a polynomial: c_j = binomial(n, j) D^j b_0 / T^j,
    /// with D the forward difference.
    fn curve(&mut self, axis: usize, degree: u8, duration: f32) -> Option<Polynomial> {
        let (end, step) = (self.ends.get_mut(axis)?, STEPS.get(axis)?);
        let degree = [0_usize, 1, 3, 7].get(usize::from(degree)).copied()?;
        let mut points = [0.0; COEFFICIENTS];
        for (place, point) in points.iter_mut().enumerate().take(degree + 1) {
            if place > 0 {
                *end = f32::from(self.fields.i16()?) * step;
            }
            *point = *end;
        }
        let (mut coefficients, mut scale) = ([0.0; COEFFICIENTS], 1.0);
        for (order, coefficient) in coefficients.iter_mut().enumerate().take(degree + 1) {
            *coefficient = *points.first()? * scale;
            // The differences of the next order.
            let next: [f32; COEFFICIENTS] =
                core::array::from_fn(|place| points.get(place + 1).map_or(0.0, |later| later - points[place]));
            points = next;
            scale *= (degree - order) as f32 / ((order + 1) as f32 * duration);
        }
        Some(Polynomial(coefficients))
    }
}

#[cfg(test)]
mod tests;
