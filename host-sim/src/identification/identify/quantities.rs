//! A vehicle's numbers from flight and bench together, each with its uncertainty.
//!
//! A flight shows c/m and c/J_i; a scale shows m; a bifilar swing shows J_i/m; a thrust stand shows c. In logarithms
//! all of these are linear, so they are combined by weighted least squares, unless they contradict each other
//! ([`super::agreement`]). Without a scale or a stand, m and c are not observable apart: then the file's mass is used.
//!
//! Each *interval* is the estimate and so many standard uncertainties to either side ([`student_t`]). The report states
//! sixteen quantities at once, and all true values together are to be in their intervals in 95 of 100 flights.
//! Bonferroni's inequality asks of each of them 1 - 0.05 / 16, whatever their correlation. An uncertainty from a few
//! parts of a flight is itself uncertain: errors over uncertainties follow Student's t with one degree of freedom less
//! than there are parts. With the 16 parts of 80 s, 1 - 0.05 / 16 of those are within 3.515, with 4 within 8.768. A
//! delay's interval follows from that of the whole delay and that of the lag, so it misses only where one of them does.

use super::agreement::{Entry, Known, contradiction};
use super::bench::Bench;
use super::fit::Fit;
use super::model::{CENTRE_INDEX, DRAG_INDEX, SQUARED_LAG_INDEX, STRENGTH_INDEX, WHOLE_DELAY_INDEX};
use super::student_t;
use controller_core::vehicle::Vehicle;
use nalgebra::{SMatrix, SVector};

/// Of the file's mass where no bench gives it: as good as exact.
const FILE_MASS_UNCERTAINTY_SHARE: f64 = 1e-6;

/// One number of a vehicle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// The estimate.
    pub value: f64,
    /// Its standard uncertainty.
    pub uncertainty: f64,
    /// The least and the greatest value that are within the stated uncertainty.
    pub interval: [f64; 2],
}

impl Quantity {
    fn new(value: f64, uncertainty: f64, coverage: f64) -> Self {
        let wide = coverage * uncertainty;
        Self { value, uncertainty, interval: [value - wide, value + wide] }
    }

    /// `unit` times e to the power of the logarithm.
    fn exponential(logarithm: f64, uncertainty: f64, unit: f64, coverage: f64) -> Self {
        let at = |deviations: f64| unit * (logarithm + deviations * uncertainty).exp();
        Self { value: at(0.0), uncertainty: at(0.0) * uncertainty, interval: [at(-coverage), at(coverage)] }
    }

    /// Whether a value is within the stated uncertainty.
    #[must_use]
    pub fn holds(&self, value: f64) -> bool {
        let [least, greatest] = self.interval;
        (least..=greatest).contains(&value)
    }
}

/// All identified numbers of a vehicle.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantities {
    /// kg.
    pub mass: Quantity,
    /// The thrust scale: thrust and drag torque over the file's.
    pub thrust_scale: Quantity,
    /// c/m, 1/kg: observable in flight alone.
    pub scale_over_mass: Quantity,
    /// kg m^2.
    pub inertia: [Quantity; 3],
    /// J_i/c, kg m^2: observable in flight alone.
    pub inertia_over_scale: [Quantity; 3],
    /// Lag and delay together, s.
    pub whole_delay: Quantity,
    /// s.
    pub lag: Quantity,
    /// s.
    pub delay: Quantity,
    /// x and y, m, from the file's.
    pub centre_of_mass: [Quantity; 2],
    /// kg/s along the body's axes.
    pub drag: [Quantity; 3],
    /// Whether the mass was weighed, or follows from a thrust stand.
    pub mass_is_measured: bool,
    /// Standard uncertainties from an estimate to either end of its interval.
    pub coverage: f64,
    /// How bench and flight contradict each other, in words.
    pub contradiction: Option<String>,
}

impl Quantities {
    /// Combines `fit` and `bench` for a vehicle whose model is `vehicle`; the log's rates were late by `late`, s.
    ///
    /// # Errors
    /// If the two cannot be combined; finite numbers can.
    pub fn combined(fit: &Fit, bench: &Bench, vehicle: &Vehicle, late: f64) -> Result<Self, String> {
        let (unknowns, covariance) = (&fit.unknowns, &fit.covariance);
        let coverage = student_t::coverage(fit.blocks);
        let direct = |index: usize| Quantity::new(unknowns[index], covariance[(index, index)].sqrt(), coverage);
        let (Known { values, covariance: spread }, contradiction) =
            logarithms(fit, bench, vehicle).ok_or("flight and bench cannot be combined")?;
        let deviation = |index: usize| f64::max(spread[(index, index)], 0.0).sqrt();
        let mass_0 = f64::from(vehicle.mass);
        let of_bench = |index: usize, unit: f64| Quantity::exponential(values[index], deviation(index), unit, coverage);
        let mass = of_bench(0, mass_0);
        let over_scale = |axis: usize| {
            let known = direct(1 + axis);
            Quantity::exponential(-known.value, known.uncertainty, f64::from(vehicle.inertia[axis]), coverage)
        };
        let strength = direct(STRENGTH_INDEX);
        let whole = direct(WHOLE_DELAY_INDEX);
        let whole_delay = Quantity::new(whole.value - late, whole.uncertainty, coverage);
        let lag = lag(&direct(SQUARED_LAG_INDEX), &whole, coverage);
        let drag = |axis: usize| {
            let of_mass = direct(DRAG_INDEX + axis);
            let relative = mass.uncertainty / mass.value * of_mass.value;
            Quantity::new(mass.value * of_mass.value, mass.value * of_mass.uncertainty.hypot(relative), coverage)
        };
        Ok(Self {
            mass,
            thrust_scale: of_bench(1, 1.0),
            scale_over_mass: Quantity::exponential(strength.value, strength.uncertainty, 1.0 / mass_0, coverage),
            inertia: [0, 1, 2].map(|axis| of_bench(2 + axis, f64::from(vehicle.inertia[axis]))),
            inertia_over_scale: [0, 1, 2].map(over_scale),
            whole_delay,
            lag,
            delay: delay(&lag, &whole_delay, coverage),
            centre_of_mass: [direct(CENTRE_INDEX), direct(CENTRE_INDEX + 1)],
            drag: [0, 1, 2].map(drag),
            mass_is_measured: bench.mass.is_some() || bench.thrust_scale.is_some(),
            coverage,
            contradiction,
        })
    }
}

