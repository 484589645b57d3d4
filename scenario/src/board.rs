//! What the firmware can fly of all scenarios: 50 Hz to 1 kHz, four rotors, and sampled loops with margin.
//!
//! On a board the law gets its body rates from the estimator, and they are late ([`rates_delay`]); they are in the
//! loops judged here, whether the scenario has `[estimator]` or not. So is the delay of the notches that follow rotors,
//! where there is margin for it ([`may_follow_rotors`]); without margin a board does without them.
//!
//! Gains may be changed on board by a few factors ([`controller_core::tuning`]). No board judges loops, so every choice
//! of factors is judged here.
//!
//! The firmware's build and `host-sim sitl` ask the same question here, so that each scenario that flies on a desk can
//! be built for a board.

use crate::file::Scenario;
use crate::reality::estimator::{notches_delay, rates_delay};
use crate::sampled_loop::{Axis, LoopModel, LoopTiming};
use crate::stability::LoopMargin;
use crate::verdict::{Refusal, Verdict};
use controller_core::allocation::{Motor, Rotor, Spin};
use controller_core::configuration::{Configuration, ExtendedLaw, LawParameters, PaperLaw};
use controller_core::extended::actuators::ActuatorParameters;
use controller_core::tuning::Factors;
use controller_core::tuning::judged::JudgedLoops;
use controller_core::vehicle::{LimitParameters, VehicleParameters};
use std::ops::RangeInclusive;

/// The rates of the firmware's control task, Hz: of the extended law, and of the paper's, which is the published one.
const CONTROL_RATES_HZ: RangeInclusive<f64> = 50.0..=1000.0;
const PAPER_LAW_RATE_HZ: f64 = 100.0;

/// Rotors that the boards have outputs for.
pub const ROTOR_COUNT: usize = 4;

/// Whether boards have what `scenario`, of the file `name`, needs: its rate and its rotors. [`check`] asks this first.
///
/// # Errors
/// One line: the file, the field, and what is wrong.
pub fn fits(scenario: &Scenario, name: &str) -> Result<(), String> {
    let rate = 1.0 / scenario.timing.period();
    if !CONTROL_RATES_HZ.contains(&rate) {
        let (min, max) = (CONTROL_RATES_HZ.start(), CONTROL_RATES_HZ.end());
        return Err(format!("{name}: control.rate: the firmware flies at {min} to {max} Hz, found {rate}"));
    }
    if matches!(scenario.configuration.law(), LawParameters::Paper(_)) && rate != PAPER_LAW_RATE_HZ {
        let problem = format!("the firmware flies the paper's law at {PAPER_LAW_RATE_HZ} Hz, found {rate}");
        return Err(format!("{name}: control.rate: {problem}; leave [gains] to the extended law for other rates"));
    }
    let Some(rotors) = scenario.configuration.rotors() else {
        return Err(format!("{name}: rotors: missing; a board needs to know what its {ROTOR_COUNT} motors turn"));
    };
    if rotors.len() != ROTOR_COUNT {
        return Err(format!("{name}: rotors.position: the boards drive {ROTOR_COUNT} motors, found {}", rotors.len()));
    }
    Ok(())
}

/// Whether the firmware can fly `scenario`, of the file `name`. One that is not certified it boots with, and does not
/// arm: why, if so.
///
/// One whose sampled loops are unstable or without margin, or whose model does not arrive, is refused: no board works
/// that out, so nothing else would keep it on the ground.
///
/// # Errors
/// One line: the file, the field, the loop or the flight, and what is wrong.
pub fn check(scenario: &Scenario, name: &str) -> Result<Option<String>, String> {
    fits(scenario, name)?;
    let verdict = Verdict::judge(scenario).map_err(|error| format!("{name}: {error}"))?;
    let law = scenario.configuration.law();
    let loops = LoopModel::new(scenario.configuration.vehicle(), law, plain_timing(scenario));
    let loops = loops.map_err(|error| format!("{name}: {error}"))?.reports();
    if let Some(lack) = verdict.lacking().or_else(|| LoopMargin::FLYABLE_MIN.first_lacking(&loops)) {
        let late = rates_delay(&scenario.timing) * 1e3;
        return Err(format!(
            "{name}: {lack}; what cannot be flown is not built (a board's body rates are up to {late:.1} ms late)"
        ));
    }
    if let Some(not_arrived) = verdict.not_arrived() {
        return Err(format!("{name}: {not_arrived}; what cannot be flown is not built"));
    }
    // The reference of the file is no board's.
    let refusal = verdict.refusal().filter(|refusal| matches!(refusal, Refusal::Inequality(_)));
    Ok(refusal.map(|refusal| format!("{name}: {refusal}; this firmware will refuse to arm")))
}

