//! Hardware in the loop: a simulator takes the motors' commands and answers with what the sensors would say.
//!
//! Once on, it stays on until reboot: the motors' own outputs carry stop, and their commands go to the simulator.
//!
//! | message | way | what |
//! |---|---|---|
//! | HIL_ACTUATOR_CONTROLS | out, one a tick | its time; commands 0 to 1 in the rotors' order; armed unless told to stop |
//! | ODOMETRY | in | where the vehicle is a tick later, as from any source of poses; may be left out |
//! | HIL_SENSOR | in | gyro and accelerometer then, with the time of the command that it answers |
//!
//! HIL_SENSOR comes last and ends the exchange; the simulator then stands still until the next command. So the two run in
//! lock-step, and what a tick sees does not depend on how long the simulator took. [`Hil::awaiting`] is true in between: an
//! emulated processor stays awake for it, a real one need not ask.
//!
//! What an answer says is true one tick after the command whose time it carries, and that is its time stamp. It carries a
//! time that the vehicle itself has sent, so no clock but the vehicle's makes anything fresh; times to come are refused.

use crate::frames;
use crate::hardware::{Clock, Fault, MOTORS, MotorCommand, Motors};
use crate::link::frame::{FRAME_MAX, Frame, Header, Parser, encode};
use crate::shared::Latest;
use controller_core::flight::{ImuSample, Pose, Stamped};
use core::cell::Cell;
use embassy_futures::select::select;
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_sync::signal::Signal;
use embedded_io_async::{Read, Write};
use mavlink::dialects::common::{
    HIL_ACTUATOR_CONTROLS_DATA, HIL_SENSOR_DATA, HilActuatorControlsFlags, HilSensorUpdatedFlags, MavFrame,
    MavModeFlag, ODOMETRY_DATA,
};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// Longest that a message may take to go out, us: then the next tick's is due.
const SEND_TIMEOUT: u64 = 8_000;

/// Pause after a failed read, us.
const READ_RETRY: u64 = 1_000;

/// From a command to the moment that the answer to it is about, us: one tick.
const PERIOD: u64 = 10_000;

/// Whether a simulator stands in for sensors and motors, and how far the exchange with it is.
pub struct Hil<M: RawMutex> {
    state: Mutex<M, Cell<State>>,
    outgoing: Signal<M, Stamped<MotorCommand>>,
}

#[derive(Clone, Copy)]
struct State {
    active: bool,
    /// When the command was given that has no answer yet.
    unanswered: Option<u64>,
}

impl<M: RawMutex> Hil<M> {
    /// Off, or on from boot.
    #[must_use]
    pub const fn new(active: bool) -> Self {
        Self { state: Mutex::new(Cell::new(State { active, unanswered: None })), outgoing: Signal::new() }
    }

    /// Turns it on, until reboot. Only to be called while disarmed: the motors stop.
    pub fn activate(&self) {
        self.update(|state| State { active: true, ..state });
    }

    /// Whether a simulator stands in for sensors and motors.
    #[must_use]
    pub fn active(&self) -> bool {
        self.state.lock(Cell::get).active
    }

    /// Whether a command is on its way that the simulator has not answered.
    #[must_use]
    pub fn awaiting(&self) -> bool {
        self.state.lock(Cell::get).unanswered.is_some()
    }

    fn update(&self, change: impl FnOnce(State) -> State) {
        self.state.lock(|cell| cell.set(change(cell.get())));
    }

    fn command(&self, command: MotorCommand, now: u64) {
        self.update(|state| State { unanswered: Some(now), ..state });
        self.outgoing.signal(Stamped { value: command, time: now });
    }

    fn answered(&self, time: u64) {
        self.update(|state| State { unanswered: state.unanswered.filter(|command| *command != time), ..state });
    }
}

/// A board's motors, or the simulator's.
pub struct SelectedMotors<'a, M: RawMutex, P, C> {
    /// Decides which.
    pub hil: &'a Hil<M>,
    /// The board's own.
    pub pins: P,
    /// The board's time.
    pub clock: C,
}

impl<M: RawMutex, P: Motors, C: Clock> Motors for SelectedMotors<'_, M, P, C> {
    async fn write(&mut self, command: MotorCommand) -> Result<(), Fault> {
        if !self.hil.active() {
            return self.pins.write(command).await;
        }
        self.hil.command(command, self.clock.now());
        self.pins.write(MotorCommand::Stop).await
    }
}

/// Sends each command that [`SelectedMotors`] was given, as `system`'s autopilot. Never ends.
pub async fn transmit<M: RawMutex>(hil: &Hil<M>, mut writer: impl Write, clock: &impl Clock, system: u8) -> ! {
    let mut buffer = [0; FRAME_MAX];
    let mut header = Header { system, component: 1, sequence: 0 };
    loop {
        let Stamped { value: command, time } = hil.outgoing.wait().await;
        let bytes = encode(header, &controls(command, time), &mut buffer);
        header.sequence = header.sequence.wrapping_add(1);
        // What does not go out leaves its tick without an answer; that shows as a sensor that grows old.
        select(writer.write_all(bytes), clock.until(time + SEND_TIMEOUT)).await;
    }
}

