//! The law near the origin, one axis at a time, as a linear system in samples.
//!
//! Everything is divided by what turns the actuator's command into the first derivative of the chain, so no inertia or
//! mass is left; and time is counted in periods h, so a gain per second is multiplied by h. With y_m the
//! m-th integral of the actual command a (see [`super::lag`]):
//!
//! | axis | a | y_1 | y_2 | y_3 | y_4 | u_f, u_s (c, x), d |
//! |---|---|---|---|---|---|---|
//! | attitude about body axis i | tau_i / J_i | body rate | angle | | | |
//! | vertical | thrust / m - g | velocity | position | | | as they are; of the extended law y alone |
//! | lateral | tau_i / J_i | body rate | tilt | velocity / g | position / g | divided by g |
//!
//! Slopes at the origin: every saturation has slope one, the MRP of a small angle is angle / 4 and (1 + |theta|^2) / 4
//! is 1/4. Hence tau_i / J_i = -A angle~ - B rate~ + omega_d' with A = k_theta / (16 J_i) and B = k_omega / J_i under
//! the paper's law; laterally the desired tilt is u_f, with omega_d and omega_d' its derivatives. The extended law sees
//! the attitude's errors projected over the lag and delay of its actuators, T: angle~ + T rate~, and rate~ + (what is
//! under way + T bias) - T omega_d' of the last tick.
//!
//! Where the velocity comes from the positions, by an alpha-beta filter with a double pole ([`Tracker`]), the law sees
//! the filter's.
//!
//! [`Law::tick`] is one tick in the flight code's order, estimates first; the matrices are its columns.

use super::compensator::Compensator;
use super::gains::{EstimateGains, LateGains, PositionGains, TorqueGains};
use super::lag::{Arrival, INTEGRATORS_MAX};

/// An axis, with the gains of the laws that act along it.
#[derive(Debug, Clone, Copy)]
enum Chain {
    Attitude(TorqueGains),
    Vertical(PositionGains),
    Lateral(PositionGains, TorqueGains),
}

/// An alpha-beta filter with the double pole rho: x += v; then, with r = position - x, x += (1 - rho^2) r and v += (1 -
/// rho)^2 r.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tracker {
    position: f64,
    velocity: f64,
}

impl Tracker {
    /// The filter of this bandwidth, times the period.
    pub fn new(bandwidth: f64) -> Self {
        let pole = (-bandwidth).exp();
        Self { position: 1.0 - pole * pole, velocity: (1.0 - pole) * (1.0 - pole) }
    }
}

/// The law for one axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Law {
    chain: Chain,
    estimates: EstimateGains,
    /// The law's model of its actuator.
    actuator: Arrival,
    /// Where the velocity comes from, if it is not known.
    tracker: Option<Tracker>,
}

/// What comes to the law's own results in a tick.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Added {
    /// To ubar.
    pub feedback: f64,
    /// To the command.
    pub command: f64,
    /// To the force that the last interval shows.
    pub force: f64,
    /// To what moves the vehicle in the next interval without being seen by the force's estimate.
    pub unseen: f64,
    /// To the desired tilt's acceleration, which the command has as well.
    pub bend: f64,
    /// To the torque bias that the next interval shows.
    pub bias: f64,
}

/// What goes through the law in a tick; zero where an axis has no such thing.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Signals {
    /// z_1 and z_2.
    pub errors: [f64; 2],
    /// d.
    pub force: f64,
    /// u_f (c) and its derivatives; along the extended law's vertical y after its step, and the step.
    pub desired: [f64; 3],
    /// The attitude's errors, projected: angle and rate.
    pub projected: [f64; 2],
    /// The torque bias.
    pub bias: f64,
    /// w.
    pub command: f64,
}

