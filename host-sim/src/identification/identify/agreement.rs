//! Whether bench and flight can be of one vehicle.
//!
//! Combined they leave residuals: of each bench entry its distance from the fit to all others, and of the flight its
//! own. Squared, over their variances and summed, they are chi-square with as many degrees of freedom as
//! there are statements more than unknowns. Beyond what chance leaves in 999 of 1,000 no combination is worth its
//! uncertainty: a number was mistyped, or another vehicle weighed, and least squares would share the error out among
//! all numbers, with tight intervals around the wrong values.

use super::student_t;
use crate::output::table::{percent, short};
use nalgebra::{SMatrix, SVector};

/// What one statement too many may leave over, in standard uncertainties: 99.9 of 100 consistent ones leave less by a
/// normal distribution. By Student's t it is more ([`student_t`]): the flight's uncertainty is known from a few parts
/// of it.
const NORMAL_QUANTILE: f64 = 3.291;
/// Its one-sided quantile at 99.9 %, for [`greatest`].
const ONE_SIDED_QUANTILE: f64 = 3.090;

/// Entries that deviate by nearly as much as the most, by this part of it, may be the wrong one as well: where only two
/// say something of the same, it does not show which of them errs.
const NEAR_TIE_SHARE: f64 = 0.9;

/// ln of m, c, J_x, J_y, J_z over the file's, and their covariance.
#[derive(Debug, Clone, PartialEq)]
pub struct Known {
    /// The logarithms.
    pub values: SVector<f64, 5>,
    /// Theirs.
    pub covariance: SMatrix<f64, 5, 5>,
}

/// A bench entry: a share of each logarithm, their sum as it was measured, and its standard uncertainty.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// As the report calls it.
    pub name: String,
    /// Of ln of m, c, J_x, J_y, J_z.
    pub row: SVector<f64, 5>,
    /// Measured.
    pub value: f64,
    /// Standard.
    pub deviation: f64,
}

/// Says which entry contradicts the rest, if all together leave more over than chance does. `flight` is the flight's
/// own part of chi-square, `freedom` how many statements there are more than unknowns, `parts` from how many parts of
/// it its uncertainty is known.
pub fn contradiction(entries: &[Entry], known: &Known, flight: f64, freedom: usize, parts: usize) -> Option<String> {
    let left = |entry: &Entry| entry.value - entry.row.dot(&known.values);
    let bench: f64 = entries.iter().map(|entry| (left(entry) / entry.deviation).powi(2)).sum();
    if freedom == 0 || bench + flight <= greatest(freedom, parts) {
        return None;
    }
    // What is left over of an entry, less its own share in the combination: its distance from what all the rest says.
    let apart = |entry: &Entry| {
        let own = spread(&known.covariance, &entry.row) / entry.deviation.powi(2);
        let others = (1.0 - own).max(1e-9);
        (left(entry) / others, entry.deviation / others.sqrt())
    };
    let apart: Vec<(&Entry, f64, f64)> = entries
        .iter()
        .map(|entry| {
            let (distance, deviation) = apart(entry);
            (entry, distance, (distance / deviation).abs())
        })
        .collect();
    let worst = apart.iter().map(|(_, _, times)| *times).fold(0.0, f64::max);
    let suspects = apart.iter().filter(|(_, _, times)| *times >= NEAR_TIE_SHARE * worst);
    let suspects = suspects.map(|(entry, distance, times)| {
        format!("{} by {} ({} standard uncertainties)", entry.name, percent(distance.exp_m1()), short(*times))
    });
    Some(format!(
        "bench and flight contradict: from what all the rest says deviates most {}: measure it again, and see that bench, log and scenario are of one vehicle",
        suspects.collect::<Vec<_>>().join(" or ")
    ))
}

/// The variance of the sum of these shares.
fn spread(covariance: &SMatrix<f64, 5, 5>, row: &SVector<f64, 5>) -> f64 {
    row.dot(&(covariance * row))
}

/// The quantile of chi-square at 99.9 % (E. B. Wilson and M. M. Hilferty, 1931), as much greater as one statement too
/// many has it.
fn greatest(freedom: usize, parts: usize) -> f64 {
    let part = 2.0 / (9.0 * freedom as f64);
    freedom as f64
        * (1.0 - part + ONE_SIDED_QUANTILE * part.sqrt()).powi(3)
        * (student_t::consistent(parts) / NORMAL_QUANTILE).powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_tables() {
        // Chi-square at 99.9 %: within 4 %, on the safe side.
        for (freedom, table) in [(1, 10.828), (2, 13.816), (4, 18.467), (10, 29.588)] {
            let ratio = greatest(freedom, 16) / (4.073_f64 / NORMAL_QUANTILE).powi(2) / table;
            assert!((0.99..1.04).contains(&ratio), "{freedom}: {ratio}");
        }
    }
}
