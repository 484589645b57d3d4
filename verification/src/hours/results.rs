//! The results of hours of missions, and whether the last was as good as the first.

use super::script::{LANDING_SPEEDS_M_PER_S, TAKE_OFF_HEIGHTS_M};
use flight::Reason;
use nalgebra::Vector3;

/// The figures of one hour.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Hour {
    /// RMS of the distance between vehicle and reference in hover, m.
    pub hover: f64,
    /// RMS of the estimate's error meanwhile, m.
    pub estimate: f64,
    /// Ticks from a cause to its consequence, means over the hour, in the order of [`TIMED_REASONS`].
    pub delays: [f64; TIMED_REASONS.len()],
}

/// Consequences that are timed: of the take-off command, of the last heartbeat, setpoint and pose, of a battery that is
/// low.
pub const TIMED_REASONS: [Reason; 5] =
    [Reason::TakenOff, Reason::GroundStationLost, Reason::SetpointsLost, Reason::PoseLost, Reason::BatteryLow];

/// The effect of parameters changed before a mission, over all missions with the same choice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParameterEffect {
    /// The choice: m, or m/s.
    pub chosen: f32,
    /// The least and the greatest of what came of it: m above the ground in hover, or m/s downwards while landing.
    pub found: (f64, f64),
    /// The shortest and the longest time that it took, ticks: from the take-off's command to its height; of a landing,
    /// nothing is said.
    pub took: (u64, u64),
}

impl ParameterEffect {
    pub(super) fn new(chosen: f32) -> Self {
        Self { chosen, found: (f64::INFINITY, f64::NEG_INFINITY), took: (u64::MAX, 0) }
    }

    pub(super) fn find(&mut self, value: f64) {
        let (least, most) = self.found;
        self.found = (least.min(value), most.max(value));
    }

    pub(super) fn take(&mut self, ticks: u64) {
        self.took = widened(self.took, ticks);
    }
}

/// The range with one more value in it.
pub(super) fn widened((least, most): (u64, u64), value: u64) -> (u64, u64) {
    (least.min(value), most.max(value))
}

/// The figures of all hours.
#[derive(Debug, Clone, PartialEq)]
pub struct Hours {
    /// Hour by hour.
    pub hours: Vec<Hour>,
    /// The shortest and longest of each of the delays, ticks.
    pub extremes: [(u64, u64); TIMED_REASONS.len()],
    /// The result of each chosen take-off height and landing speed.
    pub heights: [ParameterEffect; TAKE_OFF_HEIGHTS_M.len()],
    /// See [`Self::heights`].
    pub speeds: [ParameterEffect; LANDING_SPEEDS_M_PER_S.len()],
    /// Missions flown.
    pub missions: u64,
    /// How often the frame of the poses has moved.
    pub moves: u64,
    /// How often a request was repeated, because a pose of the last second was not believed.
    pub refusals: u64,
    /// Every transition but those between checks and ready, with its tick since the beginning.
    pub taken: Vec<(u64, Reason)>,
    /// Where the vehicle was at the end, m.
    pub position: Vector3<f64>,
}

/// How much the last hour may differ from the first, relative: means over 300 s of noise that takes about half a second
/// to forget.
const HOUR_DIFFERENCE_MAX: f64 = 0.15;

/// How far apart two delays of one kind may be, ticks.
const DELAY_SPREAD_MAX_TICKS: u64 = 1;

/// How far from the height that was chosen a hover may be, m, and how far from the speed, m/s: gusts and the estimate's
/// noise, and a landing that begins out of a climb or with the ground's cushion.
const HEIGHT_TOLERANCE_M: f64 = 0.02;
const SPEED_TOLERANCE_M_PER_S: f64 = 0.1;

impl Hours {
    /// Before anything was flown.
    pub(super) fn new() -> Self {
        Self {
            hours: Vec::new(),
            extremes: [(u64::MAX, 0); TIMED_REASONS.len()],
            heights: TAKE_OFF_HEIGHTS_M.map(ParameterEffect::new),
            speeds: LANDING_SPEEDS_M_PER_S.map(ParameterEffect::new),
            missions: 0,
            moves: 0,
            refusals: 0,
            taken: Vec::new(),
            position: Vector3::zeros(),
        }
    }

    /// Whether every delay was the same all the time, the last hour as good as the first, and every parameter obeyed.
    ///
    /// # Errors
    /// Says what was not.
    pub fn check(&self) -> Result<(), String> {
        // How long a take-off takes depends on its height: they are compared by it.
        let delays = TIMED_REASONS.iter().zip(self.extremes).filter(|(reason, _)| **reason != Reason::TakenOff);
        let rises = self.heights.iter().map(|height| (&Reason::TakenOff, height.took));
        for (reason, (least, most)) in delays.chain(rises) {
            if most.checked_sub(least).is_none_or(|apart| apart > DELAY_SPREAD_MAX_TICKS) {
                return Err(format!(
                    "{reason:?}: after {least} to {most} ticks, not more than {DELAY_SPREAD_MAX_TICKS} apart"
                ));
            }
        }
        for (what, obeyed, off) in
            [("height", &self.heights, HEIGHT_TOLERANCE_M), ("speed", &self.speeds, SPEED_TOLERANCE_M_PER_S)]
        {
            for ParameterEffect { chosen, found: (least, most), .. } in obeyed {
                let chosen = f64::from(*chosen);
                if !(chosen - off..=chosen + off).contains(least) || !(chosen - off..=chosen + off).contains(most) {
                    return Err(format!("{what}: {chosen} chosen, {least:.3} to {most:.3} found"));
                }
            }
        }
        let (Some(first), Some(last)) = (self.hours.first(), self.hours.last()) else {
            return Err("no hour was flown".to_owned());
        };
        for (what, first, last) in [("hover", first.hover, last.hover), ("estimate", first.estimate, last.estimate)] {
            let is_alike = (1.0 - HOUR_DIFFERENCE_MAX..=1.0 + HOUR_DIFFERENCE_MAX).contains(&(last / first));
            if !is_alike {
                return Err(format!("{what}: RMS {first} m in the first hour, {last} m in the last"));
            }
        }
        Ok(())
    }
}
