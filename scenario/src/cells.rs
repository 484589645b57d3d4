//! The cells of a file of numbers, however they are separated: by comma, semicolon, tab or spaces; with decimal points
//! or commas; the names of columns in a line above the numbers, which may begin with `#` or `%`, or nowhere.
//!
//! The separator is the one by which most cells of the first row are numbers, or most of the header are names.

use csv::StringRecord;
use std::borrow::Cow;

/// What separates cells; of two that do equally well the first.
const SEPARATORS: [u8; 4] = *b";\t, ";
/// What a comment begins with; a header may begin with it too.
const COMMENT_MARKS: [char; 2] = ['#', '%'];
/// The most lines above the numbers.
const HEADER_LINES_MAX: u64 = 1000;

/// A file's cells.
#[derive(Debug, Clone, PartialEq)]
pub struct Cells {
    /// The names of columns, and in which line; none without any that is known.
    pub header: Option<(u64, Vec<String>)>,
    /// The rows that are not empty, each with its line.
    pub rows: Vec<(u64, StringRecord)>,
}

/// A number with a decimal point or comma, none for anything else.
#[must_use]
pub fn number(cell: &str) -> Option<f64> {
    let is_comma = cell.matches(',').count() == 1 && !cell.contains('.');
    let pointed = if is_comma { Cow::from(cell.replace(',', ".")) } else { Cow::from(cell) };
    pointed.parse().ok()
}

/// Finds the cells of `text`, of `rows_max` rows at most; `is_name` knows the names of columns.
///
/// # Errors
/// What is wrong, with the line.
pub fn read(text: &str, rows_max: usize, is_name: impl Fn(&str) -> bool) -> Result<Cells, String> {
    let text = text.replace("\r\n", "\n").replace('\r', "\n");
    let (mut before, mut start, mut header, mut is_commented) = (0, 0, None, true);
    for line in text.split_inclusive('\n') {
        let line_words = line.trim_matches([' ', '\n']);
        let words = line_words.trim_start_matches(COMMENT_MARKS);
        let is_comment = words.len() < line_words.len();
        let (numbers, separator) = separated(words, 1, |cell| number(cell).is_some());
        if numbers > 0 && !is_comment {
            let rows = rows(&text[start..], separator, before, rows_max)?;
            return Ok(Cells { header, rows });
        }
        before += 1;
        start += line.len();
        if before > HEADER_LINES_MAX {
            return Err(format!("has no numbers in its first {HEADER_LINES_MAX} lines"));
        }
        // With spaces for separators, a unit belongs to the name before it.
        let words = words.replace(" [", "[").replace(" (", "(");
        let (known, separator) = separated(&words, 0, &is_name);
        if known > 0 && (is_commented || !is_comment) {
            let (_, names) = cells(&words, separator).next().transpose()?.unwrap_or_default();
            header = Some((before, names.iter().map(|name| name.escape_debug().to_string()).collect()));
            is_commented = is_comment;
        } else if header.is_some() && !is_comment && !words.trim().is_empty() {
            return Err(format!("line {before}: has neither numbers nor the names of columns; units go behind names"));
        }
    }
    Ok(Cells { header, rows: Vec::new() })
}

/// By which separator most cells of a line `fit`, and how many do; each that neither fits nor is empty takes `misfit`
/// from that number.
fn separated(line: &str, misfit: i64, fit: impl Fn(&str) -> bool) -> (i64, u8) {
    let mut best = (0, b',');
    for separator in SEPARATORS {
        let Some(Ok((_, record))) = cells(line, separator).next() else { continue };
        let filled = record.iter().filter(|cell| !cell.is_empty());
        let score = filled.map(|cell| if fit(cell) { 1 } else { -misfit }).sum();
        if score > best.0 {
            best = (score, separator);
        }
    }
    best
}

fn rows(text: &str, separator: u8, before: u64, rows_max: usize) -> Result<Vec<(u64, StringRecord)>, String> {
    let mut rows = Vec::new();
    for row in cells(text, separator) {
        let (line, record) = row?;
        if record.iter().all(str::is_empty) {
            continue;
        }
        rows.push((before + line, record));
        if rows.len() > rows_max {
            return Err(format!("has more than {rows_max} rows; leave out what is not needed"));
        }
    }
    Ok(rows)
}

/// The lines with their cells; between spaces nothing is left out.
fn cells(text: &str, separator: u8) -> impl Iterator<Item = Result<(u64, StringRecord), String>> {
    let mut builder = csv::ReaderBuilder::new();
    builder.has_headers(false).flexible(true).trim(csv::Trim::All).comment(Some(b'#')).delimiter(separator);
    builder.from_reader(text.as_bytes()).into_records().map(move |record| {
        let record = record.map_err(|error| error.to_string())?;
        let line = record.position().map_or(0, csv::Position::line);
        let is_left_out = |cell: &&str| separator == b' ' && cell.is_empty();
        Ok((line, record.iter().filter(|cell| !is_left_out(cell)).collect()))
    })
}