/// What the law remembers of an axis. An average of differences from tick to tick, x += share (now + past - x), is
/// remembered as (1 - share) x + share past, to which the next tick adds share now.
#[derive(Debug, Clone, Default)]
struct Memory {
    /// The tracker's x and v.
    tracked: f64,
    speed: f64,
    /// u_f.
    filtered: f64,
    /// u_s.
    intermediate: f64,
    /// y, of the extended law.
    smoothed: f64,
    /// Of zeta, such an average.
    average: f64,
    /// omega_d' of the last tick.
    desired_acceleration: f64,
    /// Of the torque bias, such an average.
    torque: f64,
    /// The acting part of the command.
    acting: f64,
    /// Commands, the newest first.
    commanded: Vec<f64>,
}

impl Law {
    /// The attitude law about one axis, its reference at rest.
    pub fn attitude(torque: TorqueGains, estimates: EstimateGains, actuator: Arrival) -> Self {
        let estimates = EstimateGains { force: None, ..estimates };
        Self { chain: Chain::Attitude(torque), estimates, actuator, tracker: None }
    }

    /// The position law along the thrust.
    pub fn vertical(position: PositionGains, estimates: EstimateGains, actuator: Arrival) -> Self {
        let estimates = EstimateGains { torque: None, late: LateGains::default(), ..estimates };
        Self { chain: Chain::Vertical(position), estimates, actuator, tracker: None }
    }

    /// The position law across the thrust, realised by tilting through the attitude law.
    pub fn lateral(position: PositionGains, torque: TorqueGains, estimates: EstimateGains, actuator: Arrival) -> Self {
        Self { chain: Chain::Lateral(position, torque), estimates, actuator, tracker: None }
    }

    /// The same with the velocity from `tracker`; the attitude's loops have none.
    pub fn tracking(self, tracker: Option<Tracker>) -> Self {
        Self { tracker, ..self }
    }

    /// Number of integrators behind the actuator; y_m beyond it do not exist.
    pub fn integrators(&self) -> usize {
        match self.chain {
            Chain::Attitude(_) | Chain::Vertical(_) => 2,
            Chain::Lateral(..) => INTEGRATORS_MAX,
        }
    }

    /// The gains of its position law, if it has one.
    pub fn position(&self) -> Option<&PositionGains> {
        match &self.chain {
            Chain::Attitude(_) => None,
            Chain::Vertical(gains) | Chain::Lateral(gains, _) => Some(gains),
        }
    }

    /// The law as matrices.
    pub fn compensator(&self) -> Compensator {
        Compensator::from_tick(self.size(), |states, measured| {
            self.tick_of_states(states, measured, &Added::default()).command
        })
    }

    /// The number of its states.
    pub fn size(&self) -> usize {
        self.used(&mut self.fresh()).len()
    }

    /// One tick of the states.
    pub fn tick_of_states(&self, states: &mut [f64], measured: &[f64; INTEGRATORS_MAX], added: &Added) -> Signals {
        let mut memory = self.fresh();
        for (place, state) in self.used(&mut memory).into_iter().zip(states.iter()) {
            *place = *state;
        }
        let signals = self.tick(&mut memory, measured, added);
        for (state, place) in states.iter_mut().zip(self.used(&mut memory)) {
            *state = *place;
        }
        signals
    }

    fn fresh(&self) -> Memory {
        Memory { commanded: vec![0.0; self.actuator.earlier_commands()], ..Memory::default() }
    }

