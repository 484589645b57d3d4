//! A track gathered tick by tick, of any length.
//!
//! Up to [`ROWS_MAX`] ticks each row is a tick. Of a longer flight two rows stand for a stretch of ticks: a column of
//! *extremes* keeps the least and the greatest value of the stretch, in order of time, so that no peak is lost; a
//! column of *samples* keeps the values at the stretch's start and at its middle, which belong together across columns:
//! a pose.

use super::track::Track;
use crate::flight::Tick;
use std::f64::consts::TAU;

/// Rows a track may have: the paper's 40 s at 100 Hz, whole.
pub const ROWS_MAX: u64 = 4000;

/// The source of a column.
pub struct Instant<'a> {
    /// The tick.
    pub tick: &'a Tick,
    /// Yaw, degrees, without jumps.
    pub yaw: f64,
    /// Desired yaw, degrees, without jumps.
    pub desired_yaw: f64,
}

/// Reads a value.
pub type Read = Box<dyn Fn(&Instant) -> f64>;

/// The values that a long flight keeps of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kept {
    /// Values of one instant, across columns.
    Samples,
    /// The least and the greatest value.
    Extremes,
}

struct Column {
    name: String,
    kept: Kept,
    read: Read,
    /// Least and greatest of the stretch so far, each with its place.
    held: Option<[(u64, f64); 2]>,
    values: Vec<f32>,
}

/// A track that grows.
pub struct ReportRecorder {
    columns: Vec<Column>,
    /// Ticks that two rows stand for; one tick is one row if this is 1.
    stretch: u64,
    seen: u64,
    period: f64,
    yaw: (f64, f64),
}

impl ReportRecorder {
    /// For a flight of so many ticks, `period` s apart.
    #[must_use]
    pub fn new(ticks: u64, period: f64, columns: Vec<(String, Kept, Read)>) -> Self {
        let stretch = if ticks <= ROWS_MAX { 1 } else { 2 * ticks.div_ceil(ROWS_MAX) };
        let column = |(name, kept, read)| Column { name, kept, read, held: None, values: Vec::new() };
        Self { columns: columns.into_iter().map(column).collect(), stretch, seen: 0, period, yaw: (0.0, 0.0) }
    }

    /// How many ticks lie between two rows.
    #[must_use]
    pub fn ticks_per_row(&self) -> u64 {
        self.stretch.div_ceil(2)
    }

    /// Takes one tick.
    pub fn observe(&mut self, tick: &Tick) {
        let heading = tick.reference.heading.direction();
        let desired = nearest_turn(f64::from(heading.y).atan2(f64::from(heading.x)), self.yaw.1);
        let yaw = nearest_turn(tick.state.yaw(), if self.seen == 0 { desired } else { self.yaw.0 });
        self.yaw = (yaw, desired);
        let instant = Instant { tick, yaw: yaw.to_degrees(), desired_yaw: desired.to_degrees() };
        let place = self.seen % self.stretch;
        for column in &mut self.columns {
            let value = (column.read)(&instant);
            if self.stretch == 1 {
                column.values.push(value as f32);
            } else if column.kept == Kept::Extremes {
                column.hold(place, value, self.stretch);
            } else if place == 0 || place == self.stretch / 2 {
                column.values.push(value as f32);
            }
        }
        self.seen += 1;
    }

    /// The track.
    #[must_use]
    pub fn finish(self, name: &str) -> Track {
        let mut columns: Vec<(String, Vec<f32>)> = Vec::with_capacity(self.columns.len());
        for mut column in self.columns {
            column.release();
            columns.push((column.name, column.values));
        }
        // The last stretch may end before its middle: its start stands for it.
        let rows = columns.iter().map(|(_, values)| values.len()).max().unwrap_or(0);
        columns.iter_mut().for_each(|(_, values)| values.resize(rows, values.last().copied().unwrap_or(f32::NAN)));
        end_beside(&mut columns, "yaw", "yaw_d");
        let step = self.period * self.stretch as f64 / if self.stretch == 1 { 1.0 } else { 2.0 };
        Track { name: name.to_owned(), start: 0.0, step, columns }
    }
}

/// `angle` plus the whole turns that bring it closest to `before`, rad.
fn nearest_turn(angle: f64, before: f64) -> f64 {
    angle + TAU * ((before - angle) / TAU).round()
}

/// Turns a column of degrees by whole turns, so that it ends beside another.
fn end_beside(columns: &mut [(String, Vec<f32>)], name: &str, other: &str) {
    let last = |name: &str| columns.iter().find(|(found, _)| found == name).and_then(|(_, values)| values.last());
    let (Some(ends), Some(beside)) = (last(name), last(other)) else { return };
    let turned = 360.0 * ((beside - ends) / 360.0).round();
    for (_, values) in columns.iter_mut().filter(|(found, _)| found == name) {
        values.iter_mut().for_each(|value| *value += turned);
    }
}

impl Column {
    /// Takes the value at a place of the stretch.
    fn hold(&mut self, place: u64, value: f64, stretch: u64) {
        let here = (place, value);
        self.held = Some(self.held.map_or([here; 2], |[least, greatest]| {
            [if value < least.1 { here } else { least }, if value > greatest.1 { here } else { greatest }]
        }));
        if place + 1 == stretch {
            self.release();
        }
    }

    /// Writes the stretch's extremes, in order of time.
    fn release(&mut self) {
        if let Some([least, greatest]) = self.held.take() {
            let (first, second) = if least.0 <= greatest.0 { (least, greatest) } else { (greatest, least) };
            self.values.extend([first.1 as f32, second.1 as f32]);
        }
    }
}

#[cfg(test)]
mod tests;
