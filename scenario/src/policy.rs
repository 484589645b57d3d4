//! Policy files: a network as numpy writes it, to numbers that fit.
//!
//! ```toml
//! scale = [4.0, 4.0, 4.0, 1.0]            # m/s^2 three times, rad/s: what an output of one demands
//!
//! [[layers]]                              # the inputs' first
//! weights = [[…22 numbers…], …]           # a row an output
//! biases = […]                            # a number an output
//! activation = "tanh"                     # "tanh", "relu" or "identity"; left out: "tanh"
//!
//! [[layers]]
//! kind = "gru"                            # "dense" or "gru"; left out: "dense"
//! input_weights = [[…], …]                # three rows an output: of r, of z, of n
//! input_biases = […]
//! hidden_weights = [[…], …]
//! hidden_biases = […]
//! initial = […]                           # what it remembers at first; left out: zeros
//! ```
//!
//! A policy that demands speeds of the rotors has other keys in the place of `scale`:
//!
//! ```toml
//! demands = "rotors"                      # "acceleration" or "rotors"; left out: "acceleration"
//! farthest = 1.0                          # m: how far off it sees its goal at most, along each axis
//! fastest = 2.0                           # m/s: how fast it sees itself at most
//! ```
//!
//! Either may say how often it acts, `period = 0.01`, in s; left out: at any rate.
//!
//! [`controller_core::shield::network`] says what inputs and outputs are, and what a layer computes.

use controller_core::error::ParameterError;
use controller_core::shield::network::{Activation, Affine, Interface, Layer, Network, OUTPUT_COUNT};
use toml::{Table, Value};

/// The numbers of a network.
#[derive(Debug, Clone, PartialEq)]
pub struct PolicyFile {
    /// The inputs' first.
    pub layers: Vec<LayerNumbers>,
    /// What inputs and outputs mean.
    pub interface: Interface,
    /// The time between two of its steps, s; none if any will do.
    pub period: Option<f32>,
}

/// Weights, row by row, and biases.
#[derive(Debug, Clone, PartialEq)]
pub struct AffineNumbers {
    /// Of the first output, one an input, then those of the second, and so on.
    pub weights: Vec<f32>,
    /// One an output.
    pub biases: Vec<f32>,
}

/// The numbers of a layer.
#[derive(Debug, Clone, PartialEq)]
pub enum LayerNumbers {
    /// Of a dense one.
    Dense {
        /// W and b.
        affine: AffineNumbers,
        /// What it makes of its sums.
        activation: Activation,
    },
    /// Of a gated recurrent unit.
    Gru {
        /// Of its inputs.
        input: AffineNumbers,
        /// Of what it remembers.
        hidden: AffineNumbers,
        /// What it remembers at first.
        initial: Vec<f32>,
    },
}

impl AffineNumbers {
    fn borrowed(&self) -> Affine<'_> {
        Affine { weights: &self.weights, biases: &self.biases }
    }

    /// From two fields of a layer's table.
    fn read(table: &Table, path: &str, weights: &str, biases: &str) -> Result<Self, String> {
        let field = format!("{path}.{weights}");
        let numbers_of = numbers(table.get(biases), &format!("{path}.{biases}"))?;
        let rows = table.get(weights).and_then(Value::as_array);
        let rows = rows.ok_or_else(|| format!("{field}: must be rows of numbers"))?;
        let row = |(number, row)| numbers(Some(row), &format!("{field}[{number}]"));
        let rows: Vec<Vec<f32>> = rows.iter().enumerate().map(row).collect::<Result<_, _>>()?;
        if rows.len() != numbers_of.len() {
            return Err(format!(
                "{field}: must have a row for each of {} biases, found {}",
                numbers_of.len(),
                rows.len()
            ));
        }
        let width = rows.first().map_or(0, Vec::len);
        match rows.iter().position(|row| row.len() != width) {
            Some(other) => {
                Err(format!("{field}[{other}]: must have {width} numbers as the others, found {}", rows[other].len()))
            }
            None => Ok(Self { weights: rows.concat(), biases: numbers_of }),
        }
    }
}

