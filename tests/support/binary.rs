//! The binary in a directory of its own, and what it left there.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The paper's scenario file.
pub const PAPER: &str = include_str!("../../scenarios/paper.toml");

/// Requirements that Table I meets, so that a search may be quick.
const EASY_REQUIREMENTS: [&str; 11] = [
    "--margin",
    "0",
    "--gain-margin",
    "1.5",
    "--delay-margin",
    "2",
    "--mrp-error",
    "0.001",
    "--recovery",
    "40",
    "--no-projection",
];

/// The arguments of a search by them, so many generations long.
pub fn search<'a>(file: &'a str, out: &'a str, generations: &'a str) -> Vec<&'a str> {
    [&["tune", file, "--out", out, "--generations", generations, "--population", "8"][..], &EASY_REQUIREMENTS].concat()
}

/// A directory of its own for each test, empty at the start.
pub fn directory(suite: &str, test: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(suite).join(test);
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).unwrap();
    path
}

pub fn host_sim(directory: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_host-sim")).args(arguments).current_dir(directory).output().unwrap()
}

pub fn status(output: &Output) -> i32 {
    output.status.code().unwrap()
}

pub fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

pub fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

pub fn files(directory: &Path) -> Vec<String> {
    let name = |entry: std::io::Result<std::fs::DirEntry>| entry.unwrap().file_name().into_string().unwrap();
    let mut names: Vec<String> = std::fs::read_dir(directory).unwrap().map(name).collect();
    names.sort();
    names
}

/// `file` with the one line that starts with `line` replaced.
pub fn with(file: &str, line: &str, replacement: &str) -> String {
    assert_eq!(file.lines().filter(|found| found.starts_with(line)).count(), 1, "{line}");
    file.lines().map(|found| if found.starts_with(line) { replacement } else { found }).collect::<Vec<_>>().join("\n")
}

/// Table I, a second of flight that starts on its reference.
pub fn brief() -> String {
    let head = with(PAPER, "duration", "duration = 1.0");
    format!("{}[reference]\nkind = \"hover\"\nposition = [0, 0, 1]\n", head.split("[initial]").next().unwrap())
}
