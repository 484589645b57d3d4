//! A scenario's text with all that it takes from other files, so that it can be kept, sent and read elsewhere.

use crate::text;
use std::io;
use std::path::Path;
use toml_edit::{DocumentMut, Item, value};

/// The text of the scenario file `path`, the points that its `[reference]` takes from another file in it.
///
/// # Errors
/// As [`text::read`]'s. A text that is no scenario, or that names a file which cannot be read, comes as it is: reading
/// the scenario says what is wrong.
pub fn read(path: &Path) -> io::Result<String> {
    let text = text::read(path)?;
    Ok(with_points(&text, path).unwrap_or(text))
}

fn with_points(text: &str, path: &Path) -> Option<String> {
    let mut document: DocumentMut = text.parse().ok()?;
    let reference = document.get_mut("reference").and_then(Item::as_table_like_mut)?;
    let file = path.parent()?.join(reference.get("file")?.as_str()?);
    let points = text::read(&file).ok().filter(|_| !reference.contains_key("data"))?;
    reference.remove("file");
    reference.insert("data", value(points));
    Some(document.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scenario;

    #[test]
    fn a_scenario_says_the_same_without_the_file_that_it_names() {
        let directory = std::env::temp_dir().join(format!("scenario-whole-{}", std::process::id()));
        std::fs::create_dir_all(&directory).unwrap();
        let points = "t,x,y,z\r\n0,0,0,1\n1,0.2,0,1\n2,0.5,0.1,1\n3,0.5,0.1,1\n";
        std::fs::write(directory.join("path.csv"), points).unwrap();
        let paper = include_str!("../../vehicles/hummingbird.toml");
        let (head, _) = paper.split_once("\n[reference]").unwrap();
        let file = directory.join("named.toml");
        std::fs::write(&file, format!("{head}\n[reference] # here\nkind = \"trajectory\"\nfile = \"path.csv\"\n"))
            .unwrap();
        let (named, text) = (Scenario::load(&file).unwrap(), read(&file).unwrap());
        std::fs::remove_dir_all(&directory).unwrap();
        let whole = Scenario::parse(&text, "elsewhere").unwrap();
        assert!(named.flies_like(&whole) && text.contains("# here"), "{text}");
    }
}
