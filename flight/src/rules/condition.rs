//! What a transition can depend on, as known in one tick.

estimation::listed! {
    /// One thing that may hold.
    pub enum Condition {
        /// An IMU sample has come.
        Started,
        /// There is nothing certified to fly with.
        Uncertified,
        /// Everything that arming needs is there.
        ChecksPass,
        /// Something of it is missing.
        ChecksFail,
        /// Arming was requested and granted.
        ArmingPermitted,
        /// A motor test was requested and granted.
        MotorTestPermitted,
        /// Anything was requested.
        Requested,
        /// The motor test has had its time.
        MotorTestOver,
        /// A disarm command was granted: on the ground any, in the air one with force.
        Disarmed,
        /// The kill switch is on.
        Killed,
        /// A take-off was requested and granted.
        TakeOffRequested,
        /// Flight by setpoints was requested and granted, and setpoints come.
        SetpointsRequested,
        /// Holding, here or at a point, was requested and granted.
        HoldRequested,
        /// Landing was requested and granted.
        LandRequested,
        /// Idling has lasted [`super::IDLING_MAX_US`].
        IdlingOver,
        /// The vehicle stands where it was armed, and holds, or has done what it does for [`super::IDLING_MAX_US`].
        HeldOnGround,
        /// The reference has come to rest at the height of the take-off.
        TakenOff,
        /// The vehicle stands on the ground though it is going down.
        Landed,
        /// The vehicle lies on its back or its side and does not move.
        Crashed,
        /// The IMU's last increment is older than [`super::IMU_AGE_MAX_US`], or the estimator has lost its state.
        ImuStale,
        /// No tick of the last [`super::REFUSAL_MAX_US`] brought new thrusts.
        ThrustsRefused,
        /// No pose has been believed for [`super::COASTING_MAX_US`], or the estimate is too uncertain.
        EstimateLost,
        /// The source of poses has been refused and found again too often in this flight.
        PosesGivenUp,
        /// A landing has lasted for longer than its height explains.
        LandingOver,
        /// Going down by the IMU alone, the vehicle's motion by the IMU contradicts the command: one of them is wrong.
        ImuDoubtful,
        /// Poses are believed again, and the governor has started from the estimate.
        PoseRegained,
        /// The same, of a vehicle that was landing when it lost them, or was commanded to land since.
        PoseRegainedToLand,
        /// Descending has lasted [`super::DESCENDING_MAX_US`].
        DescendingOver,
        /// The ground station has been silent for [`super::GROUND_STATION_TIMEOUT_US`].
        GroundStationSilent,
        /// It has been silent for as long as a vehicle holds before it lands.
        GroundStationGone,
        /// A setpoint that must be renewed was not.
        SetpointsLost,
        /// The battery has been low for [`super::BATTERY_DEBOUNCE_US`].
        BatteryLow,
        /// It has been critical for as long.
        BatteryCritical,
        /// The vehicle is outside the fence.
        FenceBreached,
        /// The vehicle has been too far from its reference for [`super::TRACKING_DEBOUNCE_US`], or was struck and
        /// thrown out of its place.
        TrackingLost,
        /// A rotor has failed, and the vehicle is where it may land.
        RotorLost,
        /// The rotors have not delivered the commanded wrench during [`super::SATURATION_DEBOUNCE_US`].
        Saturated,
        /// Control has been late for [`super::OVERRUN_DEBOUNCE_US`].
        Overrun,
    }
}

/// The conditions that hold in one tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Conditions(pub(super) u64);

impl Conditions {
    /// None of them.
    pub const NONE: Self = Self(0);

    /// These and, if `holds`, one more.
    #[must_use]
    pub const fn with(self, condition: Condition, holds: bool) -> Self {
        Self(self.0 | (holds as u64) << condition as u64)
    }

    /// Whether `condition` is one of them.
    #[must_use]
    pub const fn contain(self, condition: Condition) -> bool {
        self.0 >> condition as u64 & 1 == 1
    }
}
