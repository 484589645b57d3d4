//! The defaults of the extended law on the page of scenario files: each formula of the table stands here as code, gives
//! what the law's own formulas give for every vehicle that is here, and is what the page shows.

use controller_core::constants::Constant;
use controller_core::extended::budget::{TORQUE_THRUST_SHARE, TorqueBudget};
use controller_core::extended::defaults::{Airframe, Given, NOTHING_GIVEN, constants};
use controller_core::extended::parameters::ExtendedParameters;
use scenario::Scenario;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// How far single precision may be off.
const ROUNDING_SHARE: f64 = 2e-5;

/// What a formula is called, how it is written, and what it comes to.
struct Formula(&'static str, &'static str, f64);

/// Formulas as they stand, each value under its name for those that follow.
macro_rules! formulas {
    ($list:ident, $given:ident: $($name:ident = $formula:expr;)*) => {
        $(
            let $name: f64 = $given(stringify!($name)).unwrap_or($formula);
            $list.push(Formula(stringify!($name), stringify!($formula), $name));
        )*
    };
}

fn sqrt(number: f64) -> f64 {
    number.max(0.0).sqrt()
}

fn tan(angle: f64) -> f64 {
    angle.tan()
}

fn acos(cosine: f64) -> f64 {
    cosine.acos()
}

fn min(one: f64, other: f64) -> f64 {
    one.min(other)
}

fn max(one: f64, other: f64) -> f64 {
    one.max(other)
}

/// All formulas of the page for `airframe`, whose file gives some constants.
#[allow(non_snake_case, reason = "J and T are called as on the page")]
fn formulas(airframe: &Airframe, given: &dyn Fn(&str) -> Option<f64>) -> Vec<Formula> {
    let Airframe { vehicle, limits, rotors, actuators, .. } = *airframe;
    let [mass, g, h, lag, delay] =
        [vehicle.mass, vehicle.gravity, airframe.period, actuators.lag, actuators.delay].map(f64::from);
    let [J_11, J_22, J_33] = [vehicle.inertia.x, vehicle.inertia.y, vehicle.inertia.z].map(f64::from);
    let [thrust_max, torque_max_z] = [limits.thrust_max, limits.torque_max.z].map(f64::from);
    let (drag, degrees) = (f64::from(airframe.drag), 1.0_f64.to_radians());
    let [thrust_loss, thrust_gain] = if rotors.is_some() { [0.1, 0.15] } else { [0.0, 0.0] };
    let mut list = Vec::new();
    formulas! { list, given:
        scale_least = 1.0 - thrust_loss;
        scale_greatest = 1.0 + thrust_gain;
        floor_margin = 0.001 * mass * g;
        a_down = 0.63 * g;
        force_up = 0.36 * a_down;
    }
    // What the page says in words.
    let budget = TorqueBudget::<f64>::new(floor_margin as f32, limits, rotors);
    let tilt_torque = min(budget.radius(scale_least), budget.radius(scale_greatest));
    let U = budget.held_acceleration(vehicle, limits, 1.0);
    let [tilt_reach, yaw_reach] = budget.reach.map(|reach| max(reach, 1e-12));
    let least = (1.0 - TORQUE_THRUST_SHARE) * mass * (g - force_up - 1.0);
    let above = max(least - scale_greatest * budget.ends[0] - budget.margin, 0.0);
    let below = max(scale_least * min(budget.ends[1], thrust_max) - 1.1 * mass * g, 0.0);
    let yaw_torque = min(torque_max_z, 0.8 * min(above, below) / yaw_reach);
    formulas! { list, given:
        J = (J_11 + J_22) / 2.0;
        J_max = max(J_11, J_22);
        T = lag + delay;
        w_0 = 0.22 / (h / 2.0 + 0.12 * T + 0.01);
        w_a = min(w_0 * sqrt(min(0.075 / sqrt(J / mass), 1.0)), sqrt(2.0 * tilt_torque / J));
    }
    formulas! { list, given:
        yaw_acceleration = min(0.5 * yaw_torque / J_33, 20.0);
        w_y = min(2.4 * sqrt(yaw_acceleration), 0.3 * w_a);
    }
    let lifted = 0.9 * max(above - yaw_reach * J_33 * yaw_acceleration, 0.0) / (tilt_reach * J_max);
    formulas! { list, given:
        k_v_across = 0.54 * w_a;
        stiffer = min(1.4, 0.42 / (k_v_across * max(T, 0.001)));
        k_v_vertical = stiffer * k_v_across;
        k_p_across = 0.55 * k_v_across * k_v_across;
        k_p_vertical = 0.55 * stiffer * stiffer * k_v_across * k_v_across;
        k_f = 1.12 * w_a;
        k_s = 3.1 * k_f;
        k_d = 1.5 * w_a;
        steepest = min(acos(min(1.05 * (g - a_down) / U, 1.0)), 75.0 * degrees);
        a_across = min(max(sqrt(U * U - 0.49 * g * g), 0.5), g * tan(steepest));
        tilt_max = steepest;
        v_across = 15.0;
        v_up = 15.0;
        v_down = 8.0;
        braking_across = 0.7;
        braking_vertical = 0.7;
        turn_rate = 0.5 * sqrt(tilt_torque / J_max);
        turn_reserve = min(0.13 * tilt_torque / J_max, lifted);
        k_tilt = 4.0 * J * w_a * w_a;
        m_tilt = 0.95 * (tilt_torque - J_max * turn_reserve);
        k_omega_t = 1.7 * w_a * J;
        r_0 = m_tilt * m_tilt / (8.0 * J * w_a * w_a * tilt_torque);
        delta = 0.01;
        alpha = 0.25;
        yaw_rate = min(3.2 * sqrt(yaw_acceleration), 0.4 * w_a);
        c_1 = w_y * w_y;
        c_2 = 1.5 * w_y;
        force_across = 0.98 * a_across;
        force_heading = min(force_across, 2.5);
        force_down = max(0.95 * (U - g), 0.0);
        force_bandwidth_across = 1.5 * w_a;
        force_bandwidth_vertical = 1.5 * w_a * min(1.33, 0.95 * stiffer);
        drag_across = drag;
        torque_tilt = 0.4 * tilt_torque;
        torque_yaw = 0.5 * torque_max_z;
        torque_bandwidth = 2.0;
        scale_rate = 0.3;
    }
    list
}

