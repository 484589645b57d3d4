//! Aligned text tables for terminals.

use std::fmt::Write;

/// Rows of equal length, the first one the head; text columns left-aligned, two spaces between.
pub fn aligned(rows: &[Vec<String>]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max();
    let widths: Vec<usize> = (0..columns).map(|column| width(column).unwrap_or(0)).collect();
    rows.iter().fold(String::new(), |mut text, row| {
        let line = row.iter().zip(&widths).fold(String::new(), |mut line, (cell, width)| {
            let _ = write!(line, "{cell:width$}  ");
            line
        });
        let _ = writeln!(text, "{}", line.trim_end());
        text
    })
}

/// Four significant digits, without trailing zeros.
pub fn short(value: f64) -> String {
    let magnitude = value.abs();
    if magnitude == 0.0 || (magnitude - magnitude.round()).abs() < 1e-9 && (0.5..1e6).contains(&magnitude) {
        format!("{value:.0}")
    } else if (1e-3..1e4).contains(&magnitude) {
        let decimals = (3 - magnitude.log10().floor() as i32).max(0) as usize;
        let text = format!("{value:.decimals$}");
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    } else {
        format!("{value:.2e}")
    }
}

/// A fraction as a percentage with one decimal.
pub fn percent(fraction: f64) -> String {
    if fraction.is_finite() { format!("{:.1} %", 100.0 * fraction) } else { "none".to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_as_wide_as_their_widest_cell() {
        let row = |cells: [&str; 2]| cells.map(str::to_owned).to_vec();
        assert_eq!(aligned(&[row(["a", "b"]), row(["ccc", "d"])]), "a    b\nccc  d\n");
    }

    #[test]
    fn numbers_keep_four_digits() {
        let cases = [
            (0.0, "0"),
            (10.0, "10"),
            (1.234_56, "1.235"),
            (1234.56, "1235"),
            (1.5e-5, "1.50e-5"),
            (0.5, "0.5"),
            (2e-10, "2.00e-10"),
        ];
        for (value, text) in cases {
            assert_eq!(short(value), text);
        }
    }
}