    /// The part of the memory that this law has.
    fn used<'a>(&self, memory: &'a mut Memory) -> Vec<&'a mut f64> {
        let EstimateGains { force, torque, late } = &self.estimates;
        let mut used = Vec::new();
        if !matches!(self.chain, Chain::Attitude(_)) {
            let smooths =
                matches!(&self.chain, Chain::Vertical(gains) | Chain::Lateral(gains, _) if gains.k_d.is_some());
            // The extended law's thrust takes y at once.
            if !(smooths && matches!(self.chain, Chain::Vertical(_))) {
                used.extend([&mut memory.filtered, &mut memory.intermediate]);
            }
            if smooths {
                used.push(&mut memory.smoothed);
            }
            if self.tracker.is_some() {
                used.extend([&mut memory.tracked, &mut memory.speed]);
            }
        }
        let projects = late.time() > 0.0;
        if matches!(self.chain, Chain::Lateral(..)) && projects {
            used.push(&mut memory.desired_acceleration);
        }
        if force.is_some() {
            used.push(&mut memory.average);
        }
        if torque.is_some() {
            used.push(&mut memory.torque);
        }
        // Across, the force is observed beside the thrust's direction, which is measured.
        let thrust_observed = matches!(self.chain, Chain::Vertical(_)) && force.is_some();
        if torque.is_some() || thrust_observed || projects {
            used.push(&mut memory.acting);
            used.extend(&mut memory.commanded);
        }
        used
    }

    /// One tick: the command for `measured`, and what leads to it; the memory as it is at the next tick.
    fn tick(&self, memory: &mut Memory, measured: &[f64; INTEGRATORS_MAX], added: &Added) -> Signals {
        let EstimateGains { force, torque: bias, late } = &self.estimates;
        let share = force.map_or(0.0, |force| force.averaging);
        let bias_share = bias.unwrap_or(0.0);
        match &self.chain {
            Chain::Attitude(torque) => {
                let [rate, angle, ..] = *measured;
                let bias = memory.torque + bias_share * rate;
                let projected = [angle + late.time() * rate, rate + self.pending(memory) + late.time() * bias];
                let command = torque.feedback(projected) - bias + added.command;
                memory.torque = averaged(bias, bias_share, -rate - self.acted(memory, command));
                Signals { projected, bias, command, ..Signals::default() }
            }
            Chain::Vertical(position) => {
                let [velocity, height, ..] = *measured;
                let velocity = self.tracked(memory, velocity, height);
                let force = memory.average + share * (velocity + added.force);
                let Feedback { errors, desired } = match position.k_d {
                    Some(k_d) => at_once(position, k_d, memory, [height, velocity], force, added),
                    None => filters(position, memory, [height, velocity], force, added),
                };
                let command = desired[0] + added.command;
                let past = -velocity - self.acted(memory, command);
                memory.average = averaged(force, share, past - added.unseen);
                Signals { errors, force, desired, command, ..Signals::default() }
            }
            Chain::Lateral(position, torque) => {
                let [rate, tilt, velocity, place] = *measured;
                let velocity = self.tracked(memory, velocity, place);
                let half_drag = force.map_or(0.0, |force| 0.5 * force.drag);
                let force = memory.average + share * (velocity * (1.0 + half_drag) - 0.5 * tilt + added.force);
                let bias = memory.torque + bias_share * rate;
                let Feedback { errors, desired } = filters(position, memory, [place, velocity], force, added);
                let [lean, leaning, bend] = desired;
                let forward = bend + added.bend;
                let (angle_error, rate_error) = (tilt - lean, rate - leaning);
                let projected = [
                    angle_error + late.time() * rate_error,
                    rate_error + self.pending(memory) + late.time() * (bias - memory.desired_acceleration),
                ];
                let command = forward + torque.feedback(projected) - bias + added.command;
                memory.desired_acceleration = forward;
                memory.average = averaged(force, share, velocity * (half_drag - 1.0) - 0.5 * tilt - added.unseen);
                memory.torque =
                    averaged(bias, bias_share, -rate - self.acted(memory, command)) + bias_share * added.bias;
                Signals { errors, force, desired, projected, bias, command }
            }
        }
    }

    /// The rate that past commands will still deliver.
    fn pending(&self, memory: &Memory) -> f64 {
        let LateGains { lag, whole_delay, broken_delay } = self.estimates.late;
        let commanded = |age: usize| memory.commanded.get(age).copied().unwrap_or(0.0);
        let whole: f64 = (0..whole_delay).map(commanded).sum();
        lag * memory.acting + whole + broken_delay * commanded(whole_delay)
    }

    /// The measured velocity that the law gets.
    fn tracked(&self, memory: &mut Memory, velocity: f64, position: f64) -> f64 {
        let Some(tracker) = &self.tracker else {
            return velocity;
        };
        let predicted = memory.tracked + memory.speed;
        let residual = position - predicted;
        memory.tracked = predicted + tracker.position * residual;
        memory.speed += tracker.velocity * residual;
        memory.speed
    }

    /// The law's mean of the acting command until the next tick, `command` being given.
    fn acted(&self, memory: &mut Memory, command: f64) -> f64 {
        let Arrival { whole_delay, free, newer, older } = &self.actuator;
        let commanded =
            |age: usize| if age == 0 { command } else { memory.commanded.get(age - 1).copied().unwrap_or(0.0) };
        let (new, old) = (commanded(*whole_delay), commanded(whole_delay + 1));
        let [acting, mean] = [0, 1].map(|m| free[m] * memory.acting + newer[m] * new + older[m] * old);
        memory.acting = acting;
        if let Some(oldest) = memory.commanded.last_mut() {
            *oldest = command;
            memory.commanded.rotate_right(1);
        }
        mean
    }
}

