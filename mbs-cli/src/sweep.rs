//! `mbs sweep`: many motions as one table.
//!
//! - [`study`]: a plan and its mechanism, and what is wrong with either;
//! - [`names`]: the variables that a plan may fix or vary;
//! - [`gathering`]: what is taken of each motion;
//! - [`start`]: what constraints leave of the state that a member is to start with;
//! - [`ranks`]: processes that MPI has started.
//!
//! What all of them say together is a `Summary`.

mod gathering;
mod names;
mod ranks;
mod start;
mod study;

use std::io::{self, IsTerminal};
use std::path::{Path, PathBuf};
use std::time::Instant;

use indicatif::{ProgressBar, ProgressStyle};
use mbs_ensemble::SweepError;
use mbs_ensemble::design::Values;
use mbs_ensemble::distribution::Distribution;
use mbs_ensemble::sweep::{Outcome, Share, Sweep};
use mbs_ensemble::table::{Format, Table};
use mbs_native::Compilers;
use serde_json::{Value, json};

use crate::cache::Cache;
use crate::failure::Failure;
use crate::files::Files;
use crate::output;
use crate::summary::Summary;
use crate::words::plural;
use ranks::Ranks;
use study::{Engine, Study};

/// Integrate many motions of a mechanism, on all cores, and write what is wanted of each as a row of a table.
///
/// The plan says which parameters, first states and inputs vary, and how: grids, random numbers, Latin hypercubes,
/// Sobol's sequence; and which quantities are wanted. Members are functions of the plan and their index alone. A run
/// that is killed goes on when the same command is given again: what is done stands in FILE.parts until all is.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  mbs sweep swings.toml --out swings.csv")]
pub(crate) struct Arguments {
    /// The plan.
    #[arg(value_name = "PLAN.toml")]
    plan: PathBuf,
    /// Where the table goes, as CSV or, with the feature `parquet`, as Apache Parquet; beside the plan if not given.
    #[arg(long, value_name = "FILE.csv|FILE.parquet", value_parser = table_path)]
    out: Option<(PathBuf, Format)>,
    /// On how many threads; as many as there are cores if not given.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// The C compiler that compiles the equations of motion; what the variables MBS_CC or CC name, or else cc, gcc or
    /// clang, if not given. Without one, members are interpreted: the same bytes, but slower.
    #[arg(long, value_name = "COMMAND")]
    compiler: Option<String>,
    /// Compile nothing: interpret.
    #[arg(long, conflicts_with = "compiler")]
    interpret: bool,
    /// Find what is wrong with the plan, say what it amounts to, and run nothing.
    #[arg(long)]
    dry_run: bool,
    /// Do one share of the members, that of the rank K of N, from 0; all ranks may run at once, on machines that share
    /// the folder.
    #[arg(long, value_name = "K", requires = "ranks")]
    rank: Option<u64>,
    /// How many ranks there are.
    #[arg(long, value_name = "N", requires = "rank", value_parser = clap::value_parser!(u64).range(1..))]
    ranks: Option<u64>,
    /// Do the share that `mpirun`, `srun` or another launcher gives this process, by its rank in the environment; the
    /// last that is done makes the table. With the feature `mpi` ranks find each other without it, and rank 0 makes the
    /// table.
    #[arg(long, conflicts_with_all = ["rank", "dry_run", "merge", "summary"])]
    launched: bool,
    /// Make the table of what all ranks have done, and run nothing.
    #[arg(long, conflicts_with_all = ["rank", "dry_run"])]
    merge: bool,
    /// Print means and quantiles of the quantities, with bounds at a confidence of 95 %, and with the designs
    /// `saltelli` and `chaos` the Sobol' indices of what varies; of the table where it is there already.
    /// It keeps all numbers in memory.
    #[arg(long, conflicts_with_all = ["rank", "dry_run"])]
    summary: bool,
}

/// Reads, checks, integrates, writes.
pub(crate) fn run(arguments: &Arguments, cache: &Cache) -> Result<(), Failure> {
    let is_alone = arguments.rank.is_some() || arguments.launched || arguments.dry_run || arguments.merge;
    let ranks = if is_alone { None } else { Ranks::joined() };
    match (run_with(arguments, cache, ranks.as_ref()), &ranks) {
        (Err(failure), Some(ranks)) => {
            output::report(failure.messages());
            ranks.abort()
        }
        (outcome, _) => outcome,
    }
}

