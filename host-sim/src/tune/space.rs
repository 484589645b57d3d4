//! The search space: which constants of a law are searched, and a point of it as a configuration.
//!
//! A point holds natural logarithms. Under the paper's law: nine gains, and the thrust floor as a fraction of its greatest
//! admissible value; delta and alpha stay as the file has them: they are about noise. Under the extended law: what its
//! table of constants says ([`ExtendedParameters::TABLE`]).

use controller_core::certificate::configuration::{Configuration, ExtendedLaw, LawParameters, PaperLaw};
use controller_core::extended::parameters::{Extended, ExtendedParameters};
use controller_core::gains::{GainParameters, Gains};

/// A point of the search space.
pub type Point = Vec<f64>;

/// A constant under its name in a scenario file: section, key, value.
pub type Named = (&'static str, &'static str, f32);

/// The search space around one configuration.
#[derive(Debug, Clone)]
pub struct Space {
    configuration: Configuration,
    /// The greatest thrust floor, as a share of what is admissible; none if the projection may not be used.
    floor: Option<f32>,
}

impl Space {
    /// Around `configuration`; thrust floors of the paper's law up to the share `floor` of what is admissible, or none.
    #[must_use]
    pub fn new(configuration: &Configuration, floor: Option<f32>) -> Self {
        Self { configuration: configuration.clone(), floor }
    }

    /// The file's own constants: where the search starts.
    #[must_use]
    pub fn start(&self) -> Point {
        let logarithms = |values: &[f32]| values.iter().map(|value| f64::from(*value).ln()).collect();
        match self.configuration.law() {
            LawParameters::Paper(PaperLaw { gains: g, thrust_floor }) => {
                let floor = thrust_floor.map_or(0.5, |floor| floor / self.configuration.least_thrust());
                logarithms(&[g.k_p, g.k_v, g.k_f, g.k_s, g.k_theta, g.k_omega, g.m_p, g.m_theta, g.m_omega, floor])
            }
            LawParameters::Extended(law) => {
                logarithms(&searched(&law.parameters).map(|named| named.2).collect::<Vec<_>>())
            }
        }
    }

    /// The configuration with the constants of `point`, if the law is defined for them.
    #[must_use]
    pub fn configuration(&self, point: &Point) -> Option<Configuration> {
        match self.configuration.law() {
            LawParameters::Paper(law) => self.papers(law, point),
            LawParameters::Extended(law) => {
                let mut values = law.parameters.values();
                let searched =
                    values.iter_mut().zip(&ExtendedParameters::TABLE).filter(|(_, constant)| constant.searched);
                for ((value, _), x) in searched.zip(point) {
                    *value = x.exp() as f32;
                }
                let parameters = ExtendedParameters::from_values(values);
                let own = &self.configuration;
                let parameters = Extended::new(parameters, own.vehicle()).ok()?;
                let law = ExtendedLaw { parameters, ..*law };
                let tuned = Configuration::extended(*own.vehicle(), *own.limits(), law, *own.bounds()).ok()?;
                own.rotors().map_or(Ok(tuned.clone()), |rotors| tuned.with_rotors(rotors.clone())).ok()
            }
        }
    }

    fn papers(&self, law: &PaperLaw, point: &Point) -> Option<Configuration> {
        let numbers: Vec<f32> = point.iter().map(|x| x.exp() as f32).collect();
        let [k_p, k_v, k_f, k_s, k_theta, k_omega, m_p, m_theta, m_omega, floor] = *numbers.as_slice() else {
            return None;
        };
        let GainParameters { delta, alpha, .. } = *law.gains;
        let parameters = GainParameters { k_p, k_v, k_f, k_s, k_theta, k_omega, m_p, m_theta, m_omega, delta, alpha };
        let gains = Gains::new(parameters, self.configuration.vehicle()).ok()?;
        let configuration = self.configuration.with_gains(gains).ok()?;
        match self.floor {
            None => Some(configuration),
            Some(greatest) => {
                let floor = floor.min(greatest) * configuration.least_thrust();
                configuration.with_thrust_floor(floor).ok()
            }
        }
    }
}

/// The constants of `configuration` that a search changes, by their names in a scenario file.
#[must_use]
pub fn named(configuration: &Configuration) -> Vec<Named> {
    match configuration.law() {
        LawParameters::Paper(PaperLaw { gains: g, .. }) => {
            let gains = [
                ("k_p", g.k_p),
                ("k_v", g.k_v),
                ("k_f", g.k_f),
                ("k_s", g.k_s),
                ("k_theta", g.k_theta),
                ("k_omega", g.k_omega),
                ("m_p", g.m_p),
                ("m_theta", g.m_theta),
                ("m_omega", g.m_omega),
            ];
            gains.map(|(key, value)| ("gains", key, value)).to_vec()
        }
        LawParameters::Extended(law) => searched(&law.parameters).collect(),
    }
}

/// The extended law's searched constants.
fn searched(parameters: &ExtendedParameters) -> impl Iterator<Item = Named> {
    let named = ExtendedParameters::TABLE.into_iter().zip(parameters.values());
    named.filter(|(constant, _)| constant.searched).map(|(constant, value)| (constant.section, constant.key, value))
}