/// Whether the sampled loops of `scenario` keep their margin with the delay of notches that follow the rotors.
#[must_use]
pub fn may_follow_rotors(scenario: &Scenario) -> bool {
    let configuration = &scenario.configuration;
    let loops = LoopModel::new(configuration.vehicle(), configuration.law(), notched_timing(scenario));
    loops.is_ok_and(|loops| LoopMargin::FLYABLE_MIN.first_lacking(&loops.reports()).is_none())
}

/// The scenario's timing on a board, as late as it may be there.
fn timing(scenario: &Scenario) -> LoopTiming {
    if may_follow_rotors(scenario) { notched_timing(scenario) } else { plain_timing(scenario) }
}

/// The same on a board that does not know its rotors' speeds.
fn plain_timing(scenario: &Scenario) -> LoopTiming {
    let late = if scenario.reality.estimator.is_some() { 0.0 } else { rates_delay(&scenario.timing) };
    later(scenario.loop_timing(), late)
}

/// The same with notches.
fn notched_timing(scenario: &Scenario) -> LoopTiming {
    later(plain_timing(scenario), notches_delay())
}

/// The same `late` seconds later.
fn later(timing: LoopTiming, late: f64) -> LoopTiming {
    LoopTiming { delay_samples: timing.delay_samples + late / timing.period, ..timing }
}

/// The loops that only the attitude's factors change, and those that these and the position's across change; under the
/// paper's law, whose gains are those of every axis, the vertical one is among them.
const ATTITUDE_AXES: [Axis; 3] = [Axis::Roll, Axis::Pitch, Axis::Yaw];
const HORIZONTAL_AXES: [Axis; 2] = [Axis::LateralX, Axis::LateralY];

/// Which factors on the gains of `scenario` leave its sampled loops stable and with their margin.
#[must_use]
pub fn judged(scenario: &Scenario) -> JudgedLoops {
    let (law, timing) = (scenario.configuration.law(), timing(scenario));
    let vertical = [Axis::Vertical];
    let with_vertical = matches!(law, LawParameters::Paper(_));
    // The choices come sorted by the attitude's factors: its loops are judged once for all that have the same.
    let mut attitude = None;
    let across = |factors: &Factors| {
        let key = (factors.attitude, factors.rate);
        let (_, holds) = *attitude
            .take_if(|(last, _)| *last == key)
            .get_or_insert_with(|| (key, has_margins(scenario, timing, factors, &ATTITUDE_AXES)));
        attitude = Some((key, holds));
        holds
            && has_margins(scenario, timing, factors, &HORIZONTAL_AXES)
            && (!with_vertical || has_margins(scenario, timing, factors, &vertical))
    };
    JudgedLoops::judge(across, |factors| has_margins(scenario, timing, factors, &vertical))
}

/// Whether these loops have their margin under `factors`. Gains that the law is undefined for have none.
fn has_margins(scenario: &Scenario, timing: LoopTiming, factors: &Factors, axes: &[Axis]) -> bool {
    let configuration = &scenario.configuration;
    let Ok(law) = factors.law(configuration.law(), configuration.vehicle()) else { return false };
    let loops = LoopModel::new(configuration.vehicle(), &law, timing);
    loops.is_ok_and(|loops| axes.iter().all(|axis| LoopMargin::FLYABLE_MIN.lacking(&loops.report(*axis)).is_none()))
}

/// A hash of a scenario's configuration, in [0, 2^24): what was tuned on one is not the other's.
#[must_use]
pub fn identity(scenario: &Scenario) -> u32 {
    let LoopTiming { period, rotor_lag, delay_samples } = timing(scenario);
    let mut numbers = numbers(&scenario.configuration);
    let Motor { linear, idle } = scenario.motor();
    numbers.extend([period, rotor_lag, delay_samples, linear.into(), idle.into()]);
    hash(&numbers)
}

