//! Networks: what they make of their inputs, and which are refused.

extern crate std;
use super::*;
use crate::extended::tests::Random;
use crate::state::State;
use nalgebra::{Vector2, Vector3};
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
        rotors: core::array::from_fn(|_| random.signed()),
    }
}

const fn scaled(scale: [f32; OUTPUT_COUNT]) -> Interface {
    Interface::Acceleration { scale }
}

const ONE: Interface = scaled([1.0; OUTPUT_COUNT]);

const RAPTORS: Interface = Interface::Rotors { farthest: 1.0, fastest: 2.0 };

const fn dense<'a>(weights: &'a [f32], biases: &'a [f32]) -> Layer<'a> {
    Layer::Dense { affine: Affine { weights, biases }, activation: Activation::Tanh }
}

/// The outputs of a network that remembers nothing.
fn outputs(network: &Network, inputs: &[f32; INPUT_COUNT]) -> [f32; OUTPUT_COUNT] {
    network.outputs(inputs, &mut network.fresh())
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
    let layers: Vec<_> = made.iter().map(|(weights, biases)| dense(weights, biases)).collect();
    let network = Network::new(&layers, scaled([1.0, 2.0, 3.0, 4.0])).unwrap();
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
        for (output, value) in outputs(&network, &inputs).iter().zip(values) {
            assert!((f64::from(*output) - value).abs() < 1e-5, "{output} {value}");
        }
    }
}

#[test]
fn inputs_are_seen_from_the_heading_and_demands_are_turned_back() {
    let mut random = Random(93);
    let (zero, biases) = ([0.0; INPUT_COUNT * OUTPUT_COUNT], [0.3, -0.4, 0.5, 0.1]);
    let layers = [dense(&zero, &biases)];
    let network = Network::new(&layers, scaled([2.0, 2.0, 3.0, 0.5])).unwrap();
    for _ in 0..100 {
        let observation = observation(&mut random);
        let seen = ONE.inputs(&observation, &[0.1, 0.2, 0.3, 0.4]);
        let Observation { state, goal, heading, .. } = &observation;
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
    let layers = [dense(&weights, &[0.0; OUTPUT_COUNT])];
    let mut policy = NetworkPolicy::new(Network::new(&layers, ONE).unwrap());
    let fine = observation(&mut Random(94));
    let broken = Observation { goal: Vector3::repeat(f32::NAN), ..fine };
    assert!(policy.act(&broken).unwrap().check().is_err());
    assert!(policy.act(&fine).unwrap().check().is_ok());
}

#[test]
fn a_network_that_does_not_fit_is_refused_by_name() {
    let (weights, biases) = ([0.5; INPUT_COUNT * WIDTH_MAX * 2], [0.5; WIDTH_MAX + 1]);
    let layer =
        |inputs: usize, outputs: usize| dense(weights.get(..inputs * outputs).unwrap(), biases.get(..outputs).unwrap());
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
        (&[dense(weights.get(..INPUT_COUNT * 4).unwrap(), &nan)], [1.0; 4], "network.layers.biases"),
        (&[good], [1.0, 1.0, 2e4, 1.0], "network.scale"),
    ] {
        assert_eq!(Network::new(layers, scaled(scale)).unwrap_err().field, field);
    }
    assert!(Network::new(&[good, layer(4, WIDTH_MAX), layer(WIDTH_MAX, 4)], ONE).is_ok());
}

/// Weights and biases of a layer of so many inputs and outputs.
struct Numbers {
    weights: Vec<f32>,
    biases: Vec<f32>,
}

impl Numbers {
    fn drawn(random: &mut Random, inputs: usize, outputs: usize) -> Self {
        Self { weights: numbers(random, inputs * outputs), biases: numbers(random, outputs) }
    }

    fn affine(&self) -> Affine<'_> {
        Affine { weights: &self.weights, biases: &self.biases }
    }

    /// W x + b in double precision.
    fn of(&self, values: &[f64]) -> Vec<f64> {
        let rows = self.weights.chunks(values.len()).zip(&self.biases);
        rows.map(|(row, bias)| row.iter().zip(values).fold(f64::from(*bias), |sum, (w, x)| sum + f64::from(*w) * x))
            .collect()
    }
}

/// RAPTOR's shape: a dense layer of 16 with rectifiers, 16 recurrent units, four sums.
struct Raptors {
    first: Numbers,
    input: Numbers,
    hidden: Numbers,
    last: Numbers,
    initial: Vec<f32>,
}

