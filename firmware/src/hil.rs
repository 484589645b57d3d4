//! Hardware in the loop: a simulator takes the motors' commands and answers with sensor samples.
//!
//! It can be turned on while the motors are stopped ([`SelectedMotors`]) and stays on until reboot: the motors' own
//! outputs carry stop, and their commands go to the simulator.
//!
//! | message | way | what |
//! |---|---|---|
//! | HIL_ACTUATOR_CONTROLS | out, one a tick | its time; commands 0 to 1 in the rotors' order; armed unless stopped |
//! | ODOMETRY | in | a pose, as from any source of poses; may come late, may be left out |
//! | ESC_STATUS | in | how fast the rotors turn, the first four; may be left out; taken where `MOT_DSHOT` is set |
//! | HIL_SENSOR | in | gyro and accelerometer; as many of them as the simulator likes, in order; taken as a sensor's: [`Flow`] |
//!
//! The time of either answer is that of its values, by the vehicle's clock: the simulator adds to the time of a
//! command. The HIL_SENSOR that is true a period after the last command ends the exchange; the simulator then stands
//! still until the next one. One each millisecond is a sensor at 1 kHz, and one a tick will do. So the two run in
//! lock-step, and what a tick sees does not depend on how long the simulator took. [`Hil::awaiting`] is true in
//! between: an emulated processor stays awake for it, a real one need not ask.
//!
//! A time later than a period after the last command is refused, so no clock but the vehicle's makes anything fresh. A
//! repeated or overtaken sample is not integrated, nor is a repeated pose taken: the conditioner and the estimator see
//! to that.

use crate::deadline::{send, within};
use crate::frames;
use crate::hardware::{Clock, Fault, MotorCommand, Motors, RawImu};
use crate::imu::{self, Flow};
use crate::link::frame::{Frame, Parser};
use crate::link::pose::odometry;
use crate::link::writer::Writer;
use crate::parameters::table::Name;
use crate::shared::{self, Flag, Latest, SimulatorView};
use core::cell::Cell;
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_sync::signal::Signal;
use embedded_io_async::{Read, Write};
use flight::Stamped;
use mavlink::MessageData;
use mavlink::dialects::common::{
    ESC_STATUS_DATA, HIL_ACTUATOR_CONTROLS_DATA, HIL_SENSOR_DATA, HilActuatorControlsFlags, HilSensorUpdatedFlags,
    MavModeFlag, ODOMETRY_DATA,
};
use nalgebra::Vector3;

/// Bytes taken from the line at once.
const READ_CHUNK_BYTES: usize = 64;

/// The timeout of a read of the line.
const READ_TIMEOUT_US: u64 = 100_000;

/// Pause before the line is read again.
const RETRY_DELAY_US: u64 = 1_000;

/// rad/s in a revolution a minute.
const RAD_PER_S_PER_RPM: f32 = core::f32::consts::TAU / 60.0;

/// What a simulator must send: accelerometer and gyro, all axes.
const INERTIAL: HilSensorUpdatedFlags = HilSensorUpdatedFlags::HIL_SENSOR_UPDATED_XACC
    .union(HilSensorUpdatedFlags::HIL_SENSOR_UPDATED_YACC)
    .union(HilSensorUpdatedFlags::HIL_SENSOR_UPDATED_ZACC)
    .union(HilSensorUpdatedFlags::HIL_SENSOR_UPDATED_XGYRO)
    .union(HilSensorUpdatedFlags::HIL_SENSOR_UPDATED_YGYRO)
    .union(HilSensorUpdatedFlags::HIL_SENSOR_UPDATED_ZGYRO);

/// The exchange with the simulator: whether there is one, and how far it is.
pub struct Hil<M: RawMutex> {
    state: Mutex<M, Cell<State>>,
    command: Latest<M, MotorCommand>,
    /// There is a new command.
    outgoing: Signal<M, ()>,
}

#[derive(Clone, Copy)]
struct State {
    active: bool,
    /// A period after the last command, us: the time of the sensors' sample that ends the exchange.
    due: u64,
    /// Whether it has no answer yet.
    awaiting: bool,
}

impl<M: RawMutex> Hil<M> {
    /// No simulator yet.
    pub const fn new() -> Self {
        let state = State { active: false, due: 0, awaiting: false };
        Self { state: Mutex::new(Cell::new(state)), command: Latest::new(), outgoing: Signal::new() }
    }

    /// Whether the simulator has sensors and motors.
    pub fn active(&self) -> bool {
        self.state.lock(Cell::get).active
    }

    /// Whether a command is on its way that the simulator has not answered.
    pub fn awaiting(&self) -> bool {
        self.state.lock(Cell::get).awaiting
    }

    fn command(&self, command: MotorCommand, now: u64, period: u64) {
        self.state.lock(|state| state.set(State { active: true, due: now + period, awaiting: true }));
        self.command.put(command, now);
        self.outgoing.signal(());
    }

    /// The time of an answer, us; none for one that no command so far can have led to.
    fn stamp(&self, time: u64) -> Option<u64> {
        let State { active, due, .. } = self.state.lock(Cell::get);
        (active && time <= due).then_some(time)
    }

    /// The sensors' sample of `time`, us, has come.
    fn answered(&self, time: u64) {
        self.state.lock(|cell| {
            let state = cell.get();
            cell.set(State { awaiting: state.awaiting && time != state.due, ..state });
        });
    }
}