/// The memory of an average x: (1 - share) x + share past.
fn averaged(x: f64, share: f64, past: f64) -> f64 {
    x + share * (past - x)
}

/// What the position law makes of a position, m, and a velocity.
struct Feedback {
    /// z_1 and z_2.
    errors: [f64; 2],
    /// Its output and the output's derivatives, per sample.
    desired: [f64; 3],
}

/// y after its step, against the force d: the extended law's thrust along the vertical.
fn at_once(
    gains: &PositionGains,
    k_d: f64,
    memory: &mut Memory,
    [position, velocity]: [f64; 2],
    force: f64,
    added: &Added,
) -> Feedback {
    let y = memory.smoothed;
    let errors = [position + velocity / k_d, velocity + (y + force) / k_d];
    let ubar = gains.feedback(errors) - force + added.feedback;
    memory.smoothed = y - (-k_d).exp_m1() * (ubar - y);
    Feedback { errors, desired: [memory.smoothed, memory.smoothed - y, 0.0] }
}

/// u_f as it stands, with its derivatives, against the force d; then the filters advance, ubar or the drive held.
fn filters(
    gains: &PositionGains,
    memory: &mut Memory,
    [position, velocity]: [f64; 2],
    force: f64,
    added: &Added,
) -> Feedback {
    let PositionGains { k_f, k_s, k_d, .. } = *gains;
    let (u_f, u_s, y) = (memory.filtered, memory.intermediate, memory.smoothed);
    let (c, x, last) = (1.0 / k_f, 1.0 / k_s, k_d.map_or(0.0, |k_d| 1.0 / k_d));
    let z_1 = position + (c + x + last) * velocity + (x + last) * c * (u_f + force) + x * last * (u_s + force);
    let z_2 = velocity + c * (u_f + force) + x * (u_s + force) + last * (y + force);
    let errors = [z_1, z_2];
    let ubar = gains.feedback(errors) - force + added.feedback;
    let rate = k_f * (u_s - u_f);
    let (keep_filtered, keep_intermediate) = ((-k_f).exp(), (-k_s).exp());
    if let Some(k_d) = k_d {
        memory.smoothed = y - (-k_d).exp_m1() * (ubar - y);
        let drive = (1.0 - keep_intermediate) * (memory.smoothed - u_s);
        memory.filtered = u_f + (1.0 - keep_filtered) * (u_s - u_f) + (1.0 - (1.0 - keep_filtered) / k_f) * drive;
        memory.intermediate = u_s + drive;
        return Feedback { errors, desired: [u_f, rate, k_f * (drive - rate)] };
    }
    // k_f (e^-k_f - e^-k_s) / (k_s - k_f), from the slower exponential so that nothing overflows.
    let spread = (k_s - k_f).abs();
    let mean = if spread > 0.0 { -(-spread).exp_m1() / spread } else { 1.0 };
    let mixed = k_f * (-k_f.min(k_s)).exp() * mean;
    memory.filtered = keep_filtered * u_f + mixed * u_s + (1.0 - keep_filtered - mixed) * ubar;
    memory.intermediate = keep_intermediate * u_s + (1.0 - keep_intermediate) * ubar;
    Feedback { errors, desired: [u_f, rate, k_f * (k_s * (ubar - u_s) - rate)] }
}

#[cfg(test)]
mod tests;
