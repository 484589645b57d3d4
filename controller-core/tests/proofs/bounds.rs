//! What the filters reach and what follows by Lemma 1: `Reachable.v`, `Lemma1.v`, `SharpFlight.v`.

use super::{TRIALS, alike, as_f64, direction, near, signed};
use crate::support::Random;
use crate::support::coq::{Proofs, Value};
use crate::support::hummingbird;
use controller_core::certificate::printed;
use controller_core::certificate::reachable::{Reachable, half_l1_norm};
use controller_core::gains::Gains;
use controller_core::heading::Heading;
use controller_core::position::{CommandRates, FilterState, PositionLaw};
use controller_core::reference::{Reference, ReferenceBounds};
use controller_core::state::State;
use nalgebra::Vector3;

/// What the bounds are for: filters, gravity, and a reference.
#[derive(Clone, Copy)]
pub(super) struct Given {
    pub k_f: f64,
    pub k_s: f64,
    pub m_p: f64,
    pub gravity: f64,
    pub bounds: ReferenceBounds,
}

impl Given {
    /// That leave an upward thrust.
    pub fn random(random: &mut Random) -> Self {
        let bounds = ReferenceBounds {
            horizontal_speed: 5.0,
            horizontal_acceleration: random.within(0.0, 4.0) as f32,
            vertical_acceleration: random.within(0.0, 2.0) as f32,
            jerk: random.within(0.0, 8.0) as f32,
            snap: random.within(0.0, 20.0) as f32,
            heading_rate: random.within(0.0, 3.0) as f32,
            heading_second_derivative: random.within(0.0, 5.0) as f32,
        };
        let [k_f, k_s] = [0; 2].map(|_| random.magnitude(0.3, 30.0));
        Self { k_f, k_s, m_p: random.within(0.0, 5.0), gravity: 9.81, bounds }
    }

    pub fn reach(&self) -> Reachable {
        Reachable::new(self.k_f, self.k_s, self.m_p, self.gravity, &self.bounds)
    }

    /// Under the proofs' names.
    pub fn proofs(&self, file: &str) -> Proofs {
        let Self { k_f, k_s, m_p, gravity, bounds } = *self;
        Proofs::read(file).with(&[("k_f", k_f), ("k_s", k_s), ("M", m_p), ("g", gravity)]).with(&as_f64(&[
            ("K_12", bounds.horizontal_acceleration),
            ("K_3", bounds.vertical_acceleration),
            ("K_j", bounds.jerk),
            ("K_s", bounds.snap),
            ("K_nu_1", bounds.heading_rate),
            ("K_nu_2", bounds.heading_second_derivative),
        ]))
    }
}

/// A vector of which only what bounds it is looked at.
pub(super) fn bounded() -> Value {
    Value::record(&[("x", 0.0), ("y", 0.0), ("z", 0.0)])
}

#[test]
pub(super) fn what_the_filters_reach_is_that_of_the_proofs() {
    let mut random = Random(17);
    for trial in 0..TRIALS {
        let mut given = Given::random(&mut random);
        if trial % 10 == 0 {
            given.k_s = given.k_f;
        }
        let Given { k_f, k_s, bounds, .. } = given;
        let proofs = given.proofs("SharpFlight");
        alike(half_l1_norm(k_f, k_s), proofs.number("half_l1_norm", &[k_f, k_s]), "U_l");
        let reach = given.reach();
        let proofs = proofs
            .with(&[("t", 0.0)])
            .with_value("u", bounded().moving())
            .with_value("u_1", bounded().moving())
            .with_value("u_2", bounded());
        let [least, _] = proofs.sides("reachable", "<= z ( u t )")[..] else { panic!("two sides") };
        alike(reach.vertical_min, least, "u_z");
        for (found, standing) in [
            (reach.horizontal, "plane_length ( x ( u t ) ) ( y ( u t ) ) <="),
            (reach.jerk, "length ( u_1 t ) <= sqrt"),
            (reach.horizontal_jerk, "plane_length ( x ( u_1 t ) ) ( y ( u_1 t ) ) <="),
            (reach.vertical_jerk, "Rabs ( z ( u_1 t ) ) <="),
            (reach.horizontal_snap, "plane_length ( x u_2 ) ( y u_2 ) <="),
            (reach.vertical_snap, "Rabs ( z u_2 ) <="),
        ] {
            alike(found, proofs.sides("reachable", standing)[1], standing);
        }
        // Of one axis, without a reference.
        let [jerk, snap] = [bounds.jerk, bounds.snap].map(f64::from);
        let axis = proofs.with_value("u_f", Value::Number(0.0).moving()).with_value("u_s", Value::Number(0.0).moving());
        let axis = axis.with_value("ubar", Value::Number(0.0).moving()).with(&[("T", 0.0)]);
        alike(reach.vertical_jerk, axis.sides("jerk_of_an_axis", "<=")[1] + jerk, "u_f'");
        alike(reach.vertical_snap, axis.sides("snap_of_an_axis", "<= 2 * k_f")[1] + snap, "u_f''");
    }
}

