//! All members on all cores, into files that a killed run continues, and these into one table.

use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::design::{Design, Member};
use crate::error::SweepError;
use crate::journal::{Folder, Identity, Journal, Row};
use crate::table::{Column, Format, columns, is_made_of, sink};

/// What makes a member's quantities of its values: a motion, and what is taken of it.
///
/// A function is one: `|member: &Member| Ok(vec![…])`.
pub trait Motion: Sync {
    /// The member's quantities, NaN for what does not exist.
    ///
    /// # Errors
    /// Why the motion stopped before its end.
    fn quantities(&self, member: &Member) -> Result<Vec<f64>, String>;
}

impl<F: Fn(&Member) -> Result<Vec<f64>, String> + Sync> Motion for F {
    fn quantities(&self, member: &Member) -> Result<Vec<f64>, String> {
        self(member)
    }
}

/// Which members a process does: the ranks share them by their indices alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Share {
    /// From 0.
    pub rank: u64,
    /// How many processes there are.
    pub ranks: u64,
}

impl Share {
    /// All members.
    pub const WHOLE: Share = Share { rank: 0, ranks: 1 };

    /// The share that a launcher of processes gives this one, by the variables that OpenMPI, MPICH and Slurm set: its
    /// rank, and how many there are; `None` without.
    ///
    /// ```
    /// use mbs_ensemble::Share;
    /// let variable = |name: &str| match name {
    ///     "OMPI_COMM_WORLD_RANK" => Some("2".to_string()),
    ///     "OMPI_COMM_WORLD_SIZE" => Some("4".to_string()),
    ///     _ => None,
    /// };
    /// assert_eq!(Share::launched(variable), Some(Share { rank: 2, ranks: 4 }));
    /// assert_eq!(Share::launched(|_| None), None);
    /// ```
    pub fn launched(variable: impl Fn(&str) -> Option<String>) -> Option<Share> {
        const LAUNCHERS: [[&str; 2]; 3] = [
            ["OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"],
            ["PMI_RANK", "PMI_SIZE"],
            ["SLURM_PROCID", "SLURM_NTASKS"],
        ];
        let number = |name: &str| variable(name)?.trim().parse().ok();
        let share = |[rank, ranks]: [&str; 2]| Some(Share { rank: number(rank)?, ranks: number(ranks)? });
        LAUNCHERS.into_iter().find_map(share).filter(|share| share.rank < share.ranks)
    }

    /// Those of this rank; none where there is no such rank.
    pub fn members(self, of: u64) -> Range<u64> {
        if self.rank >= self.ranks {
            return of..of;
        }
        let at = |rank: u64| (u128::from(of) * u128::from(rank) / u128::from(self.ranks)) as u64;
        at(self.rank)..at(self.rank + 1)
    }
}

/// What came of all members.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Outcome {
    /// How many there are.
    pub members: u64,
    /// How many stopped before their end.
    pub stopped: u64,
    /// The first of these, and why.
    pub first_stopped: Option<(u64, String)>,
}

/// An ensemble on its way into a table.
///
/// ```
/// use mbs_ensemble::sweep::{Share, Sweep};
/// use mbs_ensemble::table::{Column, Format};
/// use mbs_ensemble::{Member, Plan, Variables, journal};
///
/// let text = "members = 100\n[vary]\nspeed = { normal = [10.0, 1.0] }";
/// let design = Plan::read(text)?.design(&Variables::new([("speed", "m/s")]))?;
/// let folder = tempfile::tempdir()?;
/// let sweep = Sweep {
///     design: &design,
///     quantities: vec![Column::new("height", "m")],
///     table: folder.path().join("throws.csv"),
///     format: Format::Csv,
///     identity: journal::Identity::new([("plan", journal::digest(text.as_bytes()))]),
/// };
/// let height = |member: &Member| Ok(vec![member.values[0].powi(2) / (2.0 * 9.81)]);
/// sweep.run(&height, Share::WHOLE, 2, &|_| ())?;
/// assert_eq!(sweep.merge(|_| ())?.members, 100);
/// assert!(std::fs::read_to_string(&sweep.table)?.contains("\nmember,speed,height,stopped\n0,"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Sweep<'d> {
    /// Its members.
    pub design: &'d Design,
    /// What is wanted of each motion.
    pub quantities: Vec<Column>,
    /// The file of the table. What is done stands in a folder beside it until all is.
    pub table: PathBuf,
    /// What the table is written as.
    pub format: Format,
    /// What it is made of.
    pub identity: Identity,
}

