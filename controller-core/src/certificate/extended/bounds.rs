//! Every thrust and torque the extended law can command, down to each rotor. Sections 11 and 12 of `docs/extended-law.md`.

use super::motion::cells;
use super::reach::Reach;
use super::torque::{TILT_CELLS, TiltCell, Torques};
use crate::allocation::Rotors;
use crate::allocation::geometry::ROTORS_MAX;
use crate::certificate::configuration::Configuration;
use crate::certificate::form::{ARITHMETIC_ALLOWANCE, Interval};
use crate::error::ParameterError;
use crate::extended::parameters::Extended;
use crate::math;
use heapless::Vec;
use nalgebra::Vector3;

/// Everything the extended law can command.
#[derive(Debug, Clone, PartialEq)]
pub struct ExtendedBounds {
    /// Greatest |omega_d| and |omega_d'| across the thrust axis, rad/s and rad/s^2.
    pub rates: [f64; 2],
    /// Every thrust, N.
    pub thrust: Interval,
    /// Greatest |torque| about each body axis, N m.
    pub torque: Vector3<f64>,
    /// Every thrust of each rotor as commanded, divided by the thrust scale, N.
    pub rotors: Vec<Interval, ROTORS_MAX>,
    /// N and m n in N where they come nearest to each other without attitude error.
    pub floor: [f64; 2],
}

/// One row of B+: b_T and b_tau.
#[derive(Clone, Copy)]
struct Row {
    thrust: f64,
    torque: Vector3<f64>,
    /// s_hi f_min.
    least: f64,
}

/// Works the bounds out.
///
/// # Errors
/// If a number is not finite; the constructors before it leave no way to that.
#[inline(never)] // as the turning rates
pub fn bounds(configuration: &Configuration, parameters: &Extended) -> Result<ExtendedBounds, ParameterError> {
    let (vehicle, references, rotors) = (configuration.vehicle(), configuration.bounds(), configuration.rotors());
    let reach = Reach::new(parameters, references, f64::from(vehicle.gravity));
    let inertia = vehicle.inertia.map(f64::from);
    let torques = Torques::new(parameters, &inertia);
    let turn = f64::from(parameters.heading.rate);
    let (mass, margin) = (f64::from(vehicle.mass), f64::from(parameters.floor_margin));
    let [least_scale, greatest_scale] =
        [parameters.estimates.scale_least, parameters.estimates.scale_greatest].map(f64::from);
    let rows = rows(rotors, greatest_scale);
    let raised = 1.0 + ARITHMETIC_ALLOWANCE;

    let (mut rate, mut swing) = (0.0_f64, 0.0_f64);
    let mut floor = [margin, mass * reach.vertical_least];
    for cell in cells(&reach) {
        rate = math::greater_f64(rate, cell.rate());
        swing = math::greater_f64(swing, cell.acceleration(turn));
        let available = mass * cell.least;
        for row in &rows {
            let away = -row.torque;
            let asked = (row.least + torques.feedforward(&away, &cell) + torques.bias(&away)) / row.thrust + margin;
            // What is no number is the nearest, and stays it: the inequality then fails.
            let is_further = asked * floor[1] <= floor[0] * available || floor[0].is_nan();
            if !is_further {
                floor = [asked, available];
            }
        }
    }

    // What a cell of the motion needs of a tilt is worked out once: on a board all of this is counted in seconds.
    let tilts: Vec<TiltCell, TILT_CELLS> = torques.tilt_cells().collect();
    let greatest_swing = torques.swing(swing);
    let worst = |b: &Vector3<f64>| -> Result<f64, ParameterError> {
        let lever = torques.lever(b);
        let along = |tilt| torques.feedback(b, tilt) + torques.swung(&lever, tilt, &greatest_swing);
        Ok(tilts.iter().map(along).fold(0.0, math::greater_f64) + torques.gyroscopic(b, rate)?)
    };
    let torque = Vector3::new(worst(&Vector3::x())?, worst(&Vector3::y())?, worst(&Vector3::z())?);

    let mut greatest = mass * math::hypot(reach.across, reach.vertical_greatest);
    for row in &rows {
        greatest = math::greater_f64(greatest, (row.least + worst(&-row.torque)?) / row.thrust + margin);
    }
    let mut commanded = Vec::new();
    for row in &rows {
        // With the floor for a thrust, the rotor k that sets it is at its least thrust.
        let mut most = 0.0_f64;
        for other in &rows {
            let share = row.thrust / other.thrust;
            let difference = row.torque - other.torque * share;
            most = math::greater_f64(most, share * other.least + worst(&difference)? + row.thrust * margin);
        }
        let gyroscopic = torques.gyroscopic(&row.torque, rate)?;
        let lever = torques.lever(&row.torque);
        let feedback: Vec<f64, TILT_CELLS> = tilts.iter().map(|tilt| torques.feedback(&row.torque, tilt)).collect();
        for cell in cells(&reach) {
            let lift = row.thrust * mass * cell.greatest;
            let swing = torques.swing(cell.acceleration(turn));
            for (tilt, feedback) in tilts.iter().zip(&feedback) {
                let along = lift * math::greater_f64(tilt.cosine(), 0.0);
                let support = feedback + torques.swung(&lever, tilt, &swing);
                most = math::greater_f64(most, along + support + gyroscopic);
            }
        }
        // As many as there are rotors: it fits.
        let greatest = most / least_scale * raised;
        let _ = commanded.push(Interval { least: row.least / greatest_scale / raised, greatest });
    }
    Ok(ExtendedBounds {
        rates: [rate, swing],
        thrust: Interval { least: margin / raised, greatest: greatest * raised },
        torque: torque * raised,
        rotors: commanded,
        floor: [floor[0] * raised, floor[1]],
    })
}

fn rows(rotors: Option<&Rotors>, greatest_scale: f64) -> Vec<Row, ROTORS_MAX> {
    let mut rows = Vec::new();
    for (rotor, row) in rotors.into_iter().flat_map(|rotors| rotors.iter().zip(rotors.pseudo_inverse())) {
        let torque = Vector3::new(row.y, row.z, row.w);
        // As many as there are rotors: it fits.
        let _ = rows.push(Row { thrust: row.x, torque, least: greatest_scale * f64::from(rotor.thrust_min) });
    }
    rows
}
