//! For how long something has been so.

/// Since when something holds, if it does.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub(super) struct Lasting(Option<u64>);

impl Lasting {
    /// Whether `holds` has been so for `duration` without a break, us; asked at `now`, once a tick.
    pub fn is_so(&mut self, holds: bool, duration: u64, now: u64) -> bool {
        self.0 = holds.then(|| self.0.unwrap_or(now));
        self.0.is_some_and(|since| now.saturating_sub(since) >= duration)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_break_begins_it_anew() {
        let mut lasting = Lasting::default();
        assert!(!lasting.is_so(true, 20, 100) && !lasting.is_so(true, 20, 119) && lasting.is_so(true, 20, 120));
        assert!(!lasting.is_so(false, 0, 121));
        assert!(!lasting.is_so(true, 20, 130) && lasting.is_so(true, 20, 150));
        assert!(Lasting::default().is_so(true, 0, 5));
    }
}
