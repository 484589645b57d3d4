//! The USB port as a serial line (CDC-ACM) for the link, on PA11 and PA12.
//!
//! Without a host the port costs nothing: its pull-up waits, and no interrupt comes. What a program on the host may do
//! to it is bounded: who reads nothing holds up a frame for as long as the link allows, and who writes too much waits
//! for the host's next try, not for us.
//!
//! The driver's own task waits for the host without end, as an interrupt does; nothing waits for that task.

use crate::hardware::Port;
use core::sync::atomic::{AtomicBool, Ordering};
use embassy_stm32::peripherals::USB_OTG_FS;
use embassy_stm32::usb::{self, Driver};
use embassy_usb::class::cdc_acm::{CdcAcmClass, ControlChanged, Receiver, Sender, State};
use embassy_usb::{Builder, Config, Handler, UsbDevice};
use embedded_io_async::{ErrorKind, ErrorType, Read, Write};
use static_cell::{ConstStaticCell, StaticCell};

/// Bytes of a packet at full speed.
const PACKET_BYTES: usize = 64;

/// pid.codes' numbers for trying things out: this firmware has none of its own.
const VENDOR_ID: u16 = 0x1209;
/// See [`VENDOR_ID`].
const PRODUCT_ID: u16 = 0x0001;

/// The chip's side of the port.
pub type Controller = Driver<'static, USB_OTG_FS>;

/// The port's parts, each for a task of its own.
pub struct Usb {
    /// What answers the host.
    pub device: Device,
    /// What the link receives.
    pub receiver: PortReceiver,
    /// What the link sends.
    pub transmitter: PortTransmitter,
    /// Whether a program has it open.
    pub port: UsbPort,
}

/// What answers the host, for ever: its `run`.
pub type Device = UsbDevice<'static, Controller>;

/// How the driver is set up: no pin senses the host's voltage.
pub fn config() -> usb::Config {
    let mut config = usb::Config::default();
    config.vbus_detection = false;
    config
}

/// Where the driver puts packets that arrive. Once.
pub fn packets() -> &'static mut [u8] {
    // The control endpoint's and the line's own.
    static PACKETS: ConstStaticCell<[u8; 2 * PACKET_BYTES]> = ConstStaticCell::new([0; _]);
    PACKETS.take()
}

impl Usb {
    /// A port on this driver, by the name of its board. Once.
    pub fn new(driver: Controller, name: &'static str) -> Self {
        static CONFIGURATION: ConstStaticCell<[u8; 128]> = ConstStaticCell::new([0; _]);
        static OBJECTS: ConstStaticCell<[u8; 32]> = ConstStaticCell::new([0; _]);
        static CONTROL: ConstStaticCell<[u8; PACKET_BYTES]> = ConstStaticCell::new([0; _]);
        static STATE: StaticCell<State<'static>> = StaticCell::new();
        static WATCHER: ConstStaticCell<Watcher> = ConstStaticCell::new(Watcher);
        let mut config = Config::new(VENDOR_ID, PRODUCT_ID);
        config.product = Some(name);
        config.serial_number = Some(embassy_stm32::uid::uid_hex());
        let mut builder = Builder::new(driver, config, CONFIGURATION.take(), OBJECTS.take(), &mut [], CONTROL.take());
        builder.handler(WATCHER.take());
        let class = CdcAcmClass::new(&mut builder, STATE.init_with(State::new), PACKET_BYTES as u16);
        let (sender, receiver, control) = class.split_with_control();
        Self {
            device: builder.build(),
            receiver: PortReceiver { receiver, packet: [0; PACKET_BYTES], unread: 0..0 },
            transmitter: PortTransmitter(sender),
            port: UsbPort(control),
        }
    }
}

/// Whether the host has gone to sleep, or gone: both look the same.
static IS_ASLEEP: AtomicBool = AtomicBool::new(true);

/// Follows the host's state.
struct Watcher;

impl Handler for Watcher {
    fn configured(&mut self, configured: bool) {
        IS_ASLEEP.store(!configured, Ordering::Relaxed);
    }

    fn suspended(&mut self, suspended: bool) {
        IS_ASLEEP.store(suspended, Ordering::Relaxed);
    }
}

/// Whether a program has the port open: it sets DTR, as every one does that opens a serial port.
pub struct UsbPort(ControlChanged<'static>);

impl Port for UsbPort {
    fn is_open(&self) -> bool {
        self.0.dtr() && !IS_ASLEEP.load(Ordering::Relaxed)
    }
}

/// Bytes that arrive.
pub struct PortReceiver {
    receiver: Receiver<'static, Controller>,
    packet: [u8; PACKET_BYTES],
    unread: core::ops::Range<usize>,
}

impl ErrorType for PortReceiver {
    type Error = ErrorKind;
}

impl Read for PortReceiver {
    async fn read(&mut self, bytes: &mut [u8]) -> Result<usize, ErrorKind> {
        while self.unread.is_empty() {
            let count = self.receiver.read_packet(&mut self.packet).await.map_err(|_| ErrorKind::NotConnected)?;
            self.unread = 0..count;
        }
        let unread = self.packet.get(self.unread.clone()).unwrap_or_default();
        let count = bytes.iter_mut().zip(unread).map(|(to, from)| *to = *from).count();
        self.unread.start += count;
        Ok(count)
    }
}

/// Bytes that leave.
pub struct PortTransmitter(Sender<'static, Controller>);

impl ErrorType for PortTransmitter {
    type Error = ErrorKind;
}

impl Write for PortTransmitter {
    /// At most one packet, and never a full one: after that a host waits for more before it hands on what it has.
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, ErrorKind> {
        let part = bytes.get(..PACKET_BYTES - 1).unwrap_or(bytes);
        self.0.write_packet(part).await.map_err(|_| ErrorKind::NotConnected)?;
        Ok(part.len())
    }

    async fn flush(&mut self) -> Result<(), ErrorKind> {
        Ok(())
    }
}
