//! Progress of anything longer than a few seconds: a bar on a terminal, elsewhere a plain line now and then.

use indicatif::{ProgressBar, ProgressStyle};
use std::io::{IsTerminal, Write, stderr, stdout};
use std::time::{Duration, Instant};

/// Work that takes longer shows a bar.
const BAR_AFTER: Duration = Duration::from_secs(1);
/// Between two lines at least, and until the first.
const LINES_APART: Duration = Duration::from_secs(10);
/// Silence that is broken by a line even where little has been done.
const LONGEST_SILENCE: Duration = Duration::from_secs(60);
/// What must have been done for a line before that, as a share of all.
const LINE_SHARE: f64 = 0.1;

/// Work counted in steps, shown on stderr: by a bar if both outputs are terminals, else by lines, for a pipe or a log.
pub struct Progress {
    total: u64,
    what: &'static str,
    about: Option<&'static str>,
    started: Instant,
    watched: bool,
    bar: Option<ProgressBar>,
    /// When the last line was written, and what was done by then.
    said: (Instant, u64),
}

impl Progress {
    /// `total` steps of `what`.
    #[must_use]
    pub fn new(what: &'static str, total: u64) -> Self {
        let (watched, started) = (stderr().is_terminal() && stdout().is_terminal(), Instant::now());
        Self { total, what, about: None, started, watched, bar: None, said: (started, 0) }
    }

    /// The steps that follow are about this.
    pub fn about(&mut self, about: &'static str) {
        self.about = Some(about);
        if let Some(bar) = &self.bar {
            bar.set_message(self.name());
        }
    }

    /// `done` steps are done.
    pub fn show(&mut self, done: u64) {
        if !self.watched {
            self.say(done);
        } else if let Some(bar) = &self.bar {
            bar.set_position(done);
        } else if self.started.elapsed() >= BAR_AFTER {
            self.bar = Some(start(self.total, done, self.name()));
        }
    }

    fn say(&mut self, done: u64) {
        let (before, done_before) = self.said;
        let share = done.saturating_sub(done_before) as f64 / self.total.max(1) as f64;
        if !due(before.elapsed(), share) {
            return;
        }
        self.said = (Instant::now(), done);
        // The reader may be gone.
        let _ = writeln!(stderr(), "{}", line(&self.name(), done, self.total, self.started.elapsed()));
    }

    fn name(&self) -> String {
        self.about.map_or_else(|| self.what.to_owned(), |about| format!("{} of {about}", self.what))
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// Whether a line is due so long after the last one, when such a share of all has been done since.
fn due(silence: Duration, share: f64) -> bool {
    silence >= LINES_APART && (share >= LINE_SHARE || silence >= LONGEST_SILENCE)
}

/// `done` of `total` steps took `elapsed`, as a line.
fn line(name: &str, done: u64, total: u64, elapsed: Duration) -> String {
    let share = done as f64 / total.max(1) as f64;
    let left = elapsed.as_secs_f64() * (1.0 / share - 1.0);
    let left = if left.is_finite() { format!(", about {} left", in_words(left)) } else { String::new() };
    format!("{name}: {:.0} %{left}", 100.0 * share)
}

/// A time, s, in seconds or whole minutes.
#[must_use]
pub fn in_words(seconds: f64) -> String {
    match (seconds / 60.0).ceil() {
        minutes if minutes > 1.0 => format!("{minutes:.0} minutes"),
        _ => format!("{:.0} s", seconds.max(0.0).ceil()),
    }
}

fn start(total: u64, done: u64, name: String) -> ProgressBar {
    let bar = ProgressBar::new(total).with_position(done).with_message(name);
    match ProgressStyle::with_template("{msg} [{bar:40}] {percent} %, {eta} left") {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_comes_every_tenth_or_every_minute_and_ten_seconds_after_the_last_at_the_soonest() {
        let seconds = Duration::from_secs;
        assert!(due(seconds(10), 0.1) && due(seconds(60), 0.0));
        assert!(!due(seconds(9), 0.9) && !due(seconds(59), 0.09));
    }

    #[test]
    fn a_line_says_how_much_is_done_and_how_long_the_rest_takes() {
        let seconds = Duration::from_secs;
        assert_eq!(line("flying", 1, 4, seconds(11)), "flying: 25 %, about 33 s left");
        assert_eq!(line("flying", 1, 10, seconds(100)), "flying: 10 %, about 15 minutes left");
        assert_eq!(line("flying", 0, 4, seconds(60)), "flying: 0 %");
    }
}
