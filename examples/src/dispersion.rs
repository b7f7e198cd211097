//! What the programs share that draw members by a plan: how the plan is read, and how its members come into a table.

use std::ops::Range;
use std::path::{Path, PathBuf};

use mbs_ensemble::plan::{Located, Named};
use mbs_ensemble::sweep::{Motion, Outcome};
use mbs_ensemble::table::{Column, Format};
use mbs_ensemble::{Design, Fault, Member, Plan, Share, Sweep, Variables, journal};

use crate::Failure;

/// A plan whose members a program draws.
pub struct Dispersion {
    /// The plan.
    pub plan: Plan,
    /// What it amounts to.
    pub design: Design,
    program: &'static str,
    digest: String,
    quantities: Vec<Column>,
}

impl Dispersion {
    /// Of a plan's text, with another number of members where one is given, for a program with these variables and
    /// quantities, each with its unit.
    ///
    /// # Errors
    /// What is wrong with the plan, at its place in the file of this name; what it says of motions, which are the
    /// program's own.
    pub fn planned<'v>(
        program: &'static str,
        (file, text): (&str, &str),
        members: Option<u64>,
        variables: impl IntoIterator<Item = (&'v str, &'v str)>,
        quantities: &[(&str, &str)],
    ) -> Result<Self, Failure> {
        let refused = |faults: mbs_ensemble::Faults| Failure::new(faults.render(file, text));
        let mut plan = Plan::read(text).map_err(refused)?;
        let unused = unused(&plan, program);
        if !unused.is_empty() {
            return Err(refused(unused.into()));
        }
        if let Some(value) = members {
            plan.members = Some(Located { value, span: 0..0 });
        }
        let design = plan.design(&Variables::new(variables)).map_err(refused)?;
        let quantities = quantities.iter().map(|(name, unit)| Column::new(name, unit)).collect();
        Ok(Dispersion { plan, design, program, digest: journal::digest(text.as_bytes()), quantities })
    }

    /// A member's values in the order of these variables; `usual` are those of what the plan neither fixes nor varies.
    pub fn in_order<const N: usize>(
        &self,
        variables: &[(&str, &str); N],
        usual: [f64; N],
        member: &Member,
    ) -> [f64; N] {
        let mut values = usual;
        let fixed = self.design.fixed().iter().map(|(name, value)| (name, value));
        let varied = self.design.variables().iter().map(|variable| &variable.name).zip(&member.values);
        for (given, value) in fixed.chain(varied) {
            if let Some(place) = variables.iter().position(|(name, _)| name == given) {
                values[place] = *value;
            }
        }
        values
    }

    /// Its ensemble, with this table.
    pub fn sweep(&self, table: PathBuf) -> Sweep<'_> {
        Sweep {
            design: &self.design,
            quantities: self.quantities.clone(),
            table,
            format: Format::Csv,
            identity: journal::Identity::new([
                ("program", format!("{} {}", self.program, env!("CARGO_PKG_VERSION"))),
                ("plan", self.digest.clone()),
                ("number of members", self.design.members().to_string()),
            ]),
        }
    }

    /// All members, on as many threads as there are cores if no number is given: how many stopped, and the values of
    /// each quantity, NaN for those. A table that is begun is continued.
    ///
    /// # Errors
    /// The table is finished already, or cannot be written.
    pub fn columns(
        &self,
        table: Option<&Path>,
        threads: Option<usize>,
        motion: &dyn Motion,
    ) -> Result<(Outcome, Vec<Vec<f64>>), Failure> {
        let folder = tempfile::tempdir()?;
        let sweep = self.sweep(table.map_or_else(|| folder.path().join("members.csv"), Path::to_path_buf));
        if sweep.is_finished()? {
            return Err(Failure::new(format!("{} was finished already", sweep.table.display())));
        }
        let cores = || std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        sweep.run(motion, Share::WHOLE, threads.unwrap_or_else(cores), &|_| ())?;
        let mut columns = vec![Vec::new(); self.quantities.len()];
        let outcome = sweep.merge(|row| columns.iter_mut().zip(row).for_each(|(column, value)| column.push(*value)))?;
        Ok((outcome, columns))
    }

    /// The values of each quantity where no member may stop.
    ///
    /// # Errors
    /// As of [`Dispersion::columns`]; a member stopped.
    pub fn all_columns(&self, table: Option<&Path>, motion: &dyn Motion) -> Result<Vec<Vec<f64>>, Failure> {
        let (outcome, columns) = self.columns(table, None, motion)?;
        match outcome.first_stopped {
            None => Ok(columns),
            Some((member, why)) => Err(Failure::new(format!("member {member} stopped: {why}"))),
        }
    }
}

/// What the program would not do, though a plan says it.
fn unused(plan: &Plan, program: &str) -> Vec<Fault> {
    fn first<T>(entries: &[Named<T>]) -> Option<Range<usize>> {
        entries.first().map(|entry| entry.name.span.clone())
    }
    let said = [
        ("mechanism", plan.mechanism.as_ref().map(|path| path.span.clone())),
        ("parameters", first(&plan.parameters)),
        ("inputs", first(&plan.inputs)),
        ("signals", first(&plan.signals)),
        ("motion", plan.motion.as_ref().map(|motion| motion.duration.span.clone())),
        ("quantities", first(&plan.quantities)),
    ];
    let fault = |(name, span): (&str, Option<Range<usize>>)| {
        let message = format!("a plan of `{program}` has no `{name}`: its motions are those of the program");
        span.map(|span| Fault::with_help(span, message, "leave it out"))
    };
    said.into_iter().filter_map(fault).collect()
}
