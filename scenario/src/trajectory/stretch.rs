//! By how much the times of a path must grow for its derivatives to fit.
//!
//! A path flown k times as slowly takes 1/k of its velocities, 1/k^2 of its accelerations, 1/k^3 of its jerk and 1/k^4
//! of its snap, on the same line.

use controller_core::error::ParameterError;
use controller_core::reference::knot::Knot;
use controller_core::reference::path::Path;
use controller_core::reference::segment::Segment;
use controller_core::reference::{ReferenceBounds, Trajectory};

/// The order of each bound of [`ReferenceBounds`]: speed, both accelerations, jerk, snap, the heading's two.
const BOUND_ORDERS: [i32; ReferenceBounds::COUNT] = [1, 2, 2, 3, 4, 1, 2];

/// The least k >= 0 with which `own` lies within `allowed`; infinite if one of these is zero and is needed.
#[must_use]
pub fn stretch(own: &ReferenceBounds, allowed: &ReferenceBounds) -> f64 {
    let each = own.values().into_iter().zip(allowed.values()).zip(BOUND_ORDERS).map(|((own, allowed), order)| {
        if own <= 0.0 { 0.0 } else { (f64::from(own) / f64::from(allowed)).powf(1.0 / f64::from(order)) }
    });
    each.fold(0.0, f64::max)
}

/// The bounds of the same path flown `k` times as slowly.
#[must_use]
pub fn stretched(own: &ReferenceBounds, k: f64) -> ReferenceBounds {
    let mut values = own.values();
    for (value, order) in values.iter_mut().zip(BOUND_ORDERS) {
        *value = (f64::from(*value) / k.powi(order)) as f32;
    }
    ReferenceBounds::from_values(values)
}

/// The bounds of the path along `knots`.
///
/// # Errors
/// If a derivative leaves the range of the law.
pub fn taken(knots: &[Knot]) -> Result<ReferenceBounds, ParameterError> {
    path(knots).map(|path| path.map_or(ReferenceBounds::REST, |path| path.bounds()))
}

/// The path along `knots`; none without any.
///
/// # Errors
/// If a derivative leaves the range of the law.
pub fn path(knots: &[Knot]) -> Result<Option<Path<Vec<Segment>>>, ParameterError> {
    let Some(last) = knots.last() else { return Ok(None) };
    let segments = knots.windows(2).map(|pair| Segment::between(&pair[0], &pair[1])).collect();
    Path::new(segments, last).map(Some)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_stretched_by_what_is_told_just_fits() {
        let allowed = ReferenceBounds::from_values([5.0, 3.0, 2.0, 8.0, 20.0, 1.0, 2.0]);
        for (number, factor) in (0..ReferenceBounds::COUNT).zip([1.5, 4.0, 9.0, 8.0, 16.0, 3.0, 2.0]) {
            let mut values = allowed.values();
            values[number] *= factor;
            let own = ReferenceBounds::from_values(values);
            let k = stretch(&own, &allowed);
            let fits = |k: f64| {
                stretched(&own, k).values().iter().zip(allowed.values()).all(|(own, most)| *own <= most * 1.000_001)
            };
            assert!(k > 1.0 && fits(k) && !fits(0.999 * k), "{number}: {k}");
        }
        assert_eq!(stretch(&ReferenceBounds::REST, &ReferenceBounds::REST), 0.0);
        assert_eq!(stretch(&allowed, &ReferenceBounds::REST), f64::INFINITY);
    }
}
