//! `burnish completions`: what a shell has to know to complete our arguments.

use super::{Failure, command};
use clap_complete::Shell;
use std::io::{self, Write};

/// Prints the completions of a shell.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  burnish completions bash > ~/.local/share/bash-completion/completions/burnish
  burnish completions zsh > ~/.zfunc/_burnish          with ~/.zfunc in fpath, before compinit
  burnish completions fish > ~/.config/fish/completions/burnish.fish")]
pub(super) struct Args {
    /// Which shell.
    shell: Shell,
}

/// Prints.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    // Not straight to stdout: the generator panics where it cannot write.
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut command(), "burnish", &mut script);
    Ok(io::stdout().lock().write_all(&script)?)
}
