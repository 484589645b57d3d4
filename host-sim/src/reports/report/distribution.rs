//! How a quantity is spread over many flights: a histogram, the share of flights up to each value, a table of
//! quantiles.
//!
//! A page holds no flight's value by itself but `HISTOGRAM_BARS` counts and [`QUANTILE_STEPS`] + 1 evenly spaced
//! quantiles for each group, the least and the greatest among them, whether a hundred flights were flown or a million.

use super::plot::{Color, LinePattern};
use super::prose::{Cell, Table};
use super::track::encoded;
use crate::output::table::{percent, short};
use serde_json::{Value, json};

pub(crate) const HISTOGRAM_BARS: usize = 60;
/// Steps of the distribution function.
pub const QUANTILE_STEPS: usize = 400;

/// A quantity over many flights, in one or several groups.
#[derive(Debug, Clone, PartialEq)]
pub struct Distribution {
    /// Its name.
    pub title: String,
    /// Its unit; empty for a number without one.
    pub unit: String,
    /// Whether the axis of values shows decades; values of zero and below stand at the least positive one.
    pub logarithmic: bool,
    /// The limit of every flight.
    pub bound: Option<f64>,
    /// A name and each flight's value: one group, or one for each law or vehicle. A value that is not finite is a
    /// flight that never came so far; it is counted and not drawn.
    pub groups: Vec<(String, Vec<f64>)>,
    /// The colour of each group, and how its line is drawn; beyond the last come the colours of [`Color::COLOR_CYCLE`].
    pub looks: Vec<(Color, LinePattern)>,
}

impl Distribution {
    /// Its data for the page's program.
    pub fn json(&self) -> Value {
        let sorted: Vec<Vec<f64>> = self.groups.iter().map(|(_, values)| finite(values)).collect();
        let axis = self.axis(&sorted);
        let groups = self.groups.iter().zip(&sorted).enumerate().map(|(place, ((label, values), sorted))| {
            let quantiles: Vec<f32> = (0..=QUANTILE_STEPS).map(|step| quantile(sorted, step) as f32).collect();
            let (color, line) = self.looks.get(place).copied().unwrap_or((Color::at_place(place), LinePattern::Solid));
            json!({ "label": label, "color": color.name(), "line": line.name(), "count": values.len(), "finite": sorted.len(),
                "quantiles": if sorted.is_empty() { String::new() } else { encoded(&quantiles) },
                "bins": self.counts(sorted, axis) })
        });
        json!({ "title": self.title, "unit": self.unit, "logarithmic": self.logarithmic, "bound": self.bound,
            "least": axis.0, "greatest": axis.1, "groups": groups.collect::<Vec<_>>() })
    }

    /// Quantiles of each group, and how many exceed the bound.
    pub fn table(&self) -> Table {
        let head =
            ["group", "flights", "least", "median", "95 %", "99 %", "greatest", "without a value", "above the bound"];
        let mut table = Table::new(format!("{}, in figures", self.title), &head);
        for (label, values) in &self.groups {
            let sorted = finite(values);
            let at = |share: f64| sorted.get(rank(sorted.len(), share)).map_or("none".to_owned(), |v| self.measure(*v));
            let figures = [0.0, 0.5, 0.95, 0.99, 1.0].map(|share| Cell::number(at(share)));
            let above = self.bound.map_or("no bound".to_owned(), |bound| {
                let above = sorted.iter().filter(|value| **value > bound).count();
                format!("{above} ({})", percent(above as f64 / values.len().max(1) as f64))
            });
            let mut row = vec![Cell::text(label.clone()), Cell::number(values.len().to_string())];
            row.extend(figures);
            row.extend([(values.len() - sorted.len()).to_string(), above].map(Cell::Number));
            table.rows.push(row);
        }
        table
    }

    fn measure(&self, value: f64) -> String {
        format!("{} {}", short(value), self.unit).trim_end().to_owned()
    }

