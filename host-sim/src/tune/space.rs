//! The search space: which constants of a law are searched, and a point of it as a configuration.
//!
//! A point holds natural logarithms. Under the paper's law: nine gains, and the thrust floor as a fraction of its greatest
//! admissible value; delta and alpha stay as the file has them: they are about noise. Under the extended law: every gain of the
//! position and attitude law and the speeds of the force estimate. What else it has is a promise about the vehicle's surroundings
//! (levels of the estimates, drag, limits of the thrust scale) or about noise, and stays.

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
            LawParameters::Extended(law) => logarithms(&searched(&mut { *law.parameters }).map(|(_, value)| *value)),
        }
    }

    /// The configuration with the constants of `point`, if the law is defined for them.
    #[must_use]
    pub fn configuration(&self, point: &Point) -> Option<Configuration> {
        match self.configuration.law() {
            LawParameters::Paper(law) => self.papers(law, point),
            LawParameters::Extended(law) => {
                let mut parameters: ExtendedParameters = *law.parameters;
                for ((_, value), x) in searched(&mut parameters).into_iter().zip(point) {
                    *value = x.exp() as f32;
                }
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
        LawParameters::Extended(law) => {
            let section = |key: &str| if key.starts_with("force") { "estimates" } else { "gains" };
            searched(&mut { *law.parameters }).map(|(key, value)| (section(key), key, *value)).to_vec()
        }
    }
}

/// The extended law's searched constants.
fn searched(parameters: &mut ExtendedParameters) -> [(&'static str, &mut f32); 29] {
    let ExtendedParameters { position: p, attitude: a, estimates: e, .. } = parameters;
    [
        ("k_p_across", &mut p.k_p_across),
        ("k_p_vertical", &mut p.k_p_vertical),
        ("k_v_across", &mut p.k_v_across),
        ("k_v_vertical", &mut p.k_v_vertical),
        ("k_f_across", &mut p.k_f_across),
        ("k_f_vertical", &mut p.k_f_vertical),
        ("k_s_across", &mut p.k_s_across),
        ("k_s_vertical", &mut p.k_s_vertical),
        ("m_across", &mut p.m_across),
        ("m_up", &mut p.m_up),
        ("m_down", &mut p.m_down),
        ("v_across", &mut p.v_across),
        ("v_up", &mut p.v_up),
        ("v_down", &mut p.v_down),
        ("w", &mut a.w),
        ("eta", &mut a.eta),
        ("k_t", &mut a.k_t),
        ("m_t", &mut a.m_t),
        ("eta_t", &mut a.eta_t),
        ("k_omega_t", &mut a.k_omega_t),
        ("m_omega_t", &mut a.m_omega_t),
        ("k_omega_z", &mut a.k_omega_z),
        ("m_omega_z", &mut a.m_omega_z),
        ("force_bandwidth_across", &mut e.force_bandwidth_across),
        ("force_bandwidth_vertical", &mut e.force_bandwidth_vertical),
        ("force_snap_across", &mut e.force_snap_across),
        ("force_snap_vertical", &mut e.force_snap_vertical),
        ("force_smoothing_across", &mut e.force_smoothing_across),
        ("force_smoothing_vertical", &mut e.force_smoothing_vertical),
    ]
}
