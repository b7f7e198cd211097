//! Random mechanisms, the generator against the referee:
//! `cargo run --release -p mbs-tests --bin referee -- --seed 1 --count 1000`.
//!
//! The mechanism of a seed is the same on every machine. `--count N` takes the seeds S, S + 1, … S + N − 1;
//! `--construct NAME` puts a construct into all of them, `--without A,B` leaves constructs out; `--states K` compares
//! at this many states each; `--shrink no` leaves texts as they were drawn; `--print yes` shows the text of the first
//! seed and does no more; `--file PATH` takes the mechanism of a file, at the states of the first seed. What is wrong
//! is printed with the text that shows it, and the exit code is 1.
//!
//! `--piecewise yes` draws mechanisms with branches and corners of every kind, and asks of each that it is proved: what
//! is right is never refused.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use mbs_tests::referee::{
    Construct, Drawn, Fault, Judged, draw, draw_piecewise, judge, proved, shrink, shrink_unproved,
};

struct Options {
    seed: u64,
    count: u64,
    states: usize,
    construct: Option<Construct>,
    without: Vec<Construct>,
    shrink: bool,
    print: bool,
    piecewise: bool,
    file: Option<PathBuf>,
}

fn options() -> Result<Options, String> {
    let mut options = Options {
        seed: 1,
        count: 100,
        states: 3,
        construct: None,
        without: Vec::new(),
        shrink: true,
        print: false,
        piecewise: false,
        file: None,
    };
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let value = arguments.next().ok_or_else(|| format!("{argument} wants a value"))?;
        let number = || value.parse::<u64>().map_err(|error| format!("{argument} {value}: {error}"));
        match argument.as_str() {
            "--seed" => options.seed = number()?,
            "--count" => options.count = number()?,
            "--states" => options.states = number()? as usize,
            "--print" => options.print = value == "yes",
            "--piecewise" => options.piecewise = value == "yes",
            "--shrink" => options.shrink = value != "no",
            "--file" => (options.file, options.count) = (Some(PathBuf::from(&value)), 1),
            "--construct" => options.construct = Some(construct(&value)?),
            "--without" => options.without = value.split(',').map(construct).collect::<Result<_, _>>()?,
            _ => return Err(format!("there is no option {argument}")),
        }
    }
    Ok(options)
}

fn construct(name: &str) -> Result<Construct, String> {
    let found = Construct::ALL.into_iter().find(|construct| construct.name() == name);
    found.ok_or_else(|| format!("no construct {name}; there are {}", Construct::ALL.map(Construct::name).join(", ")))
}

fn main() -> ExitCode {
    let options = match options() {
        Ok(options) => options,
        Err(report) => {
            eprintln!("error: {report}");
            return ExitCode::from(2);
        }
    };
    if options.print {
        let drawn = mechanism(&options, options.seed);
        drawn.imports.iter().for_each(|(name, text)| println!("// {name}\n{text}"));
        print!("{}", drawn.text);
        return ExitCode::SUCCESS;
    }
    // Panics of the generator are reported with the text.
    std::panic::set_hook(Box::new(|_| {}));
    if options.piecewise { run_piecewise(&options) } else { run(&options) }
}

/// The mechanism of a file, with what lies in its folder and the folders there.
fn read(path: &Path) -> std::io::Result<Drawn> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut imports = BTreeMap::new();
    let mut folders = vec![PathBuf::new()];
    while let Some(inner) = folders.pop() {
        for entry in fs::read_dir(folder.join(&inner))? {
            let (name, kind) = entry.and_then(|entry| Ok((inner.join(entry.file_name()), entry.file_type()?)))?;
            let is_text = name.extension().is_some_and(|extension| extension == "mbs" || extension == "csv");
            if kind.is_dir() && inner.as_os_str().is_empty() {
                folders.push(name);
            } else if is_text {
                imports.insert(name.display().to_string(), fs::read_to_string(folder.join(&name))?);
            }
        }
    }
    Ok(Drawn { text: fs::read_to_string(path)?, imports, constructs: BTreeSet::new() })
}

