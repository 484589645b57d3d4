//! Policy files: a network as numpy writes it, to numbers that fit.
//!
//! ```toml
//! scale = [4.0, 4.0, 4.0, 1.0]            # m/s^2 three times, rad/s: what an output of one demands
//!
//! [[layers]]                              # the inputs' first
//! weights = [[…22 numbers…], …]           # a row an output
//! biases = […]                            # a number an output
//! ```
//!
//! [`controller_core::shield::network`] says what inputs and outputs are.

use controller_core::shield::network::{Layer, Network, OUTPUT_COUNT};
use toml::{Table, Value};

/// The numbers of a network.
#[derive(Debug, Clone, PartialEq)]
pub struct PolicyFile {
    /// Weights, row by row, and biases, of each layer.
    pub layers: Vec<(Vec<f32>, Vec<f32>)>,
    /// What the outputs are multiplied by.
    pub scale: [f32; OUTPUT_COUNT],
}

impl PolicyFile {
    /// Reads `text`, of a file that errors call `file`.
    ///
    /// # Errors
    /// One line: the file, the field, and what is wrong.
    pub fn parse(text: &str, file: &str) -> Result<Self, String> {
        let said = |problem: String| format!("{file}: {problem}");
        let table: Table = text.parse().map_err(|error: toml::de::Error| said(error.message().to_owned()))?;
        let read = Self::read(&table).map_err(said)?;
        read.with(|network| network.map(|_| ())).map_err(|error| said(error.to_string()))?;
        Ok(read)
    }

    fn read(table: &Table) -> Result<Self, String> {
        only(table, &["scale", "layers"], "")?;
        let scale = numbers(table.get("scale"), "scale")?;
        let count = scale.len();
        let scale = scale.try_into().map_err(|_| format!("scale: must have {OUTPUT_COUNT} numbers, found {count}"))?;
        let layers = table.get("layers").and_then(Value::as_array).ok_or("layers: missing; write [[layers]]")?;
        let layer = |(number, layer): (usize, &Value)| {
            let path = format!("layers[{number}]");
            let layer = layer.as_table().ok_or_else(|| format!("{path}: must be a table"))?;
            only(layer, &["weights", "biases"], &format!("{path}."))?;
            let biases = numbers(layer.get("biases"), &format!("{path}.biases"))?;
            let field = format!("{path}.weights");
            let rows = layer.get("weights").and_then(Value::as_array);
            let rows = rows.ok_or_else(|| format!("{field}: must be rows of numbers"))?;
            let row = |(number, row)| numbers(Some(row), &format!("{field}[{number}]"));
            let rows: Vec<Vec<f32>> = rows.iter().enumerate().map(row).collect::<Result<_, _>>()?;
            if rows.len() != biases.len() {
                return Err(format!(
                    "{field}: must have a row for each of {} biases, found {}",
                    biases.len(),
                    rows.len()
                ));
            }
            let width = rows.first().map_or(0, Vec::len);
            match rows.iter().position(|row| row.len() != width) {
                Some(other) => Err(format!(
                    "{field}[{other}]: must have {width} numbers as the others, found {}",
                    rows[other].len()
                )),
                None => Ok((rows.concat(), biases)),
            }
        };
        let layers = layers.iter().enumerate().map(layer).collect::<Result<_, String>>()?;
        Ok(Self { layers, scale })
    }

    /// Does something with the network of these numbers.
    pub fn with<R>(&self, act: impl FnOnce(Result<Network<'_>, controller_core::error::ParameterError>) -> R) -> R {
        let layers: Vec<Layer> = self.layers.iter().map(|(weights, biases)| Layer { weights, biases }).collect();
        act(Network::new(&layers, self.scale))
    }
}

/// Refuses unknown keys.
fn only(table: &Table, known: &[&str], path: &str) -> Result<(), String> {
    match table.keys().find(|key| !known.contains(&key.as_str())) {
        Some(key) => Err(format!("{path}{key}: unknown; there are {}", known.join(" and "))),
        None => Ok(()),
    }
}

/// Numbers that single precision has.
fn numbers(value: Option<&Value>, field: &str) -> Result<Vec<f32>, String> {
    let array = value.and_then(Value::as_array).ok_or_else(|| format!("{field}: must be an array of numbers"))?;
    let number = |(place, value): (usize, &Value)| {
        let number = value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64));
        let single = number.map(|number| number as f32).filter(|single| single.is_finite());
        single.ok_or_else(|| format!("{field}[{place}]: must be a finite number of single precision"))
    };
    array.iter().enumerate().map(number).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(rows: usize, columns: usize, biases: usize) -> String {
        let row = format!("[{}]", vec!["0.5"; columns].join(", "));
        let rows = vec![row; rows].join(", ");
        format!("scale = [4, 4, 4.0, 1.0]\n[[layers]]\nweights = [{rows}]\nbiases = {:?}\n", vec![0.25; biases])
    }

    #[test]
    fn a_network_is_read_row_by_row() {
        let read = PolicyFile::parse(&file(4, 22, 4), "policy.toml").unwrap();
        assert_eq!(read.layers, [(vec![0.5; 88], vec![0.25; 4])]);
        assert_eq!(read.scale, [4.0, 4.0, 4.0, 1.0]);
    }

    #[test]
    fn what_does_not_fit_is_refused_by_file_and_field() {
        let good = file(4, 22, 4);
        for (text, said) in [
            (file(4, 21, 4), "policy.toml: network.layers.weights: needs at least 88 elements"),
            (file(3, 22, 3), "policy.toml: network.layers.biases: needs at least 4 elements"),
            (file(4, 22, 3), "policy.toml: layers[0].weights: must have a row for each of 3 biases, found 4"),
            (
                good.replace("0.25", "nan"),
                "policy.toml: layers[0].biases[0]: must be a finite number of single precision",
            ),
            (
                good.replace("0.25", "1e39"),
                "policy.toml: layers[0].biases[0]: must be a finite number of single precision",
            ),
            (good.replace("4.0, 1.0]", "4.0]"), "policy.toml: scale: must have 4 numbers, found 3"),
            (good.replace("biases", "bias"), "policy.toml: layers[0].bias: unknown; there are weights and biases"),
            ("scale = [1, 1, 1, 1]".to_owned(), "policy.toml: layers: missing; write [[layers]]"),
            (
                good.replacen("0.5, ", "", 1),
                "policy.toml: layers[0].weights[1]: must have 21 numbers as the others, found 22",
            ),
        ] {
            assert_eq!(PolicyFile::parse(&text, "policy.toml").unwrap_err(), said);
        }
        assert!(PolicyFile::parse("scale = ", "policy.toml").unwrap_err().starts_with("policy.toml: "));
    }
}
