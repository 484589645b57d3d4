//! What is to fail, and when: `pose@12..15`, `gyro@20`, `battery=9.8@30`, `rotor1@20`, `rotor1=0.4@20..30`.
//!
//! A rotor that fails delivers that share of its commanded thrust, none where no share is given, and is whole again
//! after the fault's end.
//!
//! Times are seconds of the vehicle's clock, which starts with the program; without an end a fault stays.

use std::fmt;
use std::ops::Range;
use std::str::FromStr;

/// Something that fails.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FaultyPart {
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
    /// This rotor, counted from 0, delivers this share of its commanded thrust.
    Rotor(usize, f64),
}

/// A fault and its time.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    part: FaultyPart,
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
            "{}; write WHAT@START or WHAT@START..END, in seconds; WHAT is pose, gyro, accelerometer, motors, ground-station, \
             battery=VOLTS, rotorNUMBER or rotorNUMBER=SHARE of its thrust left, from 0 to below 1",
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

impl FromStr for FaultyPart {
    type Err = NoFault;

    fn from_str(text: &str) -> Result<Self, NoFault> {
        Ok(match text {
            "pose" => Self::Pose,
            "gyro" => Self::Gyro,
            "accelerometer" => Self::Accelerometer,
            "ground-station" => Self::GroundStation,
            "motors" => Self::Motors,
            _ => rotor(text)
                .or_else(|| battery(text))
                .ok_or_else(|| NoFault(format!("{text:?} is nothing that fails")))?,
        })
    }
}

fn battery(text: &str) -> Option<FaultyPart> {
    let volts = text.strip_prefix("battery=")?.parse().ok()?;
    (0.0..=100.0).contains(&volts).then_some(FaultyPart::Battery(volts))
}

/// A rotor, which is numbered from 1.
fn rotor(text: &str) -> Option<FaultyPart> {
    let text = text.strip_prefix("rotor")?;
    let (number, left) = text.split_once('=').unwrap_or((text, "0"));
    let (number, left) = (number.parse::<usize>().ok()?, left.parse().ok()?);
    (0.0..1.0).contains(&left).then_some(FaultyPart::Rotor(number.checked_sub(1)?, left))
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
    pub fn has(&self, part: FaultyPart, now: u64) -> bool {
        self.active(now).any(|failed| failed == part)
    }

    /// The battery's voltage at `now`, us, if a fault sets it.
    #[must_use]
    pub fn voltage(&self, now: u64) -> Option<f32> {
        self.active(now).find_map(|part| if let FaultyPart::Battery(volts) = part { Some(volts) } else { None })
    }

    /// The share of its commanded thrust that a rotor, counted from 0, delivers at `now`, us.
    #[must_use]
    pub fn thrust_left(&self, rotor: usize, now: u64) -> f64 {
        let left = self.active(now).filter_map(|part| match part {
            FaultyPart::Rotor(failed, left) if failed == rotor => Some(left),
            _ => None,
        });
        left.fold(1.0, f64::min)
    }

    /// Refuses faults of rotors that a vehicle with so many does not have.
    ///
    /// # Errors
    /// Names the rotor.
    pub fn check(&self, rotors: usize) -> Result<(), String> {
        let missing = self.0.iter().find_map(|fault| match fault.part {
            FaultyPart::Rotor(rotor, _) if rotor >= rotors => Some(rotor + 1),
            _ => None,
        });
        missing.map_or(Ok(()), |number| {
            Err(format!("--fault: rotor{number} is not there: the vehicle's are rotor1 to rotor{rotors}"))
        })
    }

    fn active(&self, now: u64) -> impl Iterator<Item = FaultyPart> {
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
            assert_eq!(faults.has(FaultyPart::Pose, (time * 1e6) as u64), pose, "{time}");
        }
        assert!(faults.has(FaultyPart::GroundStation, 700_000) && !faults.has(FaultyPart::GroundStation, 1_000_000));
        assert!(!faults.has(FaultyPart::Gyro, 19_000_000) && faults.has(FaultyPart::Gyro, u64::MAX));
        assert_eq!((faults.voltage(29_000_000), faults.voltage(30_000_000)), (None, Some(9.8)));
    }

    #[test]
    fn a_rotor_delivers_what_its_fault_leaves_and_is_whole_before_and_after_it() {
        let faults = ["rotor1@20", "rotor4=0.4@20..30", "rotor4=0.7@25..35"];
        let faults = Faults(faults.map(|text| text.parse().unwrap()).to_vec());
        for (time, expected) in
            [(19.9, [1.0, 1.0]), (20.0, [0.0, 0.4]), (26.0, [0.0, 0.4]), (30.0, [0.0, 0.7]), (35.0, [0.0, 1.0])]
        {
            let left = [0, 3].map(|rotor| faults.thrust_left(rotor, (time * 1e6) as u64));
            assert_eq!(left, expected, "{time}");
        }
        assert_eq!((faults.thrust_left(1, 26_000_000), faults.check(4)), (1.0, Ok(())));
        let refused = faults.check(3).unwrap_err();
        assert_eq!(refused, "--fault: rotor4 is not there: the vehicle's are rotor1 to rotor3");
    }

    #[test]
    fn what_is_no_fault_is_refused_with_the_way_to_write_one() {
        for text in [
            "pose",
            "pose@",
            "pose@x",
            "pose@5..4",
            "pose@-1",
            "pose@NaN",
            "wing@3",
            "battery=x@3",
            "battery=-1@2",
            "rotor@3",
            "rotor0@3",
            "rotor-1@3",
            "rotor1=@3",
            "rotor1=1@3",
            "rotor1=-0.1@3",
            "rotor1=nan@3",
        ] {
            let refused = text.parse::<Fault>().unwrap_err().to_string();
            assert!(refused.contains("WHAT@START..END"), "{text}: {refused}");
        }
    }
}
