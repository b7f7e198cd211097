//! `mbs`: mechanisms from energies to proved equations of motion and to motion, on the command line.
//!
//! One file a command, each with its arguments and what it does:
//!
//! - [`check`]: is the declaration good, and can its equations be proved;
//! - [`mod@derive`]: the generated code;
//! - [`ops`]: operation counts;
//! - [`eval`]: every function's value at given states;
//! - [`linearize`]: the linear system about a state, its poles, what inputs reach;
//! - [`simulate`]: a motion as a table and as a figure.
//!
//! What they share: [`mechanism`] runs the generator's passes on a file, [`state`] reads states, [`mod@equations`]
//! evaluates them along a motion, [`output`] writes, [`files`] sees that nothing
//! that was read is overwritten, and [`failure`] is how a command ends early.
//!
//! Exit codes: 0 fine, 1 the model or the input is bad, 2 wrong usage. Results go to standard output or to the files
//! asked for, once everything has succeeded; errors, warnings and the progress bar go to standard error.

mod check;
mod derive;
mod equations;
mod eval;
mod failure;
mod files;
mod linearize;
mod mechanism;
mod ops;
mod output;
mod simulate;
mod state;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use failure::Failure;

/// Mechanisms from energies to proved equations of motion, and to motion.
///
/// Exit codes: 0 fine, 1 the model or the input is bad, 2 wrong usage.
#[derive(Parser)]
#[command(name = "mbs", version)]
struct Arguments {
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
    Simulate(simulate::Arguments),
}

fn main() -> ExitCode {
    match run(Arguments::parse().command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            output::report(failure.report());
            ExitCode::from(1)
        }
    }
}

fn run(command: Command) -> Result<(), Failure> {
    match command {
        Command::Check(arguments) => check::run(&arguments),
        Command::Derive(arguments) => derive::run(&arguments),
        Command::Ops(arguments) => ops::run(&arguments),
        Command::Eval(arguments) => eval::run(&arguments),
        Command::Linearize(arguments) => linearize::run(&arguments),
        Command::Simulate(arguments) => simulate::run(&arguments),
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
