//! What a board hands to its tasks.

use super::cause::Cause;
use super::light::Lamp;
use super::link::{RadioReceiver, Receiver, SimulatorReceiver, SimulatorTransmitter, Transmitter};
use super::storage::ParameterFlash;
use super::usb::Controller;
use super::watchdog::ChipWatchdog;

/// Everything on the board, each part ready for the task that will own it.
pub struct Board<Imu, Motors, Battery, Card, PacketRadio> {
    /// The inertial sensors, each powered up at its first sample.
    pub imu: Imu,
    /// The motors, silent.
    pub motors: Motors,
    /// The watchdog, not started.
    pub watchdog: ChipWatchdog,
    /// The battery.
    pub battery: Battery,
    /// The light, off.
    pub light: Lamp,
    /// What the link receives.
    pub receiver: Receiver,
    /// What the link sends.
    pub transmitter: Transmitter,
    /// The USB port, where it has its supply.
    pub usb: Option<Controller>,
    /// What a simulator sends.
    pub simulator_receiver: SimulatorReceiver,
    /// What a simulator receives.
    pub simulator_transmitter: SimulatorTransmitter,
    /// Bytes from a radio's receiver, where the board has a line for it.
    pub radio: Option<RadioReceiver>,
    /// The chip that carries packets over the radio, where the board has one.
    pub packet_radio: Option<PacketRadio>,
    /// The slot for a memory card, where the board has one.
    pub card: Option<Card>,
    /// Where parameters live.
    pub storage: ParameterFlash,
    /// Whether its clock is the crystal's; else it is the chip's own, exact to a hundredth or so.
    pub has_crystal: bool,
    /// Why the chip started.
    pub restart: Cause,
}
