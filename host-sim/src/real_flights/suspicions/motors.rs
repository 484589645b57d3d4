//! Whether motors carry and turn the vehicle as they are said to, and when.

use super::together::{AXES, CORRELATED_MIN, ORDER_BETTER_MIN, correlated, median};
use crate::real_flights::columns::{ColumnMap, MotorMeasure};
use crate::real_flights::flown::{Flown, PERIOD_S};
use crate::real_flights::forces::lagged;
use crate::real_flights::recording::Recording;
use crate::real_flights::torques::{arms, banded, integrals, passing, without};
use controller_core::allocation::Rotors;
use nalgebra::Vector3;

/// Orders that fit nearly as well are named as well, up to so many.
const ORDERS_NAMED_MAX: usize = 3;
/// When commands act, s: before that they cannot, and later no rotor does.
const ACTING_S: [f64; 2] = [-0.03, 0.2];
/// A small rotor's lag, s.
const USUAL_LAG_S: f64 = 0.08;
/// How far apart commands and thrust are sought, s.
const APART_MAX_S: f64 = 1.0;
/// Thrusts by the scenario's curve, over the weight.
const CARRIED: [f64; 2] = [0.4, 2.5];

pub fn battery(recording: &Recording) -> Option<String> {
    let MotorMeasure::Share { full_voltage: Some(full) } = recording.measure else { return None };
    let voltage = median(recording.motors.rows.iter().filter_map(|row| row.last().copied()).collect())?;
    let ratio = voltage / full;
    (!(0.4..1.7).contains(&ratio)).then(|| {
        let hint =
            if (ratio / 1000.0).ln().abs() < 1.0 { "; it looks like mV: write full_voltage in mV as well" } else { "" };
        format!("motors.battery: is {voltage:.2} V beside full_voltage = {full} V{hint}")
    })
}

pub fn carried(recording: &Recording, flown: &Flown, weight: f64) -> Option<String> {
    if let MotorMeasure::Share { .. } = recording.measure {
        let motors = flown.samples.first().map_or(0, |sample| sample.thrusts.len());
        let most = recording.motors.rows.iter().flat_map(|row| row.iter().take(motors)).copied().fold(0.0, f64::max);
        if !(0.05..1.1).contains(&most) {
            return Some(format!(
                "motors.full: commands reach {most:.2e} of it; write full = the greatest number that a motor can have"
            ));
        }
    }
    let thrust = median(flown.samples.iter().map(|sample| sample.thrusts.iter().sum()).collect())?;
    let ratio = thrust / weight;
    let hint = match recording.measure {
        MotorMeasure::Speed if ratio > 20.0 => "; speeds look like rpm: write unit = \"rpm\"",
        MotorMeasure::Speed if ratio < 0.05 => "; speeds look like rad/s: write unit = \"rad/s\"",
        _ => "",
    };
    (!(CARRIED[0]..CARRIED[1]).contains(&ratio)).then(|| {
        format!(
            "motors: by the scenario's rotors they would carry {ratio:.3} of the weight{hint}; look at motors.unit, \
             full, full_voltage, at the scenario's rotors and its mass"
        )
    })
}

/// Thrust follows commands, at once or soon.
pub fn motor_times(flown: &Flown) -> Option<String> {
    let forces: Option<Vec<f64>> = flown.samples.iter().map(|sample| Some(sample.force?.z)).collect();
    let (forces, sums) =
        (banded(&forces?), flown.samples.iter().map(|sample| sample.thrusts.iter().sum()).collect::<Vec<f64>>());
    let sums = banded(&sums);
    let most = (APART_MAX_S / PERIOD_S) as i64;
    let at = |late: i64| {
        let (thrust, force) = if late >= 0 {
            (sums.get(..sums.len() - late as usize), forces.get(late as usize..))
        } else {
            (sums.get(-late as usize..), forces.get(..forces.len() - (-late) as usize))
        };
        (correlated(thrust.unwrap_or_default(), force.unwrap_or_default()), late)
    };
    let (correlation, late) = (-most..=most).map(at).max_by(|a, b| a.0.total_cmp(&b.0))?;
    let late = late as f64 * PERIOD_S;
    (correlation > CORRELATED_MIN && !(ACTING_S[0]..=ACTING_S[1]).contains(&late)).then(|| {
        format!(
            "motors: thrust fits commands best {:.0} ms {} they were written (correlation {correlation:.2}): their \
             times are off; write motors.offset = {:.2}",
            1e3 * late.abs(),
            if late < 0.0 { "BEFORE" } else { "after" },
            late - USUAL_LAG_S
        )
    })
}

