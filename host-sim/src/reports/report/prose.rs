//! The page's text: sentences, facts, tables with verdicts, listings.

use super::text::escaped;
use std::fmt::Write;

/// A quantity with its value, as a reader meets it first.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fact {
    pub name: String,
    /// Its value with its unit.
    pub value: String,
}

impl Fact {
    /// A fact.
    pub fn new(name: impl Into<String>, value: impl Into<String>) -> Self {
        Self { name: name.into(), value: value.into() }
    }
}

/// One cell of a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Cell {
    /// Words.
    Text(String),
    /// A number with its unit, aligned to the right.
    Number(String),
    /// Whether a claim holds; none without a requirement.
    Verdict(Option<bool>),
}

impl Cell {
    /// Words.
    pub fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }

    pub fn number(text: impl Into<String>) -> Self {
        Self::Number(text.into())
    }

    fn html(&self) -> String {
        match self {
            Self::Text(text) => format!("<td>{}</td>", escaped(text)),
            Self::Number(text) => format!("<td class=\"number\">{}</td>", escaped(&unbroken(text))),
            Self::Verdict(verdict) => {
                let (class, word) = verdict_words(*verdict);
                format!("<td class=\"judged\"><span class=\"verdict {class}\">{word}</span></td>")
            }
        }
    }
}

/// A number stays beside its unit where a line is short.
fn unbroken(text: &str) -> String {
    let has_digit = |part: &str| part.contains(|c: char| c.is_ascii_digit());
    let part = |part: &str| if has_digit(part) { part.replace(' ', "\u{a0}") } else { part.to_owned() };
    text.split(", ").map(part).collect::<Vec<_>>().join(", ")
}

/// How a verdict looks and what it says. Its sign is the style sheet's, so that colour never stands alone.
pub fn verdict_words(verdict: Option<bool>) -> (&'static str, &'static str) {
    match verdict {
        Some(true) => ("holds", "holds"),
        Some(false) => ("fails", "FAILS"),
        None => ("reported", "reported"),
    }
}

/// A table: its first column heads the rows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Table {
    /// Its title.
    pub caption: String,
    /// One name for each column.
    pub head: Vec<String>,
    /// The rows, each as long as the head.
    pub rows: Vec<Vec<Cell>>,
}

impl Table {
    /// A table without rows.
    pub fn new(caption: impl Into<String>, head: &[&str]) -> Self {
        Self { caption: caption.into(), head: head.iter().map(|&name| name.to_owned()).collect(), rows: Vec::new() }
    }

    /// As HTML. It scrolls sideways, by keyboard too, where a page is too narrow for it.
    pub fn html(&self) -> String {
        let caption = escaped(&self.caption);
        let mut html = format!(
            "<div class=\"scroll\" role=\"region\" tabindex=\"0\" aria-label=\"{caption}\"><table><caption>{caption}</caption><thead><tr>"
        );
        for (column, name) in self.head.iter().enumerate() {
            let class =
                match self.rows.iter().find_map(|row| row.get(column).filter(|cell| !matches!(cell, Cell::Text(_)))) {
                    Some(Cell::Number(_)) => " class=\"number\"",
                    Some(Cell::Verdict(_)) => " class=\"judged\"",
                    _ => "",
                };
            let _ = write!(html, "<th scope=\"col\"{class}>{}</th>", escaped(name));
        }
        html += "</tr></thead><tbody>";
        for row in &self.rows {
            html += "<tr>";
            for (column, cell) in row.iter().enumerate() {
                match cell {
                    Cell::Text(text) if column == 0 => {
                        let _ = write!(html, "<th scope=\"row\">{}</th>", escaped(text));
                    }
                    cell => html += &cell.html(),
                }
            }
            html += "</tr>";
        }
        html + "</tbody></table></div>\n"
    }
}

/// Facts side by side.
pub fn facts(facts: &[Fact]) -> String {
    let list = facts.iter().fold(String::new(), |mut list, Fact { name, value }| {
        let _ = write!(list, "<div><dt>{}</dt><dd>{}</dd></div>", escaped(name), escaped(value));
        list
    });
    format!("<dl class=\"facts\">{list}</dl>\n")
}

/// A text as it stands, folded until the reader opens it.
pub fn listing(name: &str, text: &str) -> String {
    format!("<details><summary>{}</summary><pre tabindex=\"0\">{}</pre></details>\n", escaped(name), escaped(text))
}
