//! `compare`, and `campaign --law`, as a user meets them: scenes, files, statuses, gains, and that both fly the same
//! random flights.

use crate::support::binary;
use crate::support::binary::{files, host_sim, status, stderr, stdout, with};
use arrow_array::cast::AsArray;
use arrow_array::types::{Float64Type, UInt64Type};
use host_sim::rivals::gains::{BUILT_IN, Set};
use host_sim::rivals::kind::RivalKind;
use scenario::Scenario;
use std::fs;
use std::path::{Path, PathBuf};

const HUMMINGBIRD: &str = include_str!("../../vehicles/hummingbird.toml");
/// Not thrown at all: near where it is to be, at rest, level. Other scenes stay as they are.
const GENTLE_CAMPAIGN: &str = "[campaign]\nduration = 2\nreference = \"hover\"\nattitude = \"file\"\noffset = 0.1\nvelocity = 0\nrate = 0\nyaw_rate = 0\nwind = 0\n";
/// Thrown, and out of time.
const HOPELESS_CAMPAIGN: &str = "[campaign]\nduration = 1.0\n";
const LAWS: [&str; 8] = ["ours", "lee", "px4", "mellinger", "indi", "nested", "continuous", "memoryless"];
const SCENES: [&str; 10] =
    ["own", "step", "far step", "upside down", "gust", "storm", "noise", "weak rotors", "heavy", "random"];
const WRITTEN_FILES: [&str; 4] = ["compare.csv", "random.svg", "report.html", "scenes.svg"];

/// A directory of this suite, with the Hummingbird in it on a flight of its own that is over in 2 s.
fn directory(test: &str, campaign: &str) -> PathBuf {
    let directory = binary::directory("cli_compare", test);
    let brief = with(HUMMINGBIRD, "duration =", "duration = 2.0");
    fs::write(directory.join("h.toml"), format!("{brief}\n{campaign}")).unwrap();
    directory
}

/// compare.csv: its head, and a row for each figure.
fn table(directory: &Path) -> (Vec<String>, Vec<Vec<String>>) {
    let cells = |line: &str| line.split(',').map(|cell| cell.trim_matches('"').to_owned()).collect::<Vec<_>>();
    let text = fs::read_to_string(directory.join("compare.csv")).unwrap();
    // A quoted name may hold a comma.
    let text = text.replace(", ", "; ");
    let mut lines = text.lines();
    (cells(lines.next().unwrap()), lines.map(cells).collect())
}

#[test]
fn a_comparison_has_every_scene_every_law_and_all_its_files() {
    let directory = directory("files", GENTLE_CAMPAIGN);
    let compared = host_sim(&directory, &["compare", "h.toml", "--flights", "3", "--out", "out"]);
    let text = stdout(&compared);
    assert_eq!((status(&compared), stderr(&compared)), (0, String::new()), "{text}");
    assert!(text.starts_with("hummingbird: our law and 7 others; 3 random flights of each\n"), "{text}");
    assert!(text.contains("every random flight of ours settles, unclipped, within its bounds"), "{text}");
    assert_eq!(files(&directory.join("out")), WRITTEN_FILES);

    let (head, rows) = table(&directory.join("out"));
    assert_eq!(head[..3], ["scene", "figure", "unit"]);
    assert_eq!(
        (&head[3..11], &head[11..]),
        (&LAWS.map(str::to_owned)[..], &["ours_loses", "limit"].map(str::to_owned)[..])
    );
    let mut scenes: Vec<&str> = rows.iter().map(|row| row[0].as_str()).collect();
    scenes.dedup();
    assert_eq!(scenes, SCENES);
    for row in &rows {
        let values: Vec<f64> = row[3..11].iter().map(|cell| cell.parse().unwrap()).collect();
        assert!(values.iter().all(|value| *value >= 0.0), "{row:?}");
        // Lost where another law is clearly better, and nowhere else; how little matters differs from row to row.
        let best = values[1..].iter().copied().fold(f64::INFINITY, f64::min);
        assert!(row[11] != "true" || best < 0.99 * values[0], "{row:?}");
        assert!(row[11] == "true" || best >= 0.99 * values[0] || values[0] - best < 0.11, "{row:?}");
    }
    let starred = text.lines().filter(|line| line.starts_with("*  ") || line.starts_with("*   ")).count();
    assert_eq!(starred, rows.iter().filter(|row| row[11] == "true").count(), "{text}");
    for picture in ["random.svg", "scenes.svg"] {
        let drawn = fs::read_to_string(directory.join("out").join(picture)).unwrap();
        let curves = drawn.matches("<polyline").count();
        assert!(drawn.starts_with("<svg") && curves >= 4 * 7, "{picture}: {curves} curves");
    }

    // The page says the same: every row with its star, every law in every scene, and the gains that flew.
    let page = fs::read_to_string(directory.join("out/report.html")).unwrap();
    assert_eq!(page.matches("<td>★</td>").count(), starred);
    let data = page.split("id=\"data\">").nth(1).unwrap().split("</script>").next().unwrap();
    let data: serde_json::Value = serde_json::from_str(data).unwrap();
    let labels = |curves: &serde_json::Value| {
        let curves = curves.as_array().unwrap().iter();
        curves.map(|curve| curve["label"].as_str().unwrap().to_owned()).collect::<Vec<String>>()
    };
    let plots = data["plots"].as_array().unwrap();
    // Two scenes show height as well.
    assert_eq!((plots.len(), data["distributions"].as_array().unwrap().len()), (SCENES.len() - 1 + 2, 4));
    assert!(plots.iter().all(|plot| labels(&plot["curves"]) == LAWS), "{:?}", plots[0]);
    assert!(data["distributions"].as_array().unwrap().iter().all(|spread| labels(&spread["groups"]) == LAWS));
    let looks = plots[0]["curves"].as_array().unwrap().iter().map(|curve| curve["color"].as_str().unwrap());
    assert_eq!(looks.collect::<std::collections::BTreeSet<&str>>().len(), LAWS.len());
    for law in &LAWS[1..] {
        assert!(page.contains(&format!("<caption>{law}: cost ")), "{law}");
    }
}

