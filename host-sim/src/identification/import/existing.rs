//! A vehicle file that is there already: it may hold what somebody measured, so it is not written over unasked.

use std::collections::BTreeMap;
use toml_edit::{DocumentMut, Item};

/// The most changes that an error lists.
const LISTED_MAX: usize = 6;
/// The longest value that an error shows, characters.
const VALUE_LETTERS_MAX: usize = 60;

/// Why `new` must not take the place of `existing` unasked: the numbers that would change; none if both are the same.
#[must_use]
pub fn objection(existing: &str, new: &str) -> Option<String> {
    if existing == new {
        return None;
    }
    let (Ok(existing), Ok(new)) = (existing.parse::<DocumentMut>(), new.parse::<DocumentMut>()) else {
        return Some("is there and is no vehicle file".to_owned());
    };
    let [existing, new] = [existing, new].map(|document| {
        let mut values = BTreeMap::new();
        flatten("", document.as_item(), &mut values);
        values
    });
    let mut changes: Vec<String> = Vec::new();
    for path in existing.keys().chain(new.keys().filter(|path| !existing.contains_key(*path))) {
        let become_what = match (existing.get(path), new.get(path)) {
            (Some(old), Some(new)) if old != new => {
                format!("{path} = {} would become {}", quoted_value(old), quoted_value(new))
            }
            (Some(old), None) => format!("{path} = {} would go", quoted_value(old)),
            (None, Some(new)) => format!("{path} = {} would come", quoted_value(new)),
            _ => continue,
        };
        changes.push(become_what);
    }
    let more = changes.len().saturating_sub(LISTED_MAX);
    changes.truncate(LISTED_MAX);
    Some(match more {
        0 if changes.is_empty() => "is there with other comments".to_owned(),
        0 => format!("is there: {}", changes.join(", ")),
        more => format!("is there: {}, and {more} more", changes.join(", ")),
    })
}

/// Every value by its dotted path, without spaces and comments in it.
fn flatten(path: &str, item: &Item, values: &mut BTreeMap<String, String>) {
    if let Some(table) = item.as_table_like() {
        for (key, item) in table.iter() {
            flatten(&if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }, item, values);
        }
    } else if let Some(value) = item.as_value() {
        let lines = value.to_string();
        let lines = lines.lines().map(|line| line.split(" #").next().unwrap_or_default());
        let text = lines.flat_map(str::split_whitespace).collect::<String>().replace(",]", "]").replace(',', ", ");
        values.insert(path.to_owned(), text);
    }
}

fn quoted_value(value: &str) -> String {
    if value.chars().count() <= VALUE_LETTERS_MAX {
        return value.to_owned();
    }
    value.chars().take(VALUE_LETTERS_MAX).chain("…".chars()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_would_change_is_listed_and_the_same_file_is_no_objection() {
        let old = "name = \"a\"\n[rotors]\nlag = 0.018 # measured\nposition = [\n  [1, 2, 3],\n]\nspin = [\"cw\"]\n";
        assert_eq!(objection(old, old), None);
        assert_eq!(objection(old, &old.replace(" # measured", "")).unwrap(), "is there with other comments");
        let new = "name = \"a\"\n[vehicle]\nmass = 1.0\n[rotors]\nlag = \"missing\"\nposition = [[1, 2, 3]]\n";
        assert_eq!(
            objection(old, new).unwrap(),
            "is there: rotors.lag = 0.018 would become \"missing\", rotors.spin = [\"cw\"] would go, \
             vehicle.mass = 1.0 would come"
        );
        assert_eq!(objection("no TOML", new).unwrap(), "is there and is no vehicle file");
        let many: String = (0..9).map(|k| format!("k{k} = {k}\n")).collect();
        assert!(objection(&many, "").unwrap().ends_with("k5 = 5 would go, and 3 more"));
    }
}
