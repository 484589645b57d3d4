//! Values of parameter files: Python's and JSON's.

/// A value.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A number; `True` is 1.
    Number(f64),
    /// A text.
    Text(String),
    /// A list, a tuple or an array.
    List(Vec<Value>),
    /// A dictionary with texts as keys, in its order.
    Dictionary(Vec<(String, Value)>),
    /// `None`, and all else without a number.
    Other,
}

impl Value {
    /// What a dictionary holds at `key`.
    pub fn get(&self, key: &str) -> Option<&Self> {
        let Self::Dictionary(entries) = self else { return None };
        entries.iter().rev().find(|(known, _)| known == key).map(|(_, value)| value)
    }

    /// How many values it consists of.
    pub fn size(&self) -> usize {
        match self {
            Self::List(elements) => 1 + elements.iter().map(Self::size).sum::<usize>(),
            Self::Dictionary(entries) => 1 + entries.iter().map(|(_, value)| value.size()).sum::<usize>(),
            _ => 1,
        }
    }

    /// The same of JSON.
    pub fn of_json(json: serde_json::Value) -> Self {
        match json {
            serde_json::Value::Number(number) => number.as_f64().map_or(Self::Other, Self::Number),
            serde_json::Value::String(text) => Self::Text(text),
            serde_json::Value::Array(elements) => Self::List(elements.into_iter().map(Self::of_json).collect()),
            serde_json::Value::Object(entries) => {
                Self::Dictionary(entries.into_iter().map(|(key, value)| (key, Self::of_json(value))).collect())
            }
            serde_json::Value::Null | serde_json::Value::Bool(_) => Self::Other,
        }
    }
}