#[test]
fn the_status_says_what_became_of_ours() {
    let directory = directory("statuses", HOPELESS_CAMPAIGN);
    let lost = host_sim(&directory, &["compare", "h.toml", "--flights", "2", "--out", "lost"]);
    assert!(stdout(&lost).contains("NOT every random flight of ours settles"), "{}", stdout(&lost));
    assert_eq!((status(&lost), files(&directory.join("lost")).len()), (1, WRITTEN_FILES.len()));

    let hungry = with(&fs::read_to_string(directory.join("h.toml")).unwrap(), "snap =", "snap = 60000.0");
    fs::write(directory.join("hungry.toml"), hungry).unwrap();
    let refused = host_sim(&directory, &["compare", "hungry.toml", "--flights", "2", "--out", "out"]);
    let message = stderr(&refused);
    assert!(status(&refused) == 1 && message.contains("hummingbird: not certified ("), "{message}");

    fs::write(directory.join("file"), "in the way").unwrap();
    fs::write(directory.join("ground.toml"), format!("{HUMMINGBIRD}\n[ground]\n")).unwrap();
    for (arguments, expected) in [
        (&["none.toml"][..], "none.toml: cannot be read"),
        (&["h.toml", "--flights", "0"], "--flights: must be from 1 to 100000, found 0"),
        (&["ground.toml"], "ground.toml: ground: a campaign throws its vehicles into the air anywhere"),
        (&["h.toml", "--tune", "0"], "--tune: must be at least 1, found 0"),
        (&["h.toml", "--tune", "1", "--population", "3"], "--population: must be from 4 to 1000, found 3"),
        (&["h.toml", "--gains", "none.toml"], "none.toml: cannot be read"),
        (&["h.toml", "--gains", "g.toml", "--tune", "1"], "cannot be used with"),
        (&["h.toml", "--only", "lee,pid"], "invalid value 'pid'"),
        (&["h.toml", "--rate", "400"], "--rate: 1/rate must be a whole number of plant steps of 0.001 s, found 400 Hz"),
        (&["h.toml", "--rate", "3"], "--rate: must be from 10 to 4000 Hz, found 3"),
    ] {
        let refused = host_sim(&directory, &[&["compare"], arguments, &["--out", "out"]].concat());
        let message = stderr(&refused);
        assert!(status(&refused) == 2 && message.contains(expected), "{arguments:?}: {message}");
    }
    assert!(!directory.join("out").exists());
    let blocked = host_sim(&directory, &["compare", "h.toml", "--flights", "1", "--out", "file"]);
    assert!(status(&blocked) == 2 && stderr(&blocked).contains("file: cannot be written"), "{}", stderr(&blocked));
}

