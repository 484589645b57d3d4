//! What happens in one mission, and when.

use controller_core::governor::{HeadingSetpoint, Motion, Setpoint};
use flight::{Battery, FlightSettings, Inputs, Mode, Reason, Request};
use nalgebra::Vector3;
use rand::{Rng, RngExt};

/// Ticks of a mission: ten minutes.
pub const MISSION_TICKS: u64 = 60_000;

/// How high it takes off, m, and how fast it lands, m/s: each mission's choice, made on the ground before it.
pub const TAKE_OFF_HEIGHTS_M: [f32; 3] = [1.5, 2.0, 3.0];
pub const LANDING_SPEEDS_M_PER_S: [f32; 3] = [0.4, 0.5, 0.7];

/// Ticks between heartbeats, and between setpoints.
const HEARTBEAT_TICKS: u64 = 100;
const SETPOINT_TICKS: u64 = 20;

/// Ticks after which a refused request is repeated.
const RETRY_TICKS: u64 = 100;

/// How long each fault lasts: the ground station lost; poses lost, three times; a low battery, until it is changed.
const STATION_OUTAGE_TICKS: u64 = 400;
const POSE_OUTAGE_TICKS: [u64; 3] = [70, 150, 200];
const BATTERY_LOW_TICKS: u64 = 3_000;

/// The times of one mission, ticks since it began.
#[derive(Debug, Clone)]
pub struct Script {
    arm: u64,
    take_off: u64,
    setpoints: u64,
    circle: u64,
    station_lost: u64,
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
        let station_lost = about(22_000) / HEARTBEAT_TICKS * HEARTBEAT_TICKS;
        Self {
            arm: about(300),
            take_off: about(900),
            setpoints: about(8_000),
            circle: about(19_000),
            station_lost,
            again: station_lost + STATION_OUTAGE_TICKS + about(200),
            cease: about(26_000) / SETPOINT_TICKS * SETPOINT_TICKS,
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
        FlightSettings {
            take_off_height: TAKE_OFF_HEIGHTS_M[height],
            landing_speed: LANDING_SPEEDS_M_PER_S[speed],
            ..FlightSettings::DEFAULT
        }
    }

    /// Whether no pose comes.
    pub fn is_dark(&self, tick: u64) -> bool {
        self.dark.iter().zip(POSE_OUTAGE_TICKS).any(|(since, lasts)| (*since..since + lasts).contains(&tick))
    }

    /// Whether the frame of the poses moves now.
    pub fn moves_frame(&self, tick: u64) -> bool {
        self.frame.contains(&tick)
    }

    /// The operator's inputs in this tick, in `mode`, which will be at `now` and a period, us; `heartbeat` is when the
    /// station's last heartbeat came. A refused request is repeated a second later.
    pub fn given(&self, tick: u64, mode: Mode, now: u64, heartbeat: &mut Option<u64>) -> Inputs<'static> {
        let silent = (self.station_lost..self.station_lost + STATION_OUTAGE_TICKS).contains(&tick);
        if tick.is_multiple_of(HEARTBEAT_TICKS) && !silent {
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
        let streams =
            (self.setpoints - SETPOINT_TICKS..self.cease).contains(&tick) && tick.is_multiple_of(SETPOINT_TICKS);
        let is_low = self.runs_down && (self.land..self.land + BATTERY_LOW_TICKS).contains(&tick);
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
            Reason::GroundStationLost => self.station_lost - HEARTBEAT_TICKS,
            Reason::SetpointsLost => self.cease - SETPOINT_TICKS,
            Reason::PoseLost => self.dark[1],
            _ => self.land,
        }
    }

    /// The transitions that the mission must take.
    pub fn expected_reasons(&self) -> Vec<Reason> {
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
    (since..since + 400).contains(&tick) && (tick - since).is_multiple_of(RETRY_TICKS)
}

/// Somewhere near, in the air whichever way the frame has moved.
fn point(random: &mut impl Rng) -> Vector3<f32> {
    Vector3::new(random.random_range(-4.0..4.0), random.random_range(-4.0..4.0), random.random_range(3.5..6.0))
}
