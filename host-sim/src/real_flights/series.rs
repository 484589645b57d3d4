//! A stream of numbers on its own times.
//!
//! A row that repeats the one before shows nothing new: whoever wrote the file held the last sample. It is left out, so
//! that a held sample is not taken for a vehicle that stands still. What commands and setpoints hold, they mean.

use super::numbers::Rows;

/// The rows of a stream, times increasing.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// s.
    pub times: Vec<f64>,
    pub rows: Vec<Vec<f64>>,
    /// Rows that were left out, of all.
    pub repeated: usize,
    pub all: usize,
    /// The longest time between two rows, s.
    pub gap: f64,
}

impl Series {
    /// # Errors
    /// If times run back.
    pub fn new(rows: Rows, keeps_repeats: bool) -> Result<Self, String> {
        let all = rows.len();
        let (mut times, mut kept): (Vec<f64>, Vec<Vec<f64>>) = (Vec::with_capacity(all), Vec::with_capacity(all));
        for (time, row) in rows {
            match times.last() {
                Some(last) if time < *last => return Err(format!("time runs back from {last} to {time} s")),
                Some(last) if time == *last => {}
                _ if !keeps_repeats && kept.last() == Some(&row) => {}
                _ => {
                    times.push(time);
                    kept.push(row);
                }
            }
        }
        let gap = times.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
        Ok(Self { repeated: all - times.len(), all, gap, times, rows: kept })
    }

    pub fn first(&self) -> f64 {
        self.times.first().copied().unwrap_or(f64::INFINITY)
    }

    pub fn last(&self) -> f64 {
        self.times.last().copied().unwrap_or(f64::NEG_INFINITY)
    }

    /// The usual time between two rows, s.
    pub fn period(&self) -> f64 {
        let mut steps: Vec<f64> = self.times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        steps.sort_by(f64::total_cmp);
        steps.get(steps.len() / 2).copied().unwrap_or(f64::INFINITY)
    }

    /// Between two rows on a straight line; none outside them, or in a gap of more than `gap_max`, s.
    pub fn at(&self, time: f64, gap_max: f64) -> Option<Vec<f64>> {
        let next = self.times.partition_point(|row| *row < time);
        let (after, next_row) = (*self.times.get(next)?, self.rows.get(next)?);
        if after == time {
            return Some(next_row.clone());
        }
        let last = next.checked_sub(1)?;
        let (before, last_row) = (*self.times.get(last)?, self.rows.get(last)?);
        if after - before > gap_max {
            return None;
        }
        let share = (time - before) / (after - before);
        Some(last_row.iter().zip(next_row).map(|(a, b)| a + (b - a) * share).collect())
    }

    /// What was written last, at most `age_max` ago, s.
    pub fn held(&self, time: f64, age_max: f64) -> Option<&[f64]> {
        let last = self.times.partition_point(|row| *row <= time).checked_sub(1)?;
        (time - self.times.get(last)? <= age_max).then(|| self.rows.get(last).map(Vec::as_slice))?
    }

    /// In words: how many rows, how often, what is missing.
    pub fn described(&self) -> String {
        let rate = 1.0 / self.period();
        let gaps = self.times.windows(2).filter(|pair| pair[1] - pair[0] > 2.5 * self.period()).count();
        let mut text = format!("{} rows, {rate:.0} Hz", self.times.len());
        if self.repeated > 0 {
            text +=
                &format!(", {:.1} % repeated or at one time: left out", 100.0 * self.repeated as f64 / self.all as f64);
        }
        if gaps > 0 {
            text += &format!(", {gaps} gaps, {:.0} ms at most", 1e3 * self.gap);
        }
        text
    }
}
