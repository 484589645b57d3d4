//! The reference of a scenario as rows of a CSV file, for a program that streams it to a vehicle.
//!
//! The columns are those of [`scenario::trajectory`]'s files, all of them: `t`, `x` to `z`, `vx` to `vz`, `ax` to `az`,
//! `yaw_deg`. World frame, z up; s, m, degrees. The row `k` is the reference at `k` periods of the rows; the last one
//! is at or after the scenario's end.

use scenario::Scenario;
use std::io::{self, Write};

/// The most rows a second: a reference is told apart in whole microseconds.
pub const GREATEST_RATE: f64 = 1000.0;

/// Writes the rows of `scenario`, `rate` of them a second; returns how many.
///
/// # Errors
/// The writer's.
pub fn write(scenario: &Scenario, rate: f64, out: &mut impl Write) -> io::Result<u64> {
    writeln!(out, "t,x,y,z,vx,vy,vz,ax,ay,az,yaw_deg")?;
    let last = (scenario.timing.duration() * rate).ceil() as u64;
    for row in 0..=last {
        let time = (row as f64 * 1e6 / rate).round() as u64;
        let reference = scenario.trajectory.at(time);
        let ahead = reference.heading.direction();
        write!(out, "{}", time as f64 * 1e-6)?;
        for vector in [reference.position, reference.velocity, reference.acceleration] {
            write!(out, ",{},{},{}", vector.x, vector.y, vector.z)?;
        }
        writeln!(out, ",{}", f64::from(ahead.y).atan2(f64::from(ahead.x)).to_degrees())?;
    }
    Ok(last + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rows_are_the_reference_at_their_times() {
        let scenario = Scenario::parse(scenario::PAPER, "paper").unwrap();
        let mut text = Vec::new();
        assert_eq!(write(&scenario, 50.0, &mut text).unwrap(), 2001);
        let text = String::from_utf8(text).unwrap();
        assert_eq!(text.lines().count(), 2002);
        for line in text.lines().skip(1).step_by(37) {
            let numbers: Vec<f64> = line.split(',').map(|number| number.parse().unwrap()).collect();
            let reference = scenario.trajectory.at((numbers[0] * 1e6).round() as u64);
            let vectors = [reference.position, reference.velocity, reference.acceleration];
            for (found, wanted) in numbers[1..10].iter().zip(vectors.iter().flat_map(|vector| vector.iter())) {
                assert_eq!(*found as f32, *wanted);
            }
            let (sine, cosine) = numbers[10].to_radians().sin_cos();
            assert!((cosine - f64::from(reference.heading.direction().x)).abs() < 1e-6);
            assert!((sine - f64::from(reference.heading.direction().y)).abs() < 1e-6);
        }
    }
}
