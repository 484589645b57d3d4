//! The eigenvalues tell how fast the law itself brings a rigid body back.

use super::*;
use crate::Scenario;
use crate::rotor_loss::relaxed_hover::RelaxedHover;
use std::collections::VecDeque;

const HUMMINGBIRD: &str = include_str!("../../../../vehicles/hummingbird.toml");
const CRAZYFLIE: &str = include_str!("../../../../vehicles/published/cf2x-pybullet.toml");

/// The plant's steps in a tick.
const TICK_STEPS: usize = 100;

/// A body that turns at a steady omega_3, with its torque about x and y.
struct Body {
    attitude: UnitQuaternion<f64>,
    omega: Vector3<f64>,
    torque: Vector2<f64>,
    coming: VecDeque<Vector2<f64>>,
}

impl Body {
    fn turning(axis: &Vector3<f64>, rate: f64, holding: Vector2<f64>, delay: usize) -> Self {
        let attitude = UnitQuaternion::rotation_between(axis, &Vector3::z()).unwrap();
        Self { attitude, omega: axis * rate, torque: holding, coming: vec![holding; delay].into() }
    }

    /// A tick of the law and its period, s, in `TICK_STEPS`.
    fn tick(&mut self, law: &WithoutARotor, vehicle: &Vehicle, timing: &LoopTiming) {
        let step = timing.period / TICK_STEPS as f64;
        let under_way = self.coming.iter().sum::<Vector2<f64>>() * step;
        let pending = (self.torque * timing.rotor_lag + under_way).map(|x| x as f32);
        let attitude = Quaternion::from(self.attitude.coords.map(|x| x as f32));
        let pending = Vector4::new(0.0, pending.x, pending.y, 0.0);
        let command = law.clone().stepped(attitude, self.omega.map(|x| x as f32), &pending).0.map(f64::from).xy();
        let inertia = vehicle.inertia.map(f64::from);
        for _ in 0..TICK_STEPS {
            self.coming.push_back(command);
            let acting = self.coming.pop_front().unwrap();
            self.torque = acting + (self.torque - acting) * (-step / timing.rotor_lag).exp();
            let gyroscopic = self.omega.cross(&inertia.component_mul(&self.omega)).xy();
            let turned = (self.torque - gyroscopic).component_div(&inertia.xy()) * step;
            self.omega += turned.push(0.0);
            self.attitude *= UnitQuaternion::from_scaled_axis((self.omega - turned.push(0.0) * 0.5) * step);
        }
    }
}

/// By how much the difference of two motions of `text` shrinks in a tick, and the spectral radius.
fn shrinking(text: &str, delay: usize, rate: Option<f64>) -> (f64, f64) {
    let scenario = Scenario::parse(text, "f").unwrap();
    let configuration = &scenario.configuration;
    let (vehicle, period) = (configuration.vehicle(), scenario.timing.period());
    let timing = LoopTiming { period, rotor_lag: scenario.rotor_lag, delay_samples: delay as f64 / TICK_STEPS as f64 };
    let law = WithoutARotor::new(configuration, 0, period as f32).unwrap();
    let axis = law.axis();
    let drag = scenario.reality.drag.unwrap_or_default();
    let relaxed = || RelaxedHover::new(vehicle, configuration.rotors().unwrap(), &drag, 0, &axis).unwrap().rate;
    let rate = rate.unwrap_or_else(relaxed);
    let inertia = vehicle.inertia.map(f64::from);
    let omega = axis * rate;
    let holding = omega.cross(&inertia.component_mul(&omega)).xy();
    let mut pair = [0.0, 0.01].map(|off| {
        let mut body = Body::turning(&axis, rate, holding, delay);
        body.attitude *= UnitQuaternion::from_scaled_axis(Vector3::x() * off);
        body
    });
    let mut apart = Vec::new();
    for _ in 0..60 {
        for body in &mut pair {
            body.tick(&law, vehicle, &timing);
        }
        let eta = pair.each_ref().map(|body| body.attitude.inverse() * Vector3::z());
        let energy = (eta[1] - eta[0]).norm_squared() + (pair[1].omega - pair[0].omega).norm_squared() / 400.0;
        apart.push(energy.sqrt());
    }
    ((apart[39] / apart[9]).powf(1.0 / 30.0), radius(&law, rate, vehicle, &timing))
}

#[test]
fn the_law_itself_brings_a_body_back_as_fast() {
    for (text, delay, rate) in [(HUMMINGBIRD, 0, None), (HUMMINGBIRD, 0, Some(-5.0)), (CRAZYFLIE, 0, Some(-20.0))] {
        let (flown, radius) = shrinking(text, delay, rate);
        assert!((flown - radius).abs() < 0.02, "{rate:?}: flown {flown}, radius {radius}");
    }
    // Commands that come later than the law looks ahead.
    let [(_, prompt), (flown, late)] = [0, 250].map(|delay| shrinking(HUMMINGBIRD, delay, None));
    assert!((flown - late).abs() < 0.02 && late > prompt + 0.02, "flown {flown}, radius {late}; {prompt}");
}

#[test]
fn without_drag_a_crazyflie_turns_too_fast_for_its_ticks() {
    let (flown, radius) = shrinking(CRAZYFLIE, 0, None);
    assert!(radius > 1.1 && flown > 1.0, "flown {flown}, radius {radius}");
}
