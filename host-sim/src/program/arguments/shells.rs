//! What shells and `man` need to know of the command line, from its own description; and editors, of scenario files.

use clap::{Args, Command};
use clap_complete::Shell;
use clap_mangen::Man;
use host_sim::output::whole_file::WholeFile;
use std::io;
use std::path::{Path, PathBuf};

/// The end of `completions --help`.
pub const COMPLETIONS_HELP: &str = "\
bash, for you alone, from the next shell on:
  mkdir -p ~/.local/share/bash-completion/completions
  host-sim completions bash \\
    > ~/.local/share/bash-completion/completions/host-sim

zsh, in a folder of fpath; fish, in ~/.config/fish/completions/host-sim.fish;
PowerShell and elvish, in the profile.";

/// The end of `schema --help`.
pub const SCHEMA_HELP: &str = "\
  host-sim schema > scenario.schema.json
and, as the first line of a scenario beside it, for taplo and Even Better TOML:
  #:schema ./scenario.schema.json
It names every section and key, with type, unit, bounds, default and meaning.";

/// A shell.
#[derive(Args)]
pub struct CompletionsArguments {
    /// The shell
    shell: Shell,
}

/// Where manual pages go.
#[derive(Args)]
pub struct ManArguments {
    /// Directory for host-sim.1, host-sim-fly.1 and so on, such as ~/.local/share/man/man1
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
}

/// The completions of `program` for a shell.
pub fn completions(arguments: &CompletionsArguments, mut program: Command) -> Vec<u8> {
    let mut text = Vec::new();
    clap_complete::generate(arguments.shell, &mut program, "host-sim", &mut text);
    text
}

/// Writes every manual page of `program` into `directory`; how many.
///
/// # Errors
/// Of the first page that cannot be written.
pub fn manual(directory: &Path, mut program: Command) -> io::Result<usize> {
    std::fs::create_dir_all(directory)?;
    program.build();
    let commands = program.get_subcommands().filter(|command| !command.is_hide_set() && command.get_name() != "help");
    let pages: Vec<Command> = commands.cloned().chain([program.clone()]).collect();
    for page in &pages {
        let name = page.get_display_name().unwrap_or("host-sim");
        let mut file = WholeFile::create(&directory.join(format!("{name}.1")))?;
        Man::new(page.clone()).render(&mut file)?;
        file.finish()?;
    }
    Ok(pages.len())
}
