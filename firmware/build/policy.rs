//! From a policy's file to Rust source: the network that the firmware carries, with all the digits that reading back
//! bit for bit takes; or that it carries none.

use controller_core::shield::network::Interface;
use scenario::policy::{AffineNumbers, LayerNumbers, PolicyFile};

/// The source of an image without a policy.
pub const NONE: &str = "
/// What policy is built in.
pub type Policy = flight::NoPolicy;

/// None.
pub fn policy() -> Policy {
    flight::NoPolicy
}
";

/// The source of an image with the policy in `text`, of the file `name`.
/// Errors: one line: the file, the field and what is wrong.
pub fn source(text: &str, name: &str) -> Result<String, String> {
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
        network(text, name)?
    ))
}

/// The source of the layers and the interface of the network in `text`, of the file `name`.
/// Errors: as [`source`].
pub fn network(text: &str, name: &str) -> Result<String, String> {
    let PolicyFile { layers, interface } = PolicyFile::parse(text, name)?;
    let layers: String = layers.iter().map(|numbers| format!("    {},\n", layer(numbers))).collect();
    let interface = match interface {
        Interface::Acceleration { scale } => format!("Acceleration {{ scale: [{}] }}", list(&scale)),
        Interface::Rotors { farthest, fastest } => {
            format!("Rotors {{ farthest: {farthest:e}, fastest: {fastest:e} }}")
        }
    };
    Ok(format!(
        "
#[allow(unused_imports)] // not every network has every kind
use controller_core::shield::network::{{Activation, Affine, Interface, Layer}};

static LAYERS: &[Layer<'static>] = &[
{layers}];

const INTERFACE: Interface = Interface::{interface};
"
    ))
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
