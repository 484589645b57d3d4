//! What commands have in common at a terminal: a file read once, output written whole, signals watched, and the status
//! they end with.

use host_sim::output::interrupt::Interrupt;
use host_sim::studies::campaign::manifest::MANIFEST_FILE;
use std::fmt;
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;
use textwrap::WordSplitter;

/// A well-posed run whose claims fail.
const CLAIMS_FAIL: u8 = 1;
/// Input that cannot be used, or output that cannot be written.
pub const BAD_INPUT: u8 = 2;
/// The status of signal 0, as shells have it.
const SIGNAL_STATUS_BASE: u8 = 128;

/// Writes to standard output, whole. A reader that has gone away changes no verdict.
pub fn print(write: impl FnOnce() -> io::Result<()>) -> Result<(), String> {
    match write().and_then(|()| io::stdout().flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(format!("standard output: cannot be written: {error}"))
        }
        _ => Ok(()),
    }
}

/// Says on standard error what is wrong. Where even that cannot be written, the status is all that is left.
pub fn complain(what: impl fmt::Display) {
    // File names may hold what a terminal acts on.
    let shown = |c: char| if c.is_control() && c != '\n' { c.escape_debug().to_string() } else { c.to_string() };
    let text: String = what.to_string().chars().map(shown).collect();
    let _ = writeln!(io::stderr(), "{text}");
}

/// Widest line of printed prose, columns.
const WIDTH_MAX: usize = 100;

/// Writes a text to standard output with its prose folded; on a terminal no wider than that, and with failures in red.
pub fn print_text(text: &str) -> Result<(), String> {
    let terminal = console::Term::stdout();
    let shown = match terminal.size_checked().filter(|_| terminal.is_term()) {
        Some((_, columns)) => coloured(&folded(text, WIDTH_MAX.min(columns.into()))),
        None => folded(text, WIDTH_MAX),
    };
    print(|| io::stdout().write_all(shown.as_bytes()))
}

/// Lines of prose no wider than `width`, broken at spaces only, so that paths and options stay whole; the rows of
/// tables, whose columns are two spaces apart, stay as they are.
fn folded(text: &str, width: usize) -> String {
    let options = textwrap::Options::new(width).break_words(false).word_splitter(WordSplitter::NoHyphenation);
    let fold = |line: &str| if line.contains("  ") { line.to_owned() } else { textwrap::fill(line, &options) };
    text.split('\n').map(fold).collect::<Vec<_>>().join("\n")
}

/// Failures in red, unless NO_COLOR is set.
fn coloured(text: &str) -> String {
    let red = |word: &str| console::style(word).red().bold().to_string();
    ["FAILS", "NOT", "UNSTABLE"].iter().fold(text.to_owned(), |text, word| text.replace(word, &red(word)))
}

/// A scenario's text, read once: a pipe cannot be read twice.
pub fn text_of(file: Option<&Path>) -> Result<String, String> {
    let read = |file: &Path| {
        scenario::self_contained::read(file).map_err(|error| format!("{}: cannot be read: {error}", file.display()))
    };
    file.map_or_else(|| Ok(scenario::PAPER.to_owned()), read)
}

pub fn watch() -> Result<Interrupt, String> {
    Interrupt::watch().map_err(|error| format!("signals cannot be watched: {error}"))
}

/// The status of a run that held or did not, unless it was cut short.
pub fn status(holds: bool, signal: Option<u8>) -> ExitCode {
    match (signal, holds) {
        (Some(signal), _) => ExitCode::from(SIGNAL_STATUS_BASE + signal),
        (None, true) => ExitCode::SUCCESS,
        (None, false) => ExitCode::from(CLAIMS_FAIL),
    }
}

/// Refuses a directory in which a report would be written over that of a campaign, which may have taken hours.
pub fn not_a_campaigns(directory: &Path) -> Result<(), String> {
    if directory.join(MANIFEST_FILE).exists() {
        return Err(format!(
            "{}: holds a campaign with a report of its own: choose another --out",
            directory.display()
        ));
    }
    Ok(())
}

/// Whether both paths lead to one file that exists.
pub fn same_file(one: &Path, other: &Path) -> bool {
    matches!((one.canonicalize(), other.canonicalize()), (Ok(one), Ok(other)) if one == other)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prose_is_folded_and_tables_are_not() {
        let (prose, row) = ("one two three four", "a row  of a table  that is wide");
        assert_eq!(folded(&format!("{prose}\n{row}\n"), 10), format!("one two\nthree four\n{row}\n"));
        assert_eq!(folded("in some/long-path, --large-log", 10), "in\nsome/long-path,\n--large-log");
    }
}
