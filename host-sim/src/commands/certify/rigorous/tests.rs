use super::*;
use controller_core::configuration::LawParameters;
use std::path::Path;

/// Every scenario and vehicle that comes with the project, those of other projects among them.
fn shipped() -> Vec<Scenario> {
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let folders = ["scenarios", "vehicles", "vehicles/published"].map(|folder| top.join(folder));
    let files = folders.iter().flat_map(|folder| std::fs::read_dir(folder).unwrap());
    let mut paths: Vec<_> = files.map(|file| file.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    paths.sort();
    paths.iter().map(|path| Scenario::load(path).unwrap()).collect()
}

/// `cargo test -p host-sim certify::rigorous -- --nocapture` prints the table of docs/certificate.md.
#[test]
fn rounding_decides_nothing_for_any_shipped_or_published_vehicle() {
    let scenarios = shipped();
    assert!(scenarios.len() >= 28, "{}", scenarios.len());
    println!("| scenario | law | inequalities | tightest, margin | rounding takes at most |\n|---|---|---|---|---|");
    for scenario in &scenarios {
        let rigorous = Rigorous::new(&scenario.configuration).unwrap();
        let nearest = Certificate::new(&scenario.configuration).unwrap();
        let tightest = nearest.tightest().unwrap();
        let law = if matches!(scenario.configuration.law(), LawParameters::Paper(_)) { "paper" } else { "extended" };
        println!(
            "| {} | {law} | {} | {}, {:.2} % | {:.0e} |",
            scenario.name,
            rigorous.rows.len(),
            tightest.name,
            100.0 * tightest.margin(),
            rigorous.greatest_difference()
        );
        assert_eq!(rigorous.undecided().count(), 0, "{}", scenario.name);
        assert_eq!(rigorous.holds(), nearest.holds(), "{}", scenario.name);
        assert!(rigorous.greatest_difference() < 1e-10, "{}", rigorous.report());
        for (nearest, enclosed) in &rigorous.rows {
            for (to_nearest, sides) in [(nearest.required, enclosed.required), (nearest.available, enclosed.available)]
            {
                assert!(sides.lower() <= to_nearest && to_nearest <= sides.upper(), "{}: {sides:?}", nearest.name);
            }
        }
    }
}

#[test]
fn an_inequality_that_rounding_decides_is_named_and_does_not_hold() {
    let row = |required: f64, available: f64| {
        (
            Inequality::new("a row", "N", required, available),
            Inequality::new("a row", "N", Enclosure::from(required) * 1.0, Enclosure::from(available) * 1.0),
        )
    };
    let near = Rigorous { rows: vec![row(1.0, 2.0), row(1.0, 1.0_f64.next_up())] };
    assert!(!near.holds());
    assert_eq!(near.undecided().collect::<Vec<_>>(), ["a row"]);
    assert!(near.report().contains("FAILS") && near.report().contains("rounding decides a row;"), "{}", near.report());
    let far = Rigorous { rows: vec![row(1.0, 1.0 + 1e-14)] };
    assert!(far.holds() && far.undecided().count() == 0, "{}", far.report());
    let failing = Rigorous { rows: vec![row(2.0, 1.0), row(f64::INFINITY, 1.0)] };
    assert!(
        !failing.holds() && failing.report().contains("the same inequalities are not shown to hold"),
        "{}",
        failing.report()
    );
}

#[test]
fn a_reference_that_takes_less_than_what_is_left_does_so_whatever_rounding_did() {
    for scenario in shipped() {
        let Some((sentence, holds)) = along(&scenario) else { continue };
        let nearest = scenario::along::Along::judge(&scenario).unwrap();
        assert!(holds == nearest.holds() && sentence.ends_with("holds\n"), "{}: {sentence}", scenario.name);
        let share = format!("{:.1} %", 100.0 * nearest.taken.share);
        assert!(sentence.contains(&share), "{}: {sentence} {share}", scenario.name);
    }
}
