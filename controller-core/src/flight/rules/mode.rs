//! The supervisor's modes.

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
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Mode {
    /// Motors stopped; no IMU has been heard.
    Boot,
    /// Motors stopped; something that arming needs is missing.
    Checks,
    /// Motors stopped; an arm command would be granted.
    Ready,
    /// Motors stopped but for one, turning slowly.
    MotorTest,
    /// Armed: every motor turns slowly.
    Idling,
    /// Going up to the height of the take-off.
    TakingOff,
    /// Setpoints are flown.
    Flying,
    /// The reference is brought to rest, or flies to a point that was named, and is held there.
    Holding,
    /// Going down, until the ground is found.
    Landing,
    /// Without a pose: level, then going down by the IMU alone, until the ground is found.
    Descending,
    /// Motors stopped in the air or after a crash; until a disarm command says that somebody has looked.
    Stopped,
    /// Nothing to fly with that is certified; for ever.
    Locked,
}

impl Mode {
    /// Every mode.
    pub const ALL: [Self; 12] = [
        Self::Boot,
        Self::Checks,
        Self::Ready,
        Self::MotorTest,
        Self::Idling,
        Self::TakingOff,
        Self::Flying,
        Self::Holding,
        Self::Landing,
        Self::Descending,
        Self::Stopped,
        Self::Locked,
    ];

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

    /// The mode in one or two words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Boot => "boot",
            Self::Checks => "checks",
            Self::Ready => "ready",
            Self::MotorTest => "motor test",
            Self::Idling => "idling",
            Self::TakingOff => "taking off",
            Self::Flying => "flying",
            Self::Holding => "holding",
            Self::Landing => "landing",
            Self::Descending => "descending",
            Self::Stopped => "stopped",
            Self::Locked => "locked",
        }
    }
}