fn mechanism(options: &Options, seed: u64) -> Drawn {
    match &options.file {
        None if options.piecewise => draw_piecewise(seed),
        None => draw(seed, options.construct, &options.without),
        Some(path) => read(path).unwrap_or_else(|error| {
            eprintln!("error: {}: {error}", path.display());
            std::process::exit(1)
        }),
    }
}

fn run(options: &Options) -> ExitCode {
    let (mut total, mut faults, start) = (Judged::default(), BTreeMap::<String, Vec<u64>>::new(), Instant::now());
    let mut slowest = (Duration::ZERO, 0);
    for seed in options.seed..options.seed + options.count {
        let (drawn, begun) = (mechanism(options, seed), Instant::now());
        match judge((&drawn.text, &drawn.imports), seed, options.states) {
            Ok(judged) => {
                total.states += judged.states;
                total.numbers += judged.numbers;
                total.undetermined += judged.undetermined;
            }
            Err(fault) => {
                let first = !faults.contains_key(&fault.kind());
                faults.entry(fault.kind()).or_default().push(seed);
                let shrinks = options.shrink && first;
                let (small, fault) =
                    if shrinks { shrink(&drawn, &fault, seed, options.states) } else { (drawn, fault) };
                println!("== seed {seed}: {fault}");
                if shrinks {
                    small.imports.iter().for_each(|(name, text)| println!("// {name}\n{text}"));
                    println!("{}", small.text);
                }
            }
        }
        slowest = slowest.max((begun.elapsed(), seed));
    }
    for (kind, seeds) in &faults {
        println!("{} of kind `{kind}`: seeds {:?}", seeds.len(), &seeds[..seeds.len().min(20)]);
    }
    println!(
        "{} mechanisms, {} states, {} numbers ({} of them without a certain digit), {} faults; {:.1?}, slowest {:.1?} (seed {})",
        options.count,
        total.states,
        total.numbers,
        total.undetermined,
        faults.values().map(Vec::len).sum::<usize>(),
        start.elapsed(),
        slowest.0,
        slowest.1
    );
    if faults.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// How much of piecewise mechanisms is proved, and what is not.
fn run_piecewise(options: &Options) -> ExitCode {
    let (mut faults, mut few, start) = (BTreeMap::<String, Vec<u64>>::new(), 0, Instant::now());
    let (mut exactly, mut in_doubles, mut slowest) = (0, BTreeMap::<String, usize>::new(), (Duration::ZERO, 0));
    for seed in options.seed..options.seed + options.count {
        let (drawn, begun) = (mechanism(options, seed), Instant::now());
        match proved((&drawn.text, &drawn.imports)) {
            Ok(None) => few += 1,
            Ok(Some(proof)) => {
                exactly += proof.evidence.identities;
                for left in &proof.evidence.in_doubles {
                    *in_doubles.entry(left.reason.clone()).or_default() += left.identities;
                }
            }
            Err(fault) => refused(options, seed, &drawn, fault, &mut faults),
        }
        slowest = slowest.max((begun.elapsed(), seed));
    }
    for (kind, seeds) in &faults {
        println!("{} of kind `{kind}`: seeds {:?}", seeds.len(), &seeds[..seeds.len().min(20)]);
    }
    println!("{exactly} identities in fields; in doubles alone, by reasons: {in_doubles:?}");
    println!(
        "{} mechanisms, {few} of them finite at too few states, {} faults; {:.1?}, slowest {:.1?} (seed {})",
        options.count,
        faults.values().map(Vec::len).sum::<usize>(),
        start.elapsed(),
        slowest.0,
        slowest.1
    );
    if faults.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Takes down a fault; the first of each kind is printed with a small text.
fn refused(options: &Options, seed: u64, drawn: &Drawn, fault: Fault, faults: &mut BTreeMap<String, Vec<u64>>) {
    let is_first = !faults.contains_key(&fault.kind());
    faults.entry(fault.kind()).or_default().push(seed);
    if is_first {
        let (small, fault) = if options.shrink { shrink_unproved(drawn, &fault) } else { (drawn.clone(), fault) };
        println!("== seed {seed}: {fault}\n{}", small.text);
    }
}
