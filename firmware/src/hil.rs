//! Hardware in the loop: a simulator takes the motors' commands and answers with what the sensors would say.
//!
//! It can be turned on while the motors are stopped ([`SelectedMotors`]) and stays on until reboot: the motors' own outputs
//! carry stop, and their commands go to the simulator.
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
//! What an answer says is true one tick after the command whose time it carries, and that is its time stamp. Times after
//! that of the last command are refused, so no clock but the vehicle's makes anything fresh.

use crate::deadline::{send, within};
use crate::frames;
use crate::hardware::{Clock, Fault, MotorCommand, Motors};
use crate::link::COMPONENT;
use crate::link::draft::Draft;
use crate::link::frame::{Frame, Header, Parser};
use crate::link::message::{self, mode};
use crate::link::pose::odometry;
use crate::parameters::table::Name;
use crate::shared::{Flag, Latest, Shared};
use controller_core::flight::{ImuSample, PERIOD, Stamped};
use core::cell::Cell;
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_sync::signal::Signal;
use embedded_io_async::{Read, Write};

/// Longest that a message may take to go out, us: then the next tick's is due.
const SENDING_MAX: u64 = 8_000;

/// Bytes taken from the line at once.
const CHUNK: usize = 64;

/// How long the line may be silent before it is asked again, us.
const SILENCE: u64 = 100_000;

/// Pause before the line is asked again, us.
const RETRY: u64 = 1_000;

/// HIL_ACTUATOR_CONTROLS_FLAGS_LOCKSTEP.
const LOCKSTEP: u64 = 1;

/// HIL_SENSOR: accelerometer and gyro are known, all axes.
const INERTIAL: u32 = 0b11_1111;

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
    /// When the last command was given, us.
    commanded: u64,
    /// Whether it has no answer yet.
    awaiting: bool,
}

impl<M: RawMutex> Hil<M> {
    /// No simulator yet.
    #[must_use]
    pub const fn new() -> Self {
        let state = State { active: false, commanded: 0, awaiting: false };
        Self { state: Mutex::new(Cell::new(state)), command: Latest::new(), outgoing: Signal::new() }
    }

    /// Whether the simulator has sensors and motors.
    #[must_use]
    pub fn active(&self) -> bool {
        self.state.lock(Cell::get).active
    }

    /// Whether a command is on its way that the simulator has not answered.
    #[must_use]
    pub fn awaiting(&self) -> bool {
        self.state.lock(Cell::get).awaiting
    }

    fn command(&self, command: MotorCommand, now: u64) {
        self.state.lock(|state| state.set(State { active: true, commanded: now, awaiting: true }));
        self.command.put(command, now);
        self.outgoing.signal(());
    }

    /// When what an answer with this time says is true, us; none for one that nothing was asked for.
    fn stamp(&self, time: u64) -> Option<u64> {
        let State { active, commanded, .. } = self.state.lock(Cell::get);
        (active && time <= commanded).then(|| time + PERIOD)
    }

    fn answered(&self, time: u64) {
        self.state.lock(|cell| {
            let state = cell.get();
            cell.set(State { awaiting: state.awaiting && state.commanded != time, ..state });
        });
    }
}

impl<M: RawMutex> Default for Hil<M> {
    fn default() -> Self {
        Self::new()
    }
}

/// A board's motors, or the simulator's. The change is made between a stop and a stop, whatever asked for it.
pub struct SelectedMotors<'a, M: RawMutex, P, C> {
    /// The board's own.
    pub pins: P,
    /// The simulator's.
    pub hil: &'a Hil<M>,
    /// Raised when the simulator is wanted.
    pub wanted: &'a Flag,
    /// The board's time.
    pub clock: C,
}

