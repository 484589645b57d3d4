//! Reasons in words, for every transition: a table.
//!
//! Each fits the 50 characters of a MAVLink STATUSTEXT.

/// The length of a STATUSTEXT, characters.
pub const TEXT_MAX: usize = 50;

estimation::worded! {
    /// Why the mode changed.
    pub enum Reason {
        /// The IMU's first sample came.
        Started = "Boot over: checking",
        /// The configuration is not certified.
        NotCertified = "Locked: not certified to fly",
        /// Everything that arming needs is there.
        Ready = "Ready to arm",
        /// Something of it is missing again.
        NotReady = "No longer ready to arm",
        /// Arming was requested and granted.
        Armed = "Armed: idling",
        /// A disarm command was granted.
        Disarmed = "Disarmed by command",
        /// The kill switch is on.
        Killed = "Stopped: kill switch",
        /// A motor test was requested and granted.
        MotorTestRequested = "Motor test begins",
        /// Another request arrived during a motor test.
        MotorTestInterrupted = "Motor test stopped by another request",
        /// The motor test has had its time.
        MotorTestOver = "Motor test over",
        /// No flight was requested for [`super::rules::IDLING_MAX_US`].
        IdlingOver = "Disarmed: nothing commanded for 10 s",
        /// A take-off was requested and granted.
        TakeOffCommanded = "Taking off",
        /// The take-off has reached its height.
        TakenOff = "Take-off over: holding position",
        /// Flight by setpoints was requested and granted.
        SetpointsCommanded = "Flying setpoints",
        /// Holding was requested and granted.
        HoldCommanded = "Holding position by command",
        /// It stands where it was armed, and holds, or flies setpoints that lift nothing.
        HeldOnGround = "Landing: nothing lifts it off the ground",
        /// Landing was requested and granted.
        LandCommanded = "Landing by command",
        /// The vehicle stands on the ground.
        Landed = "Landed: disarmed",
        /// The vehicle lies on its back or its side.
        Crashed = "Stopped: lying on its back or side",
        /// No IMU increment for [`super::rules::IMU_AGE_MAX_US`], or the estimator lost its state.
        ImuLost = "Stopped: no IMU for 20 ms, or its data broke off",
        /// The law or the allocation refused its input for [`super::rules::REFUSAL_MAX_US`].
        ThrustsRefused = "Stopped: the law refused its input for 50 ms",
        /// No pose was believed for [`super::rules::COASTING_MAX_US`] in flight, or the estimate became too uncertain.
        PoseLost = "Pose lost: levelling for 1 s, then going down",
        /// The source of poses has been refused and found again too often in this flight.
        PosesGivenUp = "Poses given up: going down by the IMU",
        /// A landing has lasted for longer than its height explains.
        LandingOver = "Landing takes too long: going down by the IMU",
        /// The same as [`Self::PoseLost`], while idling.
        PoseLostOnGround = "Disarmed: pose lost",
        /// Going down by the IMU alone, it does not fit what is commanded.
        ImuDoubtful = "Stopped: IMU does not fit what was commanded",
        /// Poses are believed again.
        PoseRegained = "Pose regained: braking to hold position",
        /// The same, of a vehicle that was landing or was commanded to land.
        LandingResumed = "Pose regained: landing",
        /// Neither pose nor ground were found in [`super::rules::DESCENDING_MAX_US`].
        DescendingOver = "Stopped: neither pose nor ground found in 30 s",
        /// The ground station was silent for [`super::rules::GROUND_STATION_TIMEOUT_US`].
        GroundStationLost = "Ground station lost: holding position",
        /// The same, while idling.
        GroundStationLostOnGround = "Disarmed: ground station lost",
        /// The ground station stayed silent while the vehicle held.
        GroundStationGone = "Ground station still lost: landing",
        /// A setpoint that must be renewed was not.
        SetpointsLost = "Setpoints lost: holding position",
        /// The battery is low.
        BatteryLow = "Battery low: landing",
        /// The battery is critical.
        BatteryCritical = "Battery critical: landing",
        /// The vehicle is outside the fence.
        FenceBreached = "Outside the fence: landing",
        /// The vehicle does not follow its reference.
        TrackingLost = "Far from where it should be: landing",
        /// A rotor has failed.
        RotorLost = "Rotor lost: landing here, turning",
        /// The rotors do not deliver the commanded wrench.
        Saturated = "Rotors at their limits for 1 s: landing",
        /// Control is late.
        Overrun = "Control late for 100 ms: landing",
    }
}

impl Reason {
    /// Whether the vehicle acts on its own because something is wrong.
    #[must_use]
    pub const fn is_own_doing(self) -> bool {
        !matches!(
            self,
            Self::Started
                | Self::Ready
                | Self::NotReady
                | Self::Armed
                | Self::Disarmed
                | Self::MotorTestRequested
                | Self::MotorTestInterrupted
                | Self::MotorTestOver
                | Self::IdlingOver
                | Self::TakeOffCommanded
                | Self::TakenOff
                | Self::SetpointsCommanded
                | Self::HoldCommanded
                | Self::HeldOnGround
                | Self::LandCommanded
                | Self::Landed
                | Self::PoseRegained
                | Self::LandingResumed
        )
    }
}
