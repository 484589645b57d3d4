//! What the pages show is true: trycmd runs each `host-sim` command in their `console` blocks and compares its output,
//! in which `...` stands for any lines and `[..]` for any part of one. A command that shows no output may print
//! anything. Commands in running text must work, whatever they print. Blocks of `console,nightly`, and searches and
//! campaigns in running text, run if `PAGES=all`, as `.ci/nightly` has it. Every other command must be one that `.ci/`
//! runs, or have a reason here. `HOST_SIM` is the program to run, from the repository's root; else the tests' own.
//!
//! A block of TOML that names a file in its first line, `# mine.toml`, is that file. Each page has a folder of its own
//! with these files, `vehicles/`, `scenarios/`, `tests/numbers/vehicle_import/` and `tests/real_flights/`.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::{env, fs};
use trycmd::TestCases;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

/// What nothing in `.ci/` runs as the pages write it, by how it begins, and why.
const NOT_RUN: &[(&str, &str)] = &[
    ("host-sim sitl", "serves until it is stopped; `.ci/clients` flies it"),
    ("host-sim log LOG", "needs a card's file; `.ci/logs` converts one"),
    ("host-sim first-flight", "asks a person; `.ci/boards` walks it with one"),
    ("host-sim hil", "serves firmware that runs elsewhere; `.ci/emulated_flight` flies it"),
    ("cargo micoair", "flashes a board"),
    ("cargo matek", "flashes a board"),
    ("cargo bolt", "flashes a board"),
    ("cargo build --profile board", "`.ci/budgets` builds these images by `.ci/arm`"),
    ("cargo add", "for a crate of the reader's own"),
    ("pip install", "`.ci/wheel` installs the same"),
    (".ci/wasm", "`.ci/page` builds by it where rustup has no such target"),
    (".ci/rotorpy", "needs the network, and judges no figure"),
    ("make -C proofs", "`.ci/proofs broken` runs both"),
    ("python", "`.ci/wheel` runs the same code"),
    ("mavproxy.py", "a prompt; `.ci/clients` types the same"),
    ("openssl", "not ours; `.ci/clients signed` takes such a key"),
];

/// Pages by name, with their text.
fn pages() -> Vec<(String, String)> {
    let docs = fs::read_dir(Path::new(ROOT).join("docs")).unwrap();
    let docs = docs.map(|entry| format!("docs/{}", entry.unwrap().file_name().into_string().unwrap()));
    let names = ["README.md", "CONTRIBUTING.md", "vehicles/README.md", "python/README.md"].map(str::to_owned);
    let names = names.into_iter().chain(docs.filter(|name| name.ends_with(".md")));
    names.map(|name| (name.clone(), fs::read_to_string(Path::new(ROOT).join(name)).unwrap())).collect()
}

/// Each line with its number and the name of the block that it is in. Text outside blocks, and their fences, have none.
fn lines(text: &str) -> impl Iterator<Item = (usize, Option<&str>, &str)> {
    let mut block = None;
    text.lines().enumerate().map(move |(number, line)| {
        let fence = line.trim_start().strip_prefix("```");
        if let Some(name) = fence {
            block = if block.is_some() { None } else { Some(name) };
        }
        (number, block.filter(|_| fence.is_none()), line)
    })
}

fn everything() -> bool {
    env::var("PAGES").is_ok_and(|pages| pages == "all")
}

/// The blocks of a page that trycmd shall run, on the lines where they stand.
fn runnable(text: &str) -> String {
    // The two commands that the README opens with.
    let text = text.replace("cargo run --release -p host-sim --", "host-sim");
    let text = text.replace("cargo run --release -p host-sim", "host-sim");
    let runs = |block: &str| block == "console" || block == "console,nightly" && everything();
    let mut kept: Vec<&str> = Vec::new();
    let (mut inside, mut is_long) = (false, false);
    for (number, block, line) in lines(&text) {
        let was = inside;
        inside = block.is_some_and(runs);
        if inside && !was {
            kept.resize(kept.len().max(number - 1), "");
            kept.push("```console");
        }
        if was && (!inside || line.starts_with("$ ")) {
            match kept.last() {
                Some(last) if last.starts_with("$ ") || last.starts_with("? ") => kept.push("..."),
                Some(&"...") => (),
                // trycmd takes one end of line away.
                _ => kept.push(""),
            }
        }
        if inside {
            // What takes seconds on a busy machine says how far it is, first of all; the status is no output.
            if is_long && !line.starts_with("? ") {
                kept.push("...");
                is_long = false;
            }
            if (line, kept.last()) != ("...", Some(&"...")) {
                kept.push(line);
            }
            is_long |=
                ["$ host-sim campaign", "$ host-sim compare", "$ host-sim tune"].iter().any(|at| line.starts_with(at));
        } else if was {
            is_long = false;
            kept.push("```");
        }
    }
    kept.join("\n") + "\n"
}

