//! Section 10: the part of past commands that the actuators still carry out.

use super::double;
use nalgebra::Vector4;

/// What was commanded, through delay and lag, in pieces between the moments at which the command that acts changes.
pub struct Acting {
    lag: f64,
    /// In periods.
    delay: f64,
    period: f64,
    wrench: Vector4<f64>,
    /// The newest last.
    commands: Vec<Vector4<f64>>,
}

impl Acting {
    /// With `wrench` commanded for ever.
    pub fn new(lag: f32, delay: f32, period: f32, wrench: Vector4<f64>) -> Self {
        let period = double(period);
        Self { lag: double(lag), delay: double(delay) / period, period, wrench, commands: vec![wrench; 8] }
    }

    /// How many whole periods a command is late, and for how long after a tick the one before it still acts, s.
    fn late(&self) -> (usize, f64) {
        let whole = self.delay.floor();
        (whole as usize, (self.delay - whole) * self.period)
    }

    fn command(&self, age: usize) -> Vector4<f64> {
        self.commands[self.commands.len() - 1 - age]
    }

    /// A period with `command` given at its start; the mean over it.
    pub fn advance(&mut self, command: Vector4<f64>) -> Vector4<f64> {
        self.commands.push(command);
        let (whole, late) = self.late();
        let mut sum = Vector4::zeros();
        for (duration, command) in [(late, self.command(whole + 1)), (self.period - late, self.command(whole))] {
            if self.lag > 0.0 {
                let left = (-duration / self.lag).exp();
                sum += command * duration + (self.wrench - command) * (self.lag * (1.0 - left));
                self.wrench = command + (self.wrench - command) * left;
            } else {
                sum += command * duration;
                self.wrench = command;
            }
        }
        sum / self.period
    }

    /// What it would still deliver if nothing were commanded from now on.
    pub fn pending(&self) -> Vector4<f64> {
        let (whole, late) = self.late();
        let waiting: Vector4<f64> = (0..whole).map(|age| self.command(age) * self.period).sum();
        self.wrench * self.lag + waiting + self.command(whole) * late
    }
}

/// What rotor speeds show beside the model of the commands, less the part of it that lasts; N and N m.
pub struct Speeds {
    lag: f64,
    period: f64,
    /// The greatest thrust and torque that count.
    greatest: [f64; 2],
    lasting: Option<Vector4<f64>>,
}

impl Speeds {
    /// Twice the greatest thrust counts, and that on an arm of 2 sqrt(J / m).
    pub fn new(lag: f32, period: f32, thrust_max: f32, radius: f64) -> Self {
        let thrust = 2.0 * double(thrust_max);
        Self { lag: double(lag), period: double(period), greatest: [thrust, thrust * radius], lasting: None }
    }

    /// The mean wrench and the pending impulse, corrected by what was `measured`; `held` estimates take nothing in.
    pub fn corrected(
        &mut self,
        measured: &Vector4<f64>,
        acted: &Vector4<f64>,
        pending: &Vector4<f64>,
        held: bool,
    ) -> [Vector4<f64>; 2] {
        let [thrust, torque] = self.greatest;
        let size = (measured.x / thrust).hypot(measured.fixed_rows::<3>(1).norm() / torque);
        if size.is_nan() || size >= 1.0 {
            return [*acted, *pending];
        }
        let lasting = self.lasting.unwrap_or(measured - acted);
        let beside = measured - acted - lasting;
        if !held {
            self.lasting = Some(lasting + beside * (1.0 - (-self.period).exp()));
        }
        [acted + beside, pending + beside * self.lag]
    }
}
