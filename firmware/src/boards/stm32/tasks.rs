//! What every STM32 board runs: its tasks by priority.
//!
//! Control and the sensor have executors of their own, in interrupts; everything else shares a third, but for the
//! memory card, which has the thread to itself.

use super::bootloader;
use super::cause::Cause;
use super::chip::{self, CONTROL_INTERRUPT, SENSOR_INTERRUPT, SERVICES_INTERRUPT};
use super::clock::SystemClock;
use super::executors::{CONTROL, SENSOR, SERVICES};
use super::light::Lamp;
use super::link::{RadioReceiver, Receiver, SimulatorReceiver, SimulatorTransmitter, Transmitter};
use super::packet_radio::{self, PacketRadio};
use super::restart::Chip;
use super::storage::ParameterFlash;
use super::usb::{Controller, Device, PortReceiver, PortTransmitter, Usb, UsbPort};
use super::watchdog::ChipWatchdog;
use crate::boards::chosen::{self, BoardBattery, BoardCard, BoardImu, BoardMotors};
use crate::boards::{guard, handover, kept, recorder};
use crate::configuration::{PERIOD_US, Pilot};
use crate::control::Control;
use crate::crtp::pieces::MEMORY_BYTES;
use crate::esc::Published;
use crate::hil::{self, SelectedMotors};
use crate::last_words::LastWords;
use crate::link::port::Line;
use crate::outputs::{self, Outputs};
use crate::parameters::storage::Storage;
use crate::parameters::table::Name;
use crate::recorder::gyro::{BLOCK_BYTES, Block};
use crate::recorder::ring::{Ring, SLOT_BYTES};
use crate::repeat::{self, Repeater};
use crate::shared::{
    self, CardView, ControlView, CrtpView, Event, ImuView, MotorsView, PacketRadioView, PortView, RadioView,
    ReceiveView, RestartView, Severity, SimulatorView, StatusView, StorageView, TransmitView,
};
use crate::syslink::{self, Wire};
use crate::{boot, card, configuration, crtp, imu, link, radio, status};
use embassy_executor::{Executor, Spawner};
use embassy_stm32::interrupt::{InterruptExt, Priority};
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use static_cell::{ConstStaticCell, StaticCell};

type Raw = CriticalSectionRawMutex;
type Shared = shared::Shared<Raw>;
type Hil = hil::Hil<Raw>;
type Repeated = repeat::Repeated<Raw>;

