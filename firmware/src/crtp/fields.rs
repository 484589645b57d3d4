//! Numbers in a packet's data, one behind the other, least byte first.

use nalgebra::{Quaternion, Vector3};

/// What is still to be read of some data. None of a number that it ends before.
#[derive(Debug, Clone, Copy)]
pub struct Fields<'d>(&'d [u8]);

impl<'d> Fields<'d> {
    /// From the beginning of `data`.
    pub const fn new(data: &'d [u8]) -> Self {
        Self(data)
    }

    /// What is left.
    pub const fn rest(&self) -> &'d [u8] {
        self.0
    }

    fn bytes<const COUNT: usize>(&mut self) -> Option<[u8; COUNT]> {
        let (bytes, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*bytes)
    }

    /// A byte.
    pub fn u8(&mut self) -> Option<u8> {
        self.bytes().map(u8::from_le_bytes)
    }

    /// A byte that is not zero.
    pub fn flag(&mut self) -> Option<bool> {
        self.u8().map(|byte| byte != 0)
    }

    /// Two bytes.
    pub fn u16(&mut self) -> Option<u16> {
        self.bytes().map(u16::from_le_bytes)
    }

    /// Two bytes, with a sign.
    pub fn i16(&mut self) -> Option<i16> {
        self.bytes().map(i16::from_le_bytes)
    }

    /// Four bytes.
    pub fn u32(&mut self) -> Option<u32> {
        self.bytes().map(u32::from_le_bytes)
    }

    /// Single precision. It may be no finite number.
    pub fn f32(&mut self) -> Option<f32> {
        self.bytes().map(f32::from_le_bytes)
    }

    /// Three of them.
    pub fn vector(&mut self) -> Option<Vector3<f32>> {
        Some(Vector3::new(self.f32()?, self.f32()?, self.f32()?))
    }

    /// Three numbers of two bytes, thousandths.
    pub fn thousandths(&mut self) -> Option<Vector3<f32>> {
        let mut next = || self.i16().map(|thousandths| f32::from(thousandths) * 1e-3);
        Some(Vector3::new(next()?, next()?, next()?))
    }

    /// A unit quaternion in four bytes.
    pub fn quaternion(&mut self) -> Option<Quaternion<f32>> {
        self.u32().map(super::quaternion::unpacked)
    }
}
