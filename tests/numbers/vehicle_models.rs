//! Models in the shapes that public files have, `tests/numbers/vehicle_import/corpus`: what becomes of each is what the
//! table of docs/import.md says; where their parts stand; and that a vehicle file that is there already is kept.

use crate::support::binary::{self, files, host_sim, status, stderr, stdout};
use host_sim::identification::import::numbers::{Actuation, VehicleNumbers};
use host_sim::identification::import::read;
use host_sim::identification::import::written::{Wishes, written};
use nalgebra::Vector3;
use scenario::Scenario;
use scenario::verdict::Verdict;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// A lag for sources that have none, s.
const LAG_TEXT: &str = "0.05";

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/numbers/vehicle_import")
}

fn vehicle(name: &str) -> Result<VehicleNumbers, String> {
    let path = folder().join(name);
    read(&fs::read_to_string(&path).unwrap(), &path, None)
}

/// What becomes of a source, as the table says it.
fn outcome(name: &str) -> String {
    let given = |lag: bool| if lag { vec![("rotors.lag".to_owned(), LAG_TEXT.to_owned())] } else { Vec::new() };
    let whole = |lag: bool| {
        let wishes = Wishes { given: given(lag), neglect_products: false };
        vehicle(name).map(|vehicle| written(&vehicle, "corpus", name, &wishes).unwrap())
    };
    let file = match whole(false) {
        Err(error) => return format!("refused: {error}"),
        Ok(file) => file,
    };
    let lag_alone = file.missing == ["rotors.lag"];
    if !file.missing.is_empty() && !lag_alone {
        return format!("lacks {}", file.missing.join(", "));
    }
    let certified = if lag_alone { "certified, given a lag" } else { "certified" };
    match Scenario::parse(&whole(lag_alone).unwrap().text, "f") {
        Err(error) => format!("refused: {}", error.what),
        Ok(scenario) => match Verdict::judge(&scenario).unwrap().refusal() {
            Some(refusal) => format!("not certified: {refusal}"),
            None => certified.to_owned(),
        },
    }
}

/// The files below a folder that are sources by themselves.
fn sources(folder: &Path, prefix: &str) -> BTreeSet<String> {
    let mut all = BTreeSet::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = format!("{prefix}{}", path.file_name().unwrap().to_str().unwrap());
        if path.is_dir() {
            all.extend(sources(&path, &format!("{name}/")));
        } else {
            all.insert(name);
        }
    }
    all
}

#[test]
fn what_becomes_of_each_model_is_what_the_page_says() {
    let page = fs::read_to_string(folder().join("../../../docs/import.md")).unwrap();
    let (_, table) = page.split_once("| model | its shape | what becomes of it |\n|---|---|---|\n").unwrap();
    let rows = table.lines().take_while(|line| line.starts_with("| `"));
    let mut listed = BTreeSet::new();
    let mut wrong = String::new();
    for row in rows {
        let cells: Vec<&str> = row.trim_matches('|').split(" | ").map(str::trim).collect();
        let (name, said) = (cells[0].trim_matches('`'), cells[2].replace('`', ""));
        let found = outcome(name).replace('`', "");
        let same = said.strip_suffix('…').map_or(found == said, |start| found.starts_with(start));
        if !same {
            wrong += &format!("{name}: {found}\nis shown as: {said}\n");
        }
        listed.insert(name.to_owned());
    }
    assert!(wrong.is_empty(), "{wrong}");
    // What others include is no vehicle of its own.
    let parts = |name: &String| name.starts_with("x500_base/") || name.starts_with("corpus/by_config/camera/");
    let there: BTreeSet<String> = sources(&folder(), "").into_iter().filter(|name| !parts(name)).collect();
    assert_eq!(listed, there);
}

/// Mass, and where the first rotor stands.
fn first_rotor(name: &str) -> (f64, Vector3<f64>) {
    let vehicle = vehicle(name).unwrap_or_else(|error| panic!("{name}: {error}"));
    let Actuation::Rotors(rotors) = vehicle.actuation else { panic!("{name}") };
    assert_eq!(rotors.spin.map(|spin| spin.len()), Some(4), "{name}");
    (vehicle.mass.unwrap(), rotors.position.unwrap()[0])
}

#[test]
fn parts_stand_where_scopes_frames_and_joints_say() {
    // Four rotors of 5 g, 2 cm above the body of 1.5 kg.
    let plain = Vector3::new(0.17, -0.17, 0.02 * 1.5 / 1.52);
    let own_centre = 0.01 * 1.5 / 1.52;
    for (name, mass, position) in [
        ("corpus/actuator_number.sdf", 1.52, plain),
        ("corpus/renamed_plugin.sdf", 1.52, plain),
        ("corpus/scoped_links.sdf", 1.52, plain),
        ("corpus/frames.sdf", 1.52, plain),
        ("corpus/nested_names.sdf", 1.54, Vector3::new(0.17, -0.17, 0.02 * 1.52 / 1.54)),
        ("corpus/inertial_relative_to.sdf", 1.52, plain - Vector3::z() * own_centre),
        ("corpus/by_config/quadrotor/model.sdf", 1.53, Vector3::new(0.17, -0.17, 0.02 * 1.51 / 1.53)),
    ] {
        let (found_mass, found) = first_rotor(name);
        assert!((found_mass - mass).abs() < 1e-9 && (found - position).amax() < 1e-9, "{name}: {found_mass}, {found}");
    }
}

#[test]
fn a_vehicle_file_that_is_there_is_kept_with_what_somebody_measured() {
    let directory = binary::directory("vehicle_models", "kept");
    let source = folder().join("cf2x.urdf");
    let import = |more: &[&str]| {
        let asked = [&["vehicle", source.to_str().unwrap(), "--out", "mine.toml"], more].concat();
        let output = host_sim(&directory, &asked);
        (status(&output), stdout(&output) + &stderr(&output))
    };
    assert_eq!(import(&[]).0, 1);
    let file = directory.join("mine.toml");
    let written = fs::read_to_string(&file).unwrap();
    // The same file once more changes nothing.
    assert_eq!(import(&[]).0, 1);
    let measured = written.replace("lag = \"missing\"", "lag = 0.048 # thrust stand, 3 May");
    fs::write(&file, &measured).unwrap();
    let (code, said) = import(&[]);
    let wanted = "error: mine.toml: is there: rotors.lag = 0.048 would become \"missing\"; --with KEY=VALUE keeps a \
                  number, --overwrite none\n";
    assert_eq!((code, said.as_str()), (2, wanted));
    // A comment counts as well.
    let (code, said) = import(&["--with", "rotors.lag=0.048"]);
    assert!(code == 2 && said.contains("is there with other comments"), "{said}");
    assert_eq!(fs::read_to_string(&file).unwrap(), measured);
    assert_eq!(import(&["--with", "rotors.lag=0.05", "--overwrite"]).0, 0);
    assert!(fs::read_to_string(&file).unwrap().contains("lag = 0.05\n"));
    fs::write(&file, [0xff, 0xfe]).unwrap();
    let (code, said) = import(&[]);
    assert!(code == 2 && said.starts_with("error: mine.toml: is there: "), "{said}");
    assert_eq!(files(&directory), ["mine.toml"]);
}
