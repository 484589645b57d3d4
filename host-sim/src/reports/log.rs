//! log.csv: one row per control tick.
//!
//! The first 40 columns are a contract with other tools; what stands to their right may grow: by what the law estimates
//! (m/s^2, N m), by the rotors' thrusts (N, after lag, in still air, numbered from 1), by the wind (m/s, world), by the
//! battery's voltage (V) and current (A), by the measured state that the law got. Angles in rad, the rest in SI units;
//! each number has the digits that give its bits back.
//!
//! `p…` to `w…` and `yaw` are the vehicle's true state; what the law makes of it (`mrp…` and `position_error` on) is of
//! the state that it got, `measured_…` where there are sensors, `est_…` where there is an estimator.

use crate::flight::Tick;
use scenario::number::Number;
use scenario::reality::Reality;
use std::io::{self, Write};

/// The header row of a vehicle without rotors.
const HEADER: &str = "t,px,py,pz,vx,vy,vz,qw,qx,qy,qz,wx,wy,wz,pdx,pdy,pdz,yaw,yaw_d,thrust,tau_x,tau_y,tau_z,\
mrp_x,mrp_y,mrp_z,lift_sign,position_error,mrp_error,ubar_x,ubar_y,ubar_z,uf_x,uf_y,uf_z,us_x,us_y,us_z,s_theta,s_omega,\
qdw,qdx,qdy,qdz,wdx,wdy,wdz,wddot_x,wddot_y,wddot_z,clipped";

/// Columns of a law that estimates: force, m/s^2; torque, N m; thrust scale.
const ESTIMATES_HEADER: &str = ",d_x,d_y,d_z,tau_d_x,tau_d_y,tau_d_z,thrust_scale";

/// The header row for a vehicle with so many rotors, under a law that estimates or not.
#[must_use]
pub fn header(rotors: usize, estimates: bool) -> String {
    let law = HEADER.to_owned() + if estimates { ESTIMATES_HEADER } else { "" };
    (1..=rotors).fold(law, |header, rotor| header + &format!(",rotor_{rotor}"))
}

/// The header row's columns of `[wind]`, `[battery]` and measurements.
#[must_use]
pub fn reality_header(reality: &Reality) -> String {
    [
        (reality.wind.is_some(), WIND_HEADER),
        (reality.battery.is_some(), BATTERY_HEADER),
        (reality.sensors.is_some(), MEASURED_HEADER),
        (reality.estimator.is_some(), ESTIMATED_HEADER),
    ]
    .into_iter()
    .fold(String::new(), |header, (there, columns)| if there { header + columns } else { header })
}

const WIND_HEADER: &str = ",wind_x,wind_y,wind_z";
const BATTERY_HEADER: &str = ",voltage,current";
const MEASURED_HEADER: &str = ",measured_px,measured_py,measured_pz,measured_vx,measured_vy,measured_vz,\
measured_qw,measured_qx,measured_qy,measured_qz,measured_wx,measured_wy,measured_wz";

const ESTIMATED_HEADER: &str =
    ",est_px,est_py,est_pz,est_vx,est_vy,est_vz,est_qw,est_qx,est_qy,est_qz,est_wx,est_wy,est_wz";

/// What a row takes, bytes: 689 to 796 in the flights of `scenarios/` and `vehicles/`, and a number for each further
/// column.
#[must_use]
pub fn bytes_per_row(reality: &Reality) -> u64 {
    const MODEL_ROW_BYTES: u64 = 740;
    const NUMBER_BYTES: u64 = 14;
    MODEL_ROW_BYTES + NUMBER_BYTES * reality_header(reality).matches(',').count() as u64
}

