//! The same recovery behind a shield, replayed: the law takes over from an upset start, and from half of the flight on
//! a network flies. The same states, hence the same bits of the network's outputs and of the commands. Once more with a
//! network that remembers and demands speeds of the rotors: that of `vehicles/policies/raptor.toml`.

use super::{Hash, STATE_BYTES, embedded_at, state};
use controller_core::certificate::certified::Certified;
use controller_core::error::InputError;
use controller_core::heading::Heading;
use controller_core::law::Law;
use controller_core::shield::network::{
    Activation, Affine, INPUT_COUNT, Interface, Layer, Network, NetworkPolicy, OUTPUT_COUNT,
};
use controller_core::shield::{Demand, Policy, Settings, Shield};
use nalgebra::Vector3;

/// How long the law flies.
const UPSET_TIME_US: u64 = 10_000_000;

/// The outputs of the network's middle.
const HIDDEN_OUTPUTS: usize = 32;

/// Weights without a pattern that an error could keep, small enough to fly.
const fn weights<const COUNT: usize>() -> [f32; COUNT] {
    let (mut weights, mut seed, mut place) = ([0.0; COUNT], 1_u32, 0);
    while place < COUNT {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        #[allow(clippy::indexing_slicing)] // at build time
        {
            weights[place] = ((seed >> 8) as f32 / 8_388_608.0 - 1.0) * 0.2;
        }
        place += 1;
    }
    weights
}

static FIRST_WEIGHTS: [f32; INPUT_COUNT * HIDDEN_OUTPUTS] = weights();
static SECOND_WEIGHTS: [f32; HIDDEN_OUTPUTS * HIDDEN_OUTPUTS] = weights();
static THIRD_WEIGHTS: [f32; HIDDEN_OUTPUTS * OUTPUT_COUNT] = weights();
static BIASES: [f32; HIDDEN_OUTPUTS] = weights();
static LAYERS: [Layer<'static>; 3] =
    [dense(&FIRST_WEIGHTS, &BIASES), dense(&SECOND_WEIGHTS, &BIASES), dense(&THIRD_WEIGHTS, &[0.1, -0.1, 0.05, -0.05])];

const fn dense(weights: &'static [f32], biases: &'static [f32]) -> Layer<'static> {
    Layer::Dense { affine: Affine { weights, biases }, activation: Activation::Tanh }
}

/// A network of 22, 32, 32 and 4. None on no machine.
pub fn network() -> Option<Network<'static>> {
    Network::new(&LAYERS, Interface::Acceleration { scale: [2.0, 2.0, 2.0, 0.5] }).ok()
}

/// RAPTOR's numbers, from its file.
mod raptor {
    include!(concat!(env!("OUT_DIR"), "/raptor.rs"));

    /// The network. None on no machine.
    pub fn network() -> Option<super::Network<'static>> {
        super::Network::new(LAYERS, INTERFACE).ok()
    }
}

pub use raptor::network as recurrent_network;

/// The flight, as far as it has been replayed.
pub struct Shielded {
    law: Law,
    shield: Shield,
    policy: NetworkPolicy<'static>,
    hash: Hash,
    period: u64,
    tick: u64,
    by_policy: u64,
}

impl Shielded {
    /// At the start, in ticks of `period` us; certifies the embedded scenario. None if that fails, or if it is for
    /// another law.
    pub fn new(period: u64) -> Option<Self> {
        Self::with(period, network()?)
    }

    /// The same with a network that remembers.
    pub fn recurrent(period: u64) -> Option<Self> {
        Self::with(period, recurrent_network()?)
    }

    fn with(period: u64, network: Network<'static>) -> Option<Self> {
        let certified = Certified::new(embedded_at(period)?).ok()?;
        let (seconds, corner) = (period as f32 * 1e-6, Vector3::repeat(20.0));
        Some(Self {
            law: Law::new(&certified, seconds).ok()?,
            shield: Shield::new(certified.configuration(), &Settings::new(-corner, corner), seconds).ok()?,
            policy: NetworkPolicy::new(network),
            hash: Hash::default(),
            period,
            tick: 0,
            by_policy: 0,
        })
    }

    /// One tick at a recorded state.
    /// Errors: the law's own, for a state that it cannot use.
    pub fn tick(&mut self, record: &[u8; STATE_BYTES]) -> Result<(), InputError> {
        if self.tick * self.period == UPSET_TIME_US {
            self.shield.reset(&Heading::FORWARD);
        }
        let state = state(record);
        let Some(law) = self.law.extended() else { return Ok(()) };
        let offers = self.policy.act(&self.shield.observation(law, &state, &Vector3::zeros()));
        let flown = self.shield.step(law, &state, offers.as_ref())?;
        match offers {
            Some(Demand::Acceleration { acceleration, yaw_rate }) => {
                self.hash.add(acceleration.as_slice());
                self.hash.add(&[yaw_rate]);
            }
            Some(Demand::Rotors { speeds }) => {
                self.hash.add(&speeds);
                self.hash.add(&self.policy.memory().values);
            }
            _ => {}
        }
        self.hash.add(&[flown.wrench.thrust]);
        self.hash.add(flown.wrench.torque.as_slice());
        self.hash.add(flown.reference.position.as_slice());
        self.hash.add(flown.reference.heading.direction().as_slice());
        self.hash.add_byte(flown.reason.map_or(0, |reason| reason as u8 + 1));
        self.by_policy += u64::from(flown.reason.is_none());
        self.tick += 1;
        Ok(())
    }

    /// The number, as 64 hexadecimal digits; none if law and network have not both flown.
    pub fn digest(self) -> Option<heapless::String<64>> {
        (0 < self.by_policy && self.by_policy < self.tick).then(|| self.hash.digest())
    }
}
