//! Formulas and bounds of `proofs/*.gappa`: what Gappa bounds the rounding of is what the code computes, step by step.

use super::coq::{Definition, PROOFS, Proofs, note, words};
use std::collections::BTreeMap;
use std::fs;

/// A file's formulas, and the intervals that it assumes and proves.
pub struct Rounding {
    file: String,
    formulas: Proofs,
    intervals: BTreeMap<String, [f64; 2]>,
}

impl Rounding {
    /// Of `proofs/<file>`.
    pub fn read(file: &str) -> Self {
        let text = fs::read_to_string(format!("{PROOFS}/{file}")).unwrap_or_else(|error| panic!("{file}: {error}"));
        let lines = text.lines().map(|line| line.split('#').next().unwrap_or_default());
        let text = lines.collect::<Vec<_>>().join(" ");
        let (formulas, (proven, _)) =
            text.split_once('{').map(|(formulas, rest)| (formulas, rest.split_once('}').unwrap())).unwrap();
        let mut read = BTreeMap::new();
        for formula in formulas.split(';').map(str::trim) {
            // `a f= b` is rounded to single precision at each step, `a = b` is exact; `a = f(a_)` is an input.
            let Some((name, term)) = formula.split_once('=') else { continue };
            let rounded = name.ends_with(" f");
            let name = name.trim_end_matches(" f").trim();
            if !name.starts_with('@') && !term.trim().starts_with("f(") {
                let (file, variables, arguments, term) = (file.to_owned(), Vec::new(), Vec::new(), words(term));
                read.insert(name.to_owned(), Definition { file, variables, arguments, term, rounded });
            }
        }
        let bounds = proven.split("->").flat_map(|part| part.split("/\\")).map(interval).collect();
        Self { file: file.to_owned(), formulas: Proofs::from_definitions(read), intervals: bounds }
    }

    /// A formula of these inputs.
    pub fn number(&self, formula: &str, inputs: &[(&str, f32)]) -> f64 {
        let inputs: Vec<(&str, f64)> = inputs.iter().map(|(name, x)| (*name, f64::from(*x))).collect();
        self.formulas.clone().with(&inputs).number(formula, &[])
    }

    /// From where to where a quantity is, as assumed or as proven.
    pub fn interval(&self, quantity: &str) -> [f64; 2] {
        note(&self.file, quantity);
        self.intervals[quantity]
    }

    /// The names of its formulas and bounds.
    pub fn names(&self) -> impl Iterator<Item = &String> {
        self.formulas.defined().chain(self.intervals.keys())
    }
}

/// `x in [a, b]` or `|x| <= b`.
fn interval(bound: &str) -> (String, [f64; 2]) {
    let (quantity, [least, greatest]) = match (bound.split_once(" in ["), bound.split_once(" <= ")) {
        (Some((quantity, ends)), _) => {
            let (least, greatest) = ends.trim().trim_end_matches(']').split_once(',').expect("two ends");
            (quantity, [least, greatest].map(number))
        }
        (_, Some((quantity, most))) => (quantity, [0.0, number(most)]),
        _ => panic!("{bound} is no bound"),
    };
    (quantity.trim().to_owned(), [least, greatest])
}

/// Decimal, or `1b-17` for 2^-17.
fn number(text: &str) -> f64 {
    let text = text.trim();
    let parsed = |text: &str| text.parse::<f64>().unwrap_or_else(|_| panic!("{text} is not a number"));
    match text.split_once('b') {
        Some((mantissa, exponent)) => parsed(mantissa) * parsed(exponent).exp2(),
        None => parsed(text),
    }
}
