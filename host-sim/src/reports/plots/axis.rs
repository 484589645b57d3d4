//! An axis: its ends, the round numbers on it, and how these are written. The page's `chart.js` has the same rules.

use crate::reports::report::plot::Plot;

/// From one end to the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    /// The low end.
    pub least: f64,
    /// The high end.
    pub greatest: f64,
    /// Whether decades are evenly spaced.
    pub logarithmic: bool,
}

impl Axis {
    /// The vertical axis of `plot`, whose curves reach so far: what is shown, what is proven, other bounds unless they
    /// would flatten it, and room beyond.
    #[must_use]
    pub fn vertical(plot: &Plot, values: impl Iterator<Item = f64>) -> Self {
        let logarithmic = plot.logarithmic;
        let seen = values.filter(|value| value.is_finite() && (!logarithmic || *value > LOGARITHMIC_AXIS_MIN));
        let reached = seen.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, g), value| (l.min(value), g.max(value)));
        let reached = if reached.0 <= reached.1 { reached } else { (1.0, 1.0) };
        let most = 8.0 * (reached.1 - reached.0).max(1e-12);
        let (mut least, mut greatest) = reached;
        for bound in &plot.bounds {
            let (low, high) = (least.min(bound.value), greatest.max(bound.value));
            if bound.always || logarithmic || high.max(reached.1) - low.min(reached.0) <= most {
                (least, greatest) = (low, high);
            }
        }
        if logarithmic {
            // A decade that single precision misses by a hair is reached.
            let low = (least.max(LOGARITHMIC_AXIS_MIN).log10() + 1e-6).floor();
            return Self {
                least: 10f64.powf(low),
                greatest: 10f64.powf((greatest.log10() - 1e-6).ceil().max(low + 1.0)),
                logarithmic,
            };
        }
        if plot.from_zero {
            (least, greatest) = (least.min(0.0), greatest.max(0.0));
        }
        let flat = greatest - least <= 1e-9 * greatest.abs().max(1e-6);
        let room = match 0.1 * greatest.abs() {
            _ if !flat => 0.07 * (greatest - least),
            0.0 => 1.0,
            room => room,
        };
        Self { least: least - room, greatest: greatest + room, logarithmic }
    }

    /// How far along the axis a value lies, from 0 to 1.
    #[must_use]
    pub fn share(&self, value: f64) -> f64 {
        if self.logarithmic {
            (value.max(self.least) / self.least).ln() / (self.greatest / self.least).ln()
        } else {
            (value - self.least) / (self.greatest - self.least)
        }
    }

    /// Round numbers between the ends, about so many at most, each as it is written.
    #[must_use]
    pub fn marks(&self, most: f64) -> Vec<(f64, String)> {
        if self.logarithmic {
            let (low, high) =
                ((self.least.log10() - 1e-9).ceil() as i32, (self.greatest.log10() + 1e-9).floor() as i32);
            let step = (f64::from(high - low + 1) / most.max(1.0)).ceil().max(1.0) as usize;
            return (low..=high)
                .step_by(step)
                .map(|power| (10f64.powi(power), format!("10{}", raised(power))))
                .collect();
        }
        let rough = (self.greatest - self.least) / most.max(1.0);
        let power = 10f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0].map(|factor| factor * power).into_iter().find(|step| *step >= rough * (1.0 - 1e-9));
        let step = step.unwrap_or(10.0 * power);
        let decimals = (-(step.log10() + 1e-9).floor()).clamp(0.0, 6.0) as usize;
        let (first, last) = ((self.least / step - 1e-9).ceil() as i64, (self.greatest / step + 1e-9).floor() as i64);
        let written = |place: i64| {
            let value = place as f64 * step;
            let text = if place == 0 { "0".to_owned() } else { format!("{value:.decimals$}") };
            (value, text.replace('-', "−"))
        };
        (first..=last).map(written).collect()
    }
}

/// Below this an error on a logarithmic axis is single precision's noise, and drawn at the low end.
const LOGARITHMIC_AXIS_MIN: f64 = 1e-7;

/// An exponent as it is written above the line.
fn raised(power: i32) -> String {
    let digits = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let digit = |c: char| c.to_digit(10).and_then(|digit| digits.get(digit as usize).copied()).unwrap_or('⁻');
    power.to_string().chars().map(digit).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(axis: Axis, most: f64) -> Vec<String> {
        axis.marks(most).into_iter().map(|(_, text)| text).collect()
    }

    #[test]
    fn round_numbers_read_well_and_both_ends_of_decades_have_them() {
        let linear = |least, greatest| Axis { least, greatest, logarithmic: false };
        assert_eq!(written(linear(-0.3, 0.55), 5.0), ["−0.2", "0", "0.2", "0.4"]);
        assert_eq!(written(linear(0.0, 40.0), 9.0), ["0", "5", "10", "15", "20", "25", "30", "35", "40"]);
        assert_eq!(written(Axis { least: 1e-4, greatest: 1e2, logarithmic: true }, 9.0).first().unwrap(), "10⁻⁴");
        assert_eq!(written(Axis { least: 1e-4, greatest: 1e2, logarithmic: true }, 9.0).last().unwrap(), "10²");
    }

    #[test]
    fn an_axis_holds_its_curves_and_what_is_proven_and_zero_where_asked() {
        use crate::reports::report::plot::{Bound, Color};
        let bound = |value, always| Bound { value, label: String::new(), color: Color::Ink, always };
        let plot = Plot::new("", "N", Vec::new()).from_zero().within(vec![bound(6.0, true), bound(1e3, false)]);
        let axis = Axis::vertical(&plot, [3.0, f64::NAN, 5.0].into_iter());
        assert!(axis.least < 0.0 && axis.greatest > 6.0 && axis.greatest < 7.0, "{axis:?}");
        let decades = Plot::new("", "m", Vec::new()).logarithmic();
        let axis = Axis::vertical(&decades, [f64::from(1e-4_f32), f64::from(1e2_f32)].into_iter());
        assert_eq!((axis.least, axis.greatest), (1e-4, 1e2));
        for values in [vec![], vec![0.0], vec![-2.0, -2.0], vec![f64::NAN]] {
            for plot in [Plot::new("", "", Vec::new()), Plot::new("", "", Vec::new()).logarithmic()] {
                let axis = Axis::vertical(&plot, values.iter().copied());
                assert!(axis.least < axis.greatest && axis.least.is_finite(), "{values:?}: {axis:?}");
            }
        }
    }
}
