//! V_1, eq. (LyapunovFunctionV), of the position loop.

use super::{PERIOD_S, configuration, hover};
use crate::support::oracle::Law;
use crate::support::random::{self, ChaCha8Rng};
use controller_core::controller::{Controller, Memory};
use controller_core::position::FilterState;
use controller_core::state::State;
use nalgebra::{Quaternion, Vector3};

/// Where the position loop is: p~, v~, u_f, u_s.
#[derive(Clone, Copy)]
pub struct Translation(pub [Vector3<f64>; 4]);

impl Translation {
    /// p~' = v~, v~' = u_f and the filters, at feedback ubar_p.
    pub fn flow(&self, law: &Law, feedback: Vector3<f64>) -> [Vector3<f64>; 4] {
        let [_, v, u_f, u_s] = self.0;
        [v, u_f, -law.k_f * (u_f - u_s), -law.k_s * (u_s - feedback)]
    }

    /// z_1 and z_2; linear, so it takes derivatives to derivatives.
    pub fn z(law: &Law, [p, v, u_f, u_s]: [Vector3<f64>; 4]) -> [Vector3<f64>; 2] {
        let z_1 = p + (1.0 / law.k_f + 1.0 / law.k_s) * v + u_f / (law.k_s * law.k_f);
        [z_1, v + u_f / law.k_f + u_s / law.k_s]
    }

    /// V_1, eq. (LyapunovFunctionV).
    pub fn v_1(&self, law: &Law) -> f64 {
        let [z_1, z_2] = Self::z(law, self.0);
        let [_, _, u_f, u_s] = self.0;
        // The integral of M tanh(x / M) is M^2 ln cosh(x / M).
        let integral = |x: Vector3<f64>| {
            let ln_cosh = |x: f64| x.abs() + (-2.0 * x.abs()).exp().ln_1p() - std::f64::consts::LN_2;
            law.m_p * law.m_p * x.map(|x| ln_cosh(x / law.m_p)).sum()
        };
        let v_p = law.k_p * z_2.norm_squared() + integral(law.k_p * z_1 + law.k_v * z_2) + integral(law.k_p * z_1);
        v_p / law.k_v + 0.5 * (u_f.norm_squared() / law.k_f + u_s.norm_squared() / law.k_s)
    }

    /// dV_1/dt at feedback ubar_p: gradient times flow.
    pub fn v_1_dot(&self, law: &Law, feedback: Vector3<f64>) -> f64 {
        let flow = self.flow(law, feedback);
        let ([z_1, z_2], [z_1_dot, z_2_dot]) = (Self::z(law, self.0), Self::z(law, flow));
        let outer = law.saturate(law.k_p * z_1 + law.k_v * z_2);
        let inner = law.saturate(law.k_p * z_1);
        let by_z_1 = law.k_p * (outer + inner) / law.k_v;
        let by_z_2 = (2.0 * law.k_p * z_2 + law.k_v * outer) / law.k_v;
        let by_filters = self.0[2].dot(&flow[2]) / law.k_f + self.0[3].dot(&flow[3]) / law.k_s;
        by_z_1.dot(&z_1_dot) + by_z_2.dot(&z_2_dot) + by_filters
    }

    /// What the core is given so that it sees these errors: the reference is at the origin.
    pub fn tick(&self, controller: &mut Controller) -> Vector3<f64> {
        let [p, v, u_f, u_s] = self.0.map(|v| v.cast::<f32>());
        let filter = FilterState { filtered: u_f, intermediate: u_s };
        controller.restore(Memory { filter, ..controller.memory() });
        let upright = Quaternion::identity();
        let state = State { position: p, velocity: v, attitude: upright, angular_velocity: Vector3::zeros() };
        controller.step(&state, &hover()).unwrap().1.feedback.cast()
    }
}

/// Random z of any size from a millimetre to `greatest`, filter states anywhere in their box, as single precision has
/// it.
pub fn random_translation(rng: &mut ChaCha8Rng, law: &Law, greatest: f32) -> Translation {
    let level = law.m_p as f32;
    let (u_f, u_s) = (random::in_box(rng, level).cast::<f64>(), random::in_box(rng, level).cast::<f64>());
    let mut size = || random::log_uniform(rng, 1e-3, greatest);
    let sizes = [size(), size()];
    let [z_1, z_2] = sizes.map(|size| random::vector(rng, size).cast::<f64>());
    let v = z_2 - u_f / law.k_f - u_s / law.k_s;
    let p = z_1 - (1.0 / law.k_f + 1.0 / law.k_s) * v - u_f / (law.k_s * law.k_f);
    let rounded = |v: Vector3<f64>| v.cast::<f32>().cast();
    Translation([rounded(p), rounded(v), u_f, u_s])
}

#[test]
fn v_1_falls_at_any_z_and_filter_states() {
    let mut rng = random::generator(70);
    for number in 0..40_000 {
        let (vehicle, gains) = configuration(&mut rng, number);
        let law = Law::new(&vehicle, &gains);
        let x = random_translation(&mut rng, &law, 1e3);
        let [z_1, z_2] = Translation::z(&law, x.0);
        let exact = x.v_1_dot(&law, -law.saturate(law.k_p * z_1 + law.k_v * z_2));
        assert!(exact < 0.0, "case {number}: dV_1/dt = {exact:e} at z_1 {z_1}, z_2 {z_2}");
        // The same with the core's own feedback, whose rounding moves dV_1/dt by as much as it moves ubar_p.
        let core = x.tick(&mut Controller::uncertified(vehicle, gains, None, PERIOD_S as f32).unwrap());
        let rounding = (core + law.saturate(law.k_p * z_1 + law.k_v * z_2)).norm();
        let moved = x.v_1_dot(&law, core);
        assert!(moved < 0.0, "case {number}: dV_1/dt = {moved:e} with the core's feedback, {rounding:e} m/s^2 off");
    }
}
