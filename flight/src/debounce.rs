//! Debouncing: a condition counts once it has held for a while without a break.

/// Since when something holds, if it does.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub(super) struct Debounce(Option<u64>);

impl Debounce {
    /// Whether `holds` has been so for `duration` without a break, us; to be called once a tick, at `now`.
    pub fn holds_for(&mut self, holds: bool, duration: u64, now: u64) -> bool {
        self.0 = holds.then(|| self.0.unwrap_or(now));
        self.0.is_some_and(|since| now.saturating_sub(since) >= duration)
    }
}

#[cfg(test)]
mod tests;
