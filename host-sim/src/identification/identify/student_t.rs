//! Quantiles of Student's t, for uncertainties that are known from a few parts of a flight only.

/// The least and the greatest number of parts.
pub const PART_COUNT_RANGE: [usize; 2] = [4, 16];

/// By parts, of one degree of freedom less than there are: the quantiles at 1 - 0.05 / (2 x 16) and at 99.95 %.
const QUANTILES: [[f64; 2]; 13] = [
    [8.768, 12.924],
    [6.364, 8.610],
    [5.326, 6.869],
    [4.760, 5.959],
    [4.408, 5.408],
    [4.169, 5.041],
    [3.997, 4.781],
    [3.867, 4.587],
    [3.765, 4.437],
    [3.684, 4.318],
    [3.618, 4.221],
    [3.562, 4.140],
    [3.515, 4.073],
];

fn quantile_pair(parts: usize) -> [f64; 2] {
    let [least, most] = PART_COUNT_RANGE;
    QUANTILES[parts.clamp(least, most) - least]
}

/// Within so many standard uncertainties a number is in all but 0.05 / 16 of all flights: sixteen at once in 95 of 100.
#[must_use]
pub fn coverage(parts: usize) -> f64 {
    quantile_pair(parts)[0]
}

/// Within so many in 999 of 1,000.
#[must_use]
pub fn consistent(parts: usize) -> f64 {
    quantile_pair(parts)[1]
}
