use super::*;
use crate::flight::Flight as ClosedLoop;
use crate::reports::log;
use crate::reports::plots::FIRST_SECONDS;
use crate::reports::report::track::encoded;
use serde_json::Value;

/// The page of a flight of `text`, and log.csv of the same flight.
fn flown(text: &str) -> (Page, String) {
    let scenario = Scenario::parse(text, "test").unwrap();
    let verdict = Verdict::judge(&scenario).unwrap();
    let mut flight = ClosedLoop::new(&scenario).unwrap();
    let (mut seen, mut recorder, mut rows) = (FlightExtremes::new(&scenario), recorder(&scenario), Vec::new());
    for _ in 0..scenario.timing.ticks {
        let tick = flight.tick().unwrap();
        log::write_row(&mut rows, &tick).unwrap();
        seen.observe(&tick);
        recorder.observe(&tick);
    }
    let claims = claims::claims(&scenario, &verdict, &seen);
    let flight = Flight {
        law: &LawChoice::Ours,
        scenario: &scenario,
        text,
        verdict: &verdict,
        certification: "certified",
        claims: &claims,
        flown: &seen,
    };
    let rotors = scenario.configuration.rotors().map_or(0, |rotors| rotors.len());
    let header =
        log::header(rotors, scenario.configuration.paper().is_none()) + &log::reality_header(&scenario.reality);
    (page(&flight, recorder).0, format!("{header}\n{}", String::from_utf8(rows).unwrap()))
}

/// A column of log.csv, in the page's precision.
fn logged(log: &str, name: &str) -> Option<Vec<f32>> {
    let mut lines = log.lines();
    let place = lines.next()?.split(',').position(|column| column == name)?;
    Some(lines.map(|row| row.split(',').nth(place).unwrap().parse::<f64>().unwrap() as f32).collect())
}

fn data(html: &str) -> Value {
    let (_, data) = html.split_once("id=\"data\">").unwrap();
    serde_json::from_str(data.split_once("</script>").unwrap().0).unwrap()
}

fn brief(text: &str, duration: &str, further: &str) -> String {
    let lines = text.lines().map(|line| if line.starts_with("duration") { duration } else { line });
    lines.collect::<Vec<_>>().join("\n") + "\n" + further
}

#[test]
fn the_numbers_in_the_page_are_the_logs() {
    let hummingbird = include_str!("../../../../../vehicles/hummingbird.toml");
    let further = "[wind]\nsteady = [1.5, 0, 0]\n[sensors]\n[battery]\nfull_voltage = 12\nempty_voltage = 11\nresistance = 0.01\ncapacity = 1\n";
    for (text, further, expected) in [(scenario::PAPER, "", 38), (hummingbird, further, 54)] {
        let (page, log) = flown(&brief(text, "duration = 3.0", further));
        let data = data(&page.html());
        let columns = data["tracks"][0]["columns"].as_object().unwrap();
        let mut compared = 0;
        for (name, values) in columns {
            // Without jumps and in degrees, the page's; all else that bears a name of the log's is the log's.
            if let Some(logged) = logged(&log, name).filter(|_| !name.starts_with("yaw")) {
                assert_eq!(values.as_str().unwrap(), encoded(&logged), "{name}");
                compared += 1;
            }
        }
        assert_eq!(compared, expected, "{}", page.title);
        // Yaw is the same but for whole turns.
        let (yaw, log_yaw) = (page.tracks[0].column("yaw").unwrap(), logged(&log, "yaw").unwrap());
        for (page, log) in yaw.iter().zip(&log_yaw) {
            let turns = (page - log.to_degrees()) / 360.0;
            assert!((turns - turns.round()).abs() < 1e-5, "{page} {log}");
        }
    }
}

#[test]
fn everything_that_was_recorded_is_drawn_or_moves_the_replay() {
    let estimator = "[estimator]\n";
    for further in ["[sensors]\n", estimator] {
        let (page, _) =
            flown(&brief(include_str!("../../../../../vehicles/hummingbird.toml"), "duration = 1.0", further));
        let blocks: Vec<&Block> = page.sections.iter().flat_map(|section| &section.blocks).collect();
        let plots =
            blocks.iter().find_map(|block| if let Block::Plots(plots) = block { Some(plots) } else { None }).unwrap();
        for (column, _) in &page.tracks[0].columns {
            let drawn = plots.iter().flat_map(|plot| &plot.curves).any(|curve| curve.column == *column);
            let moves = ["qw", "qx", "qy", "qz", "clipped"].contains(&column.as_str());
            assert!(drawn || moves, "{column} is nowhere to be seen");
        }
        for title in [FIGURE_1, FIGURE_2, FIRST_SECONDS].concat() {
            assert!(plots.iter().any(|plot| plot.title == title), "no plot called {title} for the figures");
        }
        let torques = plots.iter().find(|plot| plot.title == "Torques").unwrap();
        assert!(torques.bounds.iter().filter(|bound| bound.label.contains("proven")).count() >= 2);
        let rotors = plots.iter().find(|plot| plot.title == "Rotor thrusts").unwrap();
        assert_eq!(rotors.bounds.iter().filter(|bound| bound.label.contains("proven")).count(), 8);
    }
}

#[test]
fn the_papers_flight_takes_less_than_a_megabyte_and_a_half_and_ten_minutes_no_more() {
    let (page, _) = flown(scenario::PAPER);
    let whole = page.html().len();
    assert!(whole < 1_500_000, "{whole} bytes");
    let (page, _) = flown(&brief(scenario::PAPER, "duration = 600.0", ""));
    let long = page.html().len();
    // The numbers take as many bytes; the still pictures of a livelier flight take some more.
    assert!(long < 1_500_000, "{long} bytes, {whole} for a flight of 40 s");
}

#[test]
fn a_scenario_written_to_break_the_page_stays_text() {
    let attack = "</script><script>alert(1)</script>";
    let (page, _) = flown(&brief(scenario::PAPER, "duration = 1.0", &format!("# {attack}\n")));
    let html = page.html();
    assert_eq!(html.matches("<script").count(), 2);
    assert!(html.contains("# &lt;/script&gt;&lt;script&gt;alert(1)&lt;/script&gt;"));
}
