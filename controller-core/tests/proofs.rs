//! What `proofs/` proves is what the code computes: each definition there, and each inequality that a number of the
//! code stands in, against the function here, at random points.
//!
//! The formulas and the bounds are read from the proofs themselves, so none is typed a second time.
//! [`everything_in_the_proofs_is_compared_or_says_why_not`] finds what no test compares.

mod bounds;
mod cells;
mod extended;
mod motion;
mod paper;
mod rounding;
mod tick;

use crate::support::coq::{self, PROOFS, Value};
use crate::support::gappa::Rounding;
use crate::support::{Random, hummingbird};
use controller_core::allocation::{QuadX, Rotors};
use controller_core::certificate::Certificate;
use controller_core::certificate::extended::ExtendedCertificate;
use controller_core::certificate::inequality::Inequality;
use controller_core::configuration::{Configuration, LawParameters};
use controller_core::extended::parameters::ExtendedParameters;
use nalgebra::{Quaternion, Vector2, Vector3};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

const TRIALS: usize = 2_000;

/// Every comparison.
const COMPARISONS: [fn(); 31] = [
    tick::the_thrust_range_is_that_of_the_proofs,
    tick::the_budgets_rows_are_those_of_the_proofs,
    tick::the_certificates_rows_of_torque_are_those_of_the_proofs,
    tick::a_ticks_spending_is_that_of_the_proofs,
    tick::the_laws_parts_and_their_order_are_those_of_the_proofs,
    tick::no_tick_takes_a_rotor_out_of_its_range,
    extended::the_limiter_is_that_of_the_proofs,
    extended::what_a_command_asks_of_the_frame_is_that_of_the_proofs,
    extended::the_ends_of_u_are_those_of_the_proofs,
    extended::the_tilts_error_and_its_pull_are_those_of_the_proofs,
    extended::the_tilts_torque_is_that_of_the_proofs,
    extended::the_heading_is_that_of_the_proofs,
    extended::the_slowed_law_is_that_of_the_proofs,
    extended::progress_is_that_of_the_proofs,
    paper::the_filters_are_those_of_the_proofs,
    paper::rotations_and_parameters_are_those_of_the_proofs,
    paper::the_switch_is_that_of_the_proofs,
    paper::the_torque_is_that_of_the_proofs,
    paper::the_certificates_thrust_and_torque_are_those_of_the_proofs,
    motion::the_desired_frame_and_its_rates_are_those_of_the_proofs,
    motion::how_the_thrust_direction_and_the_heading_turn_is_that_of_the_proofs,
    motion::the_parts_of_the_sharp_bound_are_those_of_the_proofs,
    bounds::what_the_filters_reach_is_that_of_the_proofs,
    bounds::the_command_and_its_derivatives_are_those_of_the_proofs,
    bounds::lemma_1_is_that_of_the_proofs,
    cells::the_sharp_bound_is_the_greatest_of_the_proofs_cells,
    cells::the_bounds_on_the_third_axis_are_the_greatest_of_the_proofs_cells,
    rounding::the_limiter_rounds_as_in_the_proofs,
    rounding::a_rotors_command_rounds_as_in_the_proofs,
    rounding::the_margins_size_is_that_of_the_proofs,
    rounding::filters_round_as_in_the_proofs,
];

const OF_WHAT_IS_COMPARED: &str = "it says something of definitions that are compared, for all numbers";
const OF_ALL_FUNCTIONS: &str = "it is about every function of time";
const OF_THE_PROOF: &str = "a notion of the proof alone";
const NOT_COMPUTED: &str = "no code computes it: tests/law/extended_flows differentiates V along flows";
const ONLY_PROOFS_NEED_IT: &str = "only a proof needs it: where a bound is reached, or by which weights it is shown";

