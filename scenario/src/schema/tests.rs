//! That the schema and the reader agree: on every scenario of the repository, and on keys and values that neither
//! takes.

use super::*;
use crate::Scenario;
use std::path::Path;
use toml::Table;

/// Why `value` is not of `schema`, as far as the schemas here go.
fn check(schema: &Value, value: &Value) -> Result<(), String> {
    for combined in ["anyOf", "oneOf"] {
        let Some(kinds) = schema[combined].as_array() else { continue };
        let fits = kinds.iter().filter(|kind| check(kind, value).is_ok()).count();
        if fits == 0 || combined == "oneOf" && fits > 1 {
            return Err(format!("{value}: {fits} of {}", schema["description"]));
        }
    }
    if let Some(texts) = schema["enum"].as_array()
        && !texts.contains(value)
    {
        return Err(format!("{value}: none of {texts:?}"));
    }
    let is_of_type = match schema["type"].as_str() {
        Some("object") => value.is_object(),
        Some("array") => value.is_array(),
        Some("string") => value.is_string(),
        Some("number") => value.is_number(),
        Some("integer") => value.as_f64().is_some_and(|number| number.fract() == 0.0),
        _ => true,
    };
    if !is_of_type {
        return Err(format!("{value}: no {}", schema["type"]));
    }
    if let Some(number) = value.as_f64() {
        let bound = |name: &str| schema[name].as_f64();
        let holds = bound("minimum").is_none_or(|min| number >= min)
            && bound("exclusiveMinimum").is_none_or(|min| number > min)
            && bound("maximum").is_none_or(|max| number <= max);
        holds.then_some(()).ok_or_else(|| format!("{number}: outside {schema}"))?;
    }
    if let Some(elements) = value.as_array() {
        let count = |name: &str| schema[name].as_u64().map(|count| count as usize);
        if count("minItems").is_some_and(|min| elements.len() < min)
            || count("maxItems").is_some_and(|max| elements.len() > max)
        {
            return Err(format!("{value}: {} elements", elements.len()));
        }
        elements.iter().try_for_each(|element| check(&schema["items"], element))?;
    }
    if let (Some(entries), Some(properties)) = (value.as_object(), schema["properties"].as_object()) {
        for (key, value) in entries {
            let property = properties.get(key).ok_or_else(|| format!("{key}: unknown"))?;
            check(property, value).map_err(|problem| format!("{key}: {problem}"))?;
        }
        let missing = schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str);
        if let Some(key) = missing.into_iter().find(|key| !entries.contains_key(*key)) {
            return Err(format!("{key}: missing"));
        }
    }
    Ok(())
}

fn checked(text: &str) -> Result<(), String> {
    let table: Table = text.parse().unwrap();
    check(&schema(), &serde_json::to_value(table).unwrap())
}

/// The scenario files of a directory, and of those in it.
fn scenarios(directory: &Path) -> Vec<(String, String)> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(directory).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() && !path.ends_with("policies") {
            files.extend(scenarios(&path));
        } else if path.extension().is_some_and(|extension| extension == "toml") {
            files.push((path.display().to_string(), std::fs::read_to_string(&path).unwrap()));
        }
    }
    files
}

#[test]
fn every_scenario_of_the_repository_is_of_the_schema() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let files = [scenarios(&root.join("vehicles")), scenarios(&root.join("scenarios"))].concat();
    assert!(files.len() > 20, "{}", files.len());
    for (name, text) in files {
        checked(&text).unwrap_or_else(|problem| panic!("{name}: {problem}"));
    }
}

/// Inserts a key that no section has at every place where a table may stand in `value`.
fn misspelt(value: &Value) -> Vec<Value> {
    let Some(entries) = value.as_object() else {
        let elements = value.as_array().into_iter().flatten().enumerate();
        let replaced = |(index, element): (usize, &Value)| {
            let with = move |element| {
                let mut all = value.clone();
                all[index] = element;
                all
            };
            misspelt(element).into_iter().map(with).collect::<Vec<_>>()
        };
        return elements.flat_map(replaced).collect();
    };
    let mut all = vec![value.clone()];
    all[0]["no_such_key"] = json!(1.0);
    for (key, inner) in entries {
        for inner in misspelt(inner) {
            let mut other = value.clone();
            other[key] = inner;
            all.push(other);
        }
    }
    all
}

#[test]
fn a_key_that_the_reader_does_not_know_is_none_of_the_schema() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut count = 0;
    for (name, text) in scenarios(&root.join("scenarios")) {
        let table: Table = text.parse().unwrap();
        for other in misspelt(&serde_json::to_value(table).unwrap()) {
            assert!(check(&schema(), &other).is_err(), "{name}: {other}");
            let text = toml::to_string(&other).unwrap();
            let error = Scenario::parse(&text, &name).err().unwrap();
            assert!(error.what.contains("no_such_key: unknown key"), "{error}");
            count += 1;
        }
    }
    assert!(count > 50, "{count}");
}

#[test]
fn a_value_that_the_schema_refuses_is_refused_by_the_reader() {
    let study = crate::STUDY;
    for (section, line) in [
        ("[vehicle]", "mass = 0.0"),
        ("[vehicle]", "mass = \"heavy\""),
        ("[control]", "rate = 5.0"),
        ("[control]", "law = \"papers\""),
        ("[initial]", "velocity = [0.0, 1.0]"),
        ("[failure]", "rotor = 1.5\ntime = 1.0"),
        ("[failure]", "rotor = 1"),
        ("[drag]", "linear = [-0.1, 0.1, 0.1]"),
        ("[estimator]", "dropout = 1.0"),
        ("[estimator]", "outage = { start = 1.0 }"),
        ("[campaign]", "reference = \"none\""),
        ("[campaign]", "mass = 0.95"),
        ("[gains]", "k_f = -1.0"),
        ("[reference]", "kind = \"hover\""),
    ] {
        let mut table: Table = study.parse().unwrap();
        let changed: Table = format!("{section}\n{line}").parse().unwrap();
        for (name, section) in changed {
            let there = table.entry(name).or_insert_with(|| toml::Value::Table(Table::new()));
            let is_reference = line.starts_with("kind");
            if is_reference {
                *there = section;
            } else {
                there.as_table_mut().unwrap().extend(section.as_table().unwrap().clone());
            }
        }
        let text = table.to_string();
        assert!(checked(&text).is_err() && Scenario::parse(&text, "f").is_err(), "{section} {line}");
    }
}
