//! Who commands: the station that armed the vehicle, a system and a component, while it is armed and heard.
//!
//! No other station may disarm it, not even by force; every station may request everything else. Where no ground
//! station armed it but a companion computer, a ground station may as well: the operator's word goes before a
//! program's. A station that has been silent for [`SILENCE`] commands no more: the next that speaks may stop the
//! motors. So may anybody where a radio armed it. Who armed is control's to say: many may have asked. Who is a ground
//! station its heartbeat says.

use super::command::Call;
use flight::Stamped;
use heapless::Deque;
use mavlink::dialects::common::MavCmd;

/// How long a commanding station may be silent, us: as long as the flight rules wait for it.
pub const SILENCE: u64 = flight::rules::GROUND_STATION_SILENCE_MAX;

/// Ground stations that are remembered, the last.
const STATIONS: usize = 4;

/// Who sent something: system and component.
type Sender = (u8, u8);

/// Who armed the vehicle, if it was a station, and when, us; as [`crate::shared::Values::commander`] has it.
type Armed = Option<Stamped<Option<Sender>>>;

/// When the station that commands was last heard, us, and who is a ground station.
#[derive(Debug, Default)]
pub struct Commander {
    heard: u64,
    stations: Deque<Sender, STATIONS>,
}

impl Commander {
    /// Hears a station at `now`, us.
    pub fn hear(&mut self, sender: Sender, armed: Armed, now: u64) {
        if armed.is_some_and(|armed| armed.value == Some(sender)) {
            self.heard = now;
        }
    }

    /// Hears a ground station's heartbeat.
    pub fn meet(&mut self, station: Sender) {
        if self.is_ground_station(station) {
            return;
        }
        if self.stations.is_full() {
            self.stations.pop_front();
        }
        // There is room for it now.
        let _ = self.stations.push_back(station);
    }

    fn is_ground_station(&self, sender: Sender) -> bool {
        self.stations.iter().any(|station| *station == sender)
    }

    /// Whether a station may have this command acted on at `now`, us, while the vehicle is armed.
    #[must_use]
    pub fn may(&self, call: &Call, sender: Sender, armed: Armed, now: u64) -> bool {
        let [first, ..] = call.parameters;
        let stops = call.command == MavCmd::MAV_CMD_COMPONENT_ARM_DISARM && first == 0.0;
        let other = armed.is_some_and(|Stamped { value, time }| {
            let yields = |commander| self.is_ground_station(sender) && !self.is_ground_station(commander);
            // What was heard of the one before it does not count.
            value.is_some_and(|commander| commander != sender && !yields(commander))
                && now.saturating_sub(self.heard.max(time)) <= SILENCE
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
        let armed = Some(Stamped { value: Some((255, 1)), time: 0 });
        assert!(
            !commander.may(&call(0.0), (254, 1), armed, 1_000) && commander.may(&call(0.0), (255, 1), armed, 1_000)
        );
        commander.hear((255, 1), armed, 2_000_000);
        commander.hear((254, 1), armed, 2_000_001);
        assert!(!commander.may(&call(0.0), (254, 1), armed, 2_000_000 + SILENCE));
        assert!(commander.may(&call(0.0), (254, 1), armed, 2_000_001 + SILENCE));
        // Who armed it since has been heard by that.
        let later = Some(Stamped { value: Some((9, 1)), time: 9_000_000 });
        assert!(!commander.may(&call(0.0), (255, 1), later, 9_000_000 + SILENCE));
    }

    #[test]
    fn anybody_may_ask_for_anything_else_and_disarm_what_no_station_armed() {
        let commander = Commander::default();
        let armed = Some(Stamped { value: Some((255, 1)), time: 0 });
        assert!(commander.may(&Call { command: MavCmd::MAV_CMD_NAV_LAND, ..call(0.0) }, (7, 1), armed, 0));
        assert!(commander.may(&call(1.0), (7, 1), armed, 0));
        for nobody in [None, Some(Stamped { value: None, time: 0 })] {
            assert!(commander.may(&call(0.0), (7, 1), nobody, 0));
        }
    }
}
