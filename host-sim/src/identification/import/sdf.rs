//! SDF of Gazebo with its motor model, as PX4's models have it: `gz-sim-multicopter-motor-model-system`, or the older
//! `libgazebo_motor_model.so`.
//!
//! All [links](super::sdf_model) are put together as they stand at zero joint angles, those of included models too. A
//! [motor's](super::sdf_motor) thrust is `motorConstant` w^2, its torque `momentConstant` times that, w at most
//! `maxRotVelocity` (rad/s); `ccw` and `cw` are seen from above. Our rotors have one lag: the slower of
//! `timeConstantUp` and `timeConstantDown`. `rotorDragCoefficient` is kg/rad, across the rotor;
//! `rollingMomentCoefficient` has no counterpart.

use super::numbers::{Actuation, RotorNumbers, Thrust, VehicleNumbers, alike};
use super::rigid::{Part, upright};
use super::sdf_model::Model;
use super::sdf_motor::MOTOR_NUMBERS;
use roxmltree::Node;
use std::path::Path;

/// Reads the document of `sdf`, which stands in `file`.
///
/// # Errors
/// Names the element, of an included file as well.
pub fn read(sdf: &Node, file: &Path) -> Result<VehicleNumbers, String> {
    let Model { frames, links, mut motors, .. } = Model::read(sdf, file)?;
    let placed = links.iter().map(|link| {
        let stands = frames.pose(&link.whole_name).map_err(|what| format!("{}: {what}", link.place))?;
        Ok(link.part.placed(&stands))
    });
    let parts: Vec<Part> = placed.collect::<Result<_, String>>()?;
    let whole = Part::together(&parts);
    let centre = whole.map(|whole| whole.centre).unwrap_or_default();
    motors.sort_by(|a, b| a.number.total_cmp(&b.number));
    for pair in motors.windows(2) {
        if pair[0].number == pair[1].number {
            return Err(format!("{}: motorNumber {} is another's already", pair[1].place, pair[1].number));
        }
    }
    let mut position = Vec::new();
    for motor in &motors {
        let link = frames.find(&motor.model, &motor.link, "link");
        let stands = link.and_then(|link| frames.pose(link));
        let stands = stands.map_err(|what| format!("{}: linkName: {what}", motor.place))?;
        position.push(upright(&motor.place, &stands)? - centre);
    }
    let mut of_all = [None; MOTOR_NUMBERS.len()];
    for (index, (number, name)) in of_all.iter_mut().zip(MOTOR_NUMBERS).enumerate() {
        let stated: Vec<_> =
            motors.iter().filter_map(|motor| Some((motor.place.clone(), motor.numbers[index]?))).collect();
        if !stated.is_empty() && stated.len() < motors.len() {
            return Err(format!("{}: {name}: the other motors do not state it; state it for all", stated[0].0));
        }
        *number = alike(name, &stated)?;
    }
    let [thrust, moment, speed, up, down, across] = of_all;
    let rotors = RotorNumbers {
        position: Some(position).filter(|position| !position.is_empty()),
        spin: Some(motors.iter().map(|motor| motor.spin).collect::<Vec<_>>()).filter(|spin| !spin.is_empty()),
        thrust: Thrust::BySpeed {
            thrust_coefficient: thrust,
            drag_coefficient: thrust.zip(moment).map(|(thrust, moment)| thrust * moment),
            speed: speed.map(|greatest| [0.0, greatest]),
        },
        lag: up.into_iter().chain(down).reduce(f64::max),
    };
    let mut vehicle = VehicleNumbers::new("SDF of Gazebo with its motor model", Actuation::Rotors(rotors));
    (vehicle.mass, vehicle.inertia) = (whole.map(|whole| whole.mass), whole.map(|whole| whole.inertia));
    vehicle.drag.rotor_across = across.unwrap_or(0.0);
    if let (Some(up), Some(down)) = (up, down)
        && up != down
    {
        let note = format!("the slower of timeConstantUp = {up} and timeConstantDown = {down}");
        vehicle.notes.push(("rotors.lag", note));
    }
    Ok(vehicle)
}