#[test]
fn gains_that_cannot_be_used_are_refused_by_file_field_and_reason() {
    let directory = directory("gains", GENTLE_CAMPAIGN);
    for (from, to, expected) in [
        ("[hummingbird.lee]", "[hummingbird.lee", "g.toml: "),
        ("[hummingbird.lee]", "[hummingbird.lea]", "g.toml: hummingbird.lee: missing"),
        ("k_r_tilt = ", "k_r_tilt = -", "g.toml: hummingbird.lee.k_r_tilt: must be a finite number greater than zero"),
        ("k_r_tilt = ", "k_r_tilt = \"1\" #", "g.toml: hummingbird.lee.k_r_tilt: must be a finite number"),
        ("k_r_tilt = ", "k_tilt = ", "g.toml: hummingbird.lee.k_tilt: unknown; known are cost and k_x_across"),
        ("mass = 0.5\n", "mass = 0.51\n", "g.toml: no table is of hummingbird's vehicle (mass = 0.5, "),
    ] {
        let text = BUILT_IN.replace(from, to);
        assert_ne!(text, BUILT_IN, "{from}");
        fs::write(directory.join("g.toml"), text).unwrap();
        for command in [&["compare", "h.toml"][..], &["campaign", "h.toml", "--law", "lee"]] {
            let refused =
                host_sim(&directory, &[command, &["--flights", "1", "--gains", "g.toml", "--out", "out"]].concat());
            let message = stderr(&refused);
            assert!(
                status(&refused) == 2 && message.lines().count() == 1 && message.contains(expected),
                "{to}: {message}"
            );
            assert!(!directory.join("out").exists(), "{to}");
        }
    }
    // A campaign of another vehicle is refused: there are no gains for it. The message says how to find some.
    heavier(&directory);
    let refused = host_sim(&directory, &["campaign", "heavier.toml", "--law", "lee", "--flights", "1"]);
    let message = stderr(&refused);
    assert!(
        status(&refused) == 2 && message.contains("the built-in gains: no table is of hummingbird's vehicle"),
        "{message}"
    );
    assert!(message.contains("those there are of: hummingbird, ") && message.contains("gains.toml"), "{message}");
}

/// A vehicle of which no gains are built in, in `directory`.
fn heavier(directory: &Path) {
    let heavier = with(&fs::read_to_string(directory.join("h.toml")).unwrap(), "mass =", "mass = 0.52");
    fs::write(directory.join("heavier.toml"), heavier).unwrap();
}

#[test]
fn a_vehicle_without_gains_has_them_searched_and_kept_for_the_next_time() {
    let directory = directory("searched", GENTLE_CAMPAIGN);
    heavier(&directory);
    let compare = ["compare", "heavier.toml", "--flights", "1", "--out", "out"];
    let least = ["--generations", "1", "--population", "4"];
    let found = host_sim(&directory, &[&compare[..], &least].concat());
    let (text, message) = (stdout(&found), stderr(&found));
    assert!(status(&found) < 2, "{message}");
    let first = message.lines().next().unwrap_or_default();
    assert!(first.starts_with("hummingbird: no gains of the other laws are built in for this vehicle"), "{message}");
    assert!(text.contains("gains found in out/gains.toml: --gains out/gains.toml takes them the next time"), "{text}");
    assert_eq!(files(&directory.join("out")), [&WRITTEN_FILES[..1], &["gains.toml"], &WRITTEN_FILES[1..]].concat());
    let gains = fs::read_to_string(directory.join("out/gains.toml")).unwrap();
    assert!(
        gains.starts_with(
            "# host-sim compare heavier.toml --tune 1 --population 4 --seed 1
"
        ),
        "{gains}"
    );

    // They are taken without another search.
    let (_, rows) = table(&directory.join("out"));
    let again = host_sim(&directory, &[&compare[..], &["--gains", "out/gains.toml"]].concat());
    assert_eq!((status(&again), stderr(&again)), (status(&found), String::new()));
    assert_eq!(table(&directory.join("out")).1.len(), rows.len());
    let thrown = ["campaign", "heavier.toml", "--law", "lee", "--gains", "out/gains.toml", "--flights", "1"];
    assert!(status(&host_sim(&directory, &thrown)) < 2);

    // Gains of another vehicle are not shown as those that flew.
    let refused = host_sim(&directory, &["compare", "h.toml", "--flights", "1", "--out", "out"]);
    let message = stderr(&refused);
    assert!(status(&refused) == 2 && message.contains("out/gains.toml: holds other gains"), "{message}");
}