#[test]
pub(super) fn the_command_and_its_derivatives_are_those_of_the_proofs() {
    let configuration = hummingbird::paper_law();
    let gains: Gains = *configuration.gains().unwrap();
    let law = PositionLaw::new(&gains, configuration.vehicle().gravity);
    let mut random = Random(18);
    for _ in 0..TRIALS {
        let [filtered, intermediate, feedback] = [0; 3].map(|_| direction(&mut random) * gains.m_p);
        let mut reference = Reference::resting(Vector3::zeros(), Heading::FORWARD);
        reference.acceleration = direction(&mut random);
        reference.jerk = direction(&mut random) * 3.0;
        reference.snap = direction(&mut random) * 5.0;
        let (still, filter) = (Vector3::zeros(), FilterState { filtered, intermediate });
        let attitude = nalgebra::Quaternion::identity();
        let state = State { position: still, velocity: still, attitude, angular_velocity: still };
        let found = law.command(&state, &reference, &filter).acceleration_command;
        let CommandRates { jerk_command, snap_command } = law.rates(&reference, &filter, &feedback);

        let space = |v: &Vector3<f32>| Value::record(&as_f64(&[("x", v.x), ("y", v.y), ("z", v.z)]));
        let proofs = Proofs::read("Lemma1")
            .with(&as_f64(&[
                ("k_f", gains.k_f),
                ("k_s", gains.k_s),
                ("g", configuration.vehicle().gravity),
                ("t", 0.0),
            ]))
            .with_value("u_f", space(&filtered).moving())
            .with_value("u_s", space(&intermediate).moving())
            .with_value("ubar", space(&feedback).moving())
            .with_value("a", space(&reference.acceleration).moving())
            .with_value("a_1", space(&reference.jerk).moving())
            .with_value("a_2", space(&reference.snap));
        let now = [Value::Number(signed(&mut random).into())];
        let proven = [proofs.value("command", &now), proofs.value("command_1", &now), proofs.value("command_2", &[])];
        for (found, proven) in [found, jerk_command, snap_command].iter().zip(proven) {
            let Value::Record(proven) = proven else { panic!("a vector") };
            for (found, axis) in found.iter().zip(["x", "y", "z"]) {
                near(*found, proven[axis].number(), 20.0, axis);
            }
        }
    }
}

#[test]
pub(super) fn lemma_1_is_that_of_the_proofs() {
    let inertia = hummingbird::vehicle().inertia.map(f64::from);
    let mut random = Random(19);
    for _ in 0..TRIALS {
        let given = Given::random(&mut random);
        let Given { k_f, k_s, m_p, gravity, bounds } = given;
        let found = printed::desired_rates(k_f, k_s, m_p, gravity, &bounds, &inertia);
        let proofs = given
            .proofs("Lemma1")
            .with(&[("t", 0.0)])
            .with_value("omega", bounded().moving())
            .with_value("omega_1", bounded());
        alike(found.angular_velocity, proofs.sides("lemma_1", "length ( omega t ) <=")[1], "U_omega");
        alike(found.angular_acceleration, proofs.sides("lemma_1", "length omega_1 <=")[1], "U_omega'");
    }
}