fn copy(from: &Path, to: &Path) {
    if from.is_dir() {
        fs::create_dir_all(to).unwrap();
        for entry in fs::read_dir(from).unwrap() {
            let name = entry.unwrap().file_name();
            copy(&from.join(&name), &to.join(&name));
        }
    } else {
        fs::copy(from, to).unwrap();
    }
}

/// A new folder with all that commands may name.
fn workplace(folder: &Path, pages: &[(String, String)]) {
    for name in ["vehicles", "scenarios", "tests/numbers/vehicle_import", "tests/real_flights"] {
        copy(&Path::new(ROOT).join(name), &folder.join(name));
    }
    for block in pages.iter().flat_map(|(_, text)| text.split("```toml\n").skip(1)) {
        let block = block.split("```").next().unwrap_or_default();
        let named = block.lines().next().and_then(|line| line.split_once("# ")).map(|(_, comment)| comment);
        let named = named.and_then(|comment| comment.split([' ', ':']).next()).filter(|name| name.ends_with(".toml"));
        if let Some(name) = named {
            fs::write(folder.join(name), block).unwrap();
        }
    }
}

/// An empty folder under target/.
fn scratch(name: &str) -> PathBuf {
    let scratch = Path::new(env!("CARGO_TARGET_TMPDIR")).join("pages").join(name);
    let _ = fs::remove_dir_all(&scratch);
    fs::create_dir_all(&scratch).unwrap();
    scratch
}

fn host_sim() -> PathBuf {
    env::var("HOST_SIM").map_or(env!("CARGO_BIN_EXE_host-sim").into(), |program| Path::new(ROOT).join(program))
}

fn run(arguments: &[&str], folder: &Path) -> Output {
    Command::new(host_sim()).args(arguments).current_dir(folder).output().unwrap()
}

#[test]
fn what_the_pages_show_is_what_the_program_prints() {
    let (pages, scratch) = (pages(), scratch("shown"));
    let cases = TestCases::new();
    cases.register_bin("host-sim", host_sim());
    for (name, text) in &pages {
        let page = scratch.join(name.replace('/', "-"));
        fs::write(&page, runnable(text)).unwrap();
        // Where trycmd runs a page's commands.
        workplace(&page.with_extension("in"), &pages);
        cases.case(page);
    }
}

/// A command without prompt, comment and environment, if that is what a line or a piece of running text is.
fn command(text: &str) -> Option<&str> {
    let text = text.trim();
    let prompted = text.strip_prefix("$ ");
    let mut command = prompted.unwrap_or(text);
    command = command.split(" #").next().unwrap_or_default().trim_end();
    while let Some((_, rest)) = command.split_once(' ').filter(|(first, _)| first.contains('=')) {
        command = rest;
    }
    let (program, _) = command.split_once(' ').unwrap_or_default();
    let ours = ["host-sim", "cargo", "pip", "python", "python3"].contains(&program);
    let script = command.strip_prefix(".ci/").is_some_and(|name| !name.is_empty());
    (ours || script || prompted.is_some()).then_some(command)
}

/// Commands, each with its page.
type Commands<'a> = BTreeSet<(String, &'a str)>;

/// What the pages show in blocks that trycmd runs, and elsewhere.
fn commands(pages: &[(String, String)]) -> (Commands<'_>, Commands<'_>) {
    let (mut run, mut other) = (Commands::new(), Commands::new());
    for (page, text) in pages {
        let found = |text: &str| command(text).map(|command| (command.to_owned(), page.as_str()));
        // A command may go on in the next line.
        let mut running = String::new();
        for (_, block, line) in lines(text) {
            match block {
                Some("console" | "console,nightly") => run.extend(found(line).filter(|_| line.starts_with("$ "))),
                Some("toml" | "python" | "mermaid") => (),
                Some(_) => {
                    let command = found(line);
                    let compared =
                        command.iter().all(|(command, _)| !command.starts_with("host-sim") || excused(command));
                    assert!(compared, "{page}: {line}: belongs into a block of console");
                    other.extend(command);
                }
                None if line.trim_start().starts_with("```") => (),
                None => running = running + line.trim() + " ",
            }
        }
        other.extend(running.split('`').skip(1).step_by(2).filter_map(found));
    }
    (run, other)
}

/// Whether it stands for several commands: `host-sim certify FILE`, or for the subcommand as such: `host-sim certify`.
fn is_pattern(command: &str) -> bool {
    let capitals = |word: &str| word.len() > 3 && word.bytes().all(|byte| byte.is_ascii_uppercase());
    command.split([' ', '/', '.']).any(capitals) || command.split(' ').count() == 2
}

