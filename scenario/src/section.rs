//! Reading a TOML table field by field, with errors that name the field by its dotted path.
//!
//! A section is opened with the declaration of its keys ([`crate::key`]), so a misspelt key is reported as such, with
//! the nearest known one, before the key it stands for is reported missing. Numbers must be finite and fit single
//! precision.

use crate::key::{Key, Layout, LeftOut, Values};
use controller_core::error::ParameterError;
use nalgebra::Vector3;
use std::fmt;
use toml::{Table, Value};

/// The longest key that may be a misspelt one, bytes: the time to compare two keys grows with the product of their
/// lengths.
const MISSPELT_KEY_MAX_BYTES: usize = 200;

/// What stands in place of a number that is not known yet: `host-sim vehicle` writes it.
pub const MISSING: &str = "missing";

/// A field that was refused, and why; `problem` also says what is allowed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FieldError {
    /// Dotted path in the file, e.g. `vehicle.inertia[2]`.
    pub field: String,
    /// The error and the allowed values, in one line.
    pub problem: String,
}

impl FieldError {
    /// Refuses `field`. Both texts lose their middle where a key or a value of the file makes them endless.
    pub fn new(field: impl Into<String>, problem: impl Into<String>) -> Self {
        Self { field: shortened(field.into(), 200), problem: shortened(problem.into(), 2000) }
    }
}

/// `text` without its middle where it has more than `longest` characters.
fn shortened(text: String, longest: usize) -> String {
    let length = text.chars().count();
    if length <= longest {
        return text;
    }
    let part = longest / 2;
    let head: String = text.chars().take(part).collect();
    head + "…" + &text.chars().skip(length - part).collect::<String>()
}

impl fmt::Display for FieldError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.field, self.problem)
    }
}

/// One table of the file and where it stands in it.
#[derive(Debug, Clone)]
pub struct Section<'a> {
    path: String,
    table: &'a Table,
    keys: &'static [Key],
}

impl<'a> Section<'a> {
    /// The whole file.
    #[must_use]
    pub fn root(table: &'a Table) -> Self {
        Self { path: String::new(), table, keys: &[] }
    }

