//! Any text as a scenario file: refused in one line, or read.

#![no_main]

use libfuzzer_sys::fuzz_target;
use scenario::Scenario;

fuzz_target!(|text: &str| {
    if let Err(error) = Scenario::parse(text, "file.toml") {
        let line = error.to_string();
        assert!(line.starts_with("file.toml: ") && line.lines().count() == 1, "{line}");
    }
});