/// A board's motors, or the simulator's. The change is made between two stops, whatever requested it.
pub struct SelectedMotors<'a, M: RawMutex, P, C> {
    /// The board's own.
    pub pins: P,
    /// The simulator's.
    pub hil: &'a Hil<M>,
    /// Raised when the simulator is wanted.
    pub requested: shared::Read<'a, Flag>,
    /// The board's time.
    pub clock: C,
    /// The time between control ticks, us.
    pub period: u64,
}

impl<M: RawMutex, P: Motors, C: Clock> Motors for SelectedMotors<'_, M, P, C> {
    async fn write(&mut self, command: MotorCommand) -> Result<(), Fault> {
        if self.hil.active() || self.requested.is_raised() && command == MotorCommand::Stop {
            self.hil.command(command, self.clock.now(), self.period);
            return self.pins.write(MotorCommand::Stop).await;
        }
        self.pins.write(command).await
    }
}

/// Sends the simulator each command that [`SelectedMotors`] was given, one every `period` us, for ever.
pub async fn transmit<M: RawMutex>(
    hil: &Hil<M>,
    mut line: impl Write,
    clock: &impl Clock,
    shared: SimulatorView<'_, M>,
    period: u64,
) -> ! {
    let mut writer = Writer::new();
    loop {
        // The time limit only makes the wait a bounded one.
        let _ = within(clock, READ_TIMEOUT_US, hil.outgoing.wait()).await;
        let Some(command) = hil.command.take() else { continue };
        writer.write(shared.parameters().get(Name::SystemId) as u8, &controls(&command));
        // Before the next is due. What does not go out is not answered, and shows as sensors that grow old.
        send(&mut line, clock, period / 5 * 4, writer.bytes()).await;
    }
}

/// Takes the simulator's answers for IMU and pose, for a control that ticks every `period` us, for ever.
pub async fn receive<M: RawMutex>(
    hil: &Hil<M>,
    mut line: impl Read,
    clock: &impl Clock,
    shared: SimulatorView<'_, M>,
    period: u64,
) -> ! {
    let mut flow = match Flow::simulated(shared.samples(), period) {
        Ok(flow) => flow,
        Err(error) => imu::refuse(shared.samples(), clock, &error).await,
    };
    let mut parser = Parser::new();
    let mut chunk = [0; READ_CHUNK_BYTES];
    loop {
        let Ok(Ok(count @ 1..)) = within(clock, READ_TIMEOUT_US, line.read(&mut chunk)).await else {
            clock.until(clock.now() + RETRY_DELAY_US).await;
            continue;
        };
        let now = clock.now();
        parser.feed(chunk.get(..count).unwrap_or(&chunk), now, &mut |frame| take(hil, frame, &mut flow, shared));
    }
}

/// Acts on one frame, if it is one of the two and a command can have led to it.
fn take<M: RawMutex>(hil: &Hil<M>, frame: &Frame<'_>, flow: &mut Flow<'_, M>, shared: SimulatorView<'_, M>) {
    match frame.message {
        HIL_SENSOR_DATA::ID => {
            let Some(message) = frame.decode::<HIL_SENSOR_DATA>() else { return };
            let stamped = hil.stamp(message.time_usec).and_then(|time| sample(&message, time));
            if let Some(sample) = stamped {
                flow.take(&sample);
                hil.answered(sample.time);
            }
        }
        // Only where the motors' controllers would answer as well.
        ESC_STATUS_DATA::ID if shared.parameters().get(Name::MotorProtocol) > 0.0 => {
            let Some(message) = frame.decode::<ESC_STATUS_DATA>() else { return };
            if let (Some(time), 0) = (hil.stamp(message.time_usec), message.index) {
                let speeds = message.rpm.map(|rpm| Some(rpm.unsigned_abs() as f32 * RAD_PER_S_PER_RPM));
                shared.rotor_speeds().put(speeds, time);
            }
        }
        ODOMETRY_DATA::ID => {
            let Some(message) = frame.decode::<ODOMETRY_DATA>() else { return };
            if let (Some(time), Ok(pose)) = (hil.stamp(message.time_usec), odometry(frame, &message)) {
                let _ = shared.poses().put(Stamped { value: pose, time });
            }
        }
        _ => {}
    }
}

/// The message with a command for the simulator.
fn controls(command: &Stamped<MotorCommand>) -> HIL_ACTUATOR_CONTROLS_DATA {
    let mut controls = [0.0; 16];
    let motors = command.value.levels();
    for (control, motor) in controls.iter_mut().zip(motors) {
        *control = motor;
    }
    let mut mode = MavModeFlag::MAV_MODE_FLAG_HIL_ENABLED;
    mode.set(MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED, command.value != MotorCommand::Stop);
    let flags = HilActuatorControlsFlags::HIL_ACTUATOR_CONTROLS_FLAGS_LOCKSTEP;
    HIL_ACTUATOR_CONTROLS_DATA { time_usec: command.time, flags, controls, mode }
}

/// The sensors' sample at `time`, us, if the simulator sent all of it.
fn sample(message: &HIL_SENSOR_DATA, time: u64) -> Option<RawImu> {
    let &HIL_SENSOR_DATA { xacc, yacc, zacc, xgyro, ygyro, zgyro, fields_updated: known, .. } = message;
    let (force, rates) = (Vector3::new(xacc, yacc, zacc), Vector3::new(xgyro, ygyro, zgyro));
    let finite = force.iter().chain(&rates).all(|component| component.is_finite());
    let whole = known.contains(INERTIAL) && finite;
    let (angular_velocity, specific_force) = (frames::body(&rates), Some(frames::body(&force)));
    whole.then_some(RawImu { time, angular_velocity, specific_force })
}
