//! The table of claims.

use host_sim::output::table::{aligned, short};

/// The table.
pub struct Claims(Vec<Vec<String>>);

impl Default for Claims {
    fn default() -> Self {
        let head = ["claim", "figure", "the paper's design", "the other", "verdict"];
        Self(vec![head.map(str::to_owned).to_vec()])
    }
}

/// Whether a claim holds: of each design that the paper's is compared with.
fn verdict(holds: &[bool]) -> &'static str {
    match (holds.iter().all(|holds| *holds), holds.iter().any(|holds| *holds)) {
        (true, _) => "confirmed",
        (false, true) => "in part",
        (false, false) => "refuted",
    }
}

impl Claims {
    /// One row; `holds` against each of the others.
    pub fn add(&mut self, claim: &str, figure: &str, ours: String, other: String, holds: &[bool]) {
        let cells = [claim, figure, &ours, &other, verdict(holds)];
        self.0.push(cells.map(str::to_owned).to_vec());
    }

    /// One row of numbers, less being better.
    pub fn less(&mut self, claim: &str, figure: &str, ours: f64, others: &[f64]) {
        let other: Vec<String> = others.iter().map(|other| three(*other)).collect();
        let holds: Vec<bool> = others.iter().map(|other| ours < *other).collect();
        self.add(claim, figure, three(ours), other.join("; "), &holds);
    }

    /// As text.
    pub fn table(&self) -> String {
        aligned(&self.0)
    }
}

/// Three significant digits.
pub fn three(value: f64) -> String {
    short(format!("{value:.2e}").parse().unwrap_or(value))
}