impl Sweep<'_> {
    fn folder(&self) -> Folder {
        Folder::beside(&self.table, self.quantities.len())
    }

    /// The folder in which what is done stands until all is.
    pub fn parts(&self) -> PathBuf {
        self.folder().path().to_path_buf()
    }

    /// Whether the table is there, made of the same; a folder that was left beside it is removed.
    ///
    /// # Errors
    /// The table is there, but made of something else, or unknown; or the folder holds another ensemble.
    pub fn is_finished(&self) -> Result<bool, SweepError> {
        let folder = self.folder();
        match (self.table.exists(), folder.exists()) {
            // It was killed between the last two steps.
            (true, true) if self.is_written() && folder.open(&self.identity).is_ok() => {
                folder.remove()?;
                Ok(true)
            }
            (true, _) => Err(SweepError::Exists { path: self.table.clone() }),
            (false, true) => folder.open(&self.identity).map(|()| false),
            (false, false) => Ok(false),
        }
    }

    /// Whether the table is there, made of the same, whatever stands beside it.
    pub fn is_written(&self) -> bool {
        is_made_of(&self.table, &self.identity)
    }

    /// The members of a share that there is.
    fn members(&self, share: Share) -> Result<Range<u64>, SweepError> {
        let Share { rank, ranks } = share;
        if rank < ranks { Ok(share.members(self.design.members())) } else { Err(SweepError::Rank { rank, ranks }) }
    }

    /// Which members of a share are not done yet.
    ///
    /// # Errors
    /// The folder cannot be read, or there is no such share.
    pub fn missing(&self, share: Share) -> Result<Vec<Range<u64>>, SweepError> {
        let members = self.members(share)?;
        let folder = self.folder();
        if folder.exists() { folder.missing(members) } else { Ok(vec![members]) }
    }

    /// Does all members of a share that are not done yet, on this many threads. `progress` is told how many members
    /// were done since it was last told.
    ///
    /// # Errors
    /// A file cannot be written, the folder holds members of another ensemble, another process does this share, or
    /// there is no such share.
    pub fn run(
        &self,
        motion: &dyn Motion,
        share: Share,
        threads: usize,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<(), SweepError> {
        let members = self.members(share)?;
        let folder = self.folder();
        folder.open(&self.identity)?;
        let journal = Mutex::new(folder.journal(share.rank, share.ranks)?);
        let queue = Mutex::new(folder.missing(members)?);
        let failure = Mutex::new(None);
        let is_over = AtomicBool::new(false);
        let worker = Worker { sweep: self, motion, journal: &journal, queue: &queue, progress, is_over: &is_over };
        std::thread::scope(|scope| {
            for _ in 0..threads.max(1) {
                scope.spawn(|| {
                    if let Err(error) = worker.work() {
                        is_over.store(true, Ordering::Relaxed);
                        failure.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
                    }
                });
            }
        });
        match failure.into_inner().unwrap_or_else(PoisonError::into_inner) {
            Some(error) => Err(error),
            None => journal.into_inner().unwrap_or_else(PoisonError::into_inner).sync(),
        }
    }

    /// Makes the table of what is done, and takes the folder away. `each` sees every member's quantities, in order.
    ///
    /// # Errors
    /// Members are missing, the table is there already, another process makes it, or a file cannot be read or written.
    pub fn merge(&self, mut each: impl FnMut(&[f64])) -> Result<Outcome, SweepError> {
        let folder = self.folder();
        if !folder.exists() {
            return Err(SweepError::Missing { first: 0, last: self.design.members().saturating_sub(1) });
        }
        folder.open(&self.identity)?;
        let _merger = folder.merger()?;
        let unfinished = folder.unfinished();
        let failed = |error| SweepError::io("write", &unfinished, error);
        let mut outcome = Outcome { members: self.design.members(), ..Outcome::default() };
        let mut sink = sink(self.format, &unfinished, &columns(self.design, &self.quantities), &self.identity)?;
        folder.rows(self.design.members(), |index, row| {
            if let Some(reason) = &row.stopped {
                outcome.stopped += 1;
                outcome.first_stopped.get_or_insert_with(|| (index, reason.clone()));
            }
            each(&row.quantities);
            sink.row(index, &self.design.values(index), &row).map_err(failed)
        })?;
        sink.finish().map_err(failed)?;
        if self.table.exists() {
            return Err(SweepError::Exists { path: self.table.clone() });
        }
        fs::rename(&unfinished, &self.table).map_err(|error| SweepError::io("write", &self.table, error))?;
        sync_folder(&self.table)?;
        folder.remove()?;
        Ok(outcome)
    }
}

/// The new name of a file is on the disk.
fn sync_folder(file: &Path) -> Result<(), SweepError> {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    // Other systems open no folders.
    if cfg!(unix) {
        let synced = fs::File::open(folder).and_then(|folder| folder.sync_all());
        synced.map_err(|error| SweepError::io("write", folder, error))?;
    }
    Ok(())
}