/// Every number of a configuration, always in this order: the law's own first, behind a number that says which law it
/// is; the rotors' last, as there may be any number of them. No pattern leaves a field out, so that one which is added
/// has to be added here.
fn numbers(configuration: &Configuration) -> Vec<f64> {
    let mut numbers: Vec<f32> = Vec::new();
    match configuration.law() {
        LawParameters::Paper(PaperLaw { gains, thrust_floor }) => {
            numbers.push(1.0);
            numbers.extend(gains.values());
            // No floor is zero.
            numbers.push(thrust_floor.unwrap_or(0.0));
        }
        LawParameters::Extended(ExtendedLaw { parameters, actuators: ActuatorParameters { lag, delay } }) => {
            numbers.push(2.0);
            numbers.extend(parameters.values());
            numbers.extend([lag, delay]);
        }
    }
    let VehicleParameters { mass, inertia, gravity } = **configuration.vehicle();
    let LimitParameters { thrust_max, torque_max } = **configuration.limits();
    numbers.extend([mass, inertia.x, inertia.y, inertia.z, gravity]);
    numbers.extend([thrust_max, torque_max.x, torque_max.y, torque_max.z]);
    numbers.extend(configuration.bounds().values());
    for rotor in configuration.rotors().into_iter().flat_map(|rotors| rotors.iter()) {
        let Rotor { position, spin, thrust_coefficient, drag_coefficient, thrust_min, thrust_max } = *rotor;
        let turns = match spin {
            Spin::Clockwise => -1.0,
            Spin::CounterClockwise => 1.0,
        };
        numbers.extend([position.x, position.y, position.z, turns]);
        numbers.extend([thrust_coefficient, drag_coefficient, thrust_min, thrust_max]);
    }
    numbers.into_iter().map(f64::from).collect()
}

