//! A small search from beginning to end, and each requirement on its own.

use super::candidate::Judging;
use super::chosen::chosen;
use super::space::Space;
use super::*;
use controller_core::configuration::LawParameters;
use controller_core::extended::defaults;
use controller_core::extended::parameters::ExtendedParameters;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use scenario::PAPER;
use scenario::stability::LoopMargin;

const EASY_REQUIREMENTS: Requirements = Requirements {
    margin: 0.0,
    loops: LoopMargin::FLYABLE_MIN,
    position_error: 0.01,
    mrp_error: 1e-3,
    recovery: 40.0,
    projection: false,
};

const SMALL_EFFORT: Effort = Effort { generations: 2, population: 6, seed: 3 };

fn paper() -> Scenario {
    Scenario::parse(PAPER, "f").unwrap()
}

/// The cost of the file's own gains.
fn verdict(scenario: &Scenario, requirements: Requirements) -> Verdict {
    let judge = Judge::new(scenario, requirements);
    judge.judge(&judge.start())
}

#[test]
fn table_one_meets_easy_requirements_and_loses_23_metres() {
    let verdict = verdict(&paper(), EASY_REQUIREMENTS);
    assert!(verdict.accepted(), "{verdict:?}");
    assert!((verdict.figures.height_lost - 23.3).abs() < 0.1, "{:?}", verdict.figures);
    // 2.5 m/s^2 of wind are more than M_p: it is carried away.
    assert!(verdict.figures.gust > 5.0 && verdict.figures.gust == verdict.figures.offset, "{:?}", verdict.figures);
}

#[test]
fn a_search_starts_from_the_files_gains_and_thrust_floor() {
    let floor = PAPER.replace("rate = 100.0", "rate = 100.0\nthrust_floor = 1.0");
    let scenario = Scenario::parse(&floor, "f").unwrap();
    let judge = Judge::new(&scenario, Requirements { projection: true, ..EASY_REQUIREMENTS });
    let start = judge.scenario(&judge.start()).unwrap().configuration;
    let near = |a: f32, b: f32| (a / b - 1.0).abs() < 1e-5;
    assert!(near(start.thrust_floor().unwrap(), 1.0), "{start:?}");
    assert!(near(start.gains().unwrap().k_p, 9.0) && near(start.gains().unwrap().m_omega, 0.045), "{start:?}");
}

#[test]
fn each_requirement_can_refuse_and_later_tests_count_as_nearer() {
    let refusals = [
        (Requirements { margin: 0.5, ..EASY_REQUIREMENTS }, "certificate: "),
        (
            Requirements { loops: LoopMargin { gain: 20.0, ..LoopMargin::FLYABLE_MIN }, ..EASY_REQUIREMENTS },
            "sampled loop roll: unstable at 4.48",
        ),
        (
            Requirements { loops: LoopMargin { delay: 0.1, ..LoopMargin::FLYABLE_MIN }, ..EASY_REQUIREMENTS },
            "sampled loop roll: unstable with 7.5 ms",
        ),
        (Requirements { recovery: 3.0, ..EASY_REQUIREMENTS }, "recovery: "),
        (Requirements { position_error: 1e-9, ..EASY_REQUIREMENTS }, "the file's flight: "),
        (Requirements { mrp_error: 1e-12, ..EASY_REQUIREMENTS }, "the file's flight: "),
    ];
    let mut last = f64::INFINITY;
    for (requirements, what) in refusals {
        let verdict = verdict(&paper(), requirements);
        assert!(!verdict.accepted());
        assert!(verdict.failed.as_ref().is_some_and(|failed| failed.starts_with(what)), "{what}: {verdict:?}");
        assert!(verdict.violation.floor() <= last, "{what}");
        last = verdict.violation.floor();
    }
    let unstable = Scenario::parse(&format!("{PAPER}\n[sampling]\ndelay = 0.01\n"), "f").unwrap();
    assert!(
        verdict(&unstable, EASY_REQUIREMENTS)
            .failed
            .is_some_and(|failed| failed.starts_with("sampled loop roll: unstable, spec"))
    );
}

