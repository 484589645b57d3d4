//! What the build embeds is what the file says, to the bit.

use scenario::Scenario;
use std::path::Path;

/// The file that is embedded when SCENARIO names none: see build/embed.rs.
const DEFAULT: &str = "vehicles/study.toml";

#[test]
fn the_embedded_configuration_is_the_files_to_the_bit() {
    let name = option_env!("SCENARIO").unwrap_or(DEFAULT);
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(name);
    let scenario = Scenario::load(&file).unwrap();
    assert_eq!(firmware::configuration::NAME, scenario.name);
    assert_eq!(firmware::configuration::embedded().unwrap(), scenario.configuration);
}

#[test]
fn the_default_is_tuned_for_a_sample_of_delay() {
    let scenario = Scenario::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(DEFAULT)).unwrap();
    assert!(scenario.delay() >= scenario.timing.period());
}
