//! Who commands: the station that armed the vehicle, while it is armed and heard.
//!
//! Nobody else may disarm it, not even by force; everything else anybody may ask for. A station that has been silent
//! for [`SILENCE`] commands no more: the next that speaks may stop the motors. So may anybody where a radio armed it.
//! Who armed is control's to say: many may have asked.

use super::command::Call;
use controller_core::flight::Stamped;
use mavlink::dialects::common::MavCmd;

/// How long a commanding station may be silent, us: as long as the flight rules wait for it.
pub const SILENCE: u64 = controller_core::flight::rules::GROUND_STATION_SILENCE_MAX;

/// Who armed the vehicle, if it was a station, and when, us; as [`crate::shared::Shared::commander`] has it.
type Armed = Option<Stamped<Option<u8>>>;

/// When the station that commands was last heard, us.
#[derive(Debug, Default)]
pub struct Commander(u64);

impl Commander {
    /// Hears a station at `now`, us.
    pub fn hear(&mut self, system: u8, armed: Armed, now: u64) {
        if armed.is_some_and(|armed| armed.value == Some(system)) {
            self.0 = now;
        }
    }

    /// Whether a station may have this command acted on at `now`, us, while the vehicle is armed.
    #[must_use]
    pub fn may(&self, call: &Call, system: u8, armed: Armed, now: u64) -> bool {
        let [first, ..] = call.parameters;
        let stops = call.command == MavCmd::MAV_CMD_COMPONENT_ARM_DISARM && first == 0.0;
        let other = armed.is_some_and(|Stamped { value, time }| {
            // What was heard of the one before it does not count.
            value.is_some_and(|commander| commander != system) && now.saturating_sub(self.0.max(time)) <= SILENCE
        });
        !(stops && other)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn call(first: f32) -> Call {
        let mut parameters = [0.0; 7];
        parameters[0] = first;
        Call { command: MavCmd::MAV_CMD_COMPONENT_ARM_DISARM, parameters, place: None }
    }

    #[test]
    fn only_who_armed_disarms_while_it_is_heard() {
        let mut commander = Commander::default();
        let armed = Some(Stamped { value: Some(255), time: 0 });
        assert!(!commander.may(&call(0.0), 254, armed, 1_000) && commander.may(&call(0.0), 255, armed, 1_000));
        commander.hear(255, armed, 2_000_000);
        commander.hear(254, armed, 2_000_001);
        assert!(!commander.may(&call(0.0), 254, armed, 2_000_000 + SILENCE));
        assert!(commander.may(&call(0.0), 254, armed, 2_000_001 + SILENCE));
        // Who armed it since has been heard by that.
        let later = Some(Stamped { value: Some(9), time: 9_000_000 });
        assert!(!commander.may(&call(0.0), 255, later, 9_000_000 + SILENCE));
    }

    #[test]
    fn anybody_may_ask_for_anything_else_and_disarm_what_no_station_armed() {
        let commander = Commander::default();
        let armed = Some(Stamped { value: Some(255), time: 0 });
        assert!(commander.may(&Call { command: MavCmd::MAV_CMD_NAV_LAND, ..call(0.0) }, 7, armed, 0));
        assert!(commander.may(&call(1.0), 7, armed, 0));
        for nobody in [None, Some(Stamped { value: None, time: 0 })] {
            assert!(commander.may(&call(0.0), 7, nobody, 0));
        }
    }
}