    /// The dotted path of `key` in this section.
    #[must_use]
    pub fn path_of(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) }
    }

    /// Refuses keys outside `known`, naming the nearest known one.
    ///
    /// # Errors
    /// The first unknown key.
    pub fn allow(&self, known: &[&str]) -> Result<(), FieldError> {
        match self.table.keys().find(|key| !known.contains(&key.as_str())) {
            None => Ok(()),
            Some(key) => {
                let near = |candidate: &&&str| strsim::damerau_levenshtein(candidate, key);
                let nearest = known.iter().filter(|_| key.len() <= MISSPELT_KEY_MAX_BYTES).min_by_key(near);
                let nearest = nearest.map_or(String::new(), |nearest| format!(", did you mean \"{nearest}\"?"));
                let all = known.join(", ");
                Err(FieldError::new(
                    // A key may hold line ends, and whatever else a terminal acts on.
                    self.path_of(&key.escape_debug().to_string()),
                    format!("unknown key{nearest} (allowed: {all})"),
                ))
            }
        }
    }

    /// The value at a dotted path such as `limits.torque_max[0]`.
    #[must_use]
    pub fn value(&self, path: &str) -> Option<&'a Value> {
        let (parents, last) = path.rsplit_once('.').map_or((None, path), |(parents, last)| (Some(parents), last));
        let mut parents = parents.into_iter().flat_map(|path| path.split('.'));
        let table = parents.try_fold(self.table, |table, key| element(table, key)?.as_table())?;
        element(table, last)
    }

    /// The same as text.
    #[must_use]
    pub fn lookup(&self, path: &str) -> Option<String> {
        self.value(path).map(in_line)
    }

    /// A refusal by one of the law's constructors, which know the file's dotted paths; `self` is the whole file, for
    /// the value it has there.
    #[must_use]
    pub fn refused(&self, error: &ParameterError) -> FieldError {
        let found = self.lookup(error.field).map_or(String::new(), |value| format!(", found {value}"));
        FieldError::new(error.field, format!("{}{found}", error.reason))
    }

    /// Names all of `keys` that are missing, in one line.
    ///
    /// # Errors
    /// If any is.
    pub fn require_all(&self, keys: &[&str]) -> Result<(), FieldError> {
        let mut missing = keys.iter().filter(|key| !self.has(key));
        let (Some(first), rest) = (missing.next(), missing.copied().collect::<Vec<_>>()) else { return Ok(()) };
        let others = if rest.is_empty() { String::new() } else { format!(", as are {}", rest.join(", ")) };
        Err(FieldError::new(self.path_of(first), format!("missing{others}")))
    }

    /// Refuses sections with numbers that are not known yet, all of them in one line.
    ///
    /// # Errors
    /// Names the keys that hold [`MISSING`].
    pub fn check_measured(&self) -> Result<(), FieldError> {
        let sections = self.table.iter().filter_map(|(name, section)| Some((name, section.as_table()?)));
        let marked = sections.flat_map(|(name, section)| {
            let keys = section.iter().filter(|(_, value)| value.as_str() == Some(MISSING));
            keys.map(move |(key, _)| format!("{name}.{key}"))
        });
        let mut marked = marked.map(|path| path.escape_debug().to_string());
        let (Some(first), others) = (marked.next(), marked.collect::<Vec<_>>()) else { return Ok(()) };
        let others = if others.is_empty() { String::new() } else { format!(", as are {}", others.join(", ")) };
        let problem = format!(
            "marked \"{MISSING}\"{others}: measure it and write the number, as the file's comments and \
             docs/identify.md say"
        );
        Err(FieldError::new(first, problem))
    }

    /// Whether `key` is there.
    #[must_use]
    pub fn has(&self, key: &str) -> bool {
        self.table.contains_key(key)
    }

    /// A section that must be there, keys not yet checked.
    ///
    /// # Errors
    /// If it is missing or no table.
    pub fn section(&self, key: &str) -> Result<Section<'a>, FieldError> {
        match self.require(key, "a section")? {
            Value::Table(table) => Ok(Section { path: self.path_of(key), table, keys: &[] }),
            other => Err(self.mismatch(key, "a section", other)),
        }
    }

    /// A section that may be left out, keys not yet checked.
    ///
    /// # Errors
    /// If it is no table.
    pub fn optional_section(&self, key: &str) -> Result<Option<Section<'a>>, FieldError> {
        if self.has(key) { self.section(key).map(Some) } else { Ok(None) }
    }

    /// A section that may be left out, with the keys of `layout`.
    ///
    /// # Errors
    /// If it is no table, or has other keys.
    pub fn open(&self, layout: &'static Layout) -> Result<Option<Section<'a>>, FieldError> {
        self.optional_section(layout.name)?.map(|section| section.with(layout)).transpose()
    }

    /// The same table with the keys of `layout`.
    ///
    /// # Errors
    /// If it has other keys.
    pub fn with(self, layout: &'static Layout) -> Result<Section<'a>, FieldError> {
        self.allow(&layout.keys.iter().map(|key| key.name).collect::<Vec<_>>())?;
        Ok(Self { keys: layout.keys, ..self })
    }

    /// A list of tables with the keys of `layout`.
    ///
    /// # Errors
    /// If it is missing, no list, or an element is no table or has other keys.
    pub fn tables(&self, layout: &'static Layout) -> Result<Vec<Section<'a>>, FieldError> {
        const REQUIREMENT: &str = "a list of tables, e.g. [{ … }, { … }]";
        let key = layout.name;
        let Value::Array(elements) = self.require(key, REQUIREMENT)? else {
            return Err(FieldError::new(self.path_of(key), format!("must be {REQUIREMENT}")));
        };
        let open = |(index, element): (usize, &'a Value)| match element {
            Value::Table(table) => {
                Section { path: format!("{}[{index}]", self.path_of(key)), table, keys: &[] }.with(layout)
            }
            other => Err(self.mismatch(&format!("{key}[{index}]"), "a table", other)),
        };
        elements.iter().enumerate().map(open).collect()
    }

    /// A text that must be there.
    ///
    /// # Errors
    /// If it is missing or no text.
    pub fn text(&self, key: &str) -> Result<&'a str, FieldError> {
        match self.require(key, "a text")? {
            Value::String(text) => Ok(text),
            other => Err(self.mismatch(key, "a text", other)),
        }
    }

    /// One of the texts of `key`'s declaration, which must be there.
    ///
    /// # Errors
    /// If it is missing or another.
    pub fn choice(&self, key: &str) -> Result<&'static str, FieldError> {
        let found = self.text(key)?;
        let names = match self.declared(key).map(|key| key.values) {
            Some(Values::Choice(names)) => names,
            _ => &[],
        };
        names.iter().find(|name| **name == found).copied().ok_or_else(|| {
            let quoted: Vec<String> = names.iter().map(|name| format!("\"{name}\"")).collect();
            let allowed = match quoted.split_last() {
                Some((last, rest)) if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
                _ => quoted.concat(),
            };
            FieldError::new(self.path_of(key), format!("must be {allowed}, found {found:?}"))
        })
    }

    /// A finite number within its declared bounds, or its default.
    ///
    /// # Errors
    /// If it is missing without a default, no number, not finite, beyond single precision, or outside its bounds.
    pub fn number(&self, key: &str) -> Result<f64, FieldError> {
        let declared = self.declared(key);
        if let (false, Some(LeftOut::Default(default))) = (self.has(key), declared.map(|key| key.left_out)) {
            return Ok(default);
        }
        let number = finite(self.require(key, "a number")?);
        let number = number.map_err(|problem| FieldError::new(self.path_of(key), problem))?;
        match declared.map(|key| key.values) {
            Some(Values::Number(bounds)) => bounds.check(self.path_of(key), number),
            _ => Ok(number),
        }
    }

    /// As [`Self::number`]; none where the key is left out.
    ///
    /// # Errors
    /// As [`Self::number`].
    pub fn optional_number(&self, key: &str) -> Result<Option<f64>, FieldError> {
        self.has(key).then(|| self.number(key)).transpose()
    }

    /// As [`Self::number`], or `default` where the key is left out.
    ///
    /// # Errors
    /// As [`Self::number`].
    pub fn number_or(&self, key: &str, default: f64) -> Result<f64, FieldError> {
        if self.has(key) { self.number(key) } else { Ok(default) }
    }

    /// Three finite numbers, each within the declared bounds, or their default.
    ///
    /// # Errors
    /// If they are missing without a default, not three, or one of them is refused as in [`Self::number`].
    pub fn vector(&self, key: &str) -> Result<Vector3<f64>, FieldError> {
        let declared = self.declared(key);
        if let (false, Some(LeftOut::Default(default))) = (self.has(key), declared.map(|key| key.left_out)) {
            return Ok(Vector3::repeat(default));
        }
        let vector = vector_at(&self.path_of(key), self.require(key, THREE_NUMBERS)?)?;
        if let Some(Values::Vector(bounds)) = declared.map(|key| key.values) {
            for (index, value) in vector.iter().enumerate() {
                bounds.check(format!("{}[{index}]", self.path_of(key)), *value)?;
            }
        }
        Ok(vector)
    }

    /// The elements of a list that must be there, each with its path.
    ///
    /// # Errors
    /// If it is missing or no list; `requirement` says of what.
    pub fn elements(&self, key: &str, requirement: &str) -> Result<Vec<(String, &'a Value)>, FieldError> {
        match self.require(key, requirement)? {
            Value::Array(elements) => {
                let path = self.path_of(key);
                Ok(elements.iter().enumerate().map(|(index, value)| (format!("{path}[{index}]"), value)).collect())
            }
            other => Err(self.mismatch(key, requirement, other)),
        }
    }

    /// Two numbers that must be there and be `allowed`; `requirement` says which are.
    ///
    /// # Errors
    /// If they are missing, not two, or not allowed.
    pub fn range(
        &self,
        key: &str,
        requirement: &str,
        allowed: impl Fn(f64, f64) -> bool,
    ) -> Result<[f64; 2], FieldError> {
        let elements = self.elements(key, requirement)?;
        let number = |value: &Value| value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64));
        match elements[..] {
            [(_, least), (_, greatest)]
                if let (Some(least), Some(greatest)) = (number(least), number(greatest))
                    && allowed(least, greatest) =>
            {
                Ok([least, greatest])
            }
            _ => {
                let found = elements.iter().map(|(_, value)| in_line(value)).collect::<Vec<_>>().join(", ");
                Err(FieldError::new(self.path_of(key), format!("must be {requirement}, found [{found}]")))
            }
        }
    }

    fn declared(&self, key: &str) -> Option<&'static Key> {
        self.keys.iter().find(|declared| declared.name == key)
    }

    fn require(&self, key: &str, requirement: &str) -> Result<&'a Value, FieldError> {
        self.table.get(key).ok_or_else(|| FieldError::new(self.path_of(key), format!("missing, must be {requirement}")))
    }

    fn mismatch(&self, key: &str, requirement: &str, found: &Value) -> FieldError {
        FieldError::new(self.path_of(key), format!("must be {requirement}, found {}", found.type_str()))
    }
}

