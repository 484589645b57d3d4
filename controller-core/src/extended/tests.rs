//! The extended law's parts, one by one, on the Hummingbird and on random plausible vehicles. Its step as a whole is in
//! `controller/tests.rs`; flights, flows and the independent transcription are in `tests/`.

extern crate std;
use nalgebra::{Quaternion, Vector3};

mod approach;
mod attitude;
mod budget;
mod constants;
mod defaults;
mod direction_limiter;
mod estimates;
pub(crate) mod example;
mod fallback;
mod heading;
mod late;
mod position;
mod saturation;
mod thrust_range;

/// Xorshift, for tests that repeat to the bit.
pub(crate) struct Random(pub u64);

impl Random {
    pub fn signed(&mut self) -> f32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 40) as f32 / 8_388_608.0 - 1.0
    }

    pub fn between(&mut self, min: f32, max: f32) -> f32 {
        min + (max - min) * 0.5 * (self.signed() + 1.0)
    }

    pub fn logarithmic(&mut self, min: f32, max: f32) -> f32 {
        self.between(min.ln(), max.ln()).exp()
    }

    pub fn below(&mut self, count: usize) -> usize {
        (self.between(0.0, count as f32) as usize).min(count - 1)
    }

    pub fn vector(&mut self, size: f32) -> Vector3<f32> {
        Vector3::new(self.signed(), self.signed(), self.signed()) * size
    }

    pub fn attitude(&mut self) -> Quaternion<f32> {
        let q = Quaternion::new(self.signed(), self.signed(), self.signed(), self.signed());
        q / q.norm()
    }
}
