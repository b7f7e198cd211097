//! `mbs`: mechanisms from energies to proved equations of motion and to motion, on the command line.
//!
//! One file a command, each with its arguments and what it does:
//!
//! - [`check`]: is the declaration good, and can its equations be proved;
//! - [`mod@derive`]: the generated code;
//! - [`ops`]: operation counts;
//! - [`eval`]: every function's value at given states;
//! - [`linearize`]: the linear system about a state, its poles, what inputs reach;
//! - [`simulate`]: a motion as a table and as a figure;
//! - [`sweep`]: many motions as one table; [`plot`]: that table as a figure;
//! - [`fmu`]: the mechanism for tools that speak FMI;
//! - [`mod@report`]: all of it on one page, moving;
//! - [`new`]: a crate around a mechanism;
//! - [`mod@format`]: files in one style; `lsp`, a feature: what editors ask;
//! - [`explain`]: the page of a diagnostic;
//! - [`watch`]: `check` on every change;
//! - [`import`]: robots of other formats as mechanisms;
//! - [`completions`], [`man`]: for the shell.
//!
//! What they share: [`mechanism`] runs the generator's passes on a file, [`cache`] keeps what they gave, [`state`]
//! reads states, [`mod@equations`] evaluates them along a motion, `accuracy`, a feature, measures their errors,
//! [`scene`] says what there is to see of them, [`summary`] what many say together, [`output`] writes, [`message`] is
//! what standard error says, [`files`] sees that nothing that was read is overwritten, and [`failure`] is how a command
//! ends early.
//!
//! Exit codes: 0 fine, 1 the model or the input is bad, 2 wrong usage. Results go to standard output or to the files
//! asked for, once everything has succeeded; errors, warnings and the progress bar go to standard error.

#[cfg(feature = "accuracy")]
mod accuracy;
mod cache;
mod check;
mod completions;
mod derive;
mod eigenvalues;
mod equations;
mod eval;
mod explain;
mod failure;
mod files;
mod fmu;
mod format;
mod import;
mod linearize;
#[cfg(feature = "lsp")]
mod lsp;
mod man;
mod mechanism;
mod message;
mod new;
mod ops;
mod output;
mod plot;
mod report;
mod scene;
mod simulate;
mod state;
mod summary;
mod sweep;
mod watch;
mod words;

use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};

use cache::Cache;
use failure::Failure;

/// What stands below the help.
const EXIT_CODES: &str = "Exit codes: 0 fine, 1 the model or the input is bad, 2 wrong usage.\n`mbs COMMAND --help` has options and an example.";

/// Mechanisms from energies to proved equations of motion, and to motion.
#[derive(Parser)]
#[command(name = "mbs", version, after_help = EXIT_CODES)]
struct Arguments {
    /// Derive and prove the mechanism in any case. Else what an earlier call has derived from the same texts is taken
    /// from the user's cache folder, or from MBS_CACHE_DIR.
    #[arg(long, global = true)]
    no_cache: bool,
    /// Print results as JSON on standard output, and messages on standard error, an object a line: severity, message;
    /// code, help, file, line and column where it is about a text.
    #[arg(long, global = true)]
    json: bool,
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Check(check::Arguments),
    Derive(derive::Arguments),
    Ops(ops::Arguments),
    Eval(eval::Arguments),
    Linearize(linearize::Arguments),
    Simulate(Box<simulate::Arguments>),
    Sweep(sweep::Arguments),
    Plot(plot::Arguments),
    Fmu(fmu::Arguments),
    Fmt(format::Arguments),
    #[cfg(feature = "lsp")]
    Lsp(lsp::Arguments),
    /// Serve an editor, which needs another build.
    #[cfg(not(feature = "lsp"))]
    #[command(hide = true)]
    Lsp {
        #[arg(long)]
        stdio: bool,
    },
    Report(report::Arguments),
    New(new::Arguments),
    Explain(explain::Arguments),
    Watch(watch::Arguments),
    Completions(completions::Arguments),
    Man(man::Arguments),
    Import(import::Arguments),
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    if arguments.json {
        output::speak_json();
    }
    let cache = if arguments.no_cache { Cache::none() } else { Cache::of_user() };
    match run(arguments.command, &cache) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            output::report(failure.messages());
            ExitCode::from(failure.code())
        }
    }
}

fn run(command: Command, cache: &Cache) -> Result<(), Failure> {
    match command {
        Command::Check(arguments) => check::run(&arguments, cache),
        Command::Derive(arguments) => derive::run(&arguments, cache),
        Command::Ops(arguments) => ops::run(&arguments),
        Command::Eval(arguments) => eval::run(&arguments, cache),
        Command::Linearize(arguments) => linearize::run(&arguments, cache),
        Command::Simulate(arguments) => simulate::run(&arguments, cache),
        Command::Sweep(arguments) => sweep::run(&arguments, cache),
        Command::Plot(arguments) => plot::run(&arguments),
        Command::Fmu(arguments) => fmu::run(&arguments, cache),
        Command::Fmt(arguments) => format::run(&arguments),
        #[cfg(feature = "lsp")]
        Command::Lsp(arguments) => lsp::run(&arguments),
        #[cfg(not(feature = "lsp"))]
        Command::Lsp { .. } => Err(Failure::of_feature("lsp")),
        Command::Report(arguments) => report::run(&arguments, cache),
        Command::New(arguments) => new::run(&arguments),
        Command::Explain(arguments) => explain::run(&arguments),
        Command::Watch(arguments) => watch::run(&arguments, cache),
        Command::Completions(arguments) => completions::run(&arguments, Arguments::command()),
        Command::Man(arguments) => man::run(&arguments, Arguments::command()),
        Command::Import(arguments) => import::run(&arguments),
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    #[test]
    fn arguments_are_consistent() {
        super::Arguments::command().debug_assert();
    }
}