impl LayerNumbers {
    fn borrowed(&self) -> Layer<'_> {
        match self {
            Self::Dense { affine, activation } => Layer::Dense { affine: affine.borrowed(), activation: *activation },
            Self::Gru { input, hidden, initial } => {
                Layer::Gru { input: input.borrowed(), hidden: hidden.borrowed(), initial }
            }
        }
    }

    fn read(table: &Table, path: &str) -> Result<Self, String> {
        let within = format!("{path}.");
        match word(table, "kind", &within, &["dense", "gru"])? {
            "gru" => {
                only(
                    table,
                    &["kind", "input_weights", "input_biases", "hidden_weights", "hidden_biases", "initial"],
                    &within,
                )?;
                let input = AffineNumbers::read(table, path, "input_weights", "input_biases")?;
                let hidden = AffineNumbers::read(table, path, "hidden_weights", "hidden_biases")?;
                let initial = match table.get("initial") {
                    None => vec![0.0; hidden.biases.len() / 3],
                    given => numbers(given, &format!("{path}.initial"))?,
                };
                Ok(Self::Gru { input, hidden, initial })
            }
            _ => {
                only(table, &["weights", "biases", "activation", "kind"], &within)?;
                let activation = match word(table, "activation", &within, &["tanh", "relu", "identity"])? {
                    "relu" => Activation::Relu,
                    "identity" => Activation::Identity,
                    _ => Activation::Tanh,
                };
                Ok(Self::Dense { affine: AffineNumbers::read(table, path, "weights", "biases")?, activation })
            }
        }
    }
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
        let interface = interface(table)?;
        let layers = table.get("layers").and_then(Value::as_array).ok_or("layers: missing; write [[layers]]")?;
        let layer = |(number, layer): (usize, &Value)| {
            let path = format!("layers[{number}]");
            let layer = layer.as_table().ok_or_else(|| format!("{path}: must be a table"))?;
            LayerNumbers::read(layer, &path)
        };
        let layers = layers.iter().enumerate().map(layer).collect::<Result<_, String>>()?;
        let period = table.contains_key("period").then(|| positive(table, "period")).transpose()?;
        Ok(Self { layers, interface, period })
    }

    /// Does something with the network of these numbers.
    pub fn with<R>(&self, act: impl FnOnce(Result<Network<'_>, ParameterError>) -> R) -> R {
        let layers: Vec<Layer> = self.layers.iter().map(LayerNumbers::borrowed).collect();
        act(Network::new(&layers, self.interface))
    }
}

/// What inputs and outputs mean.
fn interface(table: &Table) -> Result<Interface, String> {
    if word(table, "demands", "", &["acceleration", "rotors"])? == "rotors" {
        only(table, &["demands", "farthest", "fastest", "period", "layers"], "")?;
        return Ok(Interface::Rotors { farthest: positive(table, "farthest")?, fastest: positive(table, "fastest")? });
    }
    only(table, &["demands", "scale", "period", "layers"], "")?;
    let scale = numbers(table.get("scale"), "scale")?;
    let count = scale.len();
    let scale = scale.try_into().map_err(|_| format!("scale: must have {OUTPUT_COUNT} numbers, found {count}"))?;
    Ok(Interface::Acceleration { scale })
}

/// A number above zero.
fn positive(table: &Table, key: &str) -> Result<f32, String> {
    let number = table.get(key).and_then(single).filter(|number| *number > 0.0);
    number.ok_or_else(|| format!("{key}: must be a number above zero"))
}

/// One of the known words; the first where the key is missing.
fn word<'w>(table: &Table, key: &str, path: &str, known: &[&'w str]) -> Result<&'w str, String> {
    let Some(given) = table.get(key) else { return Ok(known.first().copied().unwrap_or_default()) };
    let found = given.as_str().and_then(|given| known.iter().find(|known| **known == given));
    found.copied().ok_or_else(|| format!("{path}{key}: must be {}, found {given}", known.join(" or ")))
}

/// Refuses unknown keys.
fn only(table: &Table, known: &[&str], path: &str) -> Result<(), String> {
    match table.keys().find(|key| !known.contains(&key.as_str())) {
        Some(key) => Err(format!("{path}{key}: unknown; there are {}", known.join(" and "))),
        None => Ok(()),
    }
}

/// A number that single precision has.
fn single(value: &Value) -> Option<f32> {
    let number = value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64));
    number.map(|number| number as f32).filter(|single| single.is_finite())
}