/// What stands in no number of the code: the file, the names, and the reason.
const NOT_COMPARED: [(&str, &[&str], &str); 39] = [
    ("Allocation", &["torque_fits"], "the rows imply it: rows_suffice; nothing asks for it"),
    (
        "Allocation",
        &["zero_is_left", "braking_is_left", "thrust_is_upwards", "rows_suffice", "floor_share_keeps"],
        OF_WHAT_IS_COMPARED,
    ),
    ("Allocation", &["total"], "of a pseudo-inverse: allocation/geometry/tests.rs multiplies it out"),
    (
        "Allocation",
        &["implied_row_holds"],
        "a tick leaves such rows out: its spending is compared with that of all rows",
    ),
    ("Spending", &["spares"], OF_THE_PROOF),
    (
        "Spending",
        &[
            "row_after_spending",
            "spares_after",
            "kept_is_there",
            "share_positive",
            "a_tick_keeps_the_rows",
            "a_turn_keeps_the_reserve",
            "a_tick_keeps_rotors_in_range",
        ],
        OF_WHAT_IS_COMPARED,
    ),
    (
        "Limiter",
        &["cone_is_kept", "rate_after_third_step", "turned_inwards", "share_turns_inwards", "share_keeps_the_rate"],
        OF_WHAT_IS_COMPARED,
    ),
    ("Envelope", &["never_positive", "length_is_bounded", "rate_of_the_limiter"], OF_ALL_FUNCTIONS),
    ("Attitude", &["tilt_moves", "angle_moves", "error_rates"], OF_ALL_FUNCTIONS),
    ("Attitude", &["side_within_sine"], "it is about every two vectors across each other"),
    ("Attitude", &["pull_of_the_angle", "only_the_target", "angle_below"], OF_WHAT_IS_COMPARED),
    ("Attitude", &["leaving_falls", "switch_falls", "kappa", "V", "descent", "v_falls"], NOT_COMPUTED),
    ("Heading", &["speed_is_braked", "got_has_the_sign", "braking_is_part", "no_spin"], OF_WHAT_IS_COMPARED),
    ("Heading", &["energy", "energy_falls"], NOT_COMPUTED),
    ("Fallback", &["filter_stays"], OF_ALL_FUNCTIONS),
    ("Fallback", &["progress", "progress_ends", "progress_is_bounded"], OF_WHAT_IS_COMPARED),
    ("Tube", &["response", "response_bounded", "rest_bounded", "bounds_hold"], OF_ALL_FUNCTIONS),
    (
        "Tube",
        &["thrust_across", "thrust_along", "small_tilt", "squared_length", "turn", "tilt_turns", "tilt_bends"],
        "scenario::tube counts with them, and is held against flights of the law",
    ),
    ("Mrp", &["both_lifts", "rotation_of_phi", "rotation_of_shadow"], OF_WHAT_IS_COMPARED),
    ("Adjoint", &["flight", "greatest_linear_function"], OF_ALL_FUNCTIONS),
    ("Reachable", &["G", "W", "peak"], ONLY_PROOFS_NEED_IT),
    ("Reachable", &["filtered_within_level"], OF_ALL_FUNCTIONS),
    ("Space", &["moves"], OF_ALL_FUNCTIONS),
    ("Direction", &["direction_moves", "direction_rate_moves"], OF_ALL_FUNCTIONS),
    ("Direction", &["direction_turns_within"], OF_WHAT_IS_COMPARED),
    ("DesiredFrame", &["columns_move", "omega_moves"], OF_ALL_FUNCTIONS),
    ("DesiredFrame", &["frame_turns"], OF_WHAT_IS_COMPARED),
    ("Lemma1", &["rates_in_flight"], OF_ALL_FUNCTIONS),
    ("Lemma1", &["desired_rates_bounded"], OF_WHAT_IS_COMPARED),
    ("Slope", &["mixed_is_reached"], OF_WHAT_IS_COMPARED),
    ("SharpMotion", &["within_across"], "a premise: that of sharp_bound, which is compared"),
    (
        "SharpMotion",
        &[
            "yaw_acceleration_of_values",
            "magnitude_of_tilt",
            "budget_is_shared",
            "horizontal_is_across",
            "tangential_is_across",
            "sharp_bound_of_motion",
        ],
        OF_WHAT_IS_COMPARED,
    ),
    ("SharpCells", &["yaw_bound_grows", "tilting_bound_grows", "yawing_bound_grows"], OF_WHAT_IS_COMPARED),
    ("SharpInCell", &["velocity_in_cell", "acceleration_in_cell"], OF_WHAT_IS_COMPARED),
    ("SharpCover", &["sharp_bound_covers"], OF_ALL_FUNCTIONS),
    ("SharpFlight", &["sharp_bound_of_a_flight"], OF_ALL_FUNCTIONS),
    ("Near", &["near", "share"], OF_THE_PROOF),
    ("Rounding", &["taken", "yaw_takes"], OF_THE_PROOF),
    (
        "Rounding",
        &[
            "rounded_command_within",
            "rounded_floor_below_ceiling",
            "rounded_floor_below_limit",
            "rounded_margin_below_ceiling",
            "thrust_meets_all",
            "yaw_meets_all",
        ],
        OF_WHAT_IS_COMPARED,
    ),
];