/// Boots the board and flies it, for ever.
pub fn run() -> ! {
    let mut core = handover::begin_anew(chip::quiet);
    bootloader::enter_if_wished(chip::flags() == Cause::Software);
    guard::watch(&mut core.MPU);
    let has_cache = handover::cache_instructions(&mut core);
    let mut board = chosen::take();
    defmt::info!("started by {} on {=str}", board.restart, chosen::NAME);
    static SHARED: StaticCell<Shared> = StaticCell::new();
    let shared = SHARED.init_with(Shared::new);
    let booting = shared.for_boot();
    booting.started().put((board.restart.name(), chosen::NAME), 0);
    let kept = kept::take(board.restart.is_power());
    if let Some(words) = kept.or_else(|| board.restart.words().map(LastWords::new)) {
        defmt::error!("{=str}", words.as_str());
        booting.last_words().put(words, 0);
    }
    if !board.has_crystal {
        booting.clock_doubtful().raise();
        booting.announce(Event::new(Severity::Warning, "The clock's crystal does not run: no arming"));
    }
    if !has_cache {
        booting.announce(Event::new(Severity::Warning, "The instruction cache is not on: slow"));
    }
    static HIL: StaticCell<Hil> = StaticCell::new();
    let hil = HIL.init_with(Hil::new);
    let parameters = Storage::load(board.storage, shared.for_storage());
    if let Some(wiring) = outputs::wiring(booting.parameters().get(Name::MotorOrder)) {
        board.motors.wire(wiring);
    }
    let protocol = booting.parameters().get(Name::MotorProtocol);
    if protocol > 0.0 {
        board.motors.listen(protocol > 1.0);
    }
    if board.transmitter.set_baudrate(booting.parameters().get(Name::SerialRate) as u32).is_err() {
        booting.announce(Event::new(Severity::Warning, "SER_BAUD: this clock cannot make it"));
    }
    if chip::has_no_brown_out() {
        booting.announce(Event::new(Severity::Information, "Brown-out reset is off (BOR_LEV)"));
    }
    if board.card.is_some() && booting.parameters().get(Name::LogGyro) == 1.0 {
        static GYRO_MEMORY: ConstStaticCell<[Block; chip::GYRO_BLOCKS]> = ConstStaticCell::new([[0; BLOCK_BYTES]; _]);
        booting.gyro_log().attach(GYRO_MEMORY.take());
    }
    let packet_radio = packet_radio::present(board.packet_radio);
    let mut trajectories: &mut [u8] = &mut [];
    if let Some(memory) = recorder::take(board.restart.is_power()) {
        // A client's trajectories have the end of that memory: DMA does not reach it, and need not.
        let count = if packet_radio.is_some() { MEMORY_BYTES.div_ceil(SLOT_BYTES) } else { 0 };
        let (memory, end) = memory.split_at_mut(memory.len().saturating_sub(count));
        trajectories = end.as_flattened_mut();
        trajectories.fill(0);
        booting.recorder().attach(Ring::recover(memory), configuration::NAME);
    }
    static PLACE: boot::Place = boot::Place::new();
    // Without the error's words: what prints them takes 2 KB, and the build refuses such files.
    let Ok((pilot, outputs)) = boot::start(&PLACE, booting) else {
        panic!("the embedded scenario has not four rotors")
    };

    CONTROL_INTERRUPT.set_priority(Priority::P6);
    let spawner = CONTROL.start(CONTROL_INTERRUPT);
    // Beside control: one that hangs without giving way sends nothing more.
    static REPEATED: StaticCell<Repeated> = StaticCell::new();
    let repeated = REPEATED.init_with(Repeated::new);
    spawner.spawn(repeat_commands(shared.for_motors(), repeated, board.motors).unwrap());
    spawner.spawn(control(shared.for_control(), hil, pilot, outputs, repeated, board.watchdog).unwrap());

    SENSOR_INTERRUPT.set_priority(Priority::P7);
    let spawner = SENSOR.start(SENSOR_INTERRUPT);
    spawner.spawn(sample(shared.for_imu(), board.imu).unwrap());

    SERVICES_INTERRUPT.set_priority(Priority::P8);
    let spawner = SERVICES.start(SERVICES_INTERRUPT);
    spawner.spawn(carry_link(shared, board.receiver, board.transmitter, board.usb).unwrap());
    spawner.spawn(simulated_sensors(shared.for_simulator(), hil, board.simulator_receiver).unwrap());
    spawner.spawn(simulated_motors(shared.for_simulator(), hil, board.simulator_transmitter).unwrap());
    if let Some(radio) = board.radio {
        spawner.spawn(listen(shared.for_radio(), radio).unwrap());
    }
    if let Some(radio) = packet_radio {
        spawner.spawn(answer_packets(shared.for_crtp(), radio.wire, trajectories).unwrap());
        spawner.spawn(carry_packets(shared.for_packet_radio(), radio).unwrap());
    }
    spawner.spawn(show(shared.for_status(), board.light, board.battery).unwrap());
    spawner.spawn(keep(shared.for_storage(), parameters).unwrap());
    spawner.spawn(restart_on_request(shared.for_restart()).unwrap());

    static THREAD: StaticCell<Executor> = StaticCell::new();
    THREAD.init(Executor::new()).run(|spawner| {
        if let Some(card) = board.card {
            spawner.spawn(log_flights(shared.for_card(), card).unwrap());
        }
    })
}

#[embassy_executor::task]
async fn control(
    shared: ControlView<'static, Raw>,
    hil: &'static Hil,
    pilot: &'static mut Pilot,
    outputs: Outputs,
    repeated: &'static Repeated,
    mut watchdog: ChipWatchdog,
) {
    let pins = Repeater { repeated, clock: SystemClock };
    let mut motors = SelectedMotors { pins, hil, requested: shared.hil(), clock: SystemClock, period: PERIOD_US };
    Control::new(shared, pilot, outputs).run(&SystemClock, &mut motors, &mut watchdog).await;
}

#[embassy_executor::task]
async fn repeat_commands(shared: MotorsView<'static, Raw>, repeated: &'static Repeated, motors: BoardMotors) {
    let mut motors = Published::new(motors, shared, SystemClock);
    repeat::run(repeated, &mut motors, &SystemClock, PERIOD_US).await;
}