#[test]
fn the_position_feedback_needs_the_gain_margin_too() {
    // At the actuator's command the attitude loop dominates and k_p, k_v hardly count.
    let steep = PAPER.replace("k_p = 9.0", "k_p = 900.0").replace("k_v = 6.0", "k_v = 120.0");
    let steep = Scenario::parse(&steep, "f").unwrap();
    let failed = |gain| {
        let loops = LoopMargin { gain, ..LoopMargin::FLYABLE_MIN };
        verdict(&steep, Requirements { loops, ..EASY_REQUIREMENTS }).failed.unwrap_or_default()
    };
    assert!(!failed(1.5).contains("k_p and k_v"), "{}", failed(1.5));
    assert!(failed(2.5).ends_with(": unstable with 2.5 times k_p and k_v"), "{}", failed(2.5));
}

#[test]
fn a_small_search_finds_something_at_least_as_good_as_its_start() {
    let tuned = tune(&paper(), EASY_REQUIREMENTS, SMALL_EFFORT, &Interrupt::default())
        .unwrap_or_else(|closest| panic!("{closest:?}"));
    assert!(tuned.verdict.accepted());
    assert_eq!(tuned.judged, 6 * 3);
    let own = verdict(&paper(), EASY_REQUIREMENTS);
    assert!(tuned.verdict.cost <= own.cost);
    assert_eq!(tuned.before, own);
    // The scenario it hands out is the one it judged.
    assert_eq!(verdict(&tuned.scenario, EASY_REQUIREMENTS), tuned.verdict);
}

#[test]
fn the_same_seed_gives_the_same_gains_and_another_seed_others() {
    let gains = |seed| {
        let effort = Effort { seed, population: 6, generations: 1 };
        let tuned = tune(&paper(), EASY_REQUIREMENTS, effort, &Interrupt::default())
            .unwrap_or_else(|closest| panic!("{closest:?}"));
        *tuned.scenario.configuration.gains().unwrap()
    };
    assert_eq!(gains(3), gains(3));
    assert_ne!(gains(3), gains(4));
}

#[test]
fn requirements_that_nothing_meets_give_the_closest_verdict() {
    let closest =
        tune(&paper(), Requirements { margin: 0.97, ..EASY_REQUIREMENTS }, SMALL_EFFORT, &Interrupt::default())
            .err()
            .unwrap();
    assert!(closest.failed.is_some_and(|failed| failed.starts_with("certificate: ")));
}

#[test]
fn the_projection_lowers_the_floor_below_its_greatest_value_by_the_margin() {
    let judge = Judge::new(&paper(), Requirements { projection: true, margin: 0.05, ..EASY_REQUIREMENTS });
    let mut point = judge.start();
    point[9] = 0.0;
    let configuration = judge.scenario(&point).unwrap().configuration;
    let (floor, greatest) = (configuration.thrust_floor().unwrap(), configuration.min_thrust());
    assert!((floor / greatest - 0.95).abs() < 1e-6, "{floor} of {greatest}");
}

#[test]
fn a_rewritten_file_keeps_its_comments_and_flies_the_tuned_gains() {
    let tuned = |floor: Option<f32>| {
        let mut scenario = paper();
        let own = **scenario.configuration.gains().unwrap();
        let parameters = controller_core::gains::GainParameters { k_p: 1.234_567_8, m_omega: 0.012_3, ..own };
        let gains = controller_core::gains::Gains::new(parameters, scenario.configuration.vehicle()).unwrap();
        scenario.configuration = scenario.configuration.with_gains(gains).unwrap();
        if let Some(floor) = floor {
            scenario.configuration = scenario.configuration.with_thrust_floor(floor).unwrap();
        }
        scenario.name = "mine".to_owned();
        let verdict = verdict(&scenario, EASY_REQUIREMENTS);
        Tuned { before: verdict.clone(), verdict, scenario, judged: 0 }
    };
    let (plain, floored) = (tuned(None), tuned(Some(0.4)));
    let text = output::rewritten(PAPER, &floored).unwrap();
    let read = Scenario::parse(&text, "f").unwrap();
    assert!(read.flies_like(&floored.scenario) && read.name == "mine");
    let comments = |text: &str| text.matches('#').count();
    assert_eq!(comments(&text), comments(PAPER) + 1, "{text}");
    assert!(text.starts_with("# Tuned: height lost from upside down "), "{text}");

    // Again, without projection: the floor goes, and what was said of the last result.
    let again = output::rewritten(&text, &plain).unwrap();
    assert!(Scenario::parse(&again, "f").unwrap().flies_like(&plain.scenario), "{again}");
    assert_eq!((comments(&again), again.contains("thrust_floor")), (comments(&text), false));
    // A file without [control] gets one.
    let (before, rest) = PAPER.split_once("[control]").unwrap();
    let bare = format!("{before}[plant]{}", rest.split_once("[plant]").unwrap().1);
    let read = output::rewritten(&bare, &floored).unwrap();
    assert!(read.contains("[control]\nthrust_floor = 0.4"), "{read}");
}