/// A value as TOML has it, in one line: a text may hold line ends, and whatever else a terminal acts on.
#[must_use]
pub fn in_line(value: &Value) -> String {
    match value {
        Value::String(text) => format!("{text:?}"),
        Value::Array(elements) => format!("[{}]", elements.iter().map(in_line).collect::<Vec<_>>().join(", ")),
        Value::Table(_) => "a table".to_owned(),
        other => other.to_string(),
    }
}

/// A table's value at `key` or, with an index, at `key[index]`.
fn element<'a>(table: &'a Table, key: &str) -> Option<&'a Value> {
    match key.strip_suffix(']').and_then(|key| key.split_once('[')) {
        Some((key, index)) => table.get(key)?.get(index.parse::<usize>().ok()?),
        None => table.get(key),
    }
}

/// The requirement on a vector.
const THREE_NUMBERS: &str = "a list of three numbers";

/// Three finite numbers at `path`.
///
/// # Errors
/// Names the element that is refused, or `path` if there are not three.
pub fn vector_at(path: &str, value: &Value) -> Result<Vector3<f64>, FieldError> {
    let Value::Array(elements) = value else {
        return Err(FieldError::new(path, format!("must be {THREE_NUMBERS}, found {}", value.type_str())));
    };
    if elements.len() != 3 {
        return Err(FieldError::new(path, format!("must be {THREE_NUMBERS}, found {}", elements.len())));
    }
    let mut vector = Vector3::zeros();
    for (index, (component, value)) in vector.iter_mut().zip(elements).enumerate() {
        *component = finite(value).map_err(|problem| FieldError::new(format!("{path}[{index}]"), problem))?;
    }
    Ok(vector)
}

/// A number that single precision can hold, or what is wrong with it.
fn finite(value: &Value) -> Result<f64, String> {
    let number = match value {
        Value::Float(number) => *number,
        Value::Integer(number) => *number as f64,
        other => return Err(format!("must be a number, found {}", other.type_str())),
    };
    if !number.is_finite() {
        Err(format!("must be a finite number, found {number}"))
    } else if number.abs() > f64::from(f32::MAX) {
        Err(format!("must be within ±{:e}, found {number:e}", f32::MAX))
    } else {
        Ok(number)
    }
}

#[cfg(test)]
mod tests;