fn read(path: &Path) -> Scenario {
    Scenario::load(path).unwrap_or_else(|error| panic!("{error}"))
}

/// The vehicles that are here, with rotors and without.
fn vehicles() -> Vec<Scenario> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let published = fs::read_dir(root.join("vehicles/published")).unwrap().map(|entry| entry.unwrap().path());
    let others = ["vehicles/hummingbird.toml", "vehicles/study.toml", "scenarios/paper-extended.toml"];
    published.chain(others.map(|file| root.join(file))).map(|path| read(&path)).collect()
}

#[test]
fn the_formulas_of_the_page_give_what_the_law_takes_for_every_vehicle() {
    let vehicles = vehicles();
    assert!(vehicles.len() > 12);
    for scenario in &vehicles {
        let airframe = scenario.airframe().unwrap();
        let defaults = constants(&airframe, &NOTHING_GIVEN);
        assert_agree(&airframe, &NOTHING_GIVEN, &scenario.name);
        // A constant that the file gives is the one that the others follow from.
        for place in 0..ExtendedParameters::COUNT {
            let mut given = NOTHING_GIVEN;
            let Constant { path, range, .. } = ExtendedParameters::TABLE[place];
            given[place] = Some((0.97 * defaults.values()[place]).clamp(range.min, range.max));
            assert_agree(&airframe, &given, &format!("{} with {path} given", scenario.name));
        }
    }
}

/// Compares every constant that the law takes with what the page's formula gives.
fn assert_agree(airframe: &Airframe, given: &Given, name: &str) {
    let of_file = |key: &str| {
        let place = ExtendedParameters::TABLE.iter().position(|constant| constant.key == key)?;
        given[place].map(f64::from)
    };
    let by_page = formulas(airframe, &of_file);
    let by_page: BTreeMap<&str, f64> = by_page.iter().map(|Formula(key, _, value)| (*key, *value)).collect();
    for (constant, value) in constants(airframe, given).entries() {
        let wanted = by_page.get(constant.key).unwrap_or_else(|| panic!("{}: no formula", constant.path));
        let wanted = wanted.clamp(f64::from(constant.range.min), f64::from(constant.range.max));
        let apart = (f64::from(value) - wanted).abs();
        assert!(apart <= ROUNDING_SHARE * wanted.abs(), "{name}: {} is {value}, by the page {wanted}", constant.path);
    }
}

/// A formula as the page writes it: products without a sign, whole numbers without a point.
fn shown(formula: &str) -> String {
    let spaced = formula.split_whitespace().collect::<Vec<_>>().join(" ").replace(" * ", " ");
    let whole = |end: &str| format!(".0{end}");
    [" ", ",", ")"].iter().fold(format!("{spaced} "), |text, end| text.replace(&whole(end), end)).trim_end().to_owned()
}

#[test]
fn the_page_shows_these_formulas() {
    let page = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/scenario-file.md")).unwrap();
    let scenario = vehicles().pop().unwrap();
    let written: BTreeMap<&str, String> = formulas(&scenario.airframe().unwrap(), &|_| None)
        .iter()
        .map(|Formula(name, formula, _)| (*name, format!("`{}`", shown(formula))))
        .collect();
    let mut wrong = String::new();
    let mut compare = |row: &str, name: &str| {
        let (_, said) = row.trim_end_matches(" |").rsplit_once(" | ").unwrap();
        let wanted = &written[name];
        if said != wanted {
            wrong += &format!("{name}: {wanted}, the page has {said}\n");
        }
    };
    for constant in &ExtendedParameters::TABLE {
        let start = format!("| `{}` | ", constant.path);
        compare(page.lines().find(|line| line.starts_with(&start)).unwrap(), constant.key);
    }
    for name in ["J", "J_max", "T", "w_0", "w_a", "w_y", "stiffer", "steepest"] {
        compare(page.lines().find(|line| line.starts_with(&format!("| `{name}` | "))).unwrap(), name);
    }
    assert!(wrong.is_empty(), "{wrong}");
}