#[test]
fn the_widest_bounds_leave_the_margin_and_no_more() {
    let scenario = Scenario::parse(&PAPER.replace("[0.5, 0.5, 0.5]", "[1.0, 1.0, 1.0]"), "f").unwrap();
    let (factor, bounds) = widest_bounds(&scenario.configuration, 0.05).unwrap();
    assert!(factor > 1.0, "{factor}");
    let margin = |bounds| {
        let wider = scenario.configuration.with_bounds(bounds).unwrap();
        Certificate::new(&wider).unwrap().tightest().unwrap().margin()
    };
    assert!((0.05..0.0501).contains(&margin(bounds)), "{}", margin(bounds));
}

/// The files of the extended law that this project ships, beside the siblings on the paper's trajectory.
const EXTENDED_FILES: [&str; 3] = [
    include_str!("../../../../vehicles/hummingbird.toml"),
    include_str!("../../../../vehicles/study.toml"),
    include_str!("../../../../scenarios/paper-extended.toml"),
];

fn extended() -> [Scenario; 3] {
    EXTENDED_FILES.map(|text| Scenario::parse(text, "f").unwrap())
}

fn parameters(scenario: &Scenario) -> ExtendedParameters {
    let LawParameters::Extended(law) = scenario.configuration.law() else { panic!("{}", scenario.name) };
    *law.parameters
}

/// The keys that `scenario`'s file must hold for its constants.
fn keys(scenario: &Scenario) -> Vec<&'static str> {
    let given = chosen(&scenario.airframe().unwrap(), &parameters(scenario));
    let all = ExtendedParameters::TABLE.iter().zip(given).filter(|(_, value)| value.is_some());
    all.map(|(constant, _)| constant.key).collect()
}

/// As if a search of `scenario` had found the point of these logarithms.
fn found(scenario: &Scenario, logarithm: f64) -> Tuned {
    let judge = Judge::new(scenario, Requirements::default());
    let found = judge.scenario(&vec![logarithm; judge.start().len()]).unwrap();
    Tuned { scenario: found, verdict: Verdict::missing(), before: Verdict::missing(), judged: 0 }
}

#[test]
fn what_the_files_of_the_extended_law_chose_is_found_again_and_nothing_else() {
    let [hummingbird, study, paper] = extended();
    assert_eq!(keys(&hummingbird), ["yaw_acceleration"]);
    assert_eq!(keys(&study), ["yaw_acceleration", "force_heading"]);
    assert!(keys(&paper).is_empty());
}

#[test]
fn a_search_of_the_extended_law_starts_from_the_files_constants_to_the_bit() {
    for scenario in extended() {
        let space = Space::new(&scenario, None);
        assert_eq!(space.configuration(&space.start()).as_ref(), Some(&scenario.configuration), "{}", scenario.name);
    }
}

#[test]
fn the_chosen_constants_make_all_of_any_point_again_to_the_bit() {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    for scenario in extended() {
        let (space, airframe) = (Space::new(&scenario, None), scenario.airframe().unwrap());
        let mut defined = 0;
        for _ in 0..20 {
            let point = space.start().iter().map(|_| 0.4 * (random.random::<f64>() - 0.5)).collect();
            let Some(configuration) = space.configuration(&point) else { continue };
            let wanted = parameters(&Scenario { configuration, ..scenario.clone() });
            let given = chosen(&airframe, &wanted);
            assert_eq!(defaults::constants(&airframe, &given), wanted, "{}", scenario.name);
            defined += 1;
        }
        assert!(defined > 10, "{}: {defined}", scenario.name);
    }
}