/// FNV-1a, 32 bits folded to 24, over the bits of `numbers`, each with its lowest byte first.
fn hash(numbers: &[f64]) -> u32 {
    let bytes = numbers.iter().flat_map(|number| number.to_bits().to_le_bytes());
    let hash = bytes.fold(0x811C_9DC5_u32, |hash, byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193));
    (hash >> 24) ^ (hash & 0x00FF_FFFF)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::STUDY;
    use controller_core::certificate::Certificate;
    use controller_core::tuning::{Figures, Percent, Tuning};

    /// The study with another k_omega_t: its own gains follow its rotors, however late they are.
    fn damped(k_omega_t: f64) -> Scenario {
        Scenario::parse(&STUDY.replace("[gains]", &format!("[gains]\nk_omega_t = {k_omega_t}")), "study").unwrap()
    }

    #[test]
    fn the_bits_say_what_the_analysis_says_of_each_choice() {
        // Damped so hard that some choices of factors have no margin.
        let study = damped(0.35);
        let judged = judged(&study);
        let held = |factors: &Factors| {
            let configuration = &study.configuration;
            let law = factors.law(configuration.law(), configuration.vehicle()).unwrap();
            let loops = LoopModel::new(configuration.vehicle(), &law, timing(&study)).unwrap();
            LoopMargin::FLYABLE_MIN.first_lacking(&loops.reports()).is_none()
        };
        let (mut good, mut bad) = (0, 0);
        for (index, attitude) in Percent::all().enumerate() {
            for (other, rate) in Percent::all().enumerate() {
                // Not in step with the loops above, so that every factor meets every other.
                let pick = |step: usize| Percent::all().nth((index * step + 3 * other) % Percent::COUNT).unwrap();
                let factors = Factors {
                    attitude,
                    rate,
                    position_across: pick(2),
                    velocity_across: pick(4),
                    position_vertical: pick(5),
                    velocity_vertical: pick(6),
                };
                assert_eq!(judged.hold(&factors), held(&factors), "{factors:?}");
                *if judged.hold(&factors) { &mut good } else { &mut bad } += 1;
            }
        }
        println!("{good} choices hold, {bad} do not");
        assert!(good > 0 && bad > 0);
    }

    #[test]
    fn notches_are_counted_where_there_is_margin_for_them() {
        for text in [STUDY, include_str!("../../vehicles/hummingbird.toml")] {
            let scenario = Scenario::parse(text, "a test").unwrap();
            assert!(may_follow_rotors(&scenario));
            let (plain, notched) = (plain_timing(&scenario), timing(&scenario));
            let late = (notched.delay_samples - plain.delay_samples) * plain.period;
            assert!((late - notches_delay()).abs() < 1e-9 && (1e-3..1.3e-3).contains(&late), "{late}");
        }
        // Damped harder and harder: before there is too little margin to fly, there is too little for notches.
        let damped = (10..600).map(|thousandths| damped(f64::from(thousandths) * 0.001));
        let flies_without = |scenario: &Scenario| !may_follow_rotors(scenario) && check(scenario, "damped").is_ok();
        let first = damped.into_iter().find(flies_without).unwrap();
        assert_eq!(timing(&first), plain_timing(&first));
    }

    #[test]
    fn every_factor_alone_certifies_and_keeps_its_margins() {
        for text in [STUDY, include_str!("../../vehicles/hummingbird.toml")] {
            let scenario = Scenario::parse(text, "a test").unwrap();
            let (configuration, loops) = (&scenario.configuration, judged(&scenario));
            for (percent, gain) in Percent::all().flat_map(|percent| (0..6).map(move |gain| (percent, gain))) {
                let mut factors = Factors::BUILT;
                let Factors { attitude, rate, position_across, velocity_across, position_vertical, velocity_vertical } =
                    &mut factors;
                let each = [attitude, rate, position_across, velocity_across, position_vertical, velocity_vertical];
                *each.into_iter().nth(gain).unwrap() = percent;
                let tuning = Tuning { figures: Figures::from_configuration(configuration), factors };
                let certificate = Certificate::new(&tuning.apply(configuration).unwrap()).unwrap();
                assert!(certificate.holds() && loops.hold(&factors), "{}: {factors:?}", scenario.name);
            }
        }
    }

    #[test]
    fn the_attitudes_factor_multiplies_the_tilts_stiffness() {
        let study = Scenario::parse(STUDY, "a test").unwrap();
        let stiffness = |attitude| {
            let factors = Factors { attitude, ..Factors::BUILT };
            let law = factors.law(study.configuration.law(), study.configuration.vehicle()).unwrap();
            let LawParameters::Extended(law) = law else { panic!() };
            let p = &law.parameters;
            p.k_tilt
        };
        for percent in Percent::all() {
            let factor = stiffness(percent) / stiffness(Percent::AS_BUILT);
            assert!((factor - percent.percent() / 100.0).abs() < 1e-6, "{factor}");
        }
    }

    /// The study with a change, as the firmware's build checks it.
    fn checked(line: &str, other: &str) -> Result<Option<String>, String> {
        assert!(STUDY.contains(line), "{line}");
        check(&Scenario::parse(&STUDY.replace(line, other), "a test").unwrap(), "a test")
    }

    #[test]
    fn what_the_boards_cannot_drive_is_refused_by_name() {
        assert_eq!(checked("name = ", "name = "), Ok(None));
        let error = checked("rate = 100.0 ", "rate = 40.0 ").unwrap_err();
        assert_eq!(error, "a test: control.rate: the firmware flies at 50 to 1000 Hz, found 40");
        let paper = include_str!("../../vehicles/hummingbird-paper-law.toml").replace("rate = 100.0 ", "rate = 200.0 ");
        let error = check(&Scenario::parse(&paper, "a test").unwrap(), "a test").unwrap_err();
        assert!(error.starts_with("a test: control.rate: the firmware flies the paper's law at 100 Hz, found 200"));
        let (four, six) =
            ("[-0.120208, 0.120208, 0.0],", "[-0.120208, 0.120208, 0.0], [0.17, 0.0, 0.0], [-0.17, 0.0, 0.0],");
        let six = STUDY.replace(four, six).replace("\"cw\", \"ccw\"]", "\"cw\", \"ccw\", \"cw\", \"ccw\"]");
        let error = check(&Scenario::parse(&six, "a test").unwrap(), "a test").unwrap_err();
        assert_eq!(error, "a test: rotors.position: the boards drive 4 motors, found 6");
    }

    #[test]
    fn what_flies_on_a_desk_and_not_with_a_boards_late_rates_is_not_built() {
        let late = (10..60).filter(|damping| {
            let scenario = damped(f64::from(*damping) * 0.01);
            let verdict = Verdict::judge(&scenario).unwrap();
            verdict.lacking().is_none() && check(&scenario, "a test").is_err_and(|error| error.contains("ms late"))
        });
        assert!(late.count() > 0);
    }

    #[test]
    fn another_lag_or_gain_is_another_configuration() {
        let identity_of = |text: &str| identity(&Scenario::parse(text, "a test").unwrap());
        let study = identity_of(STUDY);
        assert_eq!(study, identity_of(&STUDY.replace("name = \"study\"", "name = \"mine\"")));
        for (line, other) in [
            ("lag = 0.030 ", "lag = 0.031 "),
            ("mass = 0.460 ", "mass = 0.461 "),
            ("yaw_acceleration = 5.1", "yaw_acceleration = 5.0"),
        ] {
            assert_ne!(study, identity_of(&STUDY.replace(line, other)), "{line}");
        }
        assert!(study < 1 << 24);
    }

    #[test]
    fn the_identity_of_a_configuration_stays_from_one_build_to_the_next() {
        // Worked out by another program.
        assert_eq!(hash(&[1.0, -2.5, 0.0]), 0xB3EA9A);
        let paper = Scenario::parse(include_str!("../../vehicles/hummingbird-paper-law.toml"), "a test").unwrap();
        let numbers = numbers(&paper.configuration);
        // Law, gains, floor; vehicle, limits, bounds; four rotors.
        assert_eq!(numbers.len(), 13 + 16 + 4 * 8);
        assert_eq!(numbers[0], 1.0);
        assert_eq!(numbers[13], f64::from(paper.configuration.vehicle().mass));
    }
}
