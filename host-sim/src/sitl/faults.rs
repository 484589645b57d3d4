//! What is to fail, and when: `pose@12..15`, `gyro@20`, `battery=9.8@30`.
//!
//! Times are seconds of the vehicle's clock, which starts with the program; without an end a fault stays.

use std::fmt;
use std::ops::Range;
use std::str::FromStr;

/// Something that fails.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Part {
    /// No pose arrives.
    Pose,
    /// The IMU does not answer.
    Gyro,
    /// The IMU's accelerometer does not answer.
    Accelerometer,
    /// Frames to and from clients are lost.
    GroundStation,
    /// The motors' frames do not go out.
    Motors,
    /// The battery shows this voltage, V.
    Battery(f32),
}

/// A fault and its time.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    part: Part,
    /// s.
    time: Range<f64>,
}

/// A fault that cannot be understood.
#[derive(Debug, Clone, PartialEq)]
pub struct NoFault(String);

impl fmt::Display for NoFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}; write WHAT@START or WHAT@START..END, in seconds; WHAT is pose, gyro, accelerometer, motors, ground-station \
             or battery=VOLTS",
            self.0
        )
    }
}

impl std::error::Error for NoFault {}

impl FromStr for Fault {
    type Err = NoFault;

    fn from_str(text: &str) -> Result<Self, NoFault> {
        let (part, time) = text.split_once('@').ok_or_else(|| NoFault("there is no @".to_owned()))?;
        let (start, end) = time.split_once("..").unwrap_or((time, "inf"));
        let time = seconds(start)?..seconds(if end.is_empty() { "inf" } else { end })?;
        if !(time.start.is_finite() && time.start < time.end) {
            return Err(NoFault(format!("{} s is not before {} s", time.start, time.end)));
        }
        Ok(Self { part: part.parse()?, time })
    }
}

impl FromStr for Part {
    type Err = NoFault;

    fn from_str(text: &str) -> Result<Self, NoFault> {
        Ok(match text {
            "pose" => Self::Pose,
            "gyro" => Self::Gyro,
            "accelerometer" => Self::Accelerometer,
            "ground-station" => Self::GroundStation,
            "motors" => Self::Motors,
            _ => {
                let volts = text.strip_prefix("battery=").and_then(|volts| volts.parse().ok());
                let volts = volts.filter(|volts| (0.0..=100.0).contains(volts));
                Self::Battery(volts.ok_or_else(|| NoFault(format!("{text:?} is nothing that fails")))?)
            }
        })
    }
}

/// A time, s, that is not negative.
fn seconds(text: &str) -> Result<f64, NoFault> {
    let time = text.parse().ok().filter(|time: &f64| *time >= 0.0);
    time.ok_or_else(|| NoFault(format!("{text:?} is no time")))
}

/// All faults of a session.
#[derive(Debug, Clone, Default)]
pub struct Faults(pub Vec<Fault>);

impl Faults {
    /// Whether a part has failed at `now`, us.
    #[must_use]
    pub fn has(&self, part: Part, now: u64) -> bool {
        self.active(now).any(|failed| failed == part)
    }

    /// The battery's voltage at `now`, us, if a fault sets it.
    #[must_use]
    pub fn voltage(&self, now: u64) -> Option<f32> {
        self.active(now).find_map(|part| if let Part::Battery(volts) = part { Some(volts) } else { None })
    }

    fn active(&self, now: u64) -> impl Iterator<Item = Part> {
        let now = now as f64 * 1e-6;
        self.0.iter().filter(move |fault| fault.time.contains(&now)).map(|fault| fault.part)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_are_read_as_they_are_written() {
        let faults = ["pose@12..15", "gyro@20", "battery=9.8@30..", "ground-station@0.5..1"];
        let faults = Faults(faults.map(|text| text.parse().unwrap()).to_vec());
        for (time, pose) in [(11.9, false), (12.0, true), (14.9, true), (15.0, false)] {
            assert_eq!(faults.has(Part::Pose, (time * 1e6) as u64), pose, "{time}");
        }
        assert!(faults.has(Part::GroundStation, 700_000) && !faults.has(Part::GroundStation, 1_000_000));
        assert!(!faults.has(Part::Gyro, 19_000_000) && faults.has(Part::Gyro, u64::MAX));
        assert_eq!((faults.voltage(29_000_000), faults.voltage(30_000_000)), (None, Some(9.8)));
    }

    #[test]
    fn what_is_no_fault_is_refused_with_the_way_to_write_one() {
        for text in
            ["pose", "pose@", "pose@x", "pose@5..4", "pose@-1", "pose@NaN", "wing@3", "battery=x@3", "battery=-1@2"]
        {
            let refused = text.parse::<Fault>().unwrap_err().to_string();
            assert!(refused.contains("WHAT@START..END"), "{text}: {refused}");
        }
    }
}
