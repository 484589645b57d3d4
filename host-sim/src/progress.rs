//! A progress bar for whoever is watching, on anything longer than a second.

use indicatif::{ProgressBar, ProgressStyle};
use std::io::{IsTerminal, stderr, stdout};
use std::time::{Duration, Instant};

/// How long something may take before it shows progress.
const PATIENCE: Duration = Duration::from_secs(1);

/// Work counted in steps. Draws on stderr, and only if both outputs are terminals.
pub struct Progress {
    total: u64,
    what: &'static str,
    started: Instant,
    watched: bool,
    bar: Option<ProgressBar>,
}

impl Progress {
    /// `total` steps of `what`.
    #[must_use]
    pub fn new(what: &'static str, total: u64) -> Self {
        let watched = stderr().is_terminal() && stdout().is_terminal();
        Self { total, what, started: Instant::now(), watched, bar: None }
    }

    /// `done` steps are done.
    pub fn show(&mut self, done: u64) {
        if !self.watched || self.bar.is_none() && self.started.elapsed() < PATIENCE {
            return;
        }
        self.bar.get_or_insert_with(|| start(self.what, self.total)).set_position(done);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

fn start(what: &'static str, total: u64) -> ProgressBar {
    let bar = ProgressBar::new(total).with_message(what);
    match ProgressStyle::with_template("{msg} [{bar:40}] {percent} %, {eta} left") {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}
