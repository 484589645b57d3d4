//! Debouncing: a condition counts once it has held for a while without a break.

/// Since when something holds, if it does.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub(super) struct Debounce(Option<u64>);

impl Debounce {
    /// Whether `holds` has been so for `duration` without a break, us; asked at `now`, once a tick.
    pub fn holds_for(&mut self, holds: bool, duration: u64, now: u64) -> bool {
        self.0 = holds.then(|| self.0.unwrap_or(now));
        self.0.is_some_and(|since| now.saturating_sub(since) >= duration)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_break_begins_it_anew() {
        let mut debounce = Debounce::default();
        assert!(
            !debounce.holds_for(true, 20, 100)
                && !debounce.holds_for(true, 20, 119)
                && debounce.holds_for(true, 20, 120)
        );
        assert!(!debounce.holds_for(false, 0, 121));
        assert!(!debounce.holds_for(true, 20, 130) && debounce.holds_for(true, 20, 150));
        assert!(Debounce::default().holds_for(true, 0, 5));
    }
}
