use super::*;
use crate::flight::Flight;
use crate::flight::claims;
use crate::flight::extremes::FlightExtremes;
use scenario::verdict::Verdict;
use std::path::Path;

/// The files of `vehicles/published`.
fn published() -> Vec<(String, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../vehicles/published");
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files.iter().map(|file| (file.display().to_string(), std::fs::read_to_string(file).unwrap())).collect()
}

#[test]
fn every_published_vehicle_recovers_flies_a_circle_and_holds_every_claim() {
    let files = published();
    assert!(files.len() >= 13);
    for (file, text) in files {
        let FlownFile { scenario, text: _, added } = with_default_task(text.clone(), &file).unwrap();
        let plain = Scenario::parse(&text, &file).unwrap();
        assert_eq!(scenario.configuration, plain.configuration, "{file}: certify's verdict is about this flight too");
        let added = added.unwrap_or_else(|| panic!("{file}: nothing to look at"));
        let verdict = Verdict::judge(&scenario).unwrap();
        let flight = Flight::certified(&scenario, verdict.certified().unwrap()).unwrap();
        let flown = FlightExtremes::gather(&scenario, flight).unwrap();
        let claims = claims::claims(&scenario, &verdict, &flown);
        println!(
            "{file}: {added}; {} s, falls {:.2} m, there at {:?} s, strays {:?}",
            scenario.timing.duration(),
            flown.height_lost,
            flown.position_reached(),
            flown.strayed
        );
        assert!(claims::all_hold(&claims), "{file}: {added}\n{}", claims::table(&claims));
        assert!(flown.height_lost < START_HEIGHT_M, "{file}: falls {} m", flown.height_lost);
    }
}

#[test]
fn a_file_with_a_start_a_reference_or_the_papers_law_is_flown_as_it_is() {
    let vehicle = &published()[0].1;
    for text in [
        scenario::PAPER.to_owned(),
        scenario::STUDY.to_owned(),
        format!("duration = 5.0\n{vehicle}"),
        format!("{vehicle}\n[initial]\nposition = [0.0, 0.0, 2.0]\n"),
        format!("{vehicle}\n[reference]\nkind = \"hover\"\nposition = [0.0, 0.0, 2.0]\n"),
    ] {
        let shown = with_default_task(text.clone(), "a test").unwrap();
        assert_eq!((shown.text, shown.added), (text, None));
    }
}

#[test]
fn what_the_file_says_of_time_and_air_stays() {
    let vehicle = &published()[0].1;
    let text = format!(
        "\u{feff}duration = 33.0\n{vehicle}\n[battery]\nfull_voltage = 12.6\nempty_voltage = 10.5\nresistance = 0.03\ncapacity = 2.2\n"
    );
    let FlownFile { scenario, added, .. } = with_default_task(text, "a test").unwrap();
    assert_eq!(scenario.timing.duration(), 33.0);
    assert!(scenario.reality.wind.is_none() && scenario.reality.disturbance.is_none());
    assert!(!added.unwrap().contains("gust"));
    assert!(
        with_default_task("name = 3".to_owned(), "mine.toml").err().unwrap().to_string().starts_with("mine.toml: ")
    );
}
