//! A session's recording: a moment every control tick, half a tick after it, and all that the vehicle says.

use crate::output::whole_file::WholeFile;
use crate::reports::recording::Recording;
use crate::reports::recording::session::{SESSION_TOPICS, SessionMoment};
use scenario::Scenario;
use std::path::{Path, PathBuf};

/// A recording under way.
pub struct SessionRecord {
    recording: Recording<WholeFile>,
    path: PathBuf,
    period: u64,
    /// When the next moment is due, us.
    due: u64,
}

impl SessionRecord {
    /// Begins one of `scenario`, whose file has this `text`, at `path`, where it shows up when it is finished.
    ///
    /// # Errors
    /// In words, if it cannot be written.
    pub fn create(path: &Path, scenario: &Scenario, text: &str) -> Result<Self, String> {
        let begin = || Recording::begin(WholeFile::alone(path)?, scenario, text, SESSION_TOPICS);
        let recording = begin().map_err(failed(path))?;
        let period = scenario.timing.period_us;
        Ok(Self { recording, path: path.to_owned(), period, due: period / 2 })
    }

    /// When the next moment is due, us.
    #[must_use]
    pub fn due(&self) -> u64 {
        self.due
    }

    /// Adds a moment, if one is due.
    ///
    /// # Errors
    /// In words, if it cannot be written.
    pub fn observe(&mut self, moment: &SessionMoment) -> Result<(), String> {
        if moment.now < self.due {
            return Ok(());
        }
        self.due += self.period;
        self.recording.moment(moment).map_err(failed(&self.path))
    }

    /// Adds a text that the vehicle said at `time`, us.
    ///
    /// # Errors
    /// In words, if it cannot be written.
    pub fn observe_text(&mut self, time: u64, text: &str) -> Result<(), String> {
        self.recording.write_text(time, text).map_err(failed(&self.path))
    }

    /// Gives it its name.
    ///
    /// # Errors
    /// In words, if it cannot be written.
    pub fn finish(self) -> Result<(), String> {
        self.recording.finish().and_then(WholeFile::finish).map_err(failed(&self.path))
    }
}

fn failed(path: &Path) -> impl FnOnce(std::io::Error) -> String {
    |error| format!("{}: cannot be written: {error}", path.display())
}
