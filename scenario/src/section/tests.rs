//! What each reading accepts, and how it names what it refuses.

use super::*;
use crate::key::Bounds;

fn table(text: &str) -> Table {
    text.parse().unwrap()
}

#[test]
fn a_key_that_holds_a_line_end_is_reported_in_one_line() {
    let table: Table = toml::from_str("\"a\\nb\\u001B[2J\" = 0").unwrap();
    let error = Section::root(&table).allow(&["mass"]).unwrap_err().to_string();
    assert!(error.starts_with("a\\nb\\u{1b}[2J: unknown key") && error.lines().count() == 1, "{error}");
}

#[test]
fn an_unknown_key_names_the_nearest_known_one() {
    let table = table("[vehicle]\nmas = 1.0");
    let section = Section::root(&table).section("vehicle").unwrap();
    let error = section.allow(&["mass", "inertia", "gravity"]).unwrap_err();
    assert_eq!(error.field, "vehicle.mas");
    assert!(error.problem.contains("did you mean \"mass\"?"), "{error}");
}

#[test]
fn numbers_may_be_integers_but_nothing_else() {
    let table = table("a = 3\nb = \"3\"\nc = nan\nd = -inf\ne = 1e39\nf = true");
    let section = Section::root(&table);
    assert_eq!(section.number("a"), Ok(3.0));
    for (key, word) in
        [("b", "found string"), ("c", "found NaN"), ("d", "found -inf"), ("e", "within"), ("f", "found boolean")]
    {
        let error = section.number(key).unwrap_err();
        assert!(error.problem.contains(word) && error.field == key, "{error}");
    }
}

#[test]
fn a_vector_has_three_elements_and_names_the_bad_one() {
    let table = table("a = [1, 2.5, 3]\nb = [1, 2]\nc = [1, 2, inf]\nd = 7");
    let section = Section::root(&table);
    assert_eq!(section.vector("a"), Ok(Vector3::new(1.0, 2.5, 3.0)));
    assert_eq!(section.vector("b").unwrap_err().problem, "must be a list of three numbers, found 2");
    assert_eq!(section.vector("c").unwrap_err().field, "c[2]");
    assert!(section.vector("d").unwrap_err().problem.contains("found integer"));
    assert_eq!(section.vector("x").unwrap_err().problem, "missing, must be a list of three numbers");
}

#[test]
fn lookup_follows_dotted_paths_and_indices() {
    let table = table("[a]\nb = [1, 2]\np = [{ t = 3 }]\n[a.c]\nd = 0.5");
    let section = Section::root(&table);
    assert_eq!(section.lookup("a.b[1]").as_deref(), Some("2"));
    assert_eq!(section.lookup("a.c.d").as_deref(), Some("0.5"));
    assert_eq!(section.lookup("a.p[0].t").as_deref(), Some("3"));
    assert_eq!(section.lookup("a.p[1].t"), None);
    assert_eq!(section.lookup("a.x.d"), None);
}

const POINTS: Layout =
    Layout { name: "points", about: "", keys: &[Key::number("t", Bounds::between(0.0, 1.0, "s"), "")] };

#[test]
fn lists_of_tables_carry_their_index() {
    let table = table("[r]\npoints = [{ t = 0 }, { t = \"x\" }]");
    let points = Section::root(&table).section("r").unwrap().tables(&POINTS).unwrap();
    assert_eq!(points[1].number("t").unwrap_err().field, "r.points[1].t");
}

#[test]
fn numbers_and_vectors_are_held_to_the_bounds_of_their_declaration_or_are_its_default() {
    const LAYOUT: Layout = Layout {
        name: "a",
        about: "",
        keys: &[
            Key::number("x", Bounds::between(0.0, 2.0, "m"), ""),
            Key::number("y", Bounds::positive(""), "").or(7.0),
            Key::vector("z", Bounds::between(-1.0, 1.0, ""), "").or(0.5),
        ],
    };
    let table = table("[a]\nx = 3\ny = 0\nz = [0, 0, 2]\n[b]");
    let section = Section::root(&table).open(&LAYOUT).unwrap().unwrap();
    assert_eq!(section.number("x").unwrap_err().to_string(), "a.x: must be from 0 to 2 m, found 3");
    assert_eq!(section.number("y").unwrap_err().to_string(), "a.y: must be positive, found 0");
    assert_eq!(section.vector("z").unwrap_err().to_string(), "a.z[2]: must be from -1 to 1, found 2");
    let empty = Section::root(&table).section("b").unwrap().with(&LAYOUT).unwrap();
    assert_eq!((empty.number("y"), empty.vector("z")), (Ok(7.0), Ok(Vector3::repeat(0.5))));
    assert_eq!(empty.number("x").unwrap_err().to_string(), "b.x: missing, must be a number");
}

#[test]
fn keys_and_values_without_an_end_are_refused_at_once_and_in_a_short_line() {
    let endless = "k".repeat(4_000_000);
    let unknown = table(&format!("{endless} = 1"));
    let error = Section::root(&unknown).allow(&["mass", "inertia"]).unwrap_err().to_string();
    assert!(error.len() < 3000 && error.ends_with("k: unknown key (allowed: mass, inertia)"), "{error}");
    let error = FieldError::new("name", format!("must be short, found {endless:?}")).to_string();
    assert!(error.len() < 3000 && error.starts_with("name: must be short, found \"kkk"), "{error}");
}

#[test]
fn all_that_is_missing_is_named_together() {
    let table = "mass = 1.0".parse().unwrap();
    let section = Section::root(&table);
    let missing = section.require_all(&["mass", "inertia", "gravity"]).unwrap_err();
    assert_eq!(missing.to_string(), "inertia: missing, as are gravity");
    assert!(section.require_all(&["mass"]).is_ok());
}