impl Raptors {
    fn drawn(random: &mut Random) -> Self {
        Self {
            first: Numbers::drawn(random, INPUT_COUNT, 16),
            input: Numbers::drawn(random, 16, 48),
            hidden: Numbers::drawn(random, 16, 48),
            last: Numbers::drawn(random, 16, OUTPUT_COUNT),
            initial: numbers(random, 16),
        }
    }

    fn layers(&self) -> [Layer<'_>; 3] {
        let Self { first, input, hidden, last, initial } = self;
        [
            Layer::Dense { affine: first.affine(), activation: Activation::Relu },
            Layer::Gru { input: input.affine(), hidden: hidden.affine(), initial },
            Layer::Dense { affine: last.affine(), activation: Activation::Identity },
        ]
    }

    /// One step in double precision, by the equations of [`layer`].
    fn step(&self, inputs: &[f64], memory: &mut Vec<f64>) -> Vec<f64> {
        let seen: Vec<f64> = self.first.of(inputs).into_iter().map(|x| x.max(0.0)).collect();
        let (of_input, of_memory) = (self.input.of(&seen), self.hidden.of(memory));
        let sigmoid = |x: f64| 1.0 / (1.0 + (-x).exp());
        *memory = (0..16)
            .map(|unit| {
                let r = sigmoid(of_input[unit] + of_memory[unit]);
                let z = sigmoid(of_input[16 + unit] + of_memory[16 + unit]);
                let n = (of_input[32 + unit] + r * of_memory[32 + unit]).tanh();
                z * memory[unit] + (1.0 - z) * n
            })
            .collect();
        self.last.of(memory)
    }
}

#[test]
fn a_recurrent_network_is_its_equations_and_remembers() {
    let mut random = Random(95);
    let numbers_of = Raptors::drawn(&mut random);
    let layers = numbers_of.layers();
    let network = Network::new(&layers, RAPTORS).unwrap();
    assert_eq!(network.remembered(), 16);
    let mut memory = network.fresh();
    assert_eq!((&memory.values[..16], &memory.values[16..]), (&*numbers_of.initial, &[0.0; 48][..]));
    let mut wanted_memory: Vec<f64> = numbers_of.initial.iter().map(|value| f64::from(*value)).collect();
    let mut moved = 0.0_f64;
    for _ in 0..1_000 {
        let inputs: [f32; INPUT_COUNT] = numbers(&mut random, INPUT_COUNT).try_into().unwrap();
        let wanted = numbers_of.step(&inputs.map(f64::from), &mut wanted_memory);
        for (output, wanted) in network.outputs(&inputs, &mut memory).iter().zip(wanted) {
            assert!((f64::from(*output) - wanted).abs() < 2e-5, "{output} {wanted}");
        }
        // The same inputs with what it remembered at first give something else.
        let [output, ..] = network.outputs(&inputs, &mut network.fresh());
        moved = moved.max((f64::from(output) - f64::from(network.outputs(&inputs, &mut memory.clone())[0])).abs());
    }
    assert!(moved > 0.1);
}

#[test]
fn two_recurrent_layers_remember_side_by_side() {
    let mut random = Random(96);
    let [input, hidden, second] =
        [(INPUT_COUNT, 18), (6, 18), (6, 12)].map(|(inputs, outputs)| Numbers::drawn(&mut random, inputs, outputs));
    let small = Numbers::drawn(&mut random, 4, 12);
    let layers = [
        Layer::Gru { input: input.affine(), hidden: hidden.affine(), initial: &[0.5; 6] },
        Layer::Gru { input: second.affine(), hidden: small.affine(), initial: &[-0.25; 4] },
    ];
    let network = Network::new(&layers, ONE).unwrap();
    assert_eq!(network.remembered(), 10);
    let mut memory = network.fresh();
    assert_eq!(memory.values[..11], [0.5, 0.5, 0.5, 0.5, 0.5, 0.5, -0.25, -0.25, -0.25, -0.25, 0.0]);
    let outputs = network.outputs(&[0.1; INPUT_COUNT], &mut memory);
    assert_eq!(memory.values[6..10], outputs);
    assert!(memory.values[10..].iter().all(|value| *value == 0.0));
    assert!(memory.values[..6].iter().all(|value| *value != 0.5));
}