/// Numbers that single precision has.
fn numbers(value: Option<&Value>, field: &str) -> Result<Vec<f32>, String> {
    let array = value.and_then(Value::as_array).ok_or_else(|| format!("{field}: must be an array of numbers"))?;
    let number = |(place, value): (usize, &Value)| {
        single(value).ok_or_else(|| format!("{field}[{place}]: must be a finite number of single precision"))
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
        let affine = AffineNumbers { weights: vec![0.5; 88], biases: vec![0.25; 4] };
        assert_eq!(read.layers, [LayerNumbers::Dense { affine, activation: Activation::Tanh }]);
        assert_eq!(read.interface, Interface::Acceleration { scale: [4.0, 4.0, 4.0, 1.0] });
    }

    fn rows(rows: usize, columns: usize) -> String {
        format!("{:?}", vec![vec![0.5; columns]; rows])
    }

    /// 22 inputs, two values that are remembered, four rotors.
    fn recurrent() -> String {
        format!(
            "demands = \"rotors\"\nfarthest = 1\nfastest = 2.5\n[[layers]]\nkind = \"gru\"\ninput_weights = {}\n\
            input_biases = {:?}\nhidden_weights = {}\nhidden_biases = {:?}\n[[layers]]\nactivation = \"identity\"\n\
            weights = {}\nbiases = {:?}\n",
            rows(6, 22),
            [0.25; 6],
            rows(6, 2),
            [0.125; 6],
            rows(4, 2),
            [0.0; 4]
        )
    }

    #[test]
    fn a_recurrent_network_of_rotors_is_read_and_begins_with_zeros_unless_it_says_otherwise() {
        let read = PolicyFile::parse(&recurrent(), "policy.toml").unwrap();
        assert_eq!(read.interface, Interface::Rotors { farthest: 1.0, fastest: 2.5 });
        let input = AffineNumbers { weights: vec![0.5; 132], biases: vec![0.25; 6] };
        let hidden = AffineNumbers { weights: vec![0.5; 12], biases: vec![0.125; 6] };
        assert_eq!(read.layers[0], LayerNumbers::Gru { input, hidden, initial: vec![0.0; 2] });
        let other = recurrent().replacen("kind", "initial = [0.5, -1]\nkind", 1);
        let read = PolicyFile::parse(&other, "policy.toml").unwrap();
        assert!(matches!(&read.layers[0], LayerNumbers::Gru { initial, .. } if *initial == [0.5, -1.0]));
        read.with(|network| assert_eq!(network.unwrap().fresh().values[..3], [0.5, -1.0, 0.0]));
    }

    #[test]
    fn what_does_not_fit_a_recurrent_network_is_refused_by_file_and_field() {
        let good = recurrent();
        for (text, said) in [
            (good.replace("\"gru\"", "\"lstm\""), "layers[0].kind: must be dense or gru, found \"lstm\""),
            (good.replace("\"rotors\"", "5"), "demands: must be acceleration or rotors, found 5"),
            (good.replace("farthest = 1", "farthest = 0"), "farthest: must be a number above zero"),
            (good.replace("fastest = 2.5", ""), "fastest: must be a number above zero"),
            (good.replace("fastest = 2.5", "fastest = 2e4"), "network.fastest: must be at most 10000"),
            (
                good.replace("fastest", "scale"),
                "scale: unknown; there are demands and farthest and fastest and period and layers",
            ),
            (
                good.replace("\"identity\"", "\"elu\""),
                "layers[1].activation: must be tanh or relu or identity, found \"elu\"",
            ),
            (good.replace(&rows(6, 2), &rows(6, 3)), "network.layers.hidden_weights: takes at most 12 elements"),
            (good.replace(&rows(6, 22), &rows(6, 21)), "network.layers.input_weights: needs at least 132 elements"),
            (
                good.replacen("kind", "initial = [0.5]\nkind", 1),
                "network.layers.input_biases: takes at most 3 elements",
            ),
            (
                good.replace("input_biases", "biases"),
                "layers[0].biases: unknown; there are kind and input_weights and input_biases and hidden_weights and \
                hidden_biases and initial",
            ),
        ] {
            assert_eq!(PolicyFile::parse(&text, "policy.toml").unwrap_err(), format!("policy.toml: {said}"));
        }
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
            (
                good.replace("biases", "bias"),
                "policy.toml: layers[0].bias: unknown; there are weights and biases and activation and kind",
            ),
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