/// Writes one row.
///
/// # Errors
/// As the writer's.
pub fn write_row(out: &mut impl Write, tick: &Tick) -> io::Result<()> {
    let (s, d) = (&tick.state, &tick.diagnostics);
    let (q, nu, qd) = (&s.attitude, tick.reference.heading.direction(), &d.desired_attitude);
    write!(out, "{}", Number(tick.time_us as f64 / 1e6))?;
    doubles(out, s.position.as_slice())?;
    doubles(out, s.velocity.as_slice())?;
    doubles(out, &[q.w, q.i, q.j, q.k])?;
    doubles(out, s.angular_velocity.as_slice())?;
    singles(out, tick.reference.position.as_slice())?;
    doubles(out, &[s.yaw(), f64::from(nu.y).atan2(f64::from(nu.x))])?;
    singles(out, &[tick.wrench.thrust])?;
    singles(out, tick.wrench.torque.as_slice())?;
    singles(out, d.mrp.as_slice())?;
    singles(out, &[d.lift_sign, d.position_error.norm(), d.mrp.norm()])?;
    singles(out, d.feedback.as_slice())?;
    singles(out, d.filtered.as_slice())?;
    singles(out, d.intermediate.as_slice())?;
    singles(out, &[d.attitude_feedback.norm(), d.rate_feedback.norm()])?;
    singles(out, &[qd.w, qd.i, qd.j, qd.k])?;
    singles(out, d.desired_angular_velocity.as_slice())?;
    singles(out, d.desired_angular_acceleration.as_slice())?;
    write!(out, ",{}", u8::from(tick.clipped))?;
    if let Some(estimates) = &tick.estimates {
        singles(out, estimates.force.as_slice())?;
        singles(out, estimates.torque.as_slice())?;
        singles(out, &[estimates.scale])?;
    }
    doubles(out, &tick.rotors)?;
    if let Some(wind) = &tick.surroundings.wind {
        doubles(out, wind.as_slice())?;
    }
    if let Some((voltage, current)) = tick.surroundings.battery {
        doubles(out, &[voltage, current])?;
    }
    if let Some(measured) = &tick.measured {
        let q = &measured.attitude;
        singles(out, measured.position.as_slice())?;
        singles(out, measured.velocity.as_slice())?;
        singles(out, &[q.w, q.i, q.j, q.k])?;
        singles(out, measured.angular_velocity.as_slice())?;
    }
    writeln!(out)
}

fn doubles(out: &mut impl Write, values: &[f64]) -> io::Result<()> {
    values.iter().try_for_each(|value| write!(out, ",{}", Number(*value)))
}

fn singles(out: &mut impl Write, values: &[f32]) -> io::Result<()> {
    values.iter().try_for_each(|value| write!(out, ",{}", Number(*value)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flight::Flight;
    use scenario::Scenario;

    #[test]
    fn the_contracts_columns_come_first() {
        let contract = "t,px,py,pz,vx,vy,vz,qw,qx,qy,qz,wx,wy,wz,pdx,pdy,pdz,yaw,yaw_d,thrust,tau_x,tau_y,tau_z,mrp_x,\
            mrp_y,mrp_z,lift_sign,position_error,mrp_error,ubar_x,ubar_y,ubar_z,uf_x,uf_y,uf_z,us_x,us_y,us_z,s_theta,\
            s_omega";
        assert!(header(0, false).starts_with(contract) && header(0, true).starts_with(contract));
        assert!(header(4, false).ends_with(",clipped,rotor_1,rotor_2,rotor_3,rotor_4"));
    }

    #[test]
    fn a_row_has_a_number_for_each_column_whatever_is_there() {
        let hummingbird = include_str!("../../../vehicles/hummingbird-paper-law.toml");
        let battery = "[battery]\nfull_voltage = 12\nempty_voltage = 11\nresistance = 0.01\ncapacity = 1\n";
        let wind = "[drag]\n[wind]\nsteady = [1.5, 0, 0]\n";
        for (sections, further) in [
            (String::new(), ""),
            ("[truth]\n".into(), ""),
            (wind.into(), WIND_HEADER),
            (battery.into(), BATTERY_HEADER),
            (format!("{wind}{battery}[sensors]\n"), ",wind_x,wind_y,wind_z,voltage,current,measured_px"),
        ] {
            let scenario = Scenario::parse(&format!("{hummingbird}\n{sections}"), "f").unwrap();
            let header = header(4, scenario.configuration.paper().is_none()) + &reality_header(&scenario.reality);
            let (_, after) = header.split_once(",rotor_4").unwrap();
            assert!(after.starts_with(further) && after.is_empty() == further.is_empty(), "{header}");
            let mut row = Vec::new();
            write_row(&mut row, &Flight::new(&scenario).unwrap().tick().unwrap()).unwrap();
            let row = String::from_utf8(row).unwrap();
            assert_eq!(row.matches(',').count(), header.matches(',').count());
            let wind_x = header.split(',').position(|column| column == "wind_x");
            assert!(wind_x.is_none_or(|column| row.split(',').nth(column) == Some("1.5")), "{row}");
        }
    }
}
