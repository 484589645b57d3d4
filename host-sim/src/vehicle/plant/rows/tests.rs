//! Rows against the plant that moves one body, to the bit, for every instruction set of this machine.

use super::*;
use crate::vehicle::plant::Plant;
use scenario::Scenario;
use scenario::body::attitude_from_euler;

/// This machine's instruction sets: plain instructions always.
fn processors() -> Vec<Arch> {
    #[cfg_attr(not(target_arch = "x86_64"), expect(unused_mut, reason = "nothing is added"))]
    let mut processors = vec![Arch::Scalar];
    #[cfg(target_arch = "x86_64")]
    {
        processors.extend(pulp::x86::V3::try_new().map(Arch::V3));
        processors.extend(pulp::x86::V4::try_new().map(Arch::V4));
    }
    processors
}

fn thrown(body: usize) -> (BodyState, f64, Vector3<f64>) {
    let x = body as f64;
    let state = BodyState {
        position: Vector3::new(x, -0.3 * x, 2.0),
        velocity: Vector3::new(0.4, 0.1 * x, -0.6),
        attitude: attitude_from_euler(0.4 * x, -0.9, 2.0 - x),
        angular_velocity: Vector3::new(6.0 - x, -4.0, 0.7 * x),
    };
    (state, 3.0 + 0.2 * x, Vector3::new(0.02, -0.001 * x, 0.01))
}

#[test]
fn bodies_in_rows_move_as_each_moves_alone_whatever_the_registers_and_their_number() {
    let paper = Scenario::paper().unwrap();
    let (vehicle, limits) = (paper.configuration.vehicle(), paper.configuration.limits());
    let body = Body::new(vehicle, limits, 5e-3);
    for processor in processors() {
        // None fills a register, some fill one, some are left over.
        for bodies in [0, 1, 2, 7, 8, 21] {
            let mut rows = Rows::new(processor, bodies);
            for index in 0..bodies {
                let (state, thrust, torque) = thrown(index);
                rows.place(index, &state);
                rows.command(index, thrust, &torque);
            }
            rows.advance(&body, 3);
            rows.advance(&body, 1);
            for index in 0..bodies {
                let (state, thrust, torque) = thrown(index);
                let mut alone = Plant::new(vehicle, limits, 5e-3, state);
                alone.advance(thrust, &torque, 3);
                alone.advance(thrust, &torque, 1);
                assert_eq!(rows.state(index), *alone.state(), "{processor:?}, {index} of {bodies}");
            }
        }
    }
}
