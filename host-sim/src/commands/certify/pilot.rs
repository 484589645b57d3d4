//! The abilities of a vehicle under the extended law, in a pilot's terms.

use crate::output::table::{aligned, percent, short};
use controller_core::configuration::{Configuration, ExtendedLaw};
use controller_core::extended::budget::TorqueBudget;
use controller_core::extended::parameters::ExtendedParameters;

/// The table and the lines below it.
#[must_use]
pub fn terms(configuration: &Configuration, law: &ExtendedLaw) -> String {
    let p = &*law.parameters;
    let [mass, gravity] = [configuration.vehicle().mass, configuration.vehicle().gravity].map(f64::from);
    let (vehicle, limits) = (configuration.vehicle(), configuration.limits());
    let budget = TorqueBudget::<f64>::new(p.floor_margin, limits, configuration.rotors());
    let upwards = budget.held_acceleration(vehicle, limits, 1.0) - gravity;
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
        "{}tilt up to {} degrees\nthe thrust turns with up to {} degrees/s, and always with {} degrees/s^2\n\
         the heading turns with up to {} degrees/s, near the target with {} degrees/s^2\n{}",
        aligned(&rows),
        degrees(p.tilt_max),
        degrees(p.turn_rate),
        degrees(p.turn_reserve),
        degrees(p.yaw_rate),
        degrees(p.yaw_acceleration),
        torque(configuration, p, &budget)
    )
}

/// The parts of the torque about the tilt's axes, of what there is in every direction.
fn torque(configuration: &Configuration, p: &ExtendedParameters, budget: &TorqueBudget) -> String {
    let vehicle = configuration.vehicle();
    let most = budget.radius(1.0);
    let turning = f64::from(vehicle.inertia.x.max(vehicle.inertia.y) * p.turn_reserve);
    let shares = [
        ("an error pulls with up to", p.m_tilt.into()),
        ("turning has always", turning),
        ("a bias takes up to", p.torque_tilt.into()),
    ]
    .map(|(name, part): (_, f64)| format!("{name} {}", percent(part / most)));
    format!("of {} N m about the tilt's axes: {}\n", short(most), shares.join(", "))
}
