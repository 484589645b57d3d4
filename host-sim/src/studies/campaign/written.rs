//! What a flight of a campaign has in place of its scenario file: as comments above the file's text, in the file's own
//! terms.
//!
//! The circumstances are drawn anew from seed and number wherever they are needed ([`super::draw`]); this is for the
//! reader of one flight's report. Every number is written as it is, to the last bit.

use nalgebra::Vector3;
use scenario::Scenario;
use scenario::number::{Number, array};
use scenario::reality::sensors::VelocitySource;
use scenario::reference::ReferenceKind;

/// The text of a scenario's file below what flight `number` from `seed`, which is `thrown`, has instead.
pub fn above(text: &str, thrown: &Scenario, seed: u64, number: u64) -> String {
    let mut comments =
        format!("# Flight {number} of the campaign with seed {seed}. Drawn in place of what stands below:\n#\n");
    let lines = start(thrown).into_iter().chain(air(thrown)).chain(senses(thrown)).chain(truth(thrown));
    for line in lines.chain(failure(thrown)) {
        comments += &format!("#   {line}\n");
    }
    format!("{comments}\n{text}")
}

/// How long it flies, on what reference, and where it starts.
fn start(thrown: &Scenario) -> Vec<String> {
    let initial = &thrown.initial;
    let q = &initial.attitude;
    let mut lines = vec![format!(
        "duration = {} s, plant.step = {} s",
        Number(thrown.timing.duration()),
        Number(thrown.timing.step())
    )];
    if let ReferenceKind::Hover { position, heading } = &thrown.reference {
        lines.push(format!("reference: hover at {} m, heading {} rad", vector(position), Number(*heading)));
    }
    lines.push(format!("initial.position = {} m", vector(&initial.position)));
    lines.push(format!("initial.velocity = {} m/s", vector(&initial.velocity)));
    lines.push(format!("initial attitude, w x y z = {}", array(&[q.w, q.i, q.j, q.k])));
    lines.push(format!("initial.angular_velocity = {} rad/s", vector(&initial.angular_velocity)));
    lines
}

/// How the air moves.
fn air(thrown: &Scenario) -> Vec<String> {
    let Some(wind) = &thrown.reality.wind else { return vec!["no wind".to_owned()] };
    let mut lines = vec![format!("wind.steady = {} m/s", vector(&wind.steady))];
    if let Some(drag) = &thrown.reality.drag {
        lines.push(format!("drag.linear = {} N s/m", vector(&drag.linear)));
    }
    if let Some(gust) = &wind.gust {
        lines.push(format!("wind.gust: a step of {} m/s at {} s", vector(&gust.velocity), Number(gust.start)));
    }
    if let Some(turbulence) = &wind.turbulence {
        let (strength, seed) = (Number(turbulence.wind_at_20_feet), turbulence.seed);
        lines.push(format!("wind.turbulence: Dryden's, {strength} m/s at 20 feet, seed {seed}"));
    }
    lines
}

/// The sensors' circumstances.
fn senses(thrown: &Scenario) -> Vec<String> {
    let reality = &thrown.reality;
    if let Some(estimator) = &reality.estimator {
        return vec![format!("estimator.seed = {}", estimator.seed)];
    }
    let Some(sensors) = &reality.sensors else { return vec!["no noise".to_owned()] };
    let delay = Number(sensors.delay_ticks as f64 * thrown.timing.period());
    let velocity = match sensors.velocity {
        VelocitySource::Exact { .. } => "exact",
        VelocitySource::AlphaBeta { .. } => "alpha-beta",
        VelocitySource::Observer { .. } => "observer",
    };
    vec![
        format!("sensors.gyro_noise = {} rad/s, sensors.velocity = \"{velocity}\"", Number(sensors.gyro_noise)),
        format!("sensors.position_noise = {} m", Number(sensors.position_noise)),
        format!("sensors.attitude_noise_deg = {}", Number(sensors.attitude_noise.to_degrees())),
        format!("sensors.delay = {delay} s, sensors.seed = {}", sensors.seed),
    ]
}

/// The true vehicle, as far as it was drawn or the file has it.
fn truth(thrown: &Scenario) -> Vec<String> {
    let Some(truth) = &thrown.reality.truth else { return vec![] };
    vec![
        format!("truth.mass = {} kg, truth.inertia = {} kg m^2", Number(truth.mass), vector(&truth.inertia)),
        format!("truth.centre_of_mass = {} m", vector(&truth.centre_of_mass)),
        format!(
            "truth.thrust_scale = {}, truth.rotor_scales = {}",
            Number(truth.thrust_scale),
            array(&truth.rotor_scales)
        ),
    ]
}

/// The rotor that fails.
fn failure(thrown: &Scenario) -> Option<String> {
    let failure = thrown.reality.failure?;
    let (rotor, time, left) = (failure.rotor + 1, Number(failure.time), Number(failure.thrust_left));
    Some(format!("failure.rotor = {rotor}, failure.time = {time} s, failure.thrust_left = {left}"))
}

fn vector(v: &Vector3<f64>) -> String {
    array(v.as_slice())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::studies::campaign::draw::circumstances;

    #[test]
    fn a_flight_s_circumstances_stand_above_its_file_which_stays_what_it_is() {
        let text = "[campaign]\nmass = 0.1\ngust = 2.0\nrotor_failures = 1.0\n";
        let text = format!("{}\n{text}", include_str!("../../../../vehicles/hummingbird.toml"));
        let scenario = Scenario::parse(&text, "h").unwrap();
        let thrown = circumstances(&scenario, &scenario.campaign.ranges, 3, 8);
        let written = above(&text, &thrown, 3, 8);
        assert!(written.starts_with("# Flight 8 of the campaign with seed 3. Drawn"), "{written}");
        let reality = &thrown.reality;
        for expected in [
            "reference: hover at [0.0, 0.0, 0.0] m".to_owned(),
            format!("initial.position = {} m", vector(&thrown.initial.position)),
            format!("wind.steady = {} m/s", vector(&reality.wind.as_ref().unwrap().steady)),
            "wind.gust: a step of ".to_owned(),
            format!("sensors.position_noise = {:?} m", reality.sensors.as_ref().unwrap().position_noise),
            format!("truth.mass = {:?} kg", reality.truth.as_ref().unwrap().mass),
            format!("failure.rotor = {}, failure.time = ", reality.failure.unwrap().rotor + 1),
        ] {
            assert!(written.contains(&format!("\n#   {expected}")), "{expected} is not in:\n{written}");
        }
        // Comments above the file's text: it can be flown as it is.
        assert_eq!(Scenario::parse(&written, "h").unwrap().initial, scenario.initial);
    }

    #[test]
    fn what_is_not_there_is_said() {
        let scenario = Scenario::paper().unwrap();
        let written = above("", &scenario, 0, 1);
        assert!(written.contains("#   no wind\n#   no noise\n") && !written.contains("truth"), "{written}");
    }
}
