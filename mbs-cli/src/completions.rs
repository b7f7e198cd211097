//! `mbs completions`: what a shell completes.

use clap_complete::Shell;
use serde_json::json;

use crate::failure::Failure;
use crate::output;

/// Print a script by which a shell completes commands, options and their values.
#[derive(clap::Args)]
#[command(after_help = "\
Example:
  mbs completions bash

In ~/.bashrc: `source <(mbs completions bash)`; for zsh, a file `_mbs` in a folder of $fpath; for fish,
~/.config/fish/completions/mbs.fish; for PowerShell, a line of $PROFILE: `mbs completions powershell | Out-String |
Invoke-Expression`.")]
pub(crate) struct Arguments {
    /// The shell.
    #[arg(value_enum)]
    shell: Shell,
}

/// Prints the script.
pub(crate) fn run(arguments: &Arguments, mut command: clap::Command) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut command, "mbs", &mut script);
    let script = String::from_utf8_lossy(&script).into_owned();
    output::answer(|| json!({ "shell": arguments.shell.to_string(), "script": script }), || script.clone())
}
