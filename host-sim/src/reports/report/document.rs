//! A scenario's own text as tables, section by section, its author's comments beside the values.

use super::page::Block;
use super::prose::{Cell, Table};
use toml_edit::{DocumentMut, InlineTable, Item, Value};

/// The scenario of a page: its tables under `title`, and its text as it was read.
pub fn scenario(title: &str, text: &str) -> Vec<Block> {
    let listing = Block::Listing("The file as it was read".into(), text.to_owned());
    vec![Block::Folded(title.into(), tables(text, "scenario")), listing]
}

/// One table for each section of `toml`, the keys before the first section under `top`; none if it is no TOML.
fn tables(toml: &str, top: &str) -> Vec<Table> {
    let mut tables = sections(toml, top);
    for table in &mut tables {
        // A section without comments needs no room for them.
        if table.rows.iter().all(|row| row.last() == Some(&Cell::text(""))) {
            table.head.truncate(2);
            table.rows.iter_mut().for_each(|row| row.truncate(2));
        }
    }
    tables
}

fn sections(toml: &str, top: &str) -> Vec<Table> {
    let Ok(document) = toml.parse::<DocumentMut>() else { return Vec::new() };
    let mut first = section(top);
    let mut tables = Vec::new();
    for (key, item) in document.iter() {
        match item {
            Item::Value(value) => first.rows.push(row(key, value)),
            Item::Table(table) => {
                let mut rows = section(&format!("[{key}]"));
                rows.rows.extend(table.iter().filter_map(|(key, item)| item.as_value().map(|value| row(key, value))));
                tables.push(rows);
            }
            // No section of a scenario is written so.
            Item::ArrayOfTables(_) | Item::None => {}
        }
    }
    if !first.rows.is_empty() {
        tables.insert(0, first);
    }
    tables
}

fn section(name: &str) -> Table {
    Table::new(name, &["key", "value", "comment"])
}

fn row(key: &str, value: &Value) -> Vec<Cell> {
    let behind = value.decor().suffix().and_then(|suffix| suffix.as_str()).unwrap_or_default();
    vec![Cell::text(key), Cell::text(plain(value)), Cell::text(behind.trim().trim_start_matches('#').trim())]
}

/// A value on one line, without the comments and line breaks inside.
fn plain(value: &Value) -> String {
    match value {
        Value::Array(array) => format!("[{}]", array.iter().map(plain).collect::<Vec<_>>().join(", ")),
        Value::InlineTable(table) => format!("{{ {} }}", inline(table)),
        Value::String(text) => text.value().clone(),
        other => other.clone().decorated("", "").to_string(),
    }
}

fn inline(table: &InlineTable) -> String {
    table.iter().map(|(key, value)| format!("{key} = {}", plain(value))).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_section_keeps_its_values_and_comments() {
        let toml = "name = \"a # b\" # who\nduration = 40.0\n[vehicle]\nmass = 0.460 # kg\n[rotors]\n\
            position = [\n [1, 2], # front\n [3, 4],\n]   # m, body\n\
            [reference]\nheading = { offset = 0.0, rate = 1e-3 }\n";
        let tables = tables(toml, "scenario");
        let names: Vec<&str> = tables.iter().map(|table| table.caption.as_str()).collect();
        assert_eq!(names, ["scenario", "[vehicle]", "[rotors]", "[reference]"]);
        let row = |cells: &[&str]| cells.iter().copied().map(Cell::text).collect::<Vec<_>>();
        assert_eq!(tables[0].rows, [row(&["name", "a # b", "who"]), row(&["duration", "40.0", ""])]);
        assert_eq!(tables[1].rows, [row(&["mass", "0.460", "kg"])]);
        assert_eq!(tables[2].rows, [row(&["position", "[[1, 2], [3, 4]]", "m, body"])]);
        assert_eq!(tables[3].rows, [row(&["heading", "{ offset = 0.0, rate = 1e-3 }"])]);
        assert_eq!(tables[3].head.len(), 2);
    }
}