fn run_with(arguments: &Arguments, cache: &Cache, ranks: Option<&Ranks>) -> Result<(), Failure> {
    let mut files = Files::default();
    let mut study = Study::read(&arguments.plan, cache, &mut files)?;
    let (table, format) = arguments.out.clone().unwrap_or_else(|| (study::table_of(&arguments.plan), Format::Csv));
    files.writes("--out", &table)?;
    if arguments.dry_run {
        return output::answer(|| preview_object(&study), || preview(&study));
    }
    let share = ranks.map_or_else(|| share(arguments), |ranks| Ok(ranks.share()))?;
    let design = study.design.clone();
    let sweep = Sweep {
        design: &design,
        quantities: study.columns.clone(),
        table: table.clone(),
        format,
        identity: study.identity.clone(),
    };
    match sweep.is_finished() {
        Ok(false) => {}
        Ok(true) | Err(SweepError::Exists { .. }) if arguments.summary => return summarize(&sweep, &study),
        Ok(true) => return output::wrote(&[&table]),
        Err(error) => return Err(Failure::new(error)),
    }
    let began = Instant::now();
    let threads = arguments.threads.map_or_else(cores, usize::from);
    let mut done = 0;
    if !arguments.merge {
        if !arguments.interpret {
            compile(&mut study, arguments.compiler.as_deref(), cache);
        }
        done = integrate(&sweep, &study, share, threads)?;
        study.moved_starts().iter().for_each(output::warn);
    }
    let is_left_to_others = match ranks {
        Some(ranks) => {
            ranks.wait();
            share.rank > 0
        }
        None if arguments.launched => match sweep.missing(Share::WHOLE) {
            Ok(missing) => !missing.is_empty(),
            // Another one that was last has made the table, and takes away what there was beside it.
            Err(_) if sweep.is_written() => true,
            Err(error) => return Err(Failure::new(error)),
        },
        None => arguments.rank.is_some(),
    };
    if is_left_to_others {
        return answer_share(share, &study, done, ranks.is_some());
    }
    let mut summary = arguments.summary.then(|| Summary::of(&study.design, &study.columns));
    let outcome = sweep.merge(|quantities| summary.iter_mut().for_each(|summary| summary.push(quantities)));
    let outcome = match outcome {
        // Two that were last make one table: the other one is at it, or is done.
        Err(SweepError::Busy { .. }) if arguments.launched => return answer_share(share, &study, done, true),
        Err(SweepError::Missing { .. } | SweepError::Exists { .. }) if arguments.launched && sweep.is_written() => {
            return answer_share(share, &study, done, true);
        }
        outcome => outcome.map_err(Failure::new)?,
    };
    if let Some((first, reason)) = &outcome.first_stopped {
        let stopped = plural(outcome.stopped as usize, "member", "members");
        output::warn(format_args!("{stopped} of {} stopped; the first is {first}: {reason}", outcome.members));
    }
    let seconds = began.elapsed().as_secs_f64();
    let text = || {
        let table = table.display();
        let shown = summary.as_ref().map_or(String::new(), Summary::text);
        let members = plural(outcome.members as usize, "member", "members");
        let engine = study.engine().name();
        format!("{table}: {members}, {done} by {engine} on {threads} threads in {seconds:.1} s\n{shown}")
    };
    output::answer(|| object(&table, &outcome, Some(study.engine()), summary.as_ref()), text)
}

/// What a table says that is there already, and was made of the same.
fn summarize(sweep: &Sweep<'_>, study: &Study) -> Result<(), Failure> {
    let (name, read) = (sweep.table.display(), Table::read(&sweep.table).map_err(Failure::new)?);
    let differences = read.differences(&sweep.identity);
    if !differences.is_empty() {
        let what = differences.join(" and ");
        return Err(Failure::new(format_args!(
            "{name} is a table of another run: not of {what} as it is now; remove it, write to another file, or \
             summarize it by `mbs plot {name} --summary`"
        )));
    }
    let members = sweep.design.members();
    if read.rows as u64 != members {
        return Err(Failure::new(format_args!("{name} has {} rows, the plan has {members} members", read.rows)));
    }
    let summary = Summary::of(sweep.design, &study.columns).filled(&read);
    let outcome = Outcome { members, stopped: read.stopped as u64, first_stopped: None };
    let text = || format!("{name}: {} read\n{}", plural(read.rows, "member", "members"), summary.text());
    output::answer(|| object(&sweep.table, &outcome, None, Some(&summary)), text)
}

/// Which members this process does.
fn share(arguments: &Arguments) -> Result<Share, Failure> {
    match (arguments.rank, arguments.ranks) {
        (Some(rank), Some(ranks)) if rank >= ranks => {
            Err(Failure::new(format_args!("--rank {rank} is none of {ranks}: the first is 0")))
        }
        (Some(rank), Some(ranks)) => Ok(Share { rank, ranks }),
        _ if arguments.launched => Share::launched(|name| std::env::var(name).ok()).ok_or_else(|| {
            Failure::new(
                "--launched: no launcher has set a rank; OpenMPI, MPICH and Slurm do, others take --rank and --ranks",
            )
        }),
        _ => Ok(Share::WHOLE),
    }
}

/// What is said of a share, of which another rank makes a table without being told, or not.
fn answer_share(share: Share, study: &Study, done: u64, is_merged: bool) -> Result<(), Failure> {
    let members = share.members(study.design.members());
    let object = || json!({ "done": done, "first": members.start, "end": members.end, "engine": study.engine().key() });
    let text = || {
        let (done, Share { rank, ranks }) = (plural(done as usize, "member", "members"), share);
        let engine = study.engine().name();
        let next = if is_merged { "" } else { "; `--merge` makes the table of all" };
        format!("{done} done by rank {rank} of {ranks}, by {engine}{next}\n")
    };
    output::answer(object, text)
}