#[test]
fn a_search_does_not_begin_where_its_end_is_known() {
    let directory = directory("in vain", GENTLE_CAMPAIGN);
    heavier(&directory);
    let text = fs::read_to_string(directory.join("heavier.toml")).unwrap();
    fs::write(directory.join("hungry.toml"), with(&text, "snap =", "snap = 60000.0")).unwrap();
    let refused = host_sim(&directory, &["compare", "hungry.toml", "--out", "out"]);
    let message = stderr(&refused);
    assert!(status(&refused) == 1 && message.contains("not certified (") && message.lines().count() == 1, "{message}");
    fs::write(directory.join("file"), "in the way").unwrap();
    for out in ["file", "file/out"] {
        let refused = host_sim(&directory, &["compare", "heavier.toml", "--out", out]);
        let message = stderr(&refused);
        assert!(status(&refused) == 2 && message.contains(&format!("{out}: cannot be written")), "{message}");
        assert_eq!(message.lines().count(), 1, "{message}");
    }
    let refused = host_sim(&directory, &["compare", "heavier.toml", "--generations", "0"]);
    assert_eq!((status(&refused), stderr(&refused).lines().count()), (2, 1), "{}", stderr(&refused));
}

#[test]
fn a_rival_without_gains_is_left_out_and_named() {
    let directory = directory("left out", GENTLE_CAMPAIGN);
    let (before, rest) = BUILT_IN.split_once("[hummingbird.lee]").unwrap();
    let (_, after) = rest.split_once("[hummingbird.px4]").unwrap();
    let without = format!("{before}[hummingbird.lee]\ncost = inf\n\n[hummingbird.px4]{after}");
    fs::write(directory.join("g.toml"), without).unwrap();
    let compared = host_sim(&directory, &["compare", "h.toml", "--flights", "1", "--gains", "g.toml", "--out", "out"]);
    let text = stdout(&compared);
    assert_eq!((status(&compared), stderr(&compared)), (0, String::new()), "{text}");
    assert!(text.starts_with("hummingbird: our law and 6 others;"), "{text}");
    let why = "eft out: lee; a search found no gains with which every trial is flown to its end";
    assert!(text.contains(why), "{text}");
    assert!(fs::read_to_string(directory.join("out/report.html")).unwrap().contains(why));
    let (head, _) = table(&directory.join("out"));
    assert_eq!(head[3..10], ["ours", "px4", "mellinger", "indi", "nested", "continuous", "memoryless"]);

    let campaign = ["campaign", "h.toml", "--law", "lee", "--gains", "g.toml", "--flights", "1"];
    let refused = host_sim(&directory, &campaign);
    let message = stderr(&refused);
    assert!(status(&refused) == 2 && message.contains("there are no gains of lee"), "{message}");
}

#[test]
fn chosen_laws_fly_at_their_own_rate_beside_ours_at_the_files() {
    let directory = directory("rate", GENTLE_CAMPAIGN);
    let compare = ["compare", "h.toml", "--flights", "2", "--only", "indi,lee"];
    let slow = host_sim(&directory, &[&compare[..], &["--out", "slow"]].concat());
    let quick = host_sim(&directory, &[&compare[..], &["--rate", "500", "--out", "quick"]].concat());
    assert_eq!([status(&slow), status(&quick)], [0, 0], "{}{}", stderr(&slow), stderr(&quick));
    let text = stdout(&quick);
    assert!(text.starts_with("hummingbird: our law and 2 others at 500 Hz; 2 random flights of each\n"), "{text}");
    assert!(text.contains("gains not found at 500 Hz: lee at 100 Hz; --tune searches better ones"), "{text}");
    assert!(!stdout(&slow).contains("gains not found"), "{}", stdout(&slow));
    let ((head, slow), (_, quick)) = (table(&directory.join("slow")), table(&directory.join("quick")));
    assert_eq!(head[3..6], ["ours", "lee", "indi"]);
    let column = |rows: &[Vec<String>], place: usize| rows.iter().map(|row| row[place].clone()).collect::<Vec<_>>();
    assert_eq!(column(&slow, 3), column(&quick, 3), "ours flies as the file says");
    for law in [4, 5] {
        assert_ne!(column(&slow, law), column(&quick, law), "{}", head[law]);
    }
    // The vehicle's own limit stands beside falls and steps, below what any law does.
    let limited: Vec<&Vec<String>> = quick.iter().filter(|row| !row[7].is_empty()).collect();
    assert_eq!(limited.len(), 4);
    for row in limited {
        let number = |place: usize| row[place].parse::<f64>().unwrap();
        assert!((3..6).all(|law| number(7) < number(law)), "{row:?}");
    }
}

