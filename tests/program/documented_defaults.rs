//! The defaults of the extended law on the page of scenario files: the page shows each formula as the law declares it.

use controller_core::extended::defaults::Quantities;
use controller_core::extended::parameters::ExtendedParameters;
use std::fs;
use std::path::Path;

/// A formula as the page writes it: names alone, products without a sign, whole numbers without a point.
fn shown(formula: &str) -> String {
    let spaced = formula.split_whitespace().collect::<Vec<_>>().join(" ").replace("d.", "").replace("()", "");
    let whole = |end: &str| format!(".0{end}");
    let spaced = format!("{} ", spaced.replace(" * ", " "));
    [" ", ",", ")"].iter().fold(spaced, |text, end| text.replace(&whole(end), end)).trim_end().to_owned()
}

#[test]
fn the_page_shows_the_formulas_of_the_law() {
    let page = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/scenario-file.md")).unwrap();
    let constants = ExtendedParameters::TABLE.iter().map(|constant| (constant.path, constant.formula));
    let mut wrong = String::new();
    for (name, formula) in constants.chain(Quantities::FORMULAS.iter().copied()) {
        let row =
            page.lines().find(|line| line.starts_with(&format!("| `{name}` | "))).unwrap_or_else(|| panic!("{name}"));
        let (_, said) = row.trim_end_matches(" |").rsplit_once(" | ").unwrap();
        let expected = format!("`{}`", shown(formula));
        if said != expected {
            wrong += &format!("{name}: {expected}, the page has {said}\n");
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}
