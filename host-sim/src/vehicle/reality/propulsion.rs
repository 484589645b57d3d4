//! From the rotors' commanded thrusts to their speeds.
//!
//! The controller's model of a rotor that is to give f turns it at w_c = sqrt(f / k_eta); its motor command is u =
//! phi^-1(f / f_max) with the model's curve, w_c / w_max where that is a square. What a real one settles at, and how it
//! gets there:
//!
//! ```text
//! u >= u_0                                                  a motor that turns idles at least; zero stops it
//! u' = u V / V_0                                            a motor sees the command times the voltage
//! w_s = w_max sqrt(a u' + (1 - a) u'^2)                     thrust curve; a = 0: w_s = w_c V / V_0
//! w_s = sqrt(share) w_s                                     from the failure's time on, for the rotor that fails; or as told
//! w' = (w_s - w) / lag                                      first order; no lag: at once
//! w_c stays                                                 if a new one differs by less than deadband w_c
//! tau = J_r (sum s_i w_i' e3 + omega x e3 sum s_i w_i)      rotors as flywheels; s_i = 1 for a clockwise one
//! ```
//!
//! Thrust is k_eta w^2 and drag torque k_m w^2 ([`super::air`]). Speeds in rad/s, voltages in V, lag in s. The lag's
//! equation is linear with w_s held over a plant step, so the speeds are exact at the beginning, the middle and the end
//! of the step, as the body's method needs. It is the lag of `[rotors]`, which the body otherwise feels at the
//! middle of each step only.
//!
//! Sources: the first-order lag, R. Mahony, V. Kumar, P. Corke, *Multirotor Aerial Vehicles*, IEEE RAM 19(3), 2012; the
//! curve and the voltage, [`controller_core::allocation::curve`] and PX4's THR_MDL_FAC.
//!
//! Without rotors, thrust and torque are the wrench, clipped to the limits.

use super::battery::BatteryState;
use super::body::STAGE_TIMES;
use super::wind::first_step;
use controller_core::allocation::geometry::ROTORS_MAX;
use controller_core::allocation::{Motor, Rotor, Rotors, Spin, ThrustCurve};
use controller_core::configuration::Configuration;
use controller_core::state::Wrench;
use nalgebra::{Vector3, Vector4};
use scenario::reality::Reality;
use scenario::reality::failure::Failure;

/// The propulsion's action on the body at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Delivered {
    /// Thrust, N, and torque, N m, as commanded.
    Wrench {
        /// N.
        thrust: f64,
        /// N m, body.
        torque: Vector3<f64>,
    },
    /// The rotors' speeds, rad/s.
    Speeds([f64; ROTORS_MAX]),
}

/// A vehicle's rotors and their motors.
#[derive(Debug, Clone)]
struct Motors {
    rotors: Rotors,
    /// The share of a speed error that remains at each stage of a plant step.
    decay: [f64; 3],
    /// a: the model's, and the true one.
    linear: [f64; 2],
    /// The model's w_c of a motor that idles, rad/s.
    idling: [f64; ROTORS_MAX],
    /// w_c, rad/s.
    commands: [f64; ROTORS_MAX],
    /// w, rad/s.
    speeds: [f64; ROTORS_MAX],
    /// Mean of w' over the last plant step, rad/s^2.
    changes: [f64; ROTORS_MAX],
    /// J_r, kg m^2.
    inertia: f64,
    deadband: f64,
    /// With the plant step at which it happens.
    failure: Option<(Failure, u64)>,
    /// The share of its thrust that each rotor has left besides.
    left: [f64; ROTORS_MAX],
    battery: Option<BatteryState>,
}

/// A vehicle's propulsion.
#[derive(Debug, Clone)]
pub struct Propulsion {
    motors: Option<Motors>,
    /// Wrench that acts without rotors, and the limits it is clipped to.
    direct: (f64, Vector3<f64>),
    limits: (f64, Vector3<f64>),
    /// Plant step, s.
    step: f64,
}

impl Propulsion {
    /// The vehicle's, with the model's `motor`, at rest in its command to hover. `lag` and `step` in s.
    pub fn new(configuration: &Configuration, motor: Motor, lag: f64, reality: &Reality, step: f64) -> Self {
        let (vehicle, limits) = (configuration.vehicle(), configuration.limits());
        let hover = vehicle.mass * vehicle.gravity;
        Self {
            motors: configuration.rotors().map(|rotors| Motors::hovering(rotors, motor, hover, lag, reality, step)),
            direct: (f64::from(hover), Vector3::zeros()),
            limits: (f64::from(limits.thrust_max), limits.torque_max.map(f64::from)),
            step,
        }
    }