fn excused(command: &str) -> bool {
    NOT_RUN.iter().any(|(start, _)| command.starts_with(start))
}

#[test]
fn every_option_that_the_pages_name_exists() {
    let (pages, scratch) = (pages(), scratch("help"));
    let (run_by_trycmd, other) = commands(&pages);
    for (command, page) in other.union(&run_by_trycmd).filter(|(command, _)| command.starts_with("host-sim ")) {
        let mut words = command.split(' ').skip(1);
        let subcommand = words.next().filter(|&word| word != "COMMAND").unwrap_or("--help");
        let help = run(&[subcommand, "--help"], &scratch);
        assert!(help.status.success(), "{page}: {command}: {}", String::from_utf8_lossy(&help.stderr));
        let help = String::from_utf8(help.stdout).unwrap();
        for option in words.filter(|word| word.starts_with("--")) {
            assert!(help.contains(&format!("{option} ")) || help.contains(&format!("{option}\n")), "{page}: {command}");
        }
    }
}

#[test]
fn commands_in_running_text_can_be_used() {
    let (pages, scratch) = (pages(), scratch("text"));
    let (run_by_trycmd, other) = commands(&pages);
    let run_by_trycmd: BTreeSet<String> = run_by_trycmd.into_iter().map(|(command, _)| command).collect();
    workplace(&scratch, &pages);
    for (command, page) in other {
        let Some(arguments) = command.strip_prefix("host-sim ") else { continue };
        let long = arguments.starts_with("tune") || arguments.contains("--flights");
        if is_pattern(&command) || excused(&command) || run_by_trycmd.contains(&command) || long && !everything() {
            continue;
        }
        // It may fail a claim, as some pages say that theirs does.
        let output = run(&arguments.split(' ').collect::<Vec<_>>(), &scratch);
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(matches!(output.status.code(), Some(0 | 1)), "{page}: {command}: {errors}");
    }
}

/// All Rust that has tests.
fn sources(folder: &Path, found: &mut String) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            *found += &fs::read_to_string(path).unwrap();
        }
    }
}

#[test]
fn what_is_not_host_sim_is_run_by_ci_or_excused() {
    let mut tests = String::new();
    for folder in ["tests", "host-sim/src", "controller-core/src", "scenario/src", "firmware"] {
        sources(&Path::new(ROOT).join(folder), &mut tests);
    }
    let names: Vec<&str> = tests.lines().filter(|line| line.contains("fn ") || line.contains("mod ")).collect();
    let scripts = fs::read_dir(Path::new(ROOT).join(".ci")).unwrap();
    let scripts: String = scripts.map(|script| fs::read_to_string(script.unwrap().path()).unwrap()).collect();
    // A script names itself in its comments alone.
    let scripts: String = scripts.split_inclusive('\n').filter(|line| !line.starts_with('#')).collect();
    let plain = |text: &str| text.replace(" --locked", "").replace(" -- --nocapture", "");
    let scripts = plain(&scripts) + ".ci/run .ci/nightly";

    let pages = pages();
    let (run_by_trycmd, other) = commands(&pages);
    for (command, page) in &run_by_trycmd {
        let ours = command.starts_with("host-sim ") || command.starts_with("cargo run --release -p host-sim");
        assert!(ours, "{page}: {command}: a block of console is for host-sim alone");
    }
    let mut missing = Vec::new();
    for (command, page) in other.iter().filter(|(command, _)| !command.starts_with("host-sim ")) {
        let command = plain(command);
        let script = command.split(' ').next().filter(|program| program.starts_with(".ci/"));
        // CI runs all tests of these packages, so any of them by its name.
        let test = command.strip_prefix("cargo test -p ").map(|rest| rest.split_once(' ').unwrap_or((rest, "NAME")));
        let test = test.map(|(package, name)| (package, name.trim_start_matches("--lib ")));
        let tested = |(package, name): (&str, &str)| {
            let mut parts = name.split("::").filter(|part| !part.is_empty());
            let exists = parts.all(|part| names.iter().any(|line| line.contains(part)));
            scripts.contains(&format!("-p {package}")) && (exists || name == "NAME")
        };
        let covered = excused(&command) || test.is_some_and(tested) || scripts.contains(&command);
        let covered = covered || script.is_some_and(|script| scripts.contains(script));
        if !covered {
            missing.push(format!("{page}: {command}"));
        }
    }
    assert!(
        missing.is_empty(),
        ".ci/ runs none of these: let it, or say why not in tests/program/pages.rs: {missing:#?}"
    );
    for (start, _) in NOT_RUN {
        assert!(other.iter().any(|(command, _)| command.starts_with(start)), "{start}: no page shows it any more");
    }
}