/// Takes the simulator's answers as IMU and pose. Never ends.
pub async fn receive<M: RawMutex>(
    hil: &Hil<M>,
    mut reader: impl Read,
    clock: &impl Clock,
    imu: &Latest<M, ImuSample>,
    pose: &Latest<M, Pose>,
) -> ! {
    let mut parser = Parser::new();
    let mut buffer = [0; 64];
    loop {
        let Ok(count @ 1..) = reader.read(&mut buffer).await else {
            clock.until(clock.now() + READ_RETRY).await;
            continue;
        };
        let now = clock.now();
        for byte in buffer.iter().take(count) {
            let mut frame = parser.push(*byte, now);
            while let Some(found) = frame {
                take(hil, &found, now, imu, pose);
                frame = parser.next_frame();
            }
        }
    }
}

/// Acts on one frame, if it is one of the two and a simulator is wanted.
fn take<M: RawMutex>(hil: &Hil<M>, frame: &Frame, now: u64, imu: &Latest<M, ImuSample>, pose: &Latest<M, Pose>) {
    if !hil.active() {
        return;
    }
    if let Some(message) = frame.decode::<HIL_SENSOR_DATA>() {
        if let Some(sample) = sample(&message).filter(|_| message.time_usec <= now) {
            imu.put(sample, message.time_usec + PERIOD);
            hil.answered(message.time_usec);
        }
    } else if let Some(message) = frame.decode::<ODOMETRY_DATA>()
        && let Some(value) = odometry(&message).filter(|_| message.time_usec <= now)
    {
        pose.put(value, message.time_usec + PERIOD);
    }
}

/// The message that tells the simulator a command.
fn controls(command: MotorCommand, time: u64) -> HIL_ACTUATOR_CONTROLS_DATA {
    let mut controls = [0.0; 16];
    let mut mode = MavModeFlag::MAV_MODE_FLAG_HIL_ENABLED;
    if let MotorCommand::Run(motors) = command {
        mode |= MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED;
        for (control, motor) in controls.iter_mut().zip::<[f32; MOTORS]>(motors) {
            *control = motor;
        }
    }
    let flags = HilActuatorControlsFlags::HIL_ACTUATOR_CONTROLS_FLAGS_LOCKSTEP;
    HIL_ACTUATOR_CONTROLS_DATA { time_usec: time, flags, controls, mode }
}

/// What the sensors say, if the simulator knows all of it.
fn sample(message: &HIL_SENSOR_DATA) -> Option<ImuSample> {
    use HilSensorUpdatedFlags as Field;
    let inertial = Field::HIL_SENSOR_UPDATED_XACC
        | Field::HIL_SENSOR_UPDATED_YACC
        | Field::HIL_SENSOR_UPDATED_ZACC
        | Field::HIL_SENSOR_UPDATED_XGYRO
        | Field::HIL_SENSOR_UPDATED_YGYRO
        | Field::HIL_SENSOR_UPDATED_ZGYRO;
    let gyro = Vector3::new(message.xgyro, message.ygyro, message.zgyro);
    let accelerometer = Vector3::new(message.xacc, message.yacc, message.zacc);
    let whole = message.fields_updated.contains(inertial) && finite(&gyro) && finite(&accelerometer);
    whole.then(|| ImuSample { angular_velocity: frames::body(&gyro), specific_force: frames::body(&accelerometer) })
}

/// Where the vehicle is, if all of it is finite and in the frames that simulators use.
fn odometry(message: &ODOMETRY_DATA) -> Option<Pose> {
    let [w, x, y, z] = message.q;
    let attitude = Quaternion::new(w, x, y, z);
    let position = Vector3::new(message.x, message.y, message.z);
    let velocity = Vector3::new(message.vx, message.vy, message.vz);
    let framed =
        message.frame_id == MavFrame::MAV_FRAME_LOCAL_NED && message.child_frame_id == MavFrame::MAV_FRAME_BODY_FRD;
    let length = attitude.norm();
    // False for a NaN as well.
    let whole = framed && finite(&position) && finite(&velocity) && (length - 1.0).abs() < 1e-3;
    whole.then(|| {
        let attitude = frames::attitude(&(attitude / length));
        let rotation = UnitQuaternion::new_unchecked(attitude);
        Pose { position: frames::world(&position), velocity: rotation * frames::body(&velocity), attitude }
    })
}

fn finite(vector: &Vector3<f32>) -> bool {
    vector.iter().all(|component| component.is_finite())
}
