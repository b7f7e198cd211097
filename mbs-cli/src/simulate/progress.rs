//! The progress bar: on standard error, if that is a terminal, once an integration has taken a second.

use std::io::{self, IsTerminal};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

/// How far an integration has come.
pub(crate) struct Progress {
    start: f64,
    end: f64,
    began: Instant,
    calls: u32,
    stage: Stage,
}

enum Stage {
    /// Not a second has passed.
    Quiet,
    /// The bar is shown.
    Shown(ProgressBar),
    /// There is nobody to show it to.
    Unseen,
}

/// Positions of the bar.
const LENGTH: u64 = 1000;
/// The clock is read once in this many calls.
const PATIENCE: u32 = 64;

impl Progress {
    /// From one time to another.
    pub(crate) fn new(start: f64, end: f64) -> Self {
        let stage = if io::stderr().is_terminal() { Stage::Quiet } else { Stage::Unseen };
        Progress { start, end, began: Instant::now(), calls: 0, stage }
    }

    /// With nobody to see it.
    pub(crate) fn unseen(start: f64, end: f64) -> Self {
        Progress { stage: Stage::Unseen, ..Self::new(start, end) }
    }

    /// The integration is at the time `t`, or tries it.
    pub(crate) fn at(&mut self, t: f64) {
        self.calls = self.calls.wrapping_add(1);
        if !self.calls.is_multiple_of(PATIENCE) {
            return;
        }
        match &self.stage {
            Stage::Quiet if self.began.elapsed() > Duration::from_secs(1) => self.stage = Stage::Shown(bar()),
            Stage::Shown(bar) => {
                let fraction = ((t - self.start) / (self.end - self.start)).clamp(0.0, 1.0);
                bar.set_position((fraction * LENGTH as f64) as u64);
            }
            Stage::Quiet | Stage::Unseen => {}
        }
    }

    /// Takes the bar away.
    pub(crate) fn finish(self) {
        if let Stage::Shown(bar) = self.stage {
            bar.finish_and_clear();
        }
    }
}

fn bar() -> ProgressBar {
    let bar = ProgressBar::new(LENGTH);
    match ProgressStyle::with_template("integrating {wide_bar} {percent:>3} %  {elapsed} elapsed, {eta} left") {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}