#[test]
fn a_vehicle_that_is_not_as_its_file_says_flies_in_scenes_of_its_own() {
    let directory = directory("realism", GENTLE_CAMPAIGN);
    let compare = ["compare", "h.toml", "--realism", "--only", "indi", "--out", "out"];
    let flown = host_sim(&directory, &compare);
    let text = stdout(&flown);
    assert!(text.starts_with("hummingbird: our law and 1 others; the vehicle is not as the file says\n"), "{text}");
    assert_eq!(files(&directory.join("out")), ["compare.csv"]);
    let (_, rows) = table(&directory.join("out"));
    let scenes: Vec<&str> = rows.iter().step_by(4).map(|row| row[0].as_str()).collect();
    let expected = ["delay", "mass", "battery", "wind", "ground", "flywheels", "drag", "deadband", "mild"];
    assert_eq!((rows.len(), &scenes[..]), (36, &expected[..]));
    let lost = rows.iter().filter(|row| row[1] == "lost").any(|row| row[3] != "0");
    assert_eq!((status(&flown) == 1, text.contains("ours is LOST")), (lost, lost), "{text}");
}

#[test]
fn a_rotor_that_fails_has_scenes_of_its_own_and_needs_rotors() {
    let directory = directory("rotor_loss", GENTLE_CAMPAIGN);
    let flown = host_sim(&directory, &["compare", "h.toml", "--rotor-loss", "--only", "indi", "--out", "out"]);
    let text = stdout(&flown);
    assert!(text.starts_with("hummingbird: our law and 1 others; rotor 1 fails, and keeps so much"), "{text}");
    assert_eq!((status(&flown), files(&directory.join("out"))), (0, vec!["compare.csv".to_owned()]), "{text}");
    assert!(text.contains("ours always lands softly"), "{text}");
    let (_, rows) = table(&directory.join("out"));
    assert_eq!(rows.len(), 4 * 16);
    let of = |scene: &str, figure: &str, law: usize| {
        let row = rows.iter().find(|row| row[0] == scene && row[1] == figure).unwrap();
        row[3 + law].parse::<f64>().unwrap()
    };
    assert!(of("hover; 0 %", "height lost", 0) < 0.5 && of("hover; 0 %", "height lost", 1) > 3.0, "{text}");

    let bare = include_str!("../../scenarios/paper-extended.toml");
    fs::write(directory.join("bare.toml"), bare).unwrap();
    for (arguments, expected) in [
        (&["bare.toml", "--rotor-loss"][..], "bare.toml: --rotor-loss needs [rotors]"),
        (&["h.toml", "--rotor-loss", "--realism"], "cannot be used with"),
    ] {
        let refused = host_sim(&directory, &[&["compare"], arguments].concat());
        let message = stderr(&refused);
        assert!(status(&refused) == 2 && message.contains(expected), "{arguments:?}: {message}");
    }
}

#[test]
fn every_rival_has_gains_for_every_vehicle_that_is_compared() {
    for file in ["vehicles/hummingbird.toml", "vehicles/study.toml", "scenarios/paper-extended.toml"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(file);
        let set = Set::parse(&Scenario::load(&path).unwrap(), BUILT_IN, "gains.toml", &RivalKind::ALL).unwrap();
        let kinds: Vec<RivalKind> = set.rivals.iter().map(|(kind, ..)| *kind).collect();
        assert_eq!(kinds, RivalKind::ALL, "{file}");
        assert!(
            set.rivals.iter().all(|(kind, gains, cost)| gains.len() == kind.gains().len() && *cost > 0.0),
            "{file}"
        );
    }
}

