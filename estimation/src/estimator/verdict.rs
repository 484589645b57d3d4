//! The verdict on a pose, and the faults of the estimate, in words that fit a MAVLink STATUSTEXT (50 characters).

worded! {
    /// What a pose was taken for.
    pub enum Accepted {
        /// Fused.
        Fused = "Poses: believed",
        /// Kept until the IMU's increments reach its time; then [`super::Health::last`] has the verdict.
        Waiting = "Poses: waiting for the IMU",
        /// One of the first: the estimate begins when enough of them agree.
        Aligning = "Poses: aligning",
        /// The estimate begins with it.
        Started = "Poses: the estimate begins",
        /// The sender reported a move of its frame: the estimate is in the new frame.
        Rebased = "Poses: the sender's frame has moved",
        /// The body was lost and is found again, no further away than coasting explains: the estimate was reset to it.
        Refound = "Poses: body found again, estimate reset to it",
    }
}

worded! {
    /// Why a pose was not believed.
    pub enum Rejected {
        /// The sender reports failed tracking.
        Quality = "Pose refused: its sender says tracking failed",
        /// Its time is in the future.
        Future = "Pose refused: its time is still to come",
        /// Its time was that of an earlier pose.
        Repeated = "Pose refused: a pose of this time was here before",
        /// Older than the IMU's history, or too late among newer poses.
        TooOld = "Pose refused: too old",
        /// Identical to many before it, while the IMU moved.
        Frozen = "Pose refused: frozen while the vehicle moves",
        /// No IMU to compare it with.
        NoImu = "Pose refused: no IMU to compare it with",
        /// Its position is not where the vehicle can be.
        Position = "Pose refused: position off",
        /// Its attitude is not the vehicle's.
        Attitude = "Pose refused: attitude off",
        /// Its velocity is not the vehicle's.
        Velocity = "Pose refused: velocity off",
        /// Poses agree among themselves, at another place.
        Jump = "Pose refused: poses jumped to another place",
        /// Poses agree among themselves, at another velocity.
        Drift = "Pose refused: poses drift against the IMU",
        /// Poses agree among themselves, at another attitude.
        Turned = "Pose refused: poses turned against the gyro",
        /// Poses and accelerometer do not agree on where up is.
        Gravity = "Pose refused: up is elsewhere for accelerometer",
        /// Its source has been refused too often in this flight.
        GivenUp = "Pose refused: its source is given up",
        /// The filter had become non-finite, and begins anew.
        NotFinite = "Pose refused: the estimate lost its numbers",
    }
}

impl Accepted {
    /// Whether it agrees with the estimate, or the estimate with it: not one that waits for more, nor one that moves
    /// the frame, which agrees with nothing yet.
    pub const fn is_believed(self) -> bool {
        match self {
            Self::Fused | Self::Started | Self::Refound => true,
            Self::Waiting | Self::Aligning | Self::Rebased => false,
        }
    }
}

impl Rejected {
    /// Whether it was refused for its values: not for its time or quality, nor for want of an estimate.
    pub const fn is_lie(self) -> bool {
        match self {
            Self::Frozen
            | Self::Position
            | Self::Attitude
            | Self::Velocity
            | Self::Jump
            | Self::Drift
            | Self::Turned
            | Self::Gravity => true,
            Self::Quality
            | Self::Future
            | Self::Repeated
            | Self::TooOld
            | Self::NoImu
            | Self::GivenUp
            | Self::NotFinite => false,
        }
    }
}

worded! {
    /// The faults of the estimate, the worst first.
    #[derive(PartialOrd, Ord)]
    pub enum Fault {
        /// There is no estimate yet, or the IMU's data broke off.
        NotStarted = "Estimator: not started, no consistent poses",
        /// No IMU increment for [`super::EXTRAPOLATION_MAX_US`].
        ImuStale = "Estimator: no IMU",
        /// No pose was fused for [`super::COASTING_AFTER_US`].
        NoPose = "Estimator: no believable pose",
        /// The estimate is too uncertain to be flown on.
        Uncertain = "Estimator: too uncertain",
        /// The gyro's bias is not plausible.
        GyroBias = "Estimator: gyro bias not plausible",
        /// The accelerometer's bias is not plausible, or poses and accelerometer disagree on up.
        AccelerometerBias = "Estimator: accelerometer and poses disagree on up",
        /// The poses are noisier than their covariance.
        Inconsistent = "Estimator: poses noisier than they say",
    }
}