#[test]
fn the_files_of_the_extended_law_meet_the_usual_requirements_as_they_are() {
    for scenario in extended() {
        let verdict = verdict(&scenario, Requirements::default());
        assert!(verdict.accepted(), "{}: {verdict:?}", scenario.name);
    }
}

#[test]
fn a_tuned_file_of_the_extended_law_is_short_and_reads_back_to_the_same_law() {
    for (text, scenario) in EXTENDED_FILES.into_iter().zip(extended()) {
        let tuned = found(&scenario, 0.05);
        let written = output::rewritten(text, &tuned).unwrap();
        let read = Scenario::parse(&written, "f").unwrap_or_else(|error| panic!("{error}\n{written}"));
        assert!(read.flies_like(&tuned.scenario), "{written}");
        let [before, after] = [&scenario, &read].map(|scenario| keys(scenario).len());
        assert!(after <= before + 18, "{written}");
        let (_, value) = written.split_once("k_p_across = ").unwrap();
        assert!(value.lines().next().unwrap().len() <= 6, "{written}");
        // Tuned again from there, it holds no more.
        let again = Tuned { scenario: read, ..tuned };
        assert_eq!(output::rewritten(&written, &again).unwrap(), written);
    }
}

#[test]
fn a_file_with_every_constant_loses_those_that_follow_from_the_vehicle() {
    let [scenario, ..] = extended();
    let (before, _) = EXTENDED_FILES[0].split_once("[gains]").unwrap();
    let (_, after) = EXTENDED_FILES[0].split_once("[control]").unwrap();
    let all = scenario::constants::written(parameters(&scenario).entries());
    let text = format!("{before}{all}\n[control]{after}");
    assert!(Scenario::parse(&text, "f").unwrap().flies_like(&scenario));
    let verdict = verdict(&scenario, Requirements::default());
    let tuned = Tuned { before: verdict.clone(), verdict, scenario, judged: 1 };
    assert!(!tuned.improved());
    let written = output::rewritten(&text, &tuned).unwrap();
    assert!(Scenario::parse(&written, "f").unwrap().flies_like(&tuned.scenario), "{written}");
    assert!(written.contains("yaw_acceleration = 6.0") && !written.contains("k_p_across"), "{written}");
    assert!(!written.contains("[estimates]") && written.contains("law = \"extended\""), "{written}");
}

#[test]
fn a_vehicle_without_a_law_in_its_file_is_tuned_under_the_extended_one() {
    let bare = EXTENDED_FILES[2].replace("law = \"extended\"\n", "");
    let scenario = Scenario::parse(&bare, "f").unwrap();
    let tuned = found(&scenario, 0.05);
    let written = output::rewritten(&bare, &tuned).unwrap();
    assert!(written.contains("law = \"extended\""), "{written}");
    assert!(Scenario::parse(&written, "f").unwrap().flies_like(&tuned.scenario), "{written}");
}

#[test]
fn the_table_says_what_each_figure_was_and_is() {
    let [scenario, ..] = extended();
    let before = verdict(&scenario, Requirements::default());
    let mut after = before.clone();
    (after.figures.height_lost, after.mean[0], after.cost) = (0.5, 0.6, 3.0);
    let text = Tuned { before, verdict: after, scenario, judged: 2 }.table();
    let line =
        |name: &str| text.lines().find(|line| line.starts_with(name)).unwrap_or_else(|| panic!("{name}: {text}"));
    let numbers: Vec<&str> = line("upside down: height lost").split_whitespace().skip(5).collect();
    assert!(numbers.len() == 4 && numbers[1] == "0.5" && numbers[3] == "0.6", "{text}");
    assert!(line("cost").ends_with(" 3") && line("storm").split_whitespace().count() == 8, "{text}");
}