/// What a campaign's file says of its flights: the schema's law, and the columns.
fn campaign(directory: &Path) -> (Option<String>, arrow_array::RecordBatch) {
    let file = fs::File::open(directory.join("campaign.arrow")).unwrap();
    let rows = arrow_ipc::reader::FileReader::try_new(file, None).unwrap().next().unwrap().unwrap();
    (rows.schema().metadata().get("law").cloned(), rows)
}

fn floats(rows: &arrow_array::RecordBatch, column: &str) -> Vec<f64> {
    let never = |value: Option<f64>| value.unwrap_or(f64::INFINITY);
    rows.column_by_name(column).unwrap().as_primitive::<Float64Type>().iter().map(never).collect()
}

fn counts(rows: &arrow_array::RecordBatch, column: &str) -> Vec<u64> {
    rows.column_by_name(column).unwrap().as_primitive::<UInt64Type>().values().to_vec()
}

#[test]
fn another_law_flies_the_very_draws_of_ours_and_of_a_comparison() {
    let directory = directory("draws", "[campaign]\nduration = 6\nseed = 3\n");
    let flights = ["--flights", "6"];
    let fly = |law: &str, out: &str| {
        let flown = host_sim(&directory, &[&["campaign", "h.toml", "--law", law, "--out", out], &flights[..]].concat());
        assert!(status(&flown) <= 1, "{}", stderr(&flown));
        (status(&flown), stdout(&flown), campaign(&directory.join(out)))
    };
    let (_, _, (own_law, own)) = fly("ours", "ours");
    let (indi_status, indi_text, (indi_law, indi)) = fly("indi", "indi");
    assert_eq!((own_law, indi_law.as_deref()), (None, Some("indi")));
    assert!(
        indi_text.starts_with("hummingbird under indi: 6 flights of 6 s from seed 3, plant step 5 ms\n"),
        "{indi_text}"
    );
    for column in ["start_px", "start_qw", "start_qz", "start_wx", "wind_x", "wind_y"] {
        assert_eq!(floats(&own, column), floats(&indi, column), "{column}");
    }
    assert_ne!(floats(&own, "height_lost"), floats(&indi, "height_lost"));
    // Nothing is promised of its commands; that they leave our bounds is counted, and changes no verdict.
    let ever = |column: &str| counts(&indi, column).iter().filter(|ticks| **ticks > 0).count();
    let tracking = floats(&indi, "settled").iter().filter(|settled| settled.is_finite()).count();
    let (beyond, clipped) = (ever("beyond"), ever("clipped"));
    let counted = format!(
        "{tracking} of 6 recover and track; {beyond} went beyond a certified bound of ours; {clipped} commanded a rotor"
    );
    assert!(beyond > 0 && indi_text.contains(&counted), "{counted}: {indi_text}");
    assert_eq!((indi_status, tracking), (0, 6), "{indi_text}");
    let manifest = fs::read_to_string(directory.join("indi/campaign.json")).unwrap();
    let vehicle = Scenario::load(&directory.join("h.toml")).unwrap();
    let k_q_tilt = Set::built_in(&vehicle, &[RivalKind::Indi]).unwrap().rivals[0].1[4];
    let said = format!("\"k_q_tilt\": {k_q_tilt}");
    assert!(manifest.contains("\"law\": \"indi\"") && manifest.contains(&said), "{manifest}");
    let manifest = fs::read_to_string(directory.join("ours/campaign.json")).unwrap();
    assert!(!manifest.contains("law") && !manifest.contains("gains"), "{manifest}");

    // The same command goes on, another law is another campaign.
    assert_eq!(fly("indi", "indi").1, indi_text);
    let refused =
        host_sim(&directory, &[&["campaign", "h.toml", "--law", "lee", "--out", "indi"], &flights[..]].concat());
    let message = stderr(&refused);
    assert!(
        status(&refused) == 2 && message.contains("not the same law (\"indi\" and \"lee\"), gains of that law;"),
        "{message}"
    );
    let other = BUILT_IN.replacen(&format!("k_q_tilt = {k_q_tilt}"), &format!("k_q_tilt = {}", k_q_tilt + 0.01), 1);
    fs::write(directory.join("g.toml"), other).unwrap();
    let changed = ["campaign", "h.toml", "--law", "indi", "--gains", "g.toml", "--out", "indi"];
    let message = stderr(&host_sim(&directory, &[&changed, &flights[..]].concat()));
    assert!(message.contains("not the same gains of that law;"), "{message}");

    // The comparison's random flights are these.
    let compared = host_sim(&directory, &[&["compare", "h.toml", "--out", "all"], &flights[..]].concat());
    assert!(status(&compared) <= 1, "{}", stderr(&compared));
    let (head, rows) = table(&directory.join("all"));
    for (law, flown) in [("ours", &own), ("indi", &indi)] {
        let column = head.iter().position(|name| name == law).unwrap();
        let of = |figure: &str| rows.iter().find(|row| row[0] == "random" && row[1] == figure).unwrap()[column].clone();
        let worst = floats(flown, "height_lost").into_iter().fold(0.0, f64::max);
        let slowest = floats(flown, "settled").into_iter().fold(0.0, f64::max);
        let share = |column: &str| {
            100.0
                * (counts(flown, column).iter().sum::<u64>() as f64 / counts(flown, "ticks").iter().sum::<u64>() as f64)
        };
        assert_eq!(of("height lost; worst"), worst.to_string(), "{law}");
        assert_eq!(of("within 0.2 m for good after; slowest"), slowest.to_string(), "{law}");
        assert_eq!(of("ticks clipped"), share("clipped").to_string(), "{law}");
        assert_eq!(of("ticks beyond our certified bounds"), share("beyond").to_string(), "{law}");
    }
}