impl<M: RawMutex, P: Motors, C: Clock> Motors for SelectedMotors<'_, M, P, C> {
    async fn write(&mut self, command: MotorCommand) -> Result<(), Fault> {
        if self.hil.active() || self.wanted.is_raised() && command == MotorCommand::Stop {
            self.hil.command(command, self.clock.now());
            return self.pins.write(MotorCommand::Stop).await;
        }
        self.pins.write(command).await
    }
}

/// Sends the simulator each command that [`SelectedMotors`] was given, for ever.
pub async fn transmit<M: RawMutex>(hil: &Hil<M>, mut line: impl Write, clock: &impl Clock, shared: &Shared<M>) -> ! {
    let mut draft = Draft::new();
    let mut sequence: u8 = 0;
    loop {
        // The time limit only makes the wait a bounded one.
        let _ = within(clock, SILENCE, hil.outgoing.wait()).await;
        let Some(command) = hil.command.take() else { continue };
        let system = shared.parameters.get(Name::SystemId) as u8;
        let header = Header { system, component: COMPONENT, sequence };
        sequence = sequence.wrapping_add(1);
        controls(&mut draft, &command);
        // What does not go out is not answered, and shows as sensors that grow old.
        send(&mut line, clock, SENDING_MAX, draft.finish(header)).await;
    }
}

/// Takes the simulator's answers for IMU and pose, for ever.
pub async fn receive<M: RawMutex>(hil: &Hil<M>, mut line: impl Read, clock: &impl Clock, shared: &Shared<M>) -> ! {
    let mut parser = Parser::new();
    let mut chunk = [0; CHUNK];
    loop {
        let Ok(Ok(count @ 1..)) = within(clock, SILENCE, line.read(&mut chunk)).await else {
            clock.until(clock.now() + RETRY).await;
            continue;
        };
        let now = clock.now();
        parser.feed(chunk.get(..count).unwrap_or(&chunk), now, &mut |frame| take(hil, frame, shared));
    }
}

/// Acts on one frame, if it is one of the two and answers a command.
fn take<M: RawMutex>(hil: &Hil<M>, frame: &Frame<'_>, shared: &Shared<M>) {
    // Both begin with the time.
    let asked = frame.u64(0);
    let Some(time) = hil.stamp(asked) else { return };
    match frame.message {
        message::HIL_SENSOR if frame.is_whole() => {
            if let Some(sample) = sample(frame) {
                shared.imu.put(sample, time);
                hil.answered(asked);
            }
        }
        message::ODOMETRY => {
            if let Ok(pose) = odometry(frame) {
                shared.pose.put(pose, time);
            }
        }
        _ => {}
    }
}

/// Drafts the message that tells the simulator a command.
fn controls(draft: &mut Draft, command: &Stamped<MotorCommand>) {
    let mut controls = [0.0; 16];
    match command.value {
        MotorCommand::Stop => {}
        MotorCommand::Run(motors) => {
            for (control, motor) in controls.iter_mut().zip(motors) {
                *control = motor;
            }
        }
        MotorCommand::One { motor, level } => {
            for control in controls.iter_mut().skip(motor).take(1) {
                *control = level;
            }
        }
    }
    let armed = if command.value == MotorCommand::Stop { 0 } else { mode::ARMED };
    let draft = draft.begin(message::HIL_ACTUATOR_CONTROLS).bytes(&command.time.to_le_bytes());
    draft.bytes(&LOCKSTEP.to_le_bytes()).floats(&controls).bytes(&[mode::HIL | armed]);
}

/// What the sensors say, if the simulator knows all of it.
fn sample(message: &Frame<'_>) -> Option<ImuSample> {
    // Time, accelerometer, gyro, seven numbers of other sensors, which of all these are known.
    let (accelerometer, gyro, known) = (message.vector(8), message.vector(20), message.u32(60));
    let whole = known & INERTIAL == INERTIAL && message.are_finite(8, 6);
    whole.then(|| ImuSample { angular_velocity: frames::body(&gyro), specific_force: frames::body(&accelerometer) })
}
