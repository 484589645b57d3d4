//! The reference of a scenario as rows of a CSV file, for a program that streams it to a vehicle.
//!
//! The columns are those of [`scenario::trajectory`]'s files, all of them: `t`, `x` to `z`, `vx` to `vz`, `ax` to `az`,
//! `yaw_deg`. World frame, z up; s, m, degrees. They may be slower than the reference, by a factor: a stream needs room
//! below the bounds, since the vehicle guesses its jerk and snap. The last row is at or after the scenario's end.

use scenario::Scenario;
use std::io::{self, Write};

/// The most rows a second: a reference's time is in whole microseconds.
pub const ROW_RATE_MAX_HZ: f64 = 1000.0;

/// How many times slower than the reference rows are that a vehicle follows to within 2 cm.
pub const FOLLOWED_WITHIN_2_CM_FACTOR: f64 = 1.1;

/// Writes the rows of `scenario`, `rate` of them a second, `slower` times slower than it; returns how many.
///
/// # Errors
/// The writer's.
pub fn write(scenario: &Scenario, rate: f64, slower: f64, out: &mut impl Write) -> io::Result<u64> {
    writeln!(out, "t,x,y,z,vx,vy,vz,ax,ay,az,yaw_deg")?;
    let last = (scenario.timing.duration() * slower * rate).ceil() as u64;
    for row in 0..=last {
        let time = row as f64 / rate;
        let reference = scenario.trajectory.at((time * 1e6 / slower).round() as u64);
        let (velocity, acceleration) = (reference.velocity.cast::<f64>(), reference.acceleration.cast::<f64>());
        let ahead = reference.heading.direction();
        write!(out, "{time}")?;
        for vector in [reference.position.cast(), velocity / slower, acceleration / (slower * slower)] {
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
        assert_eq!(write(&scenario, 50.0, 1.25, &mut text).unwrap(), 2501);
        let text = String::from_utf8(text).unwrap();
        assert_eq!(text.lines().count(), 2502);
        for line in text.lines().skip(1).step_by(37) {
            let numbers: Vec<f64> = line.split(',').map(|number| number.parse().unwrap()).collect();
            let reference = scenario.trajectory.at((numbers[0] * 1e6 / 1.25).round() as u64);
            let vectors = [reference.position, reference.velocity / 1.25, reference.acceleration / 1.5625];
            for (found, wanted) in numbers[1..10].iter().zip(vectors.iter().flat_map(|vector| vector.iter())) {
                assert!((found - f64::from(*wanted)).abs() < 1e-6, "{line}");
            }
            let (sine, cosine) = numbers[10].to_radians().sin_cos();
            assert!((cosine - f64::from(reference.heading.direction().x)).abs() < 1e-6);
            assert!((sine - f64::from(reference.heading.direction().y)).abs() < 1e-6);
        }
    }
}
