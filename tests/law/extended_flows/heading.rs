//! The heading's energy of section 5, 1/2 e^2 + the integral of psi_0(c_2 v(mu)) d mu: it never rises, whatever yaw
//! gets, as long as the reference's own torque is within that.

use crate::support::extended::{law, random_configuration};
use crate::support::random;
use controller_core::extended::heading::HeadingLaw;
use nalgebra::Vector3;
use rand::RngExt;

/// One heading: its error chi, and e = omega_3 - w_3.
struct Loop {
    law: HeadingLaw,
    /// J_3, kg m^2.
    inertia: f64,
    /// What yaw may command, N m; the torque that acts besides, N m; the reference's acceleration, rad/s^2.
    ends: [f64; 2],
    bias: f64,
    ahead: f64,
}

impl Loop {
    /// -psi_0(c_2 (e + v(chi))): e' under the core's torque, cut.
    fn change(&self, chi: f64, e: f64) -> f64 {
        let [least, most] = self.ends;
        let psi = 2.0 * (0.5 * chi).sin();
        let room = most.min(-least) as f32;
        let torque = self.law.torque(psi as f32, e as f32, self.ahead as f32, &Vector3::zeros(), room);
        ((f64::from(torque) - self.bias).clamp(least, most) + self.bias) / self.inertia - self.ahead
    }

    fn energy(&self, chi: f64, e: f64) -> f64 {
        let steps = 2_000;
        let width = chi / f64::from(steps);
        let middle = |i: i32| -self.change((f64::from(i) + 0.5) * width, 0.0) * width;
        0.5 * e * e + (0..steps).map(middle).sum::<f64>()
    }
}

#[test]
fn the_headings_energy_never_rises_whatever_yaw_gets_and_the_heading_arrives() {
    let mut rng = random::generator(321);
    let mut cut = 0;
    let mut number = 0;
    while number < 60 {
        let configuration = random_configuration(&mut rng);
        let (p, inertia) = (law(&configuration).parameters, configuration.vehicle().inertia);
        // A weaker yaw takes minutes to stop.
        if p.yaw_acceleration < 0.5 {
            continue;
        }
        number += 1;
        let always = f64::from(inertia.z * p.yaw_acceleration);
        let [below, above] = [(); 2].map(|()| always * f64::from(random::log_uniform(&mut rng, 1.0, 5.0)));
        let bias = rng.random_range(-0.9..0.9) * below.min(above);
        let (least, most) = (-below + bias, above + bias);
        let ahead = rng.random_range(0.7 * least..0.7 * most) / f64::from(inertia.z);
        let flying =
            Loop { law: HeadingLaw::new(&p, &inertia), inertia: inertia.z.into(), ends: [-below, above], bias, ahead };
        let (mut chi, mut e) = (rng.random_range(-3.1..3.1_f64), rng.random_range(-3.0..3.0_f64));
        let mut energy = flying.energy(chi, e);
        let first = energy;
        let h = 1e-3;
        for tick in 0..100_000 {
            let a = (e, flying.change(chi, e));
            let b = (e + 0.5 * h * a.1, flying.change(chi + 0.5 * h * a.0, e + 0.5 * h * a.1));
            let c = (e + 0.5 * h * b.1, flying.change(chi + 0.5 * h * b.0, e + 0.5 * h * b.1));
            let d = (e + h * c.1, flying.change(chi + h * c.0, e + h * c.1));
            chi += h / 6.0 * (a.0 + 2.0 * b.0 + 2.0 * c.0 + d.0);
            e += h / 6.0 * (a.1 + 2.0 * b.1 + 2.0 * c.1 + d.1);
            if tick % 200 == 0 {
                let next = flying.energy(chi, e);
                assert!(next <= energy + 1e-5 * first, "{number}: from {energy:e} to {next:e} at {tick}");
                energy = next;
                let [least, most] = flying.ends;
                let torque = f64::from(inertia.z) * (a.1 + flying.ahead) - flying.bias;
                cut += u32::from(torque <= least || torque >= most);
            }
        }
        // The lift takes the next whole turn.
        assert!((chi / 2.0).sin().abs() < 1e-3 && e.abs() < 1e-3, "{number}: {chi} {e}");
    }
    println!("cut in {cut} of 30000");
    assert!(cut > 100, "{cut}");
}
