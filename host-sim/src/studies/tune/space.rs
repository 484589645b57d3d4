//! The search space: which constants of a law are searched, and a point of it as a configuration.
//!
//! Under the paper's law a point holds natural logarithms: of nine gains, and of the thrust floor as a fraction of its
//! greatest admissible value; delta and alpha stay as the file has them: they are about noise.
//!
//! Under the extended law it holds the logarithms of factors, one for each constant that [`ExtendedParameters::TABLE`]
//! marks; those of `TIED_CONSTANTS` move with them, and all others follow by the formulas, unless the file chose them.
//! So a candidate uses no more torque and thrust than the rotors have. A factor of one leaves a constant to the
//! formulas as well: the start is the file's law to the bit.

use super::chosen::chosen;
use controller_core::configuration::{Configuration, ExtendedLaw, LawParameters, PaperLaw};
use controller_core::extended::defaults::{self, Given, NOTHING_GIVEN};
use controller_core::extended::parameters::{Extended, ExtendedParameters};
use controller_core::gains::{GainParameters, Gains};
use scenario::Scenario;

/// A point of the search space.
pub type Point = Vec<f64>;

/// Constants that move with a searched one, each with the power of its factor. r_0 is where the tilt begins to brake
/// along a parabola: it goes with M_theta^2 / k_theta.
const TIED_CONSTANTS: [(&str, &str, f64); 4] = [
    ("k_v_vertical", "k_p_vertical", 2.0),
    ("k_tilt", "r_0", -1.0),
    ("m_tilt", "r_0", 2.0),
    ("force_bandwidth_across", "force_bandwidth_vertical", 1.0),
];

/// The search space around one scenario.
#[derive(Clone)]
pub struct Space {
    scenario: Scenario,
    /// The extended law's constants that the file gives.
    chosen: Given,
    /// The greatest thrust floor, as a share of the admissible one; `None` if the projection may not be used.
    floor: Option<f32>,
}

impl Space {
    /// Around the configuration of `scenario`; thrust floors of the paper's law up to the share `floor` of the
    /// admissible one, or none.
    pub fn new(scenario: &Scenario, floor: Option<f32>) -> Self {
        let own = match (scenario.configuration.law(), scenario.airframe()) {
            (LawParameters::Extended(law), Some(airframe)) => chosen(&airframe, &law.parameters),
            _ => NOTHING_GIVEN,
        };
        Self { scenario: scenario.clone(), chosen: own, floor }
    }

    /// The file's own constants: where the search starts.
    pub fn start(&self) -> Point {
        let configuration = &self.scenario.configuration;
        match configuration.law() {
            LawParameters::Paper(PaperLaw { gains, thrust_floor }) => {
                let floor = thrust_floor.map_or(0.5, |floor| floor / configuration.min_thrust());
                let searched = gains.entries().filter(|(gain, _)| gain.searched).map(|(_, value)| value);
                searched.chain([floor]).map(|value| f64::from(value).ln()).collect()
            }
            LawParameters::Extended(_) => vec![0.0; searched().count()],
        }
    }

    /// The configuration with the constants of `point`, if the law is defined for them.
    pub fn configuration(&self, point: &Point) -> Option<Configuration> {
        match self.scenario.configuration.law() {
            LawParameters::Paper(law) => self.papers(law, point),
            LawParameters::Extended(law) => self.extended(law, point),
        }
    }

    fn extended(&self, law: &ExtendedLaw, point: &Point) -> Option<Configuration> {
        let airframe = self.scenario.airframe()?;
        let own = law.parameters.values();
        let mut given = self.chosen;
        let moved: Vec<(&str, f64)> =
            searched().map(|place| ExtendedParameters::TABLE[place].key).zip(point.iter().copied()).collect();
        for (place, constant) in ExtendedParameters::TABLE.iter().enumerate() {
            let power = |with: &str| {
                let along = TIED_CONSTANTS.iter().find(|(other, key, _)| *other == with && *key == constant.key);
                along.map_or(f64::from(u8::from(with == constant.key)), |(.., power)| *power)
            };
            let logarithm: f64 = moved.iter().map(|(with, x)| power(with) * x).sum();
            if logarithm != 0.0 {
                given[place] = Some(rounded(f64::from(own[place]) * logarithm.exp()));
            }
        }
        let parameters = defaults::constants(&airframe, &given);
        let parameters = Extended::new(parameters, airframe.vehicle).ok()?;
        let law = ExtendedLaw { parameters, ..*law };
        let bounds = *self.scenario.configuration.bounds();
        let tuned = Configuration::extended(*airframe.vehicle, *airframe.limits, law, bounds).ok()?;
        match airframe.rotors {
            Some(rotors) => tuned.with_rotors(rotors.clone()).ok(),
            None => Some(tuned),
        }
    }

    fn papers(&self, law: &PaperLaw, point: &Point) -> Option<Configuration> {
        let mut numbers = point.iter().map(|x| x.exp() as f32);
        let own = &self.scenario.configuration;
        let mut values = law.gains.values();
        for (value, _) in values.iter_mut().zip(&GainParameters::TABLE).filter(|(_, gain)| gain.searched) {
            *value = numbers.next()?;
        }
        let floor = numbers.next()?;
        let gains = Gains::new(GainParameters::from_values(values), own.vehicle()).ok()?;
        let configuration = own.with_gains(gains).ok()?;
        match self.floor {
            None => Some(configuration),
            Some(greatest) => {
                let floor = floor.min(greatest) * configuration.min_thrust();
                configuration.with_thrust_floor(floor).ok()
            }
        }
    }
}

/// Four significant digits, so that the file is short and holds exactly the judged values.
fn rounded(value: f64) -> f32 {
    format!("{value:.3e}").parse().unwrap_or(value as f32)
}

/// The places of the extended law's searched constants in its table.
fn searched() -> impl Iterator<Item = usize> {
    (0..ExtendedParameters::COUNT).filter(|&place| ExtendedParameters::TABLE[place].searched)
}