    /// Stops the rotors at once.
    pub fn stop(&mut self) {
        if let Some(motors) = &mut self.motors {
            (motors.commands, motors.speeds) = ([0.0; ROTORS_MAX], [0.0; ROTORS_MAX]);
        }
    }

    /// Leaves a rotor, counted from 0, this share of its thrust.
    pub fn weaken(&mut self, rotor: usize, thrust_left: f64) {
        if let Some(left) = self.motors.as_mut().and_then(|motors| motors.left.get_mut(rotor)) {
            *left = thrust_left;
        }
    }

    /// Asks each rotor for a thrust, N.
    pub fn command(&mut self, thrusts: &[f32]) {
        if let Some(motors) = &mut self.motors {
            let rotors = motors.rotors.iter().zip(&motors.idling);
            for ((command, (rotor, idling)), thrust) in motors.commands.iter_mut().zip(rotors).zip(thrusts) {
                let wanted = f64::from(rotor.speed_at(*thrust));
                let wanted = if *thrust > 0.0 { wanted.max(*idling) } else { wanted };
                if (wanted - *command).abs() >= motors.deadband * *command {
                    *command = wanted;
                }
            }
        }
    }

    /// Asks a vehicle without rotors for a wrench. Returns whether the limits cut it.
    pub fn command_directly(&mut self, wrench: &Wrench) -> bool {
        let commanded = (f64::from(wrench.thrust), wrench.torque.map(f64::from));
        let torque = commanded.1.zip_map(&self.limits.1, |value, limit| value.clamp(-limit, limit));
        self.direct = (commanded.0.clamp(0.0, self.limits.0), torque);
        self.direct != commanded
    }

    /// The speeds of this moment, rad/s; zero where there is no rotor.
    pub fn speeds(&self) -> [f64; ROTORS_MAX] {
        self.motors.as_ref().map_or([0.0; ROTORS_MAX], |motors| motors.speeds)
    }

    /// Voltage, V, and current, A, of the battery, if there is one.
    pub fn battery(&self) -> Option<(f64, f64)> {
        let battery = self.motors.as_ref()?.battery.as_ref()?;
        Some((battery.voltage(), battery.current()))
    }

    /// Thrust, N, and torque, N m, that the model has of what is `delivered`.
    pub fn as_modelled(&self, delivered: &Delivered) -> (f64, Vector3<f64>) {
        match delivered {
            Delivered::Wrench { thrust, torque } => (*thrust, *torque),
            Delivered::Speeds(speeds) => {
                self.motors.as_ref().map_or((0.0, Vector3::zeros()), |motors| motors.as_modelled(speeds))
            }
        }
    }

    /// The torque of rotors that turn as `delivered` and change their speeds as in the last step, N m, on a body that
    /// turns at `rate`, rad/s.
    pub fn spin(&self, delivered: &Delivered, rate: &Vector3<f64>) -> Vector3<f64> {
        match (delivered, &self.motors) {
            (Delivered::Speeds(speeds), Some(motors)) if motors.inertia > 0.0 => motors.spin(speeds, rate),
            _ => Vector3::zeros(),
        }
    }

    /// Advances by the plant step `now`; returns what drives the body at its beginning, middle and end.
    pub fn advance(&mut self, now: u64) -> [Delivered; 3] {
        let (thrust, torque) = self.direct;
        match &mut self.motors {
            None => [Delivered::Wrench { thrust, torque }; 3],
            Some(motors) => motors.advance(now, self.step),
        }
    }
}

impl Motors {
    fn hovering(rotors: &Rotors, motor: Motor, hover: f32, lag: f64, reality: &Reality, step: f64) -> Self {
        let mut commands = [0.0; ROTORS_MAX];
        let rows = rotors.pseudo_inverse();
        for ((command, rotor), row) in commands.iter_mut().zip(rotors.iter()).zip(rows) {
            *command = hovering_speed(rotor, row, hover);
        }
        let mut idling = [0.0; ROTORS_MAX];
        for (idling, rotor) in idling.iter_mut().zip(rotors.iter()) {
            let curve = ThrustCurve::new(rotor.thrust_max, motor).ok();
            *idling = f64::from(rotor.speed_at(curve.map_or(0.0, |curve| curve.thrust(motor.idle, 1.0))));
        }
        let modelled = f64::from(motor.linear);
        let truth = reality.truth.as_ref();
        let left = |time: f64| if lag > 0.0 { (-time * step / lag).exp() } else { f64::from(time == 0.0) };
        let mut motors = Self {
            rotors: rotors.clone(),
            decay: STAGE_TIMES.map(left),
            linear: [modelled, truth.and_then(|truth| truth.thrust_curve).unwrap_or(modelled)],
            idling,
            commands,
            speeds: commands,
            changes: [0.0; ROTORS_MAX],
            inertia: truth.map_or(0.0, |truth| truth.rotor_inertia),
            deadband: truth.map_or(0.0, |truth| truth.deadband),
            failure: reality.failure.map(|failure| (failure, first_step(failure.time, step))),
            left: [1.0; ROTORS_MAX],
            battery: reality.battery.map(|battery| BatteryState::new(&battery)),
        };
        motors.speeds = motors.settled(0);
        motors
    }