/// Compiles the equations; why that cannot be is no error: they are interpreted then.
fn compile(study: &mut Study, compiler: Option<&str>, cache: &Cache) {
    let compilers = compiler.map_or_else(Compilers::of_environment, Compilers::named);
    if let Err(reason) = study.compile(&compilers, cache) {
        output::warn(format_args!("{reason}; members are interpreted, which takes longer"));
    }
}

fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
}

/// Does what is missing of a share, and says how much that was.
fn integrate(sweep: &Sweep<'_>, study: &Study, share: Share, threads: usize) -> Result<u64, Failure> {
    let missing: u64 = sweep.missing(share).map_err(Failure::new)?.iter().map(|range| range.end - range.start).sum();
    let bar = if io::stderr().is_terminal() { ProgressBar::new(missing) } else { ProgressBar::hidden() };
    let style = ProgressStyle::with_template("{wide_bar} {pos}/{len} members  {elapsed} elapsed, {eta} left");
    let bar = style.map_or(bar.clone(), |style| bar.with_style(style));
    let outcome = sweep.run(study, share, threads, &|count| bar.inc(count));
    bar.finish_and_clear();
    outcome.map(|()| missing).map_err(|error| match error {
        SweepError::Io { .. } => {
            let parts = sweep.parts();
            Failure::new(format_args!("{error}; what is done stays in {}, the same command goes on", parts.display()))
        }
        other => Failure::new(other),
    })
}

/// What was written by an engine, or read.
fn object(table: &Path, outcome: &Outcome, engine: Option<Engine>, summary: Option<&Summary>) -> Value {
    let file = table.display().to_string();
    let mut object = match engine {
        Some(engine) => json!({ "written": [file], "engine": engine.key() }),
        None => json!({ "read": file }),
    };
    object["members"] = outcome.members.into();
    object["stopped"] = outcome.stopped.into();
    if let Some(summary) = summary {
        object["summary"] = summary.object();
    }
    object
}

/// How many members a preview shows.
const SHOWN: u64 = 3;

fn preview(study: &Study) -> String {
    let design = &study.design;
    let mut text = format!("{}\nvaries:\n", plural(design.members() as usize, "member", "members"));
    for variable in design.variables() {
        let how = match &variable.spread {
            Values::Listed(values) => plural(values.len(), "value", "values"),
            Values::Range { from, to, count } => format!("{count} values from {from:?} to {to:?}"),
            Values::Drawn(distribution) => in_words_of_the_plan(distribution),
        };
        text += &format!("  {} [{}]: {how}\n", variable.name, variable.unit);
    }
    text += "quantities:\n";
    for column in &study.columns {
        text += &format!("  {} [{}]\n", column.name, column.unit);
    }
    for index in 0..design.members().min(SHOWN) {
        text += &format!("member {index}: {:?}\n", design.values(index));
    }
    text
}

fn in_words_of_the_plan(distribution: &Distribution) -> String {
    match distribution {
        Distribution::Uniform { low, high } => format!("{{ uniform = [{low:?}, {high:?}] }}"),
        Distribution::Triangular { low, mode, high } => format!("{{ triangular = [{low:?}, {mode:?}, {high:?}] }}"),
        Distribution::Normal { mean, deviation } => format!("{{ normal = [{mean:?}, {deviation:?}] }}"),
        Distribution::TruncatedNormal { mean, deviation, low, high } => {
            format!("{{ normal = [{mean:?}, {deviation:?}], within = [{low:?}, {high:?}] }}")
        }
        Distribution::Lognormal { median, deviation } => format!("{{ lognormal = [{median:?}, {deviation:?}] }}"),
    }
}

fn preview_object(study: &Study) -> Value {
    let design = &study.design;
    let column = |name: &str, unit: &str| json!({ "name": name, "unit": unit });
    let varies: Vec<Value> = design.variables().iter().map(|v| column(&v.name, &v.unit)).collect();
    let quantities: Vec<Value> = study.columns.iter().map(|c| column(&c.name, &c.unit)).collect();
    let first: Vec<Vec<f64>> = (0..design.members().min(SHOWN)).map(|index| design.values(index)).collect();
    json!({ "members": design.members(), "varies": varies, "quantities": quantities, "first": first })
}

fn table_path(text: &str) -> Result<(PathBuf, Format), String> {
    let path = PathBuf::from(text);
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
    match extension.as_deref() {
        Some("csv") => Ok((path, Format::Csv)),
        #[cfg(feature = "parquet")]
        Some("parquet") => Ok((path, Format::Parquet)),
        #[cfg(not(feature = "parquet"))]
        Some("parquet") => Err("this mbs is built without its feature `parquet`".to_string()),
        _ => Err("a table ends in .csv or .parquet".to_string()),
    }
}
