//! What Python says of a shield: its boxes, and the numbers of its rules.

use crate::errors::refused_field;
use crate::rows::one_or_more;
use crate::whole_number::Whole;
use controller_core::shield::settings::ROOMS_MAX;
use controller_core::shield::{Room, Settings};
use nalgebra::Vector3;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// What a shield was made of.
#[derive(Clone)]
pub struct ShieldArguments {
    /// The corners of its rooms, lower and upper.
    rooms: Vec<[[f64; 3]; 2]>,
    /// Margin, how late velocities are, speed, silence, patience and its greatest.
    numbers: [f64; 6],
    hand_overs: u32,
}

impl ShieldArguments {
    pub fn new(
        low: &Bound<'_, PyAny>,
        high: &Bound<'_, PyAny>,
        numbers: [f64; 6],
        hand_overs: Whole,
    ) -> PyResult<Self> {
        let hand_overs = hand_overs.within("hand_overs", 1..=u64::from(u32::MAX))? as u32;
        let (low, high) = (one_or_more::<3>(low, "low")?, one_or_more::<3>(high, "high")?);
        if !(1..=ROOMS_MAX).contains(&low.len()) {
            return Err(refused_field("low", format!("must be of 1 to {ROOMS_MAX} boxes, found {}", low.len())));
        }
        if low.len() != high.len() {
            return Err(refused_field("high", format!("must be of {} boxes as low, found {}", low.len(), high.len())));
        }
        Ok(Self { rooms: low.into_iter().zip(high).map(<[_; 2]>::from).collect(), numbers, hand_overs })
    }

    pub fn settings(&self) -> Settings {
        let corner = |corner: [f64; 3]| Vector3::from(corner).map(|place| place as f32);
        let [margin, late, speed, silence, patience, patience_greatest] = self.numbers.map(|value| value as f32);
        let room = |[low, high]: &[[f64; 3]; 2]| Room::new(corner(*low), corner(*high));
        let rooms = std::array::from_fn(|number| self.rooms.get(number).map(room));
        let hand_overs = self.hand_overs;
        Settings { rooms, margin, late, speed, silence, patience, patience_greatest, hand_overs }
    }

    /// As Python names it.
    pub fn named<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let named = PyDict::new(py);
        let corners = |which: usize| self.rooms.iter().map(|room| room[which]).collect::<Vec<_>>();
        named.set_item("low", corners(0))?;
        named.set_item("high", corners(1))?;
        let names = ["margin", "late", "speed", "silence", "patience", "patience_greatest"];
        for (name, number) in names.into_iter().zip(self.numbers) {
            named.set_item(name, number)?;
        }
        named.set_item("hand_overs", self.hand_overs)?;
        Ok(named)
    }
}
