//! From a policy's file to Rust source: the network that the firmware carries, with all the digits that reading back
//! bit for bit takes; or that it carries none.

use scenario::policy::PolicyFile;

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
    let PolicyFile { layers, scale } = PolicyFile::parse(text, name)?;
    let list = |numbers: &[f32]| numbers.iter().map(|number| format!("{number:e}, ")).collect::<String>();
    let layers: String = layers
        .iter()
        .map(|(weights, biases)| {
            format!("    Layer {{ weights: &[{}], biases: &[{}] }},\n", list(weights), list(biases))
        })
        .collect();
    Ok(format!(
        "
use controller_core::shield::network::{{Layer, Network, NetworkPolicy}};

static LAYERS: &[Layer<'static>] = &[
{layers}];

/// What policy is built in.
pub type Policy = Option<flight::Guarded<NetworkPolicy<'static>>>;

/// The network; none that the build has not accepted.
pub fn policy() -> Policy {{
    Network::new(LAYERS, [{}]).ok().map(|network| flight::Guarded::new(NetworkPolicy::new(network)))
}}
",
        list(&scale)
    ))
}