/// The order of motors with which they turn the vehicle as it turned.
pub fn motor_order(flown: &Flown, map: &ColumnMap, rotors: &Rotors) -> Option<String> {
    let count = rotors.len();
    let acting = lagged(&flown.samples, [USUAL_LAG_S; 2]);
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    // About each axis: how motors go with one another, and with the turning; and the turning's size.
    let axes: [(Vec<Vec<f64>>, Vec<f64>, f64); 3] = [0, 1, 2].map(|axis| {
        let aside = passing(flown, axis);
        let motor = |index: usize| without(&integrals(acting.iter().map(|thrusts| thrusts[index])), &aside);
        let motors: Vec<Vec<f64>> = (0..count).map(motor).collect();
        let rates: Vec<f64> = flown.samples.iter().map(|sample| sample.rates[axis]).collect();
        let rates = without(&banded(&rates), &aside);
        let together = motors.iter().map(|a| motors.iter().map(|b| dot(a, b)).collect()).collect();
        (together, motors.iter().map(|motor| dot(motor, &rates)).collect(), dot(&rates, &rates).sqrt())
    });
    let arms: Vec<Vector3<f64>> = arms(rotors).collect();
    let score = |order: &[usize]| -> [f64; 3] {
        [0, 1, 2].map(|axis| {
            let (together, with_rates, size) = &axes[axis];
            let along: f64 = order.iter().zip(&arms).map(|(motor, arm)| arm[axis] * with_rates[*motor]).sum();
            let square: f64 = order
                .iter()
                .zip(&arms)
                .flat_map(|(a, arm)| order.iter().zip(&arms).map(move |(b, other)| (a, b, arm[axis] * other[axis])))
                .map(|(a, b, arms)| arms * together[*a][*b])
                .sum();
            along / (square.max(f64::MIN_POSITIVE).sqrt() * size.max(f64::MIN_POSITIVE))
        })
    };
    let given: Vec<usize> = (0..count).collect();
    let here = score(&given);
    let of = |scores: [f64; 3]| scores.iter().sum::<f64>();
    let mut tried: Vec<(f64, Vec<usize>)> = Vec::new();
    let mut order = given;
    permuted(&mut order, 0, &mut |order| {
        let there = of(score(order));
        if there > of(here) + ORDER_BETTER_MIN && there > 2.0 * CORRELATED_MIN {
            tried.push((there, order.to_vec()));
        }
    });
    tried.sort_by(|a, b| b.0.total_cmp(&a.0));
    if let Some(best) = tried.first().map(|(best, _)| *best) {
        let name = |motor: &usize| {
            map.motors.0.columns.get(*motor).map_or("?".to_owned(), |column| format!("{:?}", column.name))
        };
        let likely = tried.iter().take_while(|(there, _)| *there > best - ORDER_BETTER_MIN).take(ORDERS_NAMED_MAX);
        let orders = likely.map(|(_, order)| format!("[{}]", order.iter().map(name).collect::<Vec<_>>().join(", ")));
        return Some(format!(
            "motors.columns: the vehicle turns as if rotors were in another order (correlations of {best:.2} in all, \
             {:.2} as written): write columns = {}",
            of(here),
            orders.collect::<Vec<_>>().join(", or ")
        ));
    }
    let against: Vec<&str> = (0..3).filter(|axis| here[*axis] < -CORRELATED_MIN).map(|axis| AXES[axis]).collect();
    (!against.is_empty()).then(|| {
        format!(
            "rotors: the vehicle turns against them about {}: look at rotors.spin and rotors.position",
            against.join(", ")
        )
    })
}

/// Calls `see` with each order of the elements from `first` on.
fn permuted(order: &mut Vec<usize>, first: usize, see: &mut impl FnMut(&[usize])) {
    if first + 1 >= order.len() {
        return see(order);
    }
    for place in first..order.len() {
        order.swap(first, place);
        permuted(order, first + 1, see);
        order.swap(first, place);
    }
}