/// Between the bounds from the squared lag: not below zero, and not above the whole. That is the whole as it was
/// flown: rates are late by what is counted for them or less, so without that the lag of a vehicle that acts at once
/// would be cut short.
fn lag(squared: &Quantity, whole: &Quantity, coverage: f64) -> Quantity {
    let root = |value: f64| value.max(0.0).sqrt().min(whole.interval[1].max(0.0));
    let interval = squared.interval.map(root);
    from_interval(root(squared.value).min(whole.value).max(interval[0]), interval, coverage)
}

/// The rest of the whole.
fn delay(lag: &Quantity, whole: &Quantity, coverage: f64) -> Quantity {
    let [least, greatest] = [whole.interval[0] - lag.interval[1], whole.interval[1] - lag.interval[0]];
    from_interval((whole.value - lag.value).max(0.0), [least.max(0.0), greatest.max(0.0)], coverage)
}

fn from_interval(value: f64, interval: [f64; 2], coverage: f64) -> Quantity {
    Quantity { value, uncertainty: (interval[1] - interval[0]) / (2.0 * coverage), interval }
}

/// Flight and bench combined, and in words how they contradict each other, if they do.
fn logarithms(fit: &Fit, bench: &Bench, vehicle: &Vehicle) -> Option<(Known, Option<String>)> {
    const LOGARITHM_SHARES: [[f64; 5]; 4] = [
        [-1.0, 1.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, -1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, -1.0, 0.0],
        [0.0, 1.0, 0.0, 0.0, -1.0],
    ];
    let flown = SMatrix::<f64, 4, 4>::from_fn(|i, j| fit.covariance[(i, j)]).try_inverse()?;
    let shares = SMatrix::<f64, 4, 5>::from_fn(|i, j| LOGARITHM_SHARES[i][j]);
    let values = SVector::<f64, 4>::from_fn(|i, _| fit.unknowns[i]);
    let mut information = shares.transpose() * flown * shares;
    let mut pull = shares.transpose() * flown * values;
    let entries = entries(bench, vehicle);
    for Entry { row, value, deviation, .. } in &entries {
        let row = row / *deviation;
        information += row * row.transpose();
        pull += row * (value / deviation);
    }
    let covariance = information.try_inverse()?;
    let known = Known { values: covariance * pull, covariance };
    let left = values - shares * known.values;
    let freedom = (LOGARITHM_SHARES.len() + entries.len()).saturating_sub(known.values.len());
    let contradiction = contradiction(&entries, &known, left.dot(&(flown * left)), freedom, fit.blocks);
    Some((known, contradiction))
}

/// The bench's logarithms; with the file's mass if the bench gives neither mass nor thrust scale.
fn entries(bench: &Bench, vehicle: &Vehicle) -> Vec<Entry> {
    let mass = f64::from(vehicle.mass);
    let entry = |name: &str, row: [f64; 5], value: f64, deviation: f64| Entry {
        name: name.to_owned(),
        row: row.into(),
        value,
        deviation,
    };
    let (of_mass, of_scale) = ([1.0, 0.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0, 0.0]);
    let mut entries = Vec::new();
    match (bench.mass, bench.thrust_scale) {
        (Some(weighed), _) => entries.push(entry("weighing", of_mass, (weighed.value / mass).ln(), weighed.relative())),
        (None, None) => entries.push(entry("the file's vehicle.mass", of_mass, 0.0, FILE_MASS_UNCERTAINTY_SHARE)),
        (None, Some(_)) => {}
    }
    if let Some(scale) = bench.thrust_scale {
        entries.push(entry("thrust_stand", of_scale, scale.value.ln(), scale.relative()));
    }
    for swing in &bench.swings {
        let mut row = [-1.0, 0.0, 0.0, 0.0, 0.0];
        row[2 + swing.axis] = 1.0;
        let of_file = f64::from(vehicle.inertia[swing.axis]) / mass;
        let name = format!("swing about {}", ["x", "y", "z"][swing.axis]);
        entries.push(entry(&name, row, (swing.over_mass.value / of_file).ln(), swing.over_mass.relative()));
    }
    entries
}