/// What all threads share.
struct Worker<'a> {
    sweep: &'a Sweep<'a>,
    motion: &'a dyn Motion,
    journal: &'a Mutex<Journal>,
    /// What is to be done, in order.
    queue: &'a Mutex<Vec<Range<u64>>>,
    progress: &'a (dyn Fn(u64) + Sync),
    is_over: &'a AtomicBool,
}

impl Worker<'_> {
    /// Takes members and does them, until none is left or another thread has failed.
    fn work(&self) -> Result<(), SweepError> {
        /// How long a thread keeps what it has done to itself.
        const PATIENCE: Duration = Duration::from_millis(200);
        /// How many members it takes at most.
        const MOST: u64 = 1 << 12;
        let mut most = 1;
        while !self.is_over.load(Ordering::Relaxed) {
            let Some(members) = self.take(most) else { break };
            let (first, began) = (members.start, Instant::now());
            let rows: Vec<Row> = members.map(|index| self.row(index)).collect();
            let took = began.elapsed();
            self.journal.lock().unwrap_or_else(PoisonError::into_inner).append(first, &rows)?;
            (self.progress)(rows.len() as u64);
            most = match took {
                _ if took < PATIENCE / 2 => (2 * most).min(MOST),
                _ if took > PATIENCE => (most / 2).max(1),
                _ => most,
            };
        }
        Ok(())
    }

    /// The next members.
    fn take(&self, most: u64) -> Option<Range<u64>> {
        let mut queue = self.queue.lock().unwrap_or_else(PoisonError::into_inner);
        let next = queue.first_mut()?;
        let taken = next.start..next.end.min(next.start + most);
        next.start = taken.end;
        if next.is_empty() {
            queue.remove(0);
        }
        Some(taken)
    }

    fn row(&self, index: u64) -> Row {
        let count = self.sweep.quantities.len();
        match self.motion.quantities(&self.sweep.design.member(index)) {
            Ok(quantities) if quantities.len() == count => Row { quantities, stopped: None },
            Ok(quantities) => {
                let reason = format!("{count} quantities are wanted, the motion has {}", quantities.len());
                Row { quantities: vec![f64::NAN; count], stopped: Some(reason) }
            }
            Err(reason) => {
                let reason = if reason.is_empty() { "it stopped".to_string() } else { reason };
                Row { quantities: vec![f64::NAN; count], stopped: Some(reason) }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::Plan;
    use crate::vocabulary::Variables;

    const PLAN: &str = "members = 300\n[vary]\nx = { uniform = [0, 1] }\ny = { values = [1, 2] }";

    fn design() -> Design {
        Plan::read(PLAN).unwrap().design(&Variables::new([("x", "m"), ("y", "1")])).unwrap()
    }

    fn sweep<'d>(design: &'d Design, folder: &Path) -> Sweep<'d> {
        Sweep {
            design,
            quantities: vec![Column::new("sum", "m")],
            table: folder.join("table.csv"),
            format: Format::Csv,
            identity: Identity::new([("plan", "1".to_string())]),
        }
    }

    fn sum(member: &Member) -> Result<Vec<f64>, String> {
        match member.index {
            17 => Err("it \"fell\"".to_string()),
            18 => Ok(vec![f64::NAN]),
            _ => Ok(vec![member.values.iter().sum()]),
        }
    }

    /// The table of a run on one thread.
    fn expected(design: &Design) -> String {
        let folder = tempfile::tempdir().unwrap();
        let sweep = sweep(design, folder.path());
        sweep.run(&sum, Share::WHOLE, 1, &|_| ()).unwrap();
        let outcome = sweep.merge(|_| ()).unwrap();
        assert_eq!((outcome.members, outcome.stopped), (600, 1));
        assert_eq!(outcome.first_stopped, Some((17, "it \"fell\"".to_string())));
        fs::read_to_string(&sweep.table).unwrap()
    }

    #[test]
    fn tables_do_not_depend_on_threads_or_ranks() {
        let design = design();
        let expected = expected(&design);
        let lines: Vec<&str> = expected.lines().collect();
        assert_eq!(
            lines[..5],
            ["# plan: 1", "# unit of x: m", "# unit of y: 1", "# unit of sum: m", "member,x,y,sum,stopped"]
        );
        assert!(lines[5 + 17].ends_with(",2.0,,\"it \"\"fell\"\"\"") && lines[5 + 18].ends_with(",1.0,,"));
        for ranks in [1, 3, 7] {
            let folder = tempfile::tempdir().unwrap();
            let sweep = sweep(&design, folder.path());
            assert!(matches!(sweep.merge(|_| ()), Err(SweepError::Missing { first: 0, last: 599 })));
            assert!(!sweep.parts().exists());
            for rank in (0..ranks).rev() {
                assert!(!sweep.is_finished().unwrap());
                assert!(rank + 1 == ranks || matches!(sweep.merge(|_| ()), Err(SweepError::Missing { first: 0, .. })));
                sweep.run(&sum, Share { rank, ranks }, 3, &|_| ()).unwrap();
            }
            sweep.merge(|_| ()).unwrap();
            assert_eq!(fs::read_to_string(&sweep.table).unwrap(), expected);
            assert!(!sweep.parts().exists() && sweep.is_written());
            assert!(matches!(sweep.is_finished(), Err(SweepError::Exists { .. })));
            // As one leaves it that is killed before the folder is gone.
            sweep.folder().open(&sweep.identity).unwrap();
            assert!(sweep.is_finished().unwrap() && !sweep.parts().exists());
        }
    }

    /// A run that stops anywhere goes on, with fewer ranks, too; no member is done twice.
    #[test]
    fn interrupted_runs_go_on() {
        let design = design();
        let expected = expected(&design);
        for limit in [0, 1, 50, 599] {
            let folder = tempfile::tempdir().unwrap();
            let sweep = sweep(&design, folder.path());
            let done = std::sync::atomic::AtomicU64::new(0);
            let count = |member: &Member| {
                done.fetch_add(1, Ordering::Relaxed);
                sum(member)
            };
            let share = Share { rank: 1, ranks: 4 };
            sweep.run(&count, share, 2, &|_| ()).unwrap();
            // What another rank was writing when it was killed.
            let torn = sweep.parts().join("rows-0-of-4");
            fs::copy(sweep.parts().join("rows-1-of-4"), &torn).unwrap();
            fs::File::options().write(true).open(&torn).unwrap().set_len(limit).unwrap();
            sweep.run(&count, Share::WHOLE, 2, &|_| ()).unwrap();
            assert_eq!(done.into_inner(), 600);
            sweep.merge(|_| ()).unwrap();
            assert_eq!(fs::read_to_string(&sweep.table).unwrap(), expected);
        }
    }

    #[test]
    fn shares_cover_all_members_once() {
        for (members, ranks) in [(10, 3), (2, 5), (u64::MAX, 7)] {
            let mut next = 0;
            for rank in 0..ranks {
                let share = Share { rank, ranks }.members(members);
                assert_eq!(share.start, next);
                next = share.end;
            }
            assert_eq!(next, members);
        }
    }

    #[test]
    fn shares_that_are_none_are_refused() {
        let design = design();
        let folder = tempfile::tempdir().unwrap();
        let sweep = sweep(&design, folder.path());
        for share in [Share { rank: 2, ranks: 2 }, Share { rank: 0, ranks: 0 }, Share { rank: u64::MAX, ranks: 1 }] {
            assert!(share.members(10).is_empty());
            assert!(matches!(sweep.missing(share), Err(SweepError::Rank { .. })));
            let error = sweep.run(&sum, share, 1, &|_| ()).unwrap_err();
            assert_eq!(
                error.to_string(),
                format!("there is no rank {} of {}: the first is 0", share.rank, share.ranks)
            );
        }
        assert!(!sweep.parts().exists());
    }

    #[test]
    fn changes_and_other_tables_are_refused() {
        let design = design();
        let folder = tempfile::tempdir().unwrap();
        let mut sweep = sweep(&design, folder.path());
        sweep.run(&sum, Share { rank: 0, ranks: 2 }, 1, &|_| ()).unwrap();
        // Another's table ends nothing that is begun.
        let is_refused = |sweep: &Sweep<'_>| matches!(sweep.is_finished(), Err(SweepError::Exists { .. }));
        for text in ["mine", "# plan: 2\nmember,x,y,sum,stopped\n"] {
            fs::write(&sweep.table, text).unwrap();
            assert!(is_refused(&sweep));
        }
        fs::remove_file(&sweep.table).unwrap();
        let half = sweep.missing(Share::WHOLE).unwrap();
        assert_eq!(half.iter().map(|range| range.end - range.start).sum::<u64>(), sweep.design.members() / 2);
        sweep.identity = Identity::new([("plan", "another".to_string())]);
        assert!(matches!(sweep.is_finished(), Err(SweepError::Changed { .. })));
        assert!(matches!(sweep.run(&sum, Share::WHOLE, 1, &|_| ()), Err(SweepError::Changed { .. })));
        fs::write(&sweep.table, "mine").unwrap();
        assert!(is_refused(&sweep));
        assert_eq!(fs::read_to_string(&sweep.table).unwrap(), "mine");
    }
}
