//! What became of a pose, and what is wrong with the estimate, in words that fit a MAVLink STATUSTEXT (50 characters).

use core::fmt;

/// What a pose was taken for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Taken {
    /// Fused.
    Fused,
    /// Kept until the IMU's increments reach its time; [`super::Health::last`] tells then.
    Waiting,
    /// One of the first: the estimate begins when enough of them agree.
    Aligning,
    /// The estimate begins with it.
    Started,
    /// The sender's frame had moved, and it says so: the estimate is in the new frame.
    Rebased,
    /// The body was lost and is found again, no further away than coasting explains: the estimate was reset to it.
    Refound,
}

impl Taken {
    /// Everything a pose can be taken for.
    pub const ALL: [Self; 6] =
        [Self::Fused, Self::Waiting, Self::Aligning, Self::Started, Self::Rebased, Self::Refound];

    /// The same in words.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::Fused => "Poses: believed",
            Self::Waiting => "Poses: waiting for the IMU",
            Self::Aligning => "Poses: aligning",
            Self::Started => "Poses: the estimate begins",
            Self::Rebased => "Poses: the sender's frame has moved",
            Self::Refound => "Poses: body found again, estimate reset to it",
        }
    }
}

impl fmt::Display for Taken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.text())
    }
}

/// Why a pose was not believed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Rejected {
    /// The sender says that its tracking has failed.
    Quality,
    /// Its time is still to come.
    Future,
    /// Its time was that of an earlier pose.
    Repeated,
    /// Older than the IMU's history, or too late among newer poses.
    TooOld,
    /// Identical to many before it, while the IMU moved.
    Frozen,
    /// No IMU to compare it with.
    NoImu,
    /// Its position is not where the vehicle can be.
    Position,
    /// Its attitude is not the vehicle's.
    Attitude,
    /// Its velocity is not the vehicle's.
    Velocity,
    /// Poses agree among themselves, at another place.
    Jump,
    /// Poses agree among themselves, at another velocity.
    Drift,
    /// Poses agree among themselves, at another attitude.
    Turned,
    /// Poses and accelerometer do not agree on where up is.
    Gravity,
    /// The filter had lost its numbers, and begins anew.
    NotFinite,
}

impl Rejected {
    /// Every reason.
    pub const ALL: [Self; 14] = [
        Self::Quality,
        Self::Future,
        Self::Repeated,
        Self::TooOld,
        Self::Frozen,
        Self::NoImu,
        Self::Position,
        Self::Attitude,
        Self::Velocity,
        Self::Jump,
        Self::Drift,
        Self::Turned,
        Self::Gravity,
        Self::NotFinite,
    ];

    /// The reason in words.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::Quality => "Pose refused: its sender says tracking failed",
            Self::Future => "Pose refused: its time is still to come",
            Self::Repeated => "Pose refused: a pose of this time was here before",
            Self::TooOld => "Pose refused: too old",
            Self::Frozen => "Pose refused: frozen while the vehicle moves",
            Self::NoImu => "Pose refused: no IMU to compare it with",
            Self::Position => "Pose refused: position off",
            Self::Attitude => "Pose refused: attitude off",
            Self::Velocity => "Pose refused: velocity off",
            Self::Jump => "Pose refused: poses jumped to another place",
            Self::Drift => "Pose refused: poses drift against the IMU",
            Self::Turned => "Pose refused: poses turned against the gyro",
            Self::Gravity => "Pose refused: up is elsewhere for accelerometer",
            Self::NotFinite => "Pose refused: the estimate lost its numbers",
        }
    }
}

impl fmt::Display for Rejected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.text())
    }
}

/// What is wrong with the estimate, the worst first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Fault {
    /// There is none yet, or the IMU's data broke off.
    NotStarted,
    /// No IMU increment for [`super::EXTRAPOLATION_MAX`].
    ImuStale,
    /// No pose was fused for [`super::COASTING_AFTER`].
    NoPose,
    /// The estimate is too uncertain to be flown on.
    Uncertain,
    /// The gyro's bias is not plausible.
    GyroBias,
    /// The accelerometer's bias is not plausible, or up is elsewhere for the poses.
    AccelerometerBias,
    /// The poses are noisier than they are said to be.
    Inconsistent,
}

impl Fault {
    /// Every fault.
    pub const ALL: [Self; 7] = [
        Self::NotStarted,
        Self::ImuStale,
        Self::NoPose,
        Self::Uncertain,
        Self::GyroBias,
        Self::AccelerometerBias,
        Self::Inconsistent,
    ];

    /// The fault in words.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::NotStarted => "Estimator: not started, no consistent poses",
            Self::ImuStale => "Estimator: no IMU",
            Self::NoPose => "Estimator: no believable pose",
            Self::Uncertain => "Estimator: too uncertain",
            Self::GyroBias => "Estimator: gyro bias not plausible",
            Self::AccelerometerBias => "Estimator: accelerometer and poses disagree on up",
            Self::Inconsistent => "Estimator: poses noisier than they say",
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.text())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flight::reason::TEXT_MAX;

    #[test]
    fn every_reason_fits_a_status_text_and_says_something_of_its_own() {
        let texts = Rejected::ALL.map(Rejected::text).into_iter().chain(Fault::ALL.map(Fault::text));
        let texts = texts.chain(Taken::ALL.map(Taken::text));
        let mut seen: heapless::Vec<&str, 32> = heapless::Vec::new();
        for text in texts {
            assert!(text.len() <= TEXT_MAX, "{text}: {}", text.len());
            assert!(!seen.contains(&text), "{text}");
            seen.push(text).unwrap();
        }
    }
}
