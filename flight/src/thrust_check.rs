//! The rotors' thrust over the commanded thrust, as a check of battery, mass and thrust curve.
//!
//! The law learns a steady lack of thrust as a vertical force and the rest as its thrust scale;
//! `Chain::delivered_share` puts the two together. With a compensated battery, the right mass and the right curve the
//! share stays near 1; vertical wind moves it by its acceleration over gravity. A share further off than
//! [`THRUST_SHARE_ERROR_MAX`] for [`THRUST_DEBOUNCE_US`] is reported, before the estimates reach their limits.

/// The distance of the share from 1 beyond which it is doubtful.
pub const THRUST_SHARE_ERROR_MAX: f32 = 0.15;

/// The time for which the share is doubtful before it is reported: the estimates take 2 s after lift-off to settle.
pub const THRUST_DEBOUNCE_US: u64 = 3_000_000;

/// The time between two reports.
pub const THRUST_REPORT_INTERVAL_US: u64 = 10_000_000;

/// The time of the next report.
#[derive(Debug, Default, PartialEq)]
pub(super) struct ThrustCheck {
    /// When to report, us; `None` while all is well.
    due: Option<u64>,
}

impl ThrustCheck {
    /// The share, in a tick in which it is to be reported. Without a flight there is no share.
    pub fn tick(&mut self, share: Option<f32>, now: u64) -> Option<f32> {
        let doubtful = share.filter(|share| share.is_nan() || (share - 1.0).abs() > THRUST_SHARE_ERROR_MAX);
        let due = *self.due.get_or_insert(now.saturating_add(THRUST_DEBOUNCE_US));
        if doubtful.is_none() {
            self.due = None;
        } else if now >= due {
            self.due = Some(now.saturating_add(THRUST_REPORT_INTERVAL_US));
            return doubtful;
        }
        None
    }
}

#[cfg(test)]
mod tests;
