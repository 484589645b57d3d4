//! log.csv: one row per control tick.
//!
//! The first 40 columns are a contract with other tools; what stands to their right may grow, by what the law estimates and, at the end,
//! the rotors' thrusts (N, after lag, numbered from 1). Angles in rad, the rest in SI
//! units; each number has the digits that give its bits back.

use crate::flight::Tick;
use std::io::{self, Write};

/// The header row of a vehicle without rotors.
const HEADER: &str = "t,px,py,pz,vx,vy,vz,qw,qx,qy,qz,wx,wy,wz,pdx,pdy,pdz,yaw,yaw_d,thrust,tau_x,tau_y,tau_z,\
mrp_x,mrp_y,mrp_z,lift_sign,position_error,mrp_error,ubar_x,ubar_y,ubar_z,uf_x,uf_y,uf_z,us_x,us_y,us_z,s_theta,s_omega,\
qdw,qdx,qdy,qdz,wdx,wdy,wdz,wddot_x,wddot_y,wddot_z,clipped";

/// What a law that estimates adds: force, m/s^2; torque, N m; thrust scale.
const ESTIMATES: &str = ",d_x,d_y,d_z,tau_d_x,tau_d_y,tau_d_z,thrust_scale";

/// The header row for a vehicle with so many rotors, under a law that estimates or not.
#[must_use]
pub fn header(rotors: usize, estimates: bool) -> String {
    let law = HEADER.to_owned() + if estimates { ESTIMATES } else { "" };
    (1..=rotors).fold(law, |header, rotor| header + &format!(",rotor_{rotor}"))
}

/// What a row takes, bytes: 689 to 796 in the flights of `scenarios/` and `vehicles/`.
pub const BYTES_PER_ROW: u64 = 740;

/// Writes one row.
///
/// # Errors
/// As the writer's.
pub fn write_row(out: &mut impl Write, tick: &Tick) -> io::Result<()> {
    let (s, d) = (&tick.state, &tick.diagnostics);
    let (q, nu, qd) = (&s.attitude, tick.reference.heading.direction(), &d.desired_attitude);
    write!(out, "{:?}", tick.time_us as f64 / 1e6)?;
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
        singles(out, estimates.force.value.as_slice())?;
        singles(out, estimates.torque.as_slice())?;
        singles(out, &[estimates.scale])?;
    }
    doubles(out, &tick.rotors)?;
    writeln!(out)
}

fn doubles(out: &mut impl Write, values: &[f64]) -> io::Result<()> {
    values.iter().try_for_each(|value| write!(out, ",{value:?}"))
}

fn singles(out: &mut impl Write, values: &[f32]) -> io::Result<()> {
    values.iter().try_for_each(|value| write!(out, ",{value:?}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_contracts_columns_come_first() {
        let contract = "t,px,py,pz,vx,vy,vz,qw,qx,qy,qz,wx,wy,wz,pdx,pdy,pdz,yaw,yaw_d,thrust,tau_x,tau_y,tau_z,mrp_x,\
            mrp_y,mrp_z,lift_sign,position_error,mrp_error,ubar_x,ubar_y,ubar_z,uf_x,uf_y,uf_z,us_x,us_y,us_z,s_theta,\
            s_omega";
        assert!(header(0, false).starts_with(contract) && header(0, true).starts_with(contract));
        assert!(header(4, false).ends_with(",clipped,rotor_1,rotor_2,rotor_3,rotor_4"));
    }
}