#[test]
fn a_policy_of_rotors_sees_what_flew_and_its_goal_and_speed_cut() {
    let mut random = Random(97);
    let zero = [0.0; INPUT_COUNT * OUTPUT_COUNT];
    let affine = Affine { weights: &zero, biases: &[3.0, -0.5, 0.25, -2.0] };
    let layers = [Layer::Dense { affine, activation: Activation::Identity }];
    let network = Network::new(&layers, RAPTORS).unwrap();
    for _ in 0..100 {
        let observation = observation(&mut random);
        let Observation { state, goal, heading, rotors } = &observation;
        let angle = heading.direction().y.atan2(heading.direction().x);
        let back = nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), -angle);
        let rotation = back * nalgebra::UnitQuaternion::new_normalize(state.attitude).to_rotation_matrix();
        let wanted: Vec<f32> = (back * (state.position - goal))
            .map(|place| place.clamp(-1.0, 1.0))
            .iter()
            .chain(rotation.matrix().transpose().iter())
            .chain((back * state.velocity).map(|speed| speed.clamp(-2.0, 2.0)).iter())
            .chain(state.angular_velocity.iter())
            .chain(rotors)
            .copied()
            .collect();
        // Its own last outputs do not count.
        for (seen, wanted) in RAPTORS.inputs(&observation, &[9.0; 4]).iter().zip(&wanted) {
            assert!((seen - wanted).abs() < 1e-5, "{seen} {wanted}");
        }
        let demand = NetworkPolicy::new(network).act(&observation).unwrap();
        assert_eq!(demand, Demand::Rotors { speeds: [3.0, -0.5, 0.25, -2.0] });
    }
}

#[test]
fn a_recurrent_policy_forgets_what_is_not_finite_and_begins_every_flight_anew() {
    let mut random = Random(98);
    let numbers_of = Raptors::drawn(&mut random);
    let layers = numbers_of.layers();
    let fresh = NetworkPolicy::new(Network::new(&layers, RAPTORS).unwrap());
    let (mut policy, fine) = (fresh, observation(&mut random));
    policy.act(&fine);
    assert_ne!(policy.memory(), fresh.memory());
    let broken = Observation { goal: Vector3::repeat(f32::NAN), ..fine };
    assert!(policy.act(&broken).unwrap().check().is_err());
    assert_eq!(policy, fresh);
    assert!(policy.act(&fine).unwrap().check().is_ok());
    policy.begin();
    assert_eq!(policy, fresh);
}

#[test]
fn a_recurrent_layer_that_does_not_fit_is_refused_by_name() {
    let mut random = Random(99);
    let good = Raptors::drawn(&mut random);
    let refused = |raptors: &Raptors, interface| Network::new(&raptors.layers(), interface).unwrap_err().field;
    let with = |change: fn(&mut Raptors)| {
        let mut other = Raptors {
            first: Numbers { weights: good.first.weights.clone(), biases: good.first.biases.clone() },
            input: Numbers { weights: good.input.weights.clone(), biases: good.input.biases.clone() },
            hidden: Numbers { weights: good.hidden.weights.clone(), biases: good.hidden.biases.clone() },
            last: Numbers { weights: good.last.weights.clone(), biases: good.last.biases.clone() },
            initial: good.initial.clone(),
        };
        change(&mut other);
        refused(&other, RAPTORS)
    };
    assert_eq!(with(|raptors| raptors.input.weights.truncate(47 * 16)), "network.layers.input_weights");
    assert_eq!(with(|raptors| raptors.input.biases.push(0.0)), "network.layers.input_biases");
    assert_eq!(with(|raptors| raptors.hidden.weights.push(0.0)), "network.layers.hidden_weights");
    assert_eq!(with(|raptors| raptors.hidden.biases[40] = f32::NAN), "network.layers.hidden_biases");
    assert_eq!(with(|raptors| raptors.initial[3] = 2e4), "network.layers.initial");
    assert_eq!(with(|raptors| raptors.initial.clear()), "network.layers.initial");
    for (interface, field) in [
        (Interface::Rotors { farthest: 0.0, fastest: 1.0 }, "network.farthest"),
        (Interface::Rotors { farthest: 1.0, fastest: f32::INFINITY }, "network.fastest"),
        (Interface::Rotors { farthest: 1.0, fastest: 2e4 }, "network.fastest"),
    ] {
        assert_eq!(refused(&good, interface), field);
    }
    // 40 and 40 values are more than a policy remembers.
    let [wide, own, narrow] =
        [(INPUT_COUNT, 120), (40, 120), (40, 4)].map(|(inputs, outputs)| Numbers::drawn(&mut random, inputs, outputs));
    let again = Numbers::drawn(&mut random, 40, 120);
    let initial = [0.0; 40];
    let layers = [
        Layer::Gru { input: wide.affine(), hidden: own.affine(), initial: &initial },
        Layer::Gru { input: again.affine(), hidden: own.affine(), initial: &initial },
        Layer::Dense { affine: narrow.affine(), activation: Activation::Identity },
    ];
    assert_eq!(Network::new(&layers, RAPTORS).unwrap_err().field, "network.layers.initial");
}
