//! The fields of a message: names, numbers, and where they begin.
//!
//! A format names each field with its type: a number, so many of them, or a message of another format. Here all of them
//! are numbers: `q[0]`, `status.voltage`.

use std::collections::BTreeMap;

const MESSAGE_MAX_BYTES: usize = u16::MAX as usize;

/// A format that holds itself has no end.
const NESTING_DEPTH_MAX: usize = 8;

/// A number of a message.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// Its name, with its place in an array.
    pub name: String,
    /// Its first byte.
    at: usize,
    number: Number,
}

/// ULog's numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Number {
    /// Of so many bytes.
    Unsigned(usize),
    /// Of so many bytes.
    Signed(usize),
    /// Single precision.
    Float,
    /// Double precision.
    Double,
}

impl Number {
    /// The number of this name; none for a message of another format.
    #[must_use]
    pub fn from_name(kind: &str) -> Option<Self> {
        Some(match kind {
            "uint64_t" => Self::Unsigned(8),
            "uint32_t" => Self::Unsigned(4),
            "uint16_t" => Self::Unsigned(2),
            "uint8_t" | "char" | "bool" => Self::Unsigned(1),
            "int64_t" => Self::Signed(8),
            "int32_t" => Self::Signed(4),
            "int16_t" => Self::Signed(2),
            "int8_t" => Self::Signed(1),
            "float" => Self::Float,
            "double" => Self::Double,
            _ => return None,
        })
    }

    /// Bytes.
    #[must_use]
    pub fn size(self) -> usize {
        match self {
            Self::Unsigned(size) | Self::Signed(size) => size,
            Self::Float => 4,
            Self::Double => 8,
        }
    }

    /// The number that these bytes begin with.
    #[must_use]
    pub fn read(self, bytes: &[u8]) -> Option<f64> {
        let bytes = bytes.get(..self.size())?;
        let mut eight = [0; 8];
        eight.iter_mut().zip(bytes).for_each(|(to, from)| *to = *from);
        let unsigned = u64::from_le_bytes(eight);
        let unused = 64 - 8 * self.size() as u32;
        Some(match self {
            Self::Unsigned(_) => unsigned as f64,
            Self::Signed(_) => ((unsigned << unused).cast_signed() >> unused) as f64,
            Self::Float => f64::from(f32::from_bits(unsigned as u32)),
            Self::Double => f64::from_bits(unsigned),
        })
    }
}

impl Field {
    /// The byte behind it.
    #[must_use]
    pub fn end(&self) -> usize {
        self.at + self.number.size()
    }

    /// Its value in a message; none if that ends before it, as PX4's do before padding.
    #[must_use]
    pub fn read(&self, message: &[u8]) -> Option<f64> {
        self.number.read(message.get(self.at..)?)
    }
}

/// The formats of a file, by their names.
#[derive(Debug, Clone, Default)]
pub struct Formats(BTreeMap<String, String>);

impl Formats {
    /// Adds `name:fields`.
    ///
    /// # Errors
    /// If it is no such text.
    pub fn add(&mut self, message: &[u8]) -> Result<(), String> {
        let text = std::str::from_utf8(message).map_err(|_| "the format is no text".to_owned())?;
        let (name, fields) = text.split_once(':').ok_or(format!("the format {text:?} has no name"))?;
        self.0.insert(name.to_owned(), fields.to_owned());
        Ok(())
    }

    /// The fields of a message, without padding.
    ///
    /// # Errors
    /// Names the format or the field that cannot be.
    pub fn fields(&self, name: &str) -> Result<Vec<Field>, String> {
        let mut fields = Vec::new();
        self.flatten(name, "", 0, 0, &mut fields)?;
        Ok(fields)
    }

    /// Adds the fields of the format `name` that begin at `at`; where they end.
    fn flatten(
        &self,
        name: &str,
        prefix: &str,
        mut at: usize,
        depth: usize,
        fields: &mut Vec<Field>,
    ) -> Result<usize, String> {
        let text = self.0.get(name).ok_or(format!("there is no format {name:?}"))?;
        if depth > NESTING_DEPTH_MAX {
            return Err(format!("the format {name:?} holds itself"));
        }
        for field in text.split_terminator(';') {
            let (kind, called) = field.split_once(' ').ok_or(format!("{name}: the field {field:?} has no name"))?;
            let (kind, count) = match kind.split_once('[') {
                None => (kind, None),
                Some((kind, count)) => {
                    let count = count.strip_suffix(']').and_then(|count| count.parse::<usize>().ok());
                    (kind, Some(count.ok_or(format!("{name}: the field {field:?} has no length"))?))
                }
            };
            for index in 0..count.unwrap_or(1) {
                let place = count.map_or_else(String::new, |_| format!("[{index}]"));
                let whole = format!("{prefix}{called}{place}");
                match Number::from_name(kind) {
                    Some(number) => {
                        if !called.starts_with("_padding") {
                            fields.push(Field { name: whole, at, number });
                        }
                        at += number.size();
                    }
                    None => {
                        let end = self.flatten(kind, &format!("{whole}."), at, depth + 1, fields)?;
                        // So that an array of them ends.
                        at = if end > at { end } else { return Err(format!("the format {kind:?} is empty")) };
                    }
                }
                if at > MESSAGE_MAX_BYTES || fields.len() > MESSAGE_MAX_BYTES {
                    return Err(format!("{name}: is longer than {MESSAGE_MAX_BYTES} bytes"));
                }
            }
        }
        Ok(at)
    }
}
