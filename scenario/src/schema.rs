//! The JSON schema of scenario files, from the declarations by which they are read ([`crate::key`]).
//!
//! It says of each key its type, bounds, default and meaning, and which must be there. What depends on more than one
//! key is for reading to say: whole numbers of steps, sections that need each other, the gains of a law.

use crate::file;
use crate::key::{Bounds, Key, Layout, LeftOut, Values};
use controller_core::constants::Constant;
use serde_json::{Map, Value, json};

/// The schema, draft 7, which editors know.
#[must_use]
pub fn schema() -> Value {
    let mut schema = table(&file::LAYOUT);
    schema["$schema"] = json!("http://json-schema.org/draft-07/schema#");
    schema["title"] = json!("Scenario file of host-sim");
    schema
}

fn table(layout: &Layout) -> Value {
    let properties: Map<String, Value> = layout.keys.iter().map(|key| (key.name.to_owned(), property(key))).collect();
    let required: Vec<&str> =
        layout.keys.iter().filter(|key| key.left_out == LeftOut::Refused).map(|key| key.name).collect();
    json!({
        "type": "object",
        "description": layout.about,
        "properties": properties,
        "required": required,
        "additionalProperties": false,
    })
}

fn property(key: &Key) -> Value {
    let mut schema = values(&key.values);
    let unit = match key.values {
        Values::Number(bounds) | Values::Vector(bounds) if !bounds.unit.is_empty() => format!(" ({})", bounds.unit),
        _ => String::new(),
    };
    schema["description"] = json!(format!("{}{unit}", key.about));
    match (key.left_out, key.values) {
        (LeftOut::Default(default), Values::Vector(_)) => schema["default"] = json!(vec![default; 3]),
        (LeftOut::Default(default), _) => schema["default"] = json!(default),
        _ => {}
    }
    schema
}

fn values(values: &Values) -> Value {
    let numbers = |bounds: &Bounds, count: usize| json!({ "type": "array", "items": number("number", bounds), "minItems": count, "maxItems": count });
    match values {
        Values::Number(bounds) => number("number", bounds),
        Values::Whole(bounds) => number("integer", bounds),
        Values::Vector(bounds) => numbers(bounds, 3),
        Values::Range(bounds) => numbers(bounds, 2),
        Values::List(each) => json!({ "type": "array", "items": self::values(each) }),
        Values::Either(kinds) => json!({ "anyOf": kinds.each_ref().map(self::values) }),
        Values::Text => json!({ "type": "string" }),
        Values::Choice(texts) => json!({ "enum": texts }),
        Values::Table(layout) => table(layout),
        Values::Tables(layout) => json!({ "type": "array", "minItems": 1, "items": table(layout) }),
        Values::Kinds(layouts) => json!({ "oneOf": layouts.iter().map(|layout| table(layout)).collect::<Vec<_>>() }),
        Values::Constants(section, tables) => constants(section, tables),
    }
}

fn number(name: &str, bounds: &Bounds) -> Value {
    let mut schema = json!({ "type": name });
    if bounds.min.is_finite() {
        schema[if bounds.above_min { "exclusiveMinimum" } else { "minimum" }] = json!(bounds.min);
    }
    if bounds.max.is_finite() {
        schema["maximum"] = json!(bounds.max);
    }
    schema
}

/// The constants of `tables` that stand in `section`; of one that is in several, the widest range.
fn constants(section: &str, tables: &[&[Constant]]) -> Value {
    let mut properties = Map::new();
    for constant in tables.iter().copied().flatten().filter(|constant| constant.section == section) {
        let (min, max) = (f64::from(constant.range.min), f64::from(constant.range.max));
        let earlier = properties.get(constant.key);
        let bound = |name: &str| earlier.and_then(|schema: &Value| schema[name].as_f64());
        let min = bound("minimum").map_or(min, |other| min.min(other));
        let max = bound("maximum").map_or(max, |other| max.max(other));
        let mut schema = number("number", &Bounds::between(min, max, ""));
        schema["description"] = json!(constant.about.trim());
        properties.insert(constant.key.to_owned(), schema);
    }
    json!({ "type": "object", "properties": properties, "additionalProperties": false })
}

#[cfg(test)]
mod tests;
