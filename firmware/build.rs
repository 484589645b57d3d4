//! Embeds the scenario that flies, and hands the linker the board's memory.
//!
//! `SCENARIO=file.toml cargo build -p firmware …` chooses the file, relative to the top of the repository. Without it
//! an image for a board is built of a vehicle that does not exist, and never arms. `POLICY=file.toml` builds in a
//! policy, a network as docs/shield.md has it. `BOOTLOADER=kept` leaves the first
//! flash to a board's own bootloader.

#[path = "build/embed.rs"]
mod embed;
#[path = "build/policy.rs"]
mod policy;

use scenario::Scenario;
use scenario::policy::PolicyFile;
use std::path::{Path, PathBuf};
use std::{env, fs};

/// What is built in without SCENARIO, to be flown on desks and emulated boards only: tuned for 30 ms of rotor lag and a
/// whole sample of delay, certified to the rotors.
const STUDY_SCENARIO: &str = "vehicles/study.toml";

/// A network that remembers: its bits and its cost are measured.
const RECURRENT_POLICY: &str = "vehicles/policies/raptor.toml";

/// Boards and the files that describe their memory, from this package's folder.
const MEMORY_FILES: &[(&str, &str)] = &[
    ("MICOAIR_H743", "memory/stm32h743.x"),
    ("MATEK_H743", "memory/stm32h743.x"),
    ("CRAZYFLIE_BOLT", "memory/crazyflie-bolt.x"),
    ("MPS2", "memory/mps2.x"),
    ("PROBE", "memory/mps2.x"),
];

/// The same for who builds with `BOOTLOADER=kept`: behind the bootloader that the board came with.
const KEPT_MEMORY_FILES: &[(&str, &str)] = &[
    ("MICOAIR_H743", "memory/stm32h743-kept.x"),
    ("MATEK_H743", "memory/stm32h743-kept.x"),
    ("CRAZYFLIE_BOLT", "memory/crazyflie-bolt.x"),
];

fn main() {
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    scenario(&out.join("configuration.rs")).unwrap_or_else(|error| fail(&error));
    println!("cargo::rerun-if-changed=build.rs");
    if env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "none") {
        link(&out).unwrap_or_else(|error| fail(&error));
    }
}

/// One clear line instead of a panic's backtrace.
fn fail(problem: &str) -> ! {
    println!("cargo::error={problem}");
    std::process::exit(1)
}

/// Whether this is an image of a board that has motors.
fn is_for_a_vehicle() -> bool {
    env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "none") && env::var_os("CARGO_FEATURE_STM32").is_some()
}

/// The greatest rate of the image's processor, Hz: what the emulated ones have time for, `.ci/emulated cost`.
fn rate_max() -> f64 {
    let is_slow = env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "none")
        && env::var_os("CARGO_FEATURE_STM32F405").is_some();
    if is_slow { 500.0 } else { 1000.0 }
}

/// Writes what the chosen file becomes to `target`.
fn scenario(target: &Path) -> Result<(), String> {
    println!("cargo::rerun-if-env-changed=SCENARIO");
    println!("cargo::rerun-if-changed=build/embed.rs");
    println!("cargo::rerun-if-changed=build/policy.rs");
    let top = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets CARGO_MANIFEST_DIR")).join("..");
    let name = env::var("SCENARIO").unwrap_or_else(|_| STUDY_SCENARIO.to_owned());
    let file = top.join(&name);
    println!("cargo::rerun-if-changed={}", file.display());
    let text = scenario::text::read(&file)
        .map_err(|error| format!("SCENARIO {name}: cannot be read from the top of the repository: {error}"))?;
    let embedded = embed::embedded(&text, &name, rate_max())?;
    if let Some(warning) = embedded.warning {
        println!("cargo::warning={warning}");
    }
    let is_named = !is_for_a_vehicle() || env::var_os("SCENARIO").is_some();
    if !is_named {
        println!("cargo::warning=no vehicle: this image never arms; build with SCENARIO=vehicles/yours.toml");
    }
    let source = format!(
        "{}\n/// Whether the build was told which vehicle it is for.\npub const IS_NAMED: bool = {is_named};\n{}",
        embedded.source,
        carried(&top, &text, &name)?
    );
    fs::write(target, source).map_err(|error| format!("{}: {error}", target.display()))?;
    replayed(&top, &target.with_file_name("raptor.rs"))
}

/// Writes the network that [`firmware::replay`] flies, and no image that flies carries, to `target`.
fn replayed(top: &Path, target: &Path) -> Result<(), String> {
    let file = top.join(RECURRENT_POLICY);
    println!("cargo::rerun-if-changed={}", file.display());
    let text = scenario::text::read(&file).map_err(|error| format!("{RECURRENT_POLICY}: {error}"))?;
    let policy = PolicyFile::parse(&text, RECURRENT_POLICY)?;
    fs::write(target, policy::network(&policy)).map_err(|error| format!("{}: {error}", target.display()))
}

/// The source of the policy that POLICY names, for the scenario `flown` of the file `vehicle`; or of none.
fn carried(top: &Path, flown: &str, vehicle: &str) -> Result<String, String> {
    println!("cargo::rerun-if-env-changed=POLICY");
    let Ok(name) = env::var("POLICY") else { return Ok(policy::NONE.to_owned()) };
    let file = top.join(&name);
    println!("cargo::rerun-if-changed={}", file.display());
    let text = scenario::text::read(&file)
        .map_err(|error| format!("POLICY {name}: cannot be read from the top of the repository: {error}"))?;
    let scenario = Scenario::parse(flown, vehicle).map_err(|error| error.to_string())?;
    policy::source(&text, &name, &scenario)
}

/// Puts the board's memory map where ../memory.x finds it, and links the scripts of the runtime and of defmt.
fn link(out: &Path) -> Result<(), String> {
    let active = |(board, _): &&(&str, &str)| env::var_os(format!("CARGO_FEATURE_{board}")).is_some();
    let boards: Vec<_> = MEMORY_FILES.iter().filter(active).collect();
    let [(_, memory)] = boards.as_slice() else {
        let names: Vec<_> = MEMORY_FILES.iter().map(|(board, _)| board.to_lowercase().replace('_', "-")).collect();
        let names = names.join(", ");
        return Err(format!("exactly one board's feature must be on, found {}; boards: {names}", boards.len()));
    };
    println!("cargo::rerun-if-env-changed=BOOTLOADER");
    let memory = match env::var("BOOTLOADER").as_deref() {
        Err(_) => memory,
        Ok("kept") => {
            let kept =
                KEPT_MEMORY_FILES.iter().find(|(board, _)| env::var_os(format!("CARGO_FEATURE_{board}")).is_some());
            kept.map(|(_, memory)| memory).ok_or("BOOTLOADER: this board has none")?
        }
        Ok(other) => return Err(format!("BOOTLOADER: found {other:?}, allowed is \"kept\", or nothing at all")),
    };
    fs::copy(memory, out.join("board-memory.x")).map_err(|error| format!("{memory}: {error}"))?;
    // The runtime requires of every board with interrupts of its own for this file; those of the emulated boards need
    // no names.
    if env::var_os("CARGO_FEATURE_MPS2").is_some() {
        fs::write(out.join("device.x"), "").map_err(|error| format!("device.x: {error}"))?;
    }
    println!("cargo::rerun-if-changed={memory}");
    println!("cargo::rustc-link-search={}", out.display());
    for argument in ["--nmagic", "-Tlink.x", "-Tdefmt.x"] {
        println!("cargo::rustc-link-arg-bins={argument}");
    }
    Ok(())
}
