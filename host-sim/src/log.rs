//! log.csv: one row per control tick, and files that appear whole or not at all.
//!
//! The first 40 columns are a contract with other tools; what stands to their right may grow. Angles in rad, the rest in SI
//! units; each number has the digits that give its bits back.

use crate::flight::Tick;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// The header row.
pub const HEADER: &str = "t,px,py,pz,vx,vy,vz,qw,qx,qy,qz,wx,wy,wz,pdx,pdy,pdz,yaw,yaw_d,thrust,tau_x,tau_y,tau_z,\
mrp_x,mrp_y,mrp_z,lift_sign,position_error,mrp_error,ubar_x,ubar_y,ubar_z,uf_x,uf_y,uf_z,us_x,us_y,us_z,s_theta,s_omega,\
qdw,qdx,qdy,qdz,wdx,wdy,wdz,wddot_x,wddot_y,wddot_z,clipped";

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
    writeln!(out, ",{}", u8::from(tick.clipped))
}

fn doubles(out: &mut impl Write, values: &[f64]) -> io::Result<()> {
    values.iter().try_for_each(|value| write!(out, ",{value:?}"))
}

fn singles(out: &mut impl Write, values: &[f32]) -> io::Result<()> {
    values.iter().try_for_each(|value| write!(out, ",{value:?}"))
}

/// A file that shows up under its name only when it is complete; dropped before that, it leaves nothing behind.
pub struct WholeFile {
    writer: Option<BufWriter<File>>,
    temporary: PathBuf,
    path: PathBuf,
}

impl WholeFile {
    /// Starts a file that will be called `path`. It grows under a hidden name in the same directory.
    ///
    /// # Errors
    /// If it cannot be created.
    pub fn create(path: &Path) -> io::Result<Self> {
        let name = path.file_name().ok_or(io::ErrorKind::InvalidInput)?.to_string_lossy();
        let temporary = path.with_file_name(format!(".{name}.{}.part", std::process::id()));
        let writer = Some(BufWriter::new(File::create(&temporary)?));
        Ok(Self { writer, temporary, path: path.to_owned() })
    }

    /// Writes `contents` to `path`, whole.
    ///
    /// # Errors
    /// If it cannot be created, written or renamed.
    pub fn write(path: &Path, contents: &str) -> io::Result<()> {
        let mut file = Self::create(path)?;
        file.write_all(contents.as_bytes())?;
        file.finish()
    }

    /// Gives the complete file its name.
    ///
    /// # Errors
    /// If what is left cannot be written, or the file not renamed.
    pub fn finish(mut self) -> io::Result<()> {
        if let Some(writer) = self.writer.take() {
            writer.into_inner().map_err(io::IntoInnerError::into_error)?;
        }
        std::fs::rename(&self.temporary, &self.path)
    }
}

impl Write for WholeFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.writer.as_mut().map_or(Ok(0), |writer| writer.write(bytes))
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer.as_mut().map_or(Ok(()), Write::flush)
    }
}

impl Drop for WholeFile {
    fn drop(&mut self) {
        // After `finish` the temporary name is gone and there is nothing to remove.
        let _ = std::fs::remove_file(&self.temporary);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_contracts_columns_come_first() {
        let contract = "t,px,py,pz,vx,vy,vz,qw,qx,qy,qz,wx,wy,wz,pdx,pdy,pdz,yaw,yaw_d,thrust,tau_x,tau_y,tau_z,mrp_x,\
            mrp_y,mrp_z,lift_sign,position_error,mrp_error,ubar_x,ubar_y,ubar_z,uf_x,uf_y,uf_z,us_x,us_y,us_z,s_theta,\
            s_omega";
        assert!(HEADER.starts_with(contract));
    }

    #[test]
    fn a_file_that_was_not_finished_leaves_nothing_behind() {
        let directory = std::env::temp_dir().join(format!("host-sim-log-{}", std::process::id()));
        std::fs::create_dir_all(&directory).unwrap();
        let path = directory.join("log.csv");
        let mut file = WholeFile::create(&path).unwrap();
        file.write_all(b"half").unwrap();
        assert!(!path.exists());
        drop(file);
        assert_eq!(std::fs::read_dir(&directory).unwrap().count(), 0);
        WholeFile::write(&path, "whole").unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "whole");
        assert_eq!(std::fs::read_dir(&directory).unwrap().count(), 1);
        std::fs::remove_dir_all(&directory).unwrap();
    }
}
