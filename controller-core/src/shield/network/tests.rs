//! Networks: what they make of their inputs, and which are refused.

extern crate std;
use super::*;
use crate::extended::tests::Random;
use crate::state::State;
use nalgebra::Vector2;
use std::vec::Vec;

fn observation(random: &mut Random) -> Observation {
    let angle = 3.0 * random.signed();
    Observation {
        state: State {
            position: random.vector(3.0),
            velocity: random.vector(3.0),
            attitude: random.attitude(),
            angular_velocity: random.vector(5.0),
        },
        goal: random.vector(3.0),
        heading: Heading::new(Vector2::new(angle.cos(), angle.sin()), 0.0, 0.0).unwrap(),
    }
}

fn numbers(random: &mut Random, count: usize) -> Vec<f32> {
    (0..count).map(|_| random.signed()).collect()
}

#[test]
fn a_network_is_its_sums_and_tanhs() {
    let mut random = Random(92);
    let sizes = [INPUT_COUNT, 7, 64, OUTPUT_COUNT];
    let made: Vec<_> =
        sizes.windows(2).map(|pair| (numbers(&mut random, pair[0] * pair[1]), numbers(&mut random, pair[1]))).collect();
    let layers: Vec<_> = made.iter().map(|(weights, biases)| Layer { weights, biases }).collect();
    let network = Network::new(&layers, [1.0, 2.0, 3.0, 4.0]).unwrap();
    for _ in 0..100 {
        let inputs: [f32; INPUT_COUNT] = numbers(&mut random, INPUT_COUNT).try_into().unwrap();
        let mut values: Vec<f64> = inputs.iter().map(|input| f64::from(*input)).collect();
        for (weights, biases) in &made {
            let each = weights.chunks(values.len()).zip(biases);
            values = each
                .map(|(row, bias)| {
                    let sum: f64 = row.iter().zip(&values).map(|(weight, value)| f64::from(*weight) * value).sum();
                    (sum + f64::from(*bias)).tanh()
                })
                .collect();
        }
        for (output, value) in network.outputs(&inputs).iter().zip(values) {
            assert!((f64::from(*output) - value).abs() < 1e-5, "{output} {value}");
        }
    }
}

#[test]
fn inputs_are_seen_from_the_heading_and_demands_are_turned_back() {
    let mut random = Random(93);
    let (zero, biases) = ([0.0; INPUT_COUNT * OUTPUT_COUNT], [0.3, -0.4, 0.5, 0.1]);
    let layers = [Layer { weights: &zero, biases: &biases }];
    let network = Network::new(&layers, [2.0, 2.0, 3.0, 0.5]).unwrap();
    for _ in 0..100 {
        let observation = observation(&mut random);
        let seen = inputs(&observation, &[0.1, 0.2, 0.3, 0.4]);
        let Observation { state, goal, heading } = &observation;
        let angle = heading.direction().y.atan2(heading.direction().x);
        let back = nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), -angle);
        let attitude = nalgebra::UnitQuaternion::new_normalize(state.attitude).to_rotation_matrix();
        let rotation = back * attitude;
        let wanted: Vec<f32> = (back * (goal - state.position))
            .iter()
            .chain((back * state.velocity).iter())
            .chain(rotation.matrix().transpose().iter())
            .chain(state.angular_velocity.iter())
            .copied()
            .chain([0.1, 0.2, 0.3, 0.4])
            .collect();
        for (seen, wanted) in seen.iter().zip(&wanted) {
            assert!((seen - wanted).abs() < 1e-5, "{seen} {wanted}");
        }
        let mut policy = NetworkPolicy::new(network);
        let Some(Demand::Acceleration { acceleration, yaw_rate }) = policy.act(&observation) else { panic!() };
        let outputs = biases.map(f32::tanh);
        let forwards = Vector3::new(2.0 * outputs[0], 2.0 * outputs[1], 3.0 * outputs[2]);
        assert!((back.inverse() * forwards - acceleration).norm() < 1e-5);
        assert!((yaw_rate - 0.5 * outputs[3]).abs() < 1e-6);
        assert!(policy.last.iter().zip(outputs).all(|(last, output)| (last - output).abs() < 1e-6));
    }
}

#[test]
fn what_is_not_finite_goes_through_once_and_is_forgotten() {
    let weights = [1.0; INPUT_COUNT * OUTPUT_COUNT];
    let layers = [Layer { weights: &weights, biases: &[0.0; OUTPUT_COUNT] }];
    let mut policy = NetworkPolicy::new(Network::new(&layers, [1.0; OUTPUT_COUNT]).unwrap());
    let fine = observation(&mut Random(94));
    let broken = Observation { goal: Vector3::repeat(f32::NAN), ..fine };
    assert!(policy.act(&broken).unwrap().check().is_err());
    assert!(policy.act(&fine).unwrap().check().is_ok());
}

#[test]
fn a_network_that_does_not_fit_is_refused_by_name() {
    let (weights, biases) = ([0.5; INPUT_COUNT * WIDTH_MAX * 2], [0.5; WIDTH_MAX + 1]);
    let layer = |inputs: usize, outputs: usize| Layer {
        weights: weights.get(..inputs * outputs).unwrap(),
        biases: biases.get(..outputs).unwrap(),
    };
    let good = layer(INPUT_COUNT, OUTPUT_COUNT);
    let nan = [f32::NAN; OUTPUT_COUNT];
    for (layers, scale, field) in [
        (&[] as &[Layer], [1.0; 4], "network.layers"),
        (&[good, layer(4, 4), layer(4, 4), layer(4, 4), layer(4, 4)], [1.0; 4], "network.layers"),
        (&[layer(INPUT_COUNT + 1, OUTPUT_COUNT)], [1.0; 4], "network.layers.weights"),
        (&[layer(INPUT_COUNT - 1, OUTPUT_COUNT)], [1.0; 4], "network.layers.weights"),
        (&[layer(INPUT_COUNT, 3)], [1.0; 4], "network.layers.biases"),
        (&[layer(INPUT_COUNT, 5)], [1.0; 4], "network.layers.biases"),
        (&[layer(INPUT_COUNT, 0)], [1.0; 4], "network.layers.biases"),
        (&[layer(INPUT_COUNT, WIDTH_MAX + 1), layer(WIDTH_MAX + 1, 4)], [1.0; 4], "network.layers.biases"),
        (&[Layer { biases: &nan, ..good }], [1.0; 4], "network.layers.biases"),
        (&[good], [1.0, 1.0, 2e4, 1.0], "network.scale"),
    ] {
        assert_eq!(Network::new(layers, scale).unwrap_err().field, field);
    }
    assert!(Network::new(&[good, layer(4, WIDTH_MAX), layer(WIDTH_MAX, 4)], [1.0; 4]).is_ok());
}
