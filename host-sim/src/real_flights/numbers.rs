//! The numbers of files, by the names of their columns.

use super::columns::{Column, Stream};
use csv::StringRecord;
use scenario::cells::{self, number};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Two hours at 500 Hz.
const ROWS_MAX: usize = 3_600_000;
/// The longest file, bytes.
const FILE_MAX_BYTES: u64 = 2_000_000_000;

/// The files of one recording, each read once.
pub struct Files<'a> {
    first: &'a Path,
    names: BTreeSet<&'a str>,
    read: BTreeMap<PathBuf, Table>,
}

/// A file's cells.
struct Table {
    names: Vec<String>,
    rows: Vec<(u64, StringRecord)>,
}

/// Rows of a stream that are complete: the time, s, and the numbers.
pub type Rows = Vec<(f64, Vec<f64>)>;

impl<'a> Files<'a> {
    /// The `first` file, whose columns have these `names`, and others beside it.
    pub fn new(first: &'a Path, names: BTreeSet<&'a str>) -> Self {
        Self { first, names, read: BTreeMap::new() }
    }

    /// A stream's rows in its file's order. A row with an empty cell in one of its columns is left out.
    ///
    /// # Errors
    /// Names the file, the line and the column that cannot be used.
    pub fn rows(&mut self, stream: &Stream) -> Result<Rows, String> {
        let path = stream.file.as_ref().map_or_else(|| self.first.to_owned(), |file| self.first.with_file_name(file));
        let in_file = |what: String| format!("{}: {what}", path.display());
        if !self.read.contains_key(&path) {
            let of_stream = stream.columns.iter().chain([&stream.time]).map(|column| &*column.name);
            let table = Table::read(&path, &of_stream.chain(self.names.iter().copied()).collect());
            self.read.insert(path.clone(), table.map_err(in_file)?);
        }
        let Some(table) = self.read.get(&path) else { return Ok(Vec::new()) };
        table.rows_of(stream).map_err(in_file)
    }
}

impl Table {
    fn read(path: &Path, known: &BTreeSet<&str>) -> Result<Self, String> {
        let bytes = scenario::text::bytes(path, FILE_MAX_BYTES).map_err(|error| format!("cannot be read: {error}"))?;
        if bytes.starts_with(&[0x1F, 0x8B]) {
            return Err("is compressed: gunzip it first".to_owned());
        }
        let text =
            String::from_utf8(bytes).map_err(|_| "is no text; a CSV with names of columns is read".to_owned())?;
        let read = cells::read(&text, ROWS_MAX, |name| known.contains(name))?;
        let (_, names) = read.header.ok_or_else(|| {
            let known = known.iter().copied().collect::<Vec<_>>().join(", ");
            format!("has none of the columns named: {known}")
        })?;
        Ok(Self { names, rows: read.rows })
    }

    fn place(&self, column: &Column) -> Result<usize, String> {
        self.names.iter().position(|name| *name == column.name).ok_or_else(|| {
            let there = self.names.join(", ");
            format!("has no column {}; it has {there}", column.name)
        })
    }

    fn rows_of(&self, stream: &Stream) -> Result<Rows, String> {
        let time = self.place(&stream.time)?;
        let places = stream.columns.iter().map(|column| self.place(column)).collect::<Result<Vec<_>, _>>()?;
        let mut rows = Rows::with_capacity(self.rows.len());
        for (line, row) in &self.rows {
            let read = |place: usize, column: &Column| -> Result<Option<f64>, String> {
                match row.get(place).unwrap_or_default() {
                    "" => Ok(None),
                    cell => match number(cell) {
                        Some(found) if found.is_finite() => Ok(Some((found - column.zero) * column.factor)),
                        Some(_) => Ok(None),
                        None => Err(format!("line {line}, {}: must be a number, found {cell:?}", column.name)),
                    },
                }
            };
            let numbers = places.iter().zip(&stream.columns).map(|(place, column)| read(*place, column));
            let numbers = numbers.collect::<Result<Option<Vec<f64>>, String>>()?;
            if let (Some(time), Some(numbers)) = (read(time, &stream.time)?, numbers) {
                rows.push((time + stream.offset, numbers));
            }
        }
        if rows.is_empty() {
            let names = stream.columns.iter().map(|column| &*column.name).collect::<Vec<_>>().join(", ");
            return Err(format!("no row has numbers in all of {names}"));
        }
        Ok(rows)
    }
}