#[test]
fn shards_and_single_flights_of_another_law_are_those_of_its_campaign() {
    let directory = directory("shards", "[campaign]\nduration = 1.0\nseed = 4\n");
    let fly = |more: &[&str]| host_sim(&directory, &[&["campaign", "h.toml", "--law", "lee"], more].concat());
    // No law recovers in a second.
    assert_eq!(status(&fly(&["--flights", "70"])), 1);
    let whole = directory.join("campaigns/hummingbird-lee");
    for (part, out) in [("1/2", "one"), ("2/2", "two")] {
        assert_eq!(status(&fly(&["--flights", "70", "--shard", part, "--out", out])), 1);
    }
    assert_eq!(status(&host_sim(&directory, &["merge", "two", "one", "--out", "merged"])), 1);
    for name in files(&whole) {
        assert_eq!(
            fs::read(whole.join(&name)).unwrap(),
            fs::read(directory.join("merged").join(&name)).unwrap(),
            "{name}"
        );
    }
    // A shard of ours does not belong to them.
    let ours = ["campaign", "h.toml", "--flights", "70", "--shard", "2/2", "--out", "ours"];
    assert_eq!(status(&host_sim(&directory, &ours)), 1);
    let refused = host_sim(&directory, &["merge", "one", "ours", "--out", "mixed"]);
    assert!(status(&refused) == 2 && stderr(&refused).contains("not the same law"), "{}", stderr(&refused));

    let again = fly(&["--flights", "70", "--replay", "6"]);
    let text = stdout(&again);
    assert!(text.starts_with("hummingbird-lee-6: 1 s flown, under the law lee, of which nothing is proven"), "{text}");
    let log = fs::read_to_string(directory.join("flights/hummingbird-lee-6/log.csv")).unwrap();
    let place = log.lines().next().unwrap().split(',').position(|name| name == "pz").unwrap();
    let heights: Vec<f64> =
        log.lines().skip(1).map(|row| row.split(',').nth(place).unwrap().parse().unwrap()).collect();
    let lowest = heights.iter().copied().fold(f64::INFINITY, f64::min);
    let (_, rows) = campaign(&whole);
    assert_eq!(floats(&rows, "height_lost")[6], (heights[0] - lowest).max(0.0));
    let ours = stdout(&host_sim(&directory, &["campaign", "h.toml", "--replay", "6"]));
    assert!(ours.starts_with("hummingbird-6: ") && !ours.contains("under the law"), "{ours}");

    for (arguments, expected) in [
        (&["--law", "pid"][..], "possible values: ours, lee, px4"),
        (&["--gains", "g.toml"], "--gains: our law's gains are the scenario's"),
    ] {
        let refused = host_sim(&directory, &[&["campaign", "h.toml"], arguments].concat());
        assert!(status(&refused) == 2 && stderr(&refused).contains(expected), "{}", stderr(&refused));
    }
}