#[embassy_executor::task]
async fn sample(shared: ImuView<'static, Raw>, mut sensor: BoardImu) {
    imu::run(shared, &SystemClock, &mut sensor, PERIOD_US).await;
}

/// Starts what the link consists of. The port's parts are for one executor, so they are made in it.
#[embassy_executor::task]
async fn carry_link(shared: &'static Shared, receiver: Receiver, transmitter: Transmitter, usb: Option<Controller>) {
    // SAFETY: this is a task, and Embassy's executors run it.
    let spawner = unsafe { Spawner::for_current_executor().await };
    let (mut port_receiver, mut port_transmitter) = (None, None);
    if let Some(Usb { device, receiver, transmitter, port }) = usb.map(|usb| Usb::new(usb, chosen::NAME)) {
        (port_receiver, port_transmitter) = (Some(receiver), Some(transmitter));
        spawner.spawn(answer_host(device).unwrap());
        spawner.spawn(watch_port(shared.for_port(), port).unwrap());
    } else {
        shared.for_port().announce(Event::new(Severity::Warning, "USB has no supply: the port stays off"));
    }
    let on_port = shared.for_receive().on_port();
    let line = Line { serial: receiver, port: port_receiver, on_port };
    spawner.spawn(receive(shared.for_receive(), line).unwrap());
    let line = Line { serial: transmitter, port: port_transmitter, on_port };
    spawner.spawn(transmit(shared.for_transmit(), line).unwrap());
}

#[embassy_executor::task]
async fn receive(shared: ReceiveView<'static, Raw>, line: Line<'static, Receiver, PortReceiver>) {
    link::receive::receive(line, &SystemClock, shared).await;
}

#[embassy_executor::task]
async fn transmit(shared: TransmitView<'static, Raw>, line: Line<'static, Transmitter, PortTransmitter>) {
    link::transmit::transmit(line, &SystemClock, shared).await;
}

#[embassy_executor::task]
async fn answer_host(mut device: Device) {
    device.run().await;
}

#[embassy_executor::task]
async fn watch_port(shared: PortView<'static, Raw>, port: UsbPort) {
    link::port::watch(&port, &SystemClock, shared).await;
}

#[embassy_executor::task]
async fn simulated_sensors(shared: SimulatorView<'static, Raw>, hil: &'static Hil, line: SimulatorReceiver) {
    hil::receive(hil, line, &SystemClock, shared, PERIOD_US).await;
}

#[embassy_executor::task]
async fn simulated_motors(shared: SimulatorView<'static, Raw>, hil: &'static Hil, line: SimulatorTransmitter) {
    hil::transmit(hil, line, &SystemClock, shared, PERIOD_US).await;
}

#[embassy_executor::task]
async fn listen(shared: RadioView<'static, Raw>, line: RadioReceiver) {
    radio::receive(line, &SystemClock, shared).await;
}

#[embassy_executor::task]
async fn carry_packets(shared: PacketRadioView<'static, Raw>, radio: PacketRadio) {
    let PacketRadio { receiver, transmitter, stop, wire } = radio;
    syslink::run((receiver, transmitter), stop, &SystemClock, wire, shared).await;
}

#[embassy_executor::task]
async fn answer_packets(shared: CrtpView<'static, Raw>, wire: &'static Wire<Raw>, memory: &'static mut [u8]) {
    crtp::task::run(wire.receiver(), wire.sender(), &SystemClock, shared, memory).await;
}

#[embassy_executor::task]
async fn show(shared: StatusView<'static, Raw>, light: Lamp, battery: BoardBattery) {
    status::run(light, battery, &SystemClock, shared).await;
}

#[embassy_executor::task]
async fn keep(shared: StorageView<'static, Raw>, mut storage: Storage<ParameterFlash>) {
    storage.keep(&SystemClock, shared).await;
}

#[embassy_executor::task]
async fn restart_on_request(shared: RestartView<'static, Raw>) {
    crate::restart::run(shared, &SystemClock, &mut Chip).await;
}

#[embassy_executor::task]
async fn log_flights(shared: CardView<'static, Raw>, slot: BoardCard) {
    card::run(slot, card::PREPARED_BYTES, &SystemClock, shared).await;
}
