//! The trade between height lost and gusts: every accepted candidate that no other beats in both.

use super::candidate::Verdict;
use super::space::Point;
use crate::table::{aligned, percent, short};

/// Rows a table of it shows at most.
const ROWS: usize = 12;

/// Accepted candidates, least height first, the excursion in a gust falling with it.
#[derive(Debug, Clone, Default)]
pub struct Frontier {
    members: Vec<(Point, Verdict)>,
}

impl Frontier {
    /// Takes a candidate in, unless another one is at least as good in both respects.
    pub fn offer(&mut self, point: &Point, verdict: &Verdict) {
        let beats =
            |a: &Verdict, b: &Verdict| a.shown.height_lost <= b.shown.height_lost && a.shown.gust <= b.shown.gust;
        if self.members.iter().any(|(_, member)| beats(member, verdict)) {
            return;
        }
        self.members.retain(|(_, member)| !beats(verdict, member));
        let height = verdict.shown.height_lost;
        let place = self.members.partition_point(|(_, member)| member.shown.height_lost < height);
        self.members.insert(place, (point.clone(), verdict.clone()));
    }

    /// The least height lost, m.
    #[must_use]
    pub fn least_height(&self) -> Option<f64> {
        self.members.first().map(|(_, verdict)| verdict.shown.height_lost)
    }

    /// A table for a terminal, thinned to a dozen rows.
    #[must_use]
    pub fn table(&self) -> String {
        let head = ["height lost [m]", "gust [m]", "step [s]", "activity [N]", "cost", "active constraint", "margin"];
        let mut rows = vec![head.map(str::to_owned).to_vec()];
        let step = self.members.len().div_ceil(ROWS).max(1);
        let last = self.members.len().saturating_sub(1);
        for (index, (_, verdict)) in self.members.iter().enumerate() {
            if index % step == 0 || index == last {
                let (name, margin) =
                    verdict.tightest.map_or(("", f64::NAN), |tightest| (tightest.name, tightest.margin()));
                let shown = &verdict.shown;
                let numbers = [shown.height_lost, shown.gust, shown.step, shown.activity, verdict.cost].map(short);
                rows.push([numbers.to_vec(), vec![name.to_owned(), percent(margin)]].concat());
            }
        }
        aligned(&rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_keeps_what_no_other_beats_in_both_respects() {
        let mut frontier = Frontier::default();
        for (height, gust) in [(5.0, 1.0), (4.0, 5.0), (6.0, 2.0), (4.0, 4.0), (3.0, 9.0)] {
            let mut verdict = Verdict::missing();
            (verdict.shown.height_lost, verdict.shown.gust) = (height, gust);
            frontier.offer(&vec![0.0; 10], &verdict);
        }
        let kept: Vec<_> = frontier.members.iter().map(|(_, v)| (v.shown.height_lost, v.shown.gust)).collect();
        assert_eq!(kept, [(3.0, 9.0), (4.0, 4.0), (5.0, 1.0)]);
        assert_eq!(frontier.least_height(), Some(3.0));
    }
}
