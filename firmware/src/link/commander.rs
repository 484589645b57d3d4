//! Who commands: the station that armed the vehicle, while it is armed and heard.
//!
//! Nobody else may disarm it, not even by force; everything else anybody may ask for. A station that has been silent for
//! [`SILENCE`] commands no more: the next that speaks may stop the motors.

use super::command::Call;
use mavlink::dialects::common::MavCmd;

/// How long a commanding station may be silent, us: as long as the flight rules wait for it.
pub const SILENCE: u64 = controller_core::flight::rules::GROUND_STATION_SILENCE_MAX;

/// The station that armed the vehicle, and when it was last heard, us.
#[derive(Debug, Default)]
pub struct Commander(Option<(u8, u64)>);

impl Commander {
    /// Hears a station at `now`, us.
    pub fn hear(&mut self, system: u8, now: u64) {
        if let Some((commander, heard)) = &mut self.0
            && *commander == system
        {
            *heard = now;
        }
    }

    /// Whether a station may have this command acted on at `now`, us, while the vehicle is armed or not. Who arms, commands.
    pub fn may(&mut self, call: &Call, system: u8, armed: bool, now: u64) -> bool {
        if call.command != MavCmd::MAV_CMD_COMPONENT_ARM_DISARM {
            return true;
        }
        let [first, ..] = call.parameters;
        let others =
            self.0.is_some_and(|(commander, heard)| commander != system && now.saturating_sub(heard) <= SILENCE);
        if first == 1.0 && !armed {
            self.0 = Some((system, now));
        }
        first != 0.0 || !armed || !others
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
        assert!(commander.may(&call(0.0), 9, true, 0), "nobody commands yet");
        assert!(commander.may(&call(1.0), 255, false, 0));
        assert!(!commander.may(&call(0.0), 254, true, 1_000) && commander.may(&call(0.0), 255, true, 1_000));
        // An arm command of somebody else, while it is armed, changes nothing.
        assert!(commander.may(&call(1.0), 254, true, 2_000) && !commander.may(&call(0.0), 254, true, 3_000));
        commander.hear(255, 2_000_000);
        assert!(!commander.may(&call(0.0), 254, true, 2_000_000 + SILENCE));
        assert!(commander.may(&call(0.0), 254, true, 2_000_001 + SILENCE));
        assert!(commander.may(&call(0.0), 254, false, 2_000_000), "nothing to stop");
    }

    #[test]
    fn anybody_may_ask_for_anything_else() {
        let mut commander = Commander::default();
        commander.may(&call(1.0), 255, false, 0);
        assert!(commander.may(&Call { command: MavCmd::MAV_CMD_NAV_LAND, ..call(0.0) }, 7, true, 0));
    }
}
