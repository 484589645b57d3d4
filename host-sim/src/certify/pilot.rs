//! The abilities of a vehicle under the extended law, in a pilot's terms.

use crate::table::{aligned, percent, short};
use controller_core::configuration::{Configuration, ExtendedLaw};
use controller_core::extended::budget::{Row, THRUST_LEFT, TorqueBudget};
use controller_core::extended::parameters::ExtendedParameters;

/// The table and the lines below it.
#[must_use]
pub fn terms(configuration: &Configuration, law: &ExtendedLaw) -> String {
    let p = &*law.parameters;
    let [mass, gravity] = [configuration.vehicle().mass, configuration.vehicle().gravity].map(f64::from);
    let budget = budget(configuration, p);
    let [each, taken] = budget.ceiling;
    let thrust = (1.0 - THRUST_LEFT) * (each - taken).min(f64::from(configuration.limits().thrust_max));
    let upwards = thrust / mass - gravity;
    let row = |name: &str, values: [f64; 3]| [vec![name.to_owned()], values.map(short).to_vec()].concat();
    let forces = [p.force_across, p.force_up, p.force_down].map(f64::from);
    let rows = [
        ["what a pilot gets", "across", "up", "down"].map(str::to_owned).to_vec(),
        row("acceleration, m/s^2", [f64::from(p.a_across), upwards, f64::from(p.a_down)]),
        row("speed of approach, m/s", [p.v_across, p.v_up, p.v_down].map(f64::from)),
        row("force held, m/s^2", forces),
        row("force held, N", forces.map(|force| mass * force)),
    ];
    let degrees = |angle: f32| short(f64::from(angle).to_degrees().round());
    format!(
        "{}tilt up to {} degrees\nthe thrust turns with up to {} degrees/s and {} degrees/s^2, {} of them always\n\
         the heading turns with up to {} degrees/s and {} degrees/s^2\n{}",
        aligned(&rows),
        degrees(p.tilt_max),
        degrees(p.turn_rate),
        degrees(p.turn_acceleration),
        degrees(p.turn_reserve),
        degrees(p.yaw_rate),
        degrees(p.yaw_acceleration),
        torque(configuration, p)
    )
}

fn budget(configuration: &Configuration, parameters: &ExtendedParameters) -> TorqueBudget {
    TorqueBudget::new(parameters, configuration.vehicle(), configuration.limits(), configuration.rotors())
}

/// The shares of the torque: of roll's and pitch's limit or of the rotors' range, whichever leaves the tilt less.
fn torque(configuration: &Configuration, p: &ExtendedParameters) -> String {
    let unbiased = ExtendedParameters { torque_tilt: 0.0, torque_yaw: 0.0, ..*p };
    let idle =
        ExtendedParameters { turn_rate: 0.0, yaw_rate: 0.0, yaw_acceleration: 0.0, w: 0.0, m_omega_z: 0.0, ..unbiased };
    let [full, unbiased, idle] = [p, &unbiased, &idle].map(|parameters| budget(configuration, parameters));
    let names = ["roll and pitch torque", "yaw torque", "the rotors' range"];
    let rows = names.iter().zip(full.rows.iter().zip(unbiased.rows.iter().zip(&idle.rows)));
    let of_tilt = rows.filter(|(_, (row, _))| row.tilt > 0.0);
    let left = |row: &Row| row.room / row.tilt;
    let Some((name, (row, (unbiased, idle)))) = of_tilt.min_by(|(_, (a, _)), (_, (b, _))| left(a).total_cmp(&left(b)))
    else {
        return String::new();
    };
    let [tilt, yaw] = full.inertia;
    let [feedback, reserve] = [p.m_all, p.turn_reserve].map(f64::from);
    let parts = [
        ("tilt feedback", row.tilt * feedback),
        ("turning reserve", (row.tilt * tilt + row.yaw * yaw) * reserve),
        ("yaw", idle.room - unbiased.room),
        ("bias", unbiased.room - row.room),
    ];
    let shares: Vec<String> =
        parts.iter().map(|(name, part)| format!("{name} {}", percent(part / idle.room))).collect();
    format!("of {name}: {}\n", shares.join(", "))
}
