//! From a policy's file to Rust source: the network that the firmware carries, with all the digits that reading back
//! bit for bit takes; or that it carries none.

use controller_core::extended::rotor_speeds::RotorSpeeds;
use controller_core::shield::network::Interface;
use scenario::Scenario;
use scenario::policy::{AffineNumbers, LayerNumbers, PolicyFile};

/// By how much of it the time between a policy's steps may differ from the tick's.
const PERIOD_TOLERANCE: f64 = 1e-4;

/// The source of an image without a policy.
pub const NONE: &str = "
/// What policy is built in.
pub type Policy = flight::NoPolicy;

/// None.
pub fn policy() -> Policy {
    flight::NoPolicy
}
";

/// The source of an image with the policy in `text`, of the file `name`, for the vehicle of `scenario`.
/// Errors: one line: the file, the field and what is wrong.
pub fn source(text: &str, name: &str, scenario: &Scenario) -> Result<String, String> {
    let policy = PolicyFile::parse(text, name)?;
    fits(&policy, scenario).map_err(|problem| format!("{name}: {problem}"))?;
    Ok(format!(
        "{}
use controller_core::shield::network::{{Network, NetworkPolicy}};

/// What policy is built in.
pub type Policy = Option<flight::Guarded<NetworkPolicy<'static>>>;

/// The network; none that the build has not accepted.
pub fn policy() -> Policy {{
    Network::new(LAYERS, INTERFACE).ok().map(|network| flight::Guarded::new(NetworkPolicy::new(network)))
}}
",
        network(&policy)
    ))
}

/// Whether the vehicle of `scenario` can fly it at its rate.
/// Errors: the field and what is wrong.
fn fits(policy: &PolicyFile, scenario: &Scenario) -> Result<(), String> {
    let (vehicle, configuration) = (&scenario.name, &scenario.configuration);
    let ticks = scenario.timing.period();
    if let Some(period) = policy.period.filter(|period| (f64::from(*period) / ticks - 1.0).abs() > PERIOD_TOLERANCE) {
        let rate = (1.0 / period).round();
        return Err(format!(
            "period: it acts every {period} s, {vehicle} every {ticks} s; give the scenario [control] rate = {rate:.1}"
        ));
    }
    let takes_speeds =
        configuration.rotors().is_some_and(|rotors| RotorSpeeds::new(rotors, configuration.limits()).is_some());
    if matches!(policy.interface, Interface::Rotors { .. }) && !takes_speeds {
        return Err(format!(
            "demands: speeds of rotors are for an X of four like rotors, of which front right turns counter-clockwise; \
             {vehicle} has others"
        ));
    }
    Ok(())
}

/// The source of its layers and of its interface.
pub fn network(PolicyFile { layers, interface, .. }: &PolicyFile) -> String {
    let layers: String = layers.iter().map(|numbers| format!("    {},\n", layer(numbers))).collect();
    let interface = match interface {
        Interface::Acceleration { scale } => format!("Acceleration {{ scale: [{}] }}", list(scale)),
        Interface::Rotors { farthest, fastest } => {
            format!("Rotors {{ farthest: {farthest:e}, fastest: {fastest:e} }}")
        }
    };
    format!(
        "
#[allow(unused_imports)] // not every network has every kind
use controller_core::shield::network::{{Activation, Affine, Interface, Layer}};

static LAYERS: &[Layer<'static>] = &[
{layers}];

const INTERFACE: Interface = Interface::{interface};
"
    )
}

/// A layer as source.
fn layer(numbers: &LayerNumbers) -> String {
    match numbers {
        LayerNumbers::Dense { affine: numbers, activation } => {
            format!("Layer::Dense {{ affine: {}, activation: Activation::{activation:?} }}", affine(numbers))
        }
        LayerNumbers::Gru { input, hidden, initial } => {
            let [input, hidden] = [input, hidden].map(affine);
            format!("Layer::Gru {{ input: {input}, hidden: {hidden}, initial: &[{}] }}", list(initial))
        }
    }
}

fn affine(AffineNumbers { weights, biases }: &AffineNumbers) -> String {
    format!("Affine {{ weights: &[{}], biases: &[{}] }}", list(weights), list(biases))
}

fn list(numbers: &[f32]) -> String {
    numbers.iter().map(|number| format!("{number:e}, ")).collect()
}
