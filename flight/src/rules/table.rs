//! The table: in this mode, if this holds, go there, for this reason.

use super::{Condition, Mode};
use crate::reason::Reason;

/// One row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Row {
    /// The mode it applies in.
    pub from: Mode,
    /// What takes it.
    pub condition: Condition,
    /// The mode it leads to; the same one for a row that only forbids those below it.
    pub to: Mode,
    /// Why, in words.
    pub reason: Reason,
}

const fn row(from: Mode, condition: Condition, to: Mode, reason: Reason) -> Row {
    Row { from, condition, to, reason }
}

/// The rules. Within a mode, an upper row goes before a lower one.
#[rustfmt::skip]
pub const TABLE: [Row; 109] = {
    use Condition::*;
    use Mode::*;
    [
        //  in          if                   go to       because
        row(Boot,       Uncertified,         Locked,     Reason::NotCertified),
        row(Boot,       Started,             Checks,     Reason::Started),

        row(Locked,     MotorTestPermitted,  MotorTest,  Reason::MotorTestRequested),

        row(Checks,     Uncertified,         Locked,     Reason::NotCertified),
        row(Checks,     Killed,              Checks,     Reason::Killed),
        row(Checks,     Disarmed,            Checks,     Reason::Disarmed),
        row(Checks,     ArmingPermitted,     Idling,     Reason::Armed),
        row(Checks,     MotorTestPermitted,  MotorTest,  Reason::MotorTestRequested),
        row(Checks,     ChecksPass,          Ready,      Reason::Ready),

        row(Ready,      Killed,              Checks,     Reason::Killed),
        row(Ready,      Disarmed,            Ready,      Reason::Disarmed),
        row(Ready,      ArmingPermitted,     Idling,     Reason::Armed),
        row(Ready,      MotorTestPermitted,  MotorTest,  Reason::MotorTestRequested),
        row(Ready,      ChecksFail,          Checks,     Reason::NotReady),

        row(MotorTest,  Killed,              Checks,     Reason::Killed),
        row(MotorTest,  Disarmed,            Checks,     Reason::Disarmed),
        row(MotorTest,  Requested,           Checks,     Reason::MotorTestInterrupted),
        row(MotorTest,  MotorTestOver,       Checks,     Reason::MotorTestOver),

        row(Idling,     Killed,              Stopped,    Reason::Killed),
        row(Idling,     Disarmed,            Checks,     Reason::Disarmed),
        row(Idling,     Crashed,             Stopped,    Reason::Crashed),
        row(Idling,     ImuStale,            Checks,     Reason::ImuLost),
        row(Idling,     EstimateLost,        Checks,     Reason::PoseLostOnGround),
        row(Idling,     GroundStationSilent, Checks,     Reason::GroundStationLostOnGround),
        row(Idling,     BatteryCritical,     Checks,     Reason::BatteryCritical),
        row(Idling,     BatteryLow,          Checks,     Reason::BatteryLow),
        row(Idling,     Overrun,             Checks,     Reason::Overrun),
        row(Idling,     LandRequested,       Checks,     Reason::Landed),
        row(Idling,     TakeOffRequested,    TakingOff,  Reason::TakeOffCommanded),
        row(Idling,     SetpointsRequested,  Flying,     Reason::SetpointsCommanded),
        row(Idling,     IdlingOver,          Checks,     Reason::IdlingOver),

        row(TakingOff,  Killed,              Stopped,    Reason::Killed),
        row(TakingOff,  Disarmed,            Checks,     Reason::Disarmed),
        row(TakingOff,  Crashed,             Stopped,    Reason::Crashed),
        row(TakingOff,  ImuStale,            Stopped,    Reason::ImuLost),
        row(TakingOff,  ThrustsRefused,      Stopped,    Reason::ThrustsRefused),
        row(TakingOff,  PosesGivenUp,        Descending, Reason::PosesGivenUp),
        row(TakingOff,  EstimateLost,        Descending, Reason::PoseLost),
        row(TakingOff,  RotorLost,           Landing,    Reason::RotorLost),
        row(TakingOff,  BatteryCritical,     Landing,    Reason::BatteryCritical),
        row(TakingOff,  BatteryLow,          Landing,    Reason::BatteryLow),
        row(TakingOff,  FenceBreached,       Landing,    Reason::FenceBreached),
        row(TakingOff,  TrackingLost,        Landing,    Reason::TrackingLost),
        row(TakingOff,  Saturated,           Landing,    Reason::Saturated),
        row(TakingOff,  Overrun,             Landing,    Reason::Overrun),
        row(TakingOff,  LandRequested,       Landing,    Reason::LandCommanded),
        row(TakingOff,  HoldRequested,       Holding,    Reason::HoldCommanded),
        row(TakingOff,  SetpointsRequested,  Flying,     Reason::SetpointsCommanded),
        row(TakingOff,  GroundStationSilent, Holding,    Reason::GroundStationLost),
        row(TakingOff,  TakenOff,            Holding,    Reason::TakenOff),

        row(Flying,     Killed,              Stopped,    Reason::Killed),
        row(Flying,     Disarmed,            Checks,     Reason::Disarmed),
        row(Flying,     Crashed,             Stopped,    Reason::Crashed),
        row(Flying,     ImuStale,            Stopped,    Reason::ImuLost),
        row(Flying,     ThrustsRefused,      Stopped,    Reason::ThrustsRefused),
        row(Flying,     PosesGivenUp,        Descending, Reason::PosesGivenUp),
        row(Flying,     EstimateLost,        Descending, Reason::PoseLost),
        row(Flying,     RotorLost,           Landing,    Reason::RotorLost),
        row(Flying,     BatteryCritical,     Landing,    Reason::BatteryCritical),
        row(Flying,     BatteryLow,          Landing,    Reason::BatteryLow),
        row(Flying,     FenceBreached,       Landing,    Reason::FenceBreached),
        row(Flying,     TrackingLost,        Landing,    Reason::TrackingLost),
        row(Flying,     Saturated,           Landing,    Reason::Saturated),
        row(Flying,     Overrun,             Landing,    Reason::Overrun),
        row(Flying,     HeldOnGround,        Landing,    Reason::HeldOnGround),
        row(Flying,     LandRequested,       Landing,    Reason::LandCommanded),
        row(Flying,     HoldRequested,       Holding,    Reason::HoldCommanded),
        row(Flying,     GroundStationSilent, Holding,    Reason::GroundStationLost),
        row(Flying,     SetpointsLost,       Holding,    Reason::SetpointsLost),

        row(Holding,    Killed,              Stopped,    Reason::Killed),
        row(Holding,    Disarmed,            Checks,     Reason::Disarmed),
        row(Holding,    Crashed,             Stopped,    Reason::Crashed),
        row(Holding,    ImuStale,            Stopped,    Reason::ImuLost),
        row(Holding,    ThrustsRefused,      Stopped,    Reason::ThrustsRefused),
        row(Holding,    PosesGivenUp,        Descending, Reason::PosesGivenUp),
        row(Holding,    EstimateLost,        Descending, Reason::PoseLost),
        row(Holding,    RotorLost,           Landing,    Reason::RotorLost),
        row(Holding,    BatteryCritical,     Landing,    Reason::BatteryCritical),
        row(Holding,    BatteryLow,          Landing,    Reason::BatteryLow),
        row(Holding,    FenceBreached,       Landing,    Reason::FenceBreached),
        row(Holding,    TrackingLost,        Landing,    Reason::TrackingLost),
        row(Holding,    Saturated,           Landing,    Reason::Saturated),
        row(Holding,    Overrun,             Landing,    Reason::Overrun),
        row(Holding,    HeldOnGround,        Landing,    Reason::HeldOnGround),
        row(Holding,    LandRequested,       Landing,    Reason::LandCommanded),
        row(Holding,    GroundStationGone,   Landing,    Reason::GroundStationGone),
        row(Holding,    SetpointsRequested,  Flying,     Reason::SetpointsCommanded),

        row(Landing,    Killed,              Stopped,    Reason::Killed),
        row(Landing,    Disarmed,            Checks,     Reason::Disarmed),
        row(Landing,    Landed,              Checks,     Reason::Landed),
        row(Landing,    Crashed,             Stopped,    Reason::Crashed),
        row(Landing,    ImuStale,            Stopped,    Reason::ImuLost),
        row(Landing,    ThrustsRefused,      Stopped,    Reason::ThrustsRefused),
        row(Landing,    PosesGivenUp,        Descending, Reason::PosesGivenUp),
        row(Landing,    LandingOver,         Descending, Reason::LandingOver),
        row(Landing,    EstimateLost,        Descending, Reason::PoseLost),
        row(Landing,    HoldRequested,       Holding,    Reason::HoldCommanded),

        row(Descending, Killed,              Stopped,    Reason::Killed),
        row(Descending, Disarmed,            Checks,     Reason::Disarmed),
        row(Descending, Landed,              Checks,     Reason::Landed),
        row(Descending, Crashed,             Stopped,    Reason::Crashed),
        row(Descending, ImuStale,            Stopped,    Reason::ImuLost),
        row(Descending, ThrustsRefused,      Stopped,    Reason::ThrustsRefused),
        row(Descending, ImuDoubtful,         Stopped,    Reason::ImuDoubtful),
        row(Descending, PoseRegained,        Holding,    Reason::PoseRegained),
        row(Descending, PoseRegainedToLand,  Landing,    Reason::LandingResumed),
        row(Descending, DescendingOver,      Stopped,    Reason::DescendingOver),

        row(Stopped,    Killed,              Stopped,    Reason::Killed),
        row(Stopped,    Disarmed,            Checks,     Reason::Disarmed),
    ]
};