/// The names of all definitions, theorems, formulas and bounds.
fn everything() -> BTreeSet<String> {
    let mut everything = BTreeSet::new();
    for file in fs::read_dir(PROOFS).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()) {
        let extension = Path::new(&file).extension().and_then(|extension| extension.to_str());
        match (extension, file.split('.').next()) {
            (Some("v"), Some(stem)) => everything.extend(coq::names(stem).iter().map(|name| format!("{stem}.{name}"))),
            (Some("gappa"), _) => {
                everything.extend(Rounding::read(&file).names().map(|name| format!("{file}.{name}")));
            }
            _ => {}
        }
    }
    everything
}

#[test]
fn everything_in_the_proofs_is_compared_or_says_why_not() {
    let excused =
        NOT_COMPARED.iter().flat_map(|(file, names, _)| names.iter().map(move |name| format!("{file}.{name}")));
    let excused: BTreeSet<String> = excused.collect();
    COMPARISONS.iter().for_each(|compare| compare());
    let compared = coq::compared();
    let everything = everything();
    assert!(everything.len() > 100, "{}: the proofs have lost their definitions", everything.len());
    let left: Vec<&String> =
        everything.iter().filter(|name| compared.contains(*name) == excused.contains(*name)).collect();
    assert!(left.is_empty(), "neither compared nor excused, or both: {left:?}");
    assert!(excused.is_subset(&everything), "a reason for what is no longer there");
}

/// Of the Hummingbird, but never at rest: so the least thrusts count.
fn rotors() -> Rotors {
    Rotors::quad_x(QuadX { speed_min: 250.0, ..hummingbird::QUAD }).unwrap()
}

fn extended_law() -> Configuration {
    hummingbird::extended_law().with_rotors(rotors()).unwrap()
}

fn constants() -> ExtendedParameters {
    let LawParameters::Extended(law) = *extended_law().law() else { panic!("the extended law") };
    *law.parameters
}

/// In [-1, 1).
fn signed(random: &mut Random) -> f32 {
    random.within(-1.0, 1.0) as f32
}

fn direction(random: &mut Random) -> Vector3<f32> {
    Vector3::new(signed(random), signed(random), signed(random))
}

fn as_f64(numbers: &[(&'static str, f32)]) -> Vec<(&'static str, f64)> {
    numbers.iter().map(|(name, x)| (*name, f64::from(*x))).collect()
}

fn field<'a>(record: &'a Value, name: &str) -> &'a Value {
    let Value::Record(fields) = record else { panic!("a record") };
    &fields[name]
}

fn certificate() -> ExtendedCertificate {
    let Certificate::Extended(found) = Certificate::new(&extended_law()).unwrap() else { panic!("the extended law") };
    found
}

fn row<'a>(certificate: &'a ExtendedCertificate, name: &str) -> &'a Inequality {
    certificate.inequalities.iter().find(|row| row.name.starts_with(name)).unwrap()
}

/// A vector across an axis.
fn plane(v: &Vector2<f32>) -> Value {
    across([v.x, v.y].map(f64::from))
}

fn across([x, y]: [f64; 2]) -> Value {
    Value::record(&[("x", x), ("y", y), ("z", 0.0)])
}

fn unit_quaternion(random: &mut Random) -> Quaternion<f32> {
    let q = Quaternion::new(signed(random), signed(random), signed(random), signed(random));
    q / q.norm()
}

/// The same with q_0 >= 0: the lift keeps q_0 above the switching scalar.
fn lifted(random: &mut Random) -> Quaternion<f32> {
    let q = unit_quaternion(random);
    if q.w < 0.0 { -q } else { q }
}

/// In single precision, for terms up to `scale`.
fn near(found: f32, proven: f64, scale: f64, what: &str) {
    assert!((f64::from(found) - proven).abs() <= 2e-5 * scale, "{what}: {found}, and {proven} in the proof");
}

/// In double precision.
fn same(found: f64, proven: f64, what: &str) {
    assert!((found - proven).abs() <= 1e-9 * proven.abs(), "{what}: {found}, and {proven} in the proof");
}

/// In double precision, within the rounding of a few hundred operations.
fn alike(found: f64, proven: f64, what: &str) {
    assert!((found - proven).abs() <= 1e-12 * proven.abs(), "{what}: {found}, and {proven} in the proof");
}