    /// The speeds that the commands lead to, rad/s, in the plant step `now`.
    fn settled(&self, now: u64) -> [f64; ROTORS_MAX] {
        let voltage = self.battery.as_ref().map_or(1.0, BatteryState::ratio);
        let mut settled = self.commands;
        for (speed, rotor) in settled.iter_mut().zip(self.rotors.iter()) {
            if self.linear == [0.0; 2] {
                *speed *= voltage;
            } else {
                let [modelled, linear] = self.linear;
                let greatest = f64::from(rotor.speed_at(rotor.thrust_max));
                let command = voltage * command_of(*speed / greatest, modelled);
                *speed = greatest * (linear * command + (1.0 - linear) * command * command).sqrt();
            }
        }
        if let Some((failed, _)) = self.failure.filter(|(_, first)| now >= *first)
            && let Some(speed) = settled.get_mut(failed.rotor)
        {
            *speed *= failed.thrust_left.sqrt();
        }
        for (speed, left) in settled.iter_mut().zip(self.left) {
            *speed *= left.sqrt();
        }
        settled
    }

    /// Thrust, N, and torque, N m, of rotors at these speeds, rad/s, as the model has them.
    fn as_modelled(&self, speeds: &[f64; ROTORS_MAX]) -> (f64, Vector3<f64>) {
        let rotors = self.rotors.iter().zip(self.rotors.effectiveness()).zip(speeds);
        rotors.fold((0.0, Vector3::zeros()), |(thrust, torque), ((rotor, column), speed)| {
            let force = f64::from(rotor.thrust_coefficient) * speed * speed;
            (thrust + force * column.x, torque + Vector3::new(column.y, column.z, column.w) * force)
        })
    }

    fn spin(&self, speeds: &[f64; ROTORS_MAX], rate: &Vector3<f64>) -> Vector3<f64> {
        let (mut turning, mut changing) = (0.0, 0.0);
        for ((rotor, speed), change) in self.rotors.iter().zip(speeds).zip(self.changes) {
            let sign = if rotor.spin == Spin::Clockwise { 1.0 } else { -1.0 };
            turning += sign * speed;
            changing += sign * change;
        }
        (Vector3::z() * changing + rate.cross(&Vector3::z()) * turning) * self.inertia
    }

    fn advance(&mut self, now: u64, step: f64) -> [Delivered; 3] {
        let settled = self.settled(now);
        let start = self.speeds;
        let at = |left: f64| {
            let mut speeds = settled;
            for (speed, from) in speeds.iter_mut().zip(start) {
                *speed += (from - *speed) * left;
            }
            speeds
        };
        // A rotor without lag is at its new speed from the beginning of the step on.
        let stages = if self.decay[1] == 0.0 { [settled; 3] } else { self.decay.map(at) };
        self.speeds = stages[2];
        self.changes = std::array::from_fn(|rotor| (stages[2][rotor] - start[rotor]) / step);
        let power = self.rotors.iter().zip(stages[1]).map(|(rotor, w)| f64::from(rotor.drag_coefficient) * w * w * w);
        if let Some(battery) = &mut self.battery {
            battery.draw(power.sum(), step);
        }
        stages.map(Delivered::Speeds)
    }
}

/// The command of a rotor that is to turn at this part of its greatest speed, with the curve's `linear` part.
fn command_of(speed: f64, linear: f64) -> f64 {
    let fraction = speed * speed;
    // Without a linear part, zero would be divided by zero.
    if linear > 0.0 {
        2.0 * fraction / (linear + (linear * linear + 4.0 * (1.0 - linear) * fraction).sqrt())
    } else {
        speed
    }
}

/// The model's speed of a rotor at hover, rad/s; `row` is its share of a wrench, `hover` N.
fn hovering_speed(rotor: &Rotor, row: &Vector4<f64>, hover: f32) -> f64 {
    let thrust = (row.x as f32 * hover).clamp(rotor.thrust_min, rotor.thrust_max);
    f64::from(rotor.speed_at(thrust))
}

#[cfg(test)]
mod tests;
