//! What happens in one mission, and when.

use controller_core::governor::{HeadingSetpoint, Motion, Setpoint};
use flight::{Battery, FlightSettings, Inputs, Mode, Reason, Request};
use nalgebra::Vector3;
use rand::{Rng, RngExt};

/// Ticks of a mission: ten minutes.
pub const MISSION: u64 = 60_000;

/// How high it takes off, m, and how fast it lands, m/s: each mission's choice, made on the ground before it.
pub const HEIGHTS: [f32; 3] = [1.5, 2.0, 3.0];
pub const SPEEDS: [f32; 3] = [0.4, 0.5, 0.7];

/// Ticks between heartbeats, and between setpoints.
const HEARTBEAT: u64 = 100;
const SETPOINT: u64 = 20;

/// Ticks after which who was refused asks again.
const AGAIN: u64 = 100;

/// How long each silence lasts, ticks: of the ground station; of poses, three times; of a battery that is low, until it
/// is changed.
const SILENCE: u64 = 400;
const DARK: [u64; 3] = [70, 150, 200];
const LOW: u64 = 3_000;

/// The times of one mission, ticks since it began.
#[derive(Debug, Clone)]
pub struct Script {
    arm: u64,
    take_off: u64,
    setpoints: u64,
    circle: u64,
    silence: u64,
    again: u64,
    cease: u64,
    dark: [u64; 3],
    frame: [u64; 2],
    go: u64,
    land: u64,
    /// Whether a low battery makes it land.
    runs_down: bool,
    /// Which of the heights and speeds.
    choice: (usize, usize),
    /// Points to fly to, m, of the frame of the poses.
    points: Vec<Vector3<f32>>,
}

impl Script {
    pub fn new(number: u64, random: &mut impl Rng) -> Self {
        let mut about = |time: u64| time + random.random_range(0..200);
        // It takes a second to find out that setpoints have ceased, two and a half for the station: its last heartbeat
        // counts.
        let silence = about(22_000) / HEARTBEAT * HEARTBEAT;
        Self {
            arm: about(300),
            take_off: about(900),
            setpoints: about(8_000),
            circle: about(19_000),
            silence,
            again: silence + SILENCE + about(200),
            cease: about(26_000) / SETPOINT * SETPOINT,
            dark: [about(28_000), about(30_000), about(55_000)],
            frame: [about(32_000), about(50_000)],
            go: about(34_000),
            land: about(36_000),
            runs_down: number.is_multiple_of(4),
            choice: ((number % 3) as usize, (number / 3 % 3) as usize),
            points: (0..12).map(|_| point(random)).collect(),
        }
    }

    /// This mission's take-off height and landing speed.
    pub fn choice(&self) -> (usize, usize) {
        self.choice
    }

    /// The flight settings of this mission.
    pub fn settings(&self) -> FlightSettings {
        let (height, speed) = self.choice;
        FlightSettings { take_off_height: HEIGHTS[height], landing_speed: SPEEDS[speed], ..FlightSettings::DEFAULT }
    }

    /// Whether no pose comes.
    pub fn is_dark(&self, tick: u64) -> bool {
        self.dark.iter().zip(DARK).any(|(since, lasts)| (*since..since + lasts).contains(&tick))
    }

    /// Whether the frame of the poses moves now.
    pub fn moves_frame(&self, tick: u64) -> bool {
        self.frame.contains(&tick)
    }

    /// The operator's inputs in this tick, in `mode`, which will be at `now` and a period, us; `heartbeat` is when the
    /// station's last heartbeat came. A refused request is repeated a second later.
    pub fn given(&self, tick: u64, mode: Mode, now: u64, heartbeat: &mut Option<u64>) -> Inputs<'static> {
        let silent = (self.silence..self.silence + SILENCE).contains(&tick);
        if tick.is_multiple_of(HEARTBEAT) && !silent {
            *heartbeat = Some(now);
        }
        let request = match tick {
            tick if mode.may_arm() && asks(self.arm, tick) => Some(Request::Arm),
            tick if mode == Mode::Idling && asks(self.take_off, tick) => Some(Request::TakeOff(None)),
            tick if tick == self.setpoints || tick == self.again => Some(Request::FlySetpoints),
            tick if tick == self.go => Some(Request::GoTo(self.setpoint(self.setpoints))),
            tick if tick == self.land && !self.runs_down => Some(Request::Land),
            _ => None,
        };
        let streams = (self.setpoints - SETPOINT..self.cease).contains(&tick) && tick.is_multiple_of(SETPOINT);
        let is_low = self.runs_down && (self.land..self.land + LOW).contains(&tick);
        Inputs {
            request,
            ground_station: *heartbeat,
            setpoint: streams.then(|| self.setpoint(tick)),
            battery: if is_low { Battery::Low } else { Battery::Good },
            ..Inputs::default()
        }
    }

    /// A point, another one every ten seconds; then a circle of 1 m once round in 12 s.
    fn setpoint(&self, tick: u64) -> Setpoint {
        let motion = match tick.checked_sub(self.circle) {
            None => Motion::Position(self.points[(tick / 1_000) as usize % self.points.len()]),
            Some(since) => {
                let (sine, cosine) = (0.5 * since as f32 * 0.01).sin_cos();
                Motion::Velocity(Vector3::new(-sine, cosine, 0.0) * 0.5)
            }
        };
        Setpoint { motion, turn: HeadingSetpoint::Keep }
    }

    /// When what led to this began, ticks.
    pub fn cause(&self, reason: Reason) -> u64 {
        match reason {
            Reason::GroundStationLost => self.silence - HEARTBEAT,
            Reason::SetpointsLost => self.cease - SETPOINT,
            Reason::PoseLost => self.dark[1],
            _ => self.land,
        }
    }

    /// The transitions that the mission must take.
    pub fn wanted(&self) -> Vec<Reason> {
        vec![
            Reason::Armed,
            Reason::TakeOffCommanded,
            Reason::TakenOff,
            Reason::SetpointsCommanded,
            Reason::GroundStationLost,
            Reason::SetpointsCommanded,
            Reason::SetpointsLost,
            Reason::PoseLost,
            Reason::PoseRegained,
            if self.runs_down { Reason::BatteryLow } else { Reason::LandCommanded },
            Reason::Landed,
        ]
    }
}

/// Whether it is time for the request of `since`, or for one of its three repetitions.
fn asks(since: u64, tick: u64) -> bool {
    (since..since + 400).contains(&tick) && (tick - since).is_multiple_of(AGAIN)
}

/// Somewhere near, in the air whichever way the frame has moved.
fn point(random: &mut impl Rng) -> Vector3<f32> {
    Vector3::new(random.random_range(-4.0..4.0), random.random_range(-4.0..4.0), random.random_range(3.5..6.0))
}