    /// The ends of the axis of values: those of all groups, and the bound.
    fn axis(&self, sorted: &[Vec<f64>]) -> (f64, f64) {
        let values = sorted.iter().flatten().copied().chain(self.bound);
        let values = values.filter(|value| !self.logarithmic || *value > 0.0);
        let (least, greatest) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, g), v| (l.min(v), g.max(v)));
        if least > greatest {
            (1.0, 2.0)
        } else if least == greatest {
            (least - 0.5 * least.abs().max(1e-9), greatest + 0.5 * greatest.abs().max(1e-9))
        } else {
            (least, greatest)
        }
    }

    /// How many values fall into each bar.
    fn counts(&self, sorted: &[f64], (least, greatest): (f64, f64)) -> Vec<u64> {
        let mut bins = vec![0; HISTOGRAM_BARS];
        let scaled = |value: f64| if self.logarithmic { value.max(least).ln() } else { value };
        let width = (scaled(greatest) - scaled(least)) / HISTOGRAM_BARS as f64;
        for value in sorted {
            let bin = ((scaled(*value) - scaled(least)) / width) as usize;
            bins[bin.min(HISTOGRAM_BARS - 1)] += 1;
        }
        bins
    }
}

/// The finite values in order.
fn finite(values: &[f64]) -> Vec<f64> {
    let mut values: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    values
}

/// The place, among so many in order, that this share of them lies at or below.
fn rank(count: usize, share: f64) -> usize {
    ((share * count as f64).ceil() as usize).clamp(1, count.max(1)) - 1
}

fn quantile(sorted: &[f64], step: usize) -> f64 {
    sorted.get(rank(sorted.len(), step as f64 / QUANTILE_STEPS as f64)).copied().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;
    use base64::Engine;
    use base64::engine::general_purpose::STANDARD;

    fn distribution(values: Vec<f64>) -> Distribution {
        let groups = vec![("all".to_owned(), values)];
        Distribution {
            title: "t".into(),
            unit: "m".into(),
            logarithmic: false,
            bound: Some(0.9),
            groups,
            looks: vec![(Color::Sky, LinePattern::Dotted)],
        }
    }

    #[test]
    fn every_flight_is_counted_once_and_the_extremes_are_kept() {
        // 0.001 to 1 in an order that is not theirs, and two flights that never came so far.
        let mut values: Vec<f64> = (0..1000).map(|i| f64::from((i * 7) % 1000 + 1) / 1000.0).collect();
        values.extend([f64::NAN, f64::INFINITY]);
        let spread = distribution(values);
        let json = spread.json();
        let group = &json["groups"][0];
        let bins: u64 = group["bins"].as_array().unwrap().iter().map(|bin| bin.as_u64().unwrap()).sum();
        assert_eq!((group["color"].as_str(), group["line"].as_str()), (Some("sky"), Some("dotted")));
        assert_eq!((bins, group["finite"].as_u64(), group["count"].as_u64()), (1000, Some(1000), Some(1002)));
        let bytes = STANDARD.decode(group["quantiles"].as_str().unwrap()).unwrap();
        let quantiles: Vec<f32> = bytes.chunks(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect();
        assert_eq!(
            (quantiles.len(), quantiles[0], quantiles[QUANTILE_STEPS / 2], quantiles[QUANTILE_STEPS]),
            (401, 0.001, 0.5, 1.0)
        );
        let row: Vec<Cell> = spread.table().rows.remove(0);
        let numbers = ["1002", "0.001 m", "0.5 m", "0.95 m", "0.99 m", "1 m", "2", "100 (10.0 %)"];
        assert_eq!(row[1..], numbers.map(Cell::number));
    }

    #[test]
    fn groups_without_values_and_values_all_alike_have_an_axis() {
        for values in [vec![], vec![f64::NAN], vec![0.0; 3], vec![2.0; 3]] {
            for bound in [None, Some(2.0)] {
                for logarithmic in [false, true] {
                    let spread = Distribution { bound, logarithmic, ..distribution(values.clone()) };
                    let json = spread.json();
                    let (least, greatest) = (json["least"].as_f64().unwrap(), json["greatest"].as_f64().unwrap());
                    assert!(least < greatest, "{values:?} {bound:?}: {least} {greatest}");
                    assert!(!logarithmic || least > 0.0, "{values:?} {bound:?}: {least}");
                }
            }
        }
    }
}
