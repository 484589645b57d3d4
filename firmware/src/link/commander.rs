//! Who commands: the station that armed the vehicle, a system and a component, while it is armed and received.
//!
//! No other station may disarm it, not even by force; every station may request everything else. Where no ground
//! station armed it but a companion computer, a ground station may as well: the operator overrides a program. A station
//! that has been silent for [`COMMANDER_TIMEOUT_US`] commands no more: any other may then stop the motors, as any
//! station may where a radio armed it. Control decides who armed, since many may have asked. A heartbeat shows who is a
//! ground station.

use super::command::Call;
use flight::Stamped;
use heapless::Deque;
use mavlink::dialects::common::MavCmd;

/// How long a commanding station may be silent: as long as the flight rules wait for it.
pub const COMMANDER_TIMEOUT_US: u64 = flight::rules::GROUND_STATION_TIMEOUT_US;

/// Ground stations that are remembered, the last.
const STATIONS_REMEMBERED: usize = 4;

/// Who sent something: system and component.
type Sender = (u8, u8);

/// Who armed the vehicle, if it was a station, and when, us; as [`crate::shared::Values::commander`] has it.
type Armed = Option<Stamped<Option<Sender>>>;

/// When the commanding station was last received, us, and which stations are ground stations.
#[derive(Debug, Default)]
pub struct Commander {
    received: u64,
    stations: Deque<Sender, STATIONS_REMEMBERED>,
}

impl Commander {
    /// Notes a frame of a station at `now`, us; whether it is the commanding one.
    pub fn receive(&mut self, sender: Sender, armed: Armed, now: u64) -> bool {
        let commands = armed.is_some_and(|armed| armed.value == Some(sender));
        if commands {
            self.received = now;
        }
        commands
    }

    /// Notes a ground station's heartbeat.
    pub fn add_ground_station(&mut self, station: Sender) {
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
    pub fn may_command(&self, call: &Call, sender: Sender, armed: Armed, now: u64) -> bool {
        let [first, ..] = call.parameters;
        let stops = call.command == MavCmd::MAV_CMD_COMPONENT_ARM_DISARM && first == 0.0;
        let other = armed.is_some_and(|Stamped { value, time }| {
            let yields = |commander| self.is_ground_station(sender) && !self.is_ground_station(commander);
            // Frames of the commander before it do not count.
            value.is_some_and(|commander| commander != sender && !yields(commander))
                && now.saturating_sub(self.received.max(time)) <= COMMANDER_TIMEOUT_US
        });
        !(stops && other)
    }
}

#[cfg(test)]
mod tests;
