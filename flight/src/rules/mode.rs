//! The supervisor's modes.

estimation::worded! {
    /// What the vehicle is doing.
    ///
    /// ```text
    ///            +------+  started   +--------+  all is well   +-------+
    ///            | Boot | ---------> |        | -------------> |       |
    ///            +------+            | Checks |                | Ready |
    ///                |               |        | <------------- |       |
    ///  not certified |               +--------+  something is  +-------+
    ///                v                ^  ^  ^       missing        | arm
    ///            +--------+           |  |  |                      v
    ///            | Locked |   disarm  |  |  | disarm, nothing  +--------+
    ///            +--------+           |  |  | commanded        | Idling |
    ///                                 |  |  +----------------- +--------+
    ///  +-----------+    motor test    |  |                         | take off, or fly setpoints
    ///  | MotorTest | <----------------+  | landed                  v
    ///  +-----------+          |          |           +---------------------------+
    ///            +---------+  |          +-----------| TakingOff, Flying,        |
    ///            | Stopped | -+                      | Holding, Landing:         |
    ///            +---------+                         | the law on the estimate   |
    ///                 ^                              +---------------------------+
    ///                 | crashed, killed,                  | pose lost     ^ pose regained
    ///                 | no IMU, thrusts refused           v               |
    ///                 |                              +---------------------------+
    ///                 +----------------------------- | Descending: level, by IMU |
    ///                                                +---------------------------+
    /// ```
    pub enum Mode {
        /// Motors stopped; no IMU sample has come.
        Boot = "boot",
        /// Motors stopped; something that arming needs is missing.
        Checks = "checks",
        /// Motors stopped; an arm command would be granted.
        Ready = "ready",
        /// Motors stopped but for one, turning slowly.
        MotorTest = "motor test",
        /// Armed: every motor turns slowly.
        Idling = "idling",
        /// Going up to the height of the take-off.
        TakingOff = "taking off",
        /// Setpoints are flown.
        Flying = "flying",
        /// The reference is brought to rest, or flies to a point that was named, and is held there.
        Holding = "holding",
        /// Going down, until the ground is found.
        Landing = "landing",
        /// Without a pose: level, then going down by the IMU alone, until the ground is found.
        Descending = "descending",
        /// Motors stopped in the air or after a crash, until a disarm command confirms an inspection.
        Stopped = "stopped",
        /// Nothing to fly with that is certified; for ever.
        Locked = "locked",
    }
}

impl Mode {
    /// Whether the motors turn, or may within a tick, because the vehicle is armed.
    #[must_use]
    pub fn is_armed(self) -> bool {
        self == Self::Idling || self.flies()
    }

    /// Whether no motor turns and an arm command may be granted.
    #[must_use]
    pub fn may_arm(self) -> bool {
        matches!(self, Self::Boot | Self::Checks | Self::Ready | Self::Locked)
    }

    /// Whether the law drives the motors.
    #[must_use]
    pub fn flies(self) -> bool {
        self == Self::Descending || self.is_guided()
    }

    /// Whether the law flies a reference of the governor's.
    #[must_use]
    pub fn is_guided(self) -> bool {
        matches!(self, Self::TakingOff | Self::Flying | Self::Holding | Self::Landing)
    }
}
