//! The trade between height lost and position gain: every accepted candidate that no other beats in both.

use super::candidate::Verdict;
use super::space::Point;
use crate::table::{aligned, percent, short};

/// Rows a table of it shows at most.
const ROWS: usize = 12;

/// Accepted candidates, least height first, k_p rising with it.
#[derive(Debug, Clone, Default)]
pub struct Frontier {
    members: Vec<(Point, Verdict)>,
}

impl Frontier {
    /// Takes a candidate in, unless another one is at least as good in both respects.
    pub fn offer(&mut self, point: &Point, verdict: &Verdict) {
        let beats = |a: &Verdict, b: &Verdict| a.height_lost <= b.height_lost && a.position_gain >= b.position_gain;
        if self.members.iter().any(|(_, member)| beats(member, verdict)) {
            return;
        }
        self.members.retain(|(_, member)| !beats(verdict, member));
        let place = self.members.partition_point(|(_, member)| member.height_lost < verdict.height_lost);
        self.members.insert(place, (point.clone(), verdict.clone()));
    }

    /// The least height lost, m.
    #[must_use]
    pub fn least_height(&self) -> Option<f64> {
        self.members.first().map(|(_, verdict)| verdict.height_lost)
    }

    /// The candidate of greatest k_p among those that lose at most `height` m.
    #[must_use]
    pub fn greatest_gain_within(&self, height: f64) -> Option<(Point, Verdict)> {
        self.members.iter().take_while(|(_, verdict)| verdict.height_lost <= height).last().cloned()
    }

    /// A table for a terminal, thinned to a dozen rows.
    #[must_use]
    pub fn table(&self) -> String {
        let head = ["height lost [m]", "k_p [1/s^2]", "active constraint", "margin"];
        let mut rows = vec![head.map(str::to_owned).to_vec()];
        let step = self.members.len().div_ceil(ROWS).max(1);
        let last = self.members.len().saturating_sub(1);
        for (index, (_, verdict)) in self.members.iter().enumerate() {
            if index % step == 0 || index == last {
                let (name, margin) =
                    verdict.tightest.map_or(("", f64::NAN), |tightest| (tightest.name, tightest.margin()));
                let numbers = [short(verdict.height_lost), short(verdict.position_gain)];
                rows.push([numbers.to_vec(), vec![name.to_owned(), percent(margin)]].concat());
            }
        }
        aligned(&rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn verdict(height_lost: f64, position_gain: f64) -> Verdict {
        Verdict { violation: 0.0, failed: None, height_lost, position_gain, tightest: None }
    }

    #[test]
    fn it_keeps_what_no_other_beats_in_both_respects() {
        let mut frontier = Frontier::default();
        for (height, gain) in [(5.0, 9.0), (4.0, 5.0), (6.0, 8.0), (4.0, 6.0), (3.0, 1.0)] {
            frontier.offer(&vec![0.0; 10], &verdict(height, gain));
        }
        let kept: Vec<_> = frontier.members.iter().map(|(_, v)| (v.height_lost, v.position_gain)).collect();
        assert_eq!(kept, [(3.0, 1.0), (4.0, 6.0), (5.0, 9.0)]);
        assert_eq!(frontier.greatest_gain_within(4.5).map(|(_, v)| v.position_gain), Some(6.0));
    }
}
