//! Whether the accelerometer carries the weight and feels the drag, and positions accelerate as it says.

use super::together::{AXES, CORRELATED_MIN, ORDER_BETTER_MIN, SCALE_FACTOR, correlated, median, variance};
use crate::real_flights::columns::{ColumnMap, STANDARD_GRAVITY};
use crate::real_flights::flown::{Flown, PERIOD_S};
use nalgebra::Vector3;

/// Without an accelerometer: speed changes as gravity and rotors allow.
pub fn speed_unit(flown: &Flown) -> Option<String> {
    let size = median(flown.samples.iter().filter_map(|sample| Some(sample.force?.norm())).collect())?;
    let is_off = (size / STANDARD_GRAVITY).ln().abs() > SCALE_FACTOR.ln();
    (!flown.is_felt && is_off).then(|| {
        format!("pose.position: moves as if {size:.1} m/s^2 carried the weight: look at pose.unit, and at time.unit")
    })
}

pub fn force_unit(flown: &Flown) -> Option<String> {
    if !flown.is_felt {
        return None;
    }
    let size = median(flown.samples.iter().filter_map(|sample| Some(sample.force?.norm())).collect())?;
    if (size / STANDARD_GRAVITY).ln().abs() < SCALE_FACTOR.ln() {
        return None;
    }
    let units = [(1.0, "m/s^2"), (STANDARD_GRAVITY, "g"), (1e-3 * STANDARD_GRAVITY, "mg")];
    let fits = |(from, _): &(f64, &str)| {
        units.iter().find(|(to, _)| (size / from * to / STANDARD_GRAVITY).ln().abs() < 0.2 && from != to)
    };
    let advice = units.iter().find_map(|from| fits(from).map(|to| (from.1, to.1)));
    let advice = advice.map_or(String::new(), |(from, to)| {
        format!("; in {to}, read as {from}, they would: write force_unit = \"{to}\"")
    });
    Some(format!("imu.force: is {size:.3} m/s^2 in flight and does not carry the weight{advice}"))
}

/// Drag is against the velocity, along each axis across the thrust; thrust along z.
pub fn force_axes(flown: &Flown, map: &ColumnMap) -> Option<String> {
    if !flown.is_felt {
        return None;
    }
    let forces: Vec<Vector3<f64>> = flown.samples.iter().map(|sample| sample.force).collect::<Option<_>>()?;
    let mean = forces.iter().sum::<Vector3<f64>>() / forces.len() as f64;
    let name = |axis: usize| map.imu.columns.get(3 + axis).map_or("?", |column| &*column.name);
    let along = mean.iamax();
    if along != 2 || mean.z < 0.0 {
        let sign = if (mean[along] < 0.0) != (along > 0 && map.z_down) { "-" } else { "" };
        return Some(format!(
            "imu.force: the weight is carried along {}{}, not along z: the column for z looks like \"{sign}{}\"",
            if mean[along] < 0.0 { "-" } else { "" },
            AXES[along],
            name(along)
        ));
    }
    let body: Vec<Vector3<f64>> =
        flown.samples.iter().map(|sample| sample.attitude.inverse_transform_vector(&sample.velocity)).collect();
    let correlation = |force: usize, axis: usize| {
        correlated(
            &forces.iter().map(|vector| vector[force]).collect::<Vec<_>>(),
            &body.iter().map(|vector| -vector[axis]).collect::<Vec<_>>(),
        )
    };
    let given = correlation(0, 0) + correlation(1, 1);
    let others = [
        (correlation(1, 0) + correlation(0, 1), "x and y exchanged"),
        (-correlation(1, 0) + correlation(0, 1), "x and y exchanged, the first with a minus"),
        (correlation(1, 0) - correlation(0, 1), "x and y exchanged, the second with a minus"),
        (-correlation(1, 0) - correlation(0, 1), "x and y exchanged, both with a minus"),
        (-correlation(0, 0) + correlation(1, 1), "x with a minus"),
        (correlation(0, 0) - correlation(1, 1), "y with a minus"),
        (-correlation(0, 0) - correlation(1, 1), "x and y with a minus"),
    ];
    let best = others.into_iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
    (best.0 > 2.0 * CORRELATED_MIN && best.0 > given + ORDER_BETTER_MIN)
        .then(|| format!("imu.force, or pose.position: drag is against the velocity only with {}", best.1))
}

/// Positions accelerate across as the accelerometer says; their tilt, which was found by it, left in.
pub fn places(flown: &Flown) -> Option<String> {
    if !flown.is_felt {
        return None;
    }
    const SPAN_SAMPLES: usize = 20;
    let mut both: [[Vec<f64>; 2]; 2] = Default::default();
    for window in flown.samples.windows(SPAN_SAMPLES + 1).step_by(SPAN_SAMPLES / 2) {
        let felt = window.iter().take(SPAN_SAMPLES).map(|sample| {
            let attitude = sample.attitude * flown.tilt.inverse();
            Some((attitude * sample.force? - Vector3::z() * STANDARD_GRAVITY) * PERIOD_S)
        });
        let felt: Vector3<f64> = felt.sum::<Option<_>>()?;
        let seen = window[SPAN_SAMPLES].velocity - window[0].velocity;
        for (axis, [all_felt, all_seen]) in both.iter_mut().enumerate() {
            all_felt.push(felt[axis]);
            all_seen.push(seen[axis]);
        }
    }
    let correlation = both.iter().map(|[felt, seen]| correlated(felt, seen)).sum::<f64>() / 2.0;
    let size = |which: usize| both.iter().map(|axis| variance(&axis[which])).sum::<f64>();
    let scale = (size(1) / size(0).max(f64::MIN_POSITIVE)).sqrt();
    if correlation < CORRELATED_MIN {
        return Some(format!(
            "pose.position: its acceleration has nothing to do with the accelerometer's (correlation {correlation:.2}, \
             {scale:.3} times as great): another order of axes, or another attitude"
        ));
    }
    let units = [
        (1000.0, "mm, read as m: write unit = \"mm\""),
        (100.0, "cm, read as m: write unit = \"cm\""),
        (0.001, "m, read as mm: write unit = \"m\""),
        (0.01, "m, read as cm: write unit = \"m\""),
        (3.281, "feet: convert them"),
    ];
    let near = |factor: f64| (scale / factor).ln().abs() < 0.35;
    let (_, unit) = units.iter().find(|(factor, _)| near(*factor))?;
    Some(format!("pose.position: moves {scale:.3} times as far as the accelerometer says: it looks like {unit}"))
}
