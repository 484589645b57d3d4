//! `host-sim log`: a log of the firmware in, a log of PX4's topics out.

use super::reader::Ulog;
use super::topics::{TICK_TOPIC, written};
use crate::output::whole_file::WholeFile;
use std::io::Write;
use std::path::Path;

/// The longest log: an hour of ticks is 50 MB.
pub const LOG_MAX_BYTES: u64 = 1 << 30;

/// Reads `from`, writes `to`, and says in a line what was written.
///
/// # Errors
/// Names the file, and what is wrong; then nothing is written.
pub fn run(from: &Path, to: &Path) -> Result<String, String> {
    let in_file = |path: &Path, what: String| format!("{}: {what}", path.display());
    let bytes = scenario::text::bytes(from, LOG_MAX_BYTES)
        .map_err(|error| in_file(from, format!("cannot be read: {error}")))?;
    let log = Ulog::read(&bytes, &[TICK_TOPIC]).map_err(|what| in_file(from, what))?;
    let file = written(&log).map_err(|what| in_file(from, format!("{what}{}", log.damage)))?;
    let stored = WholeFile::create(to).and_then(|mut out| out.write_all(&file).and_then(|()| out.finish()));
    stored.map_err(|error| in_file(to, format!("cannot be written: {error}")))?;
    let ticks = log.topic(TICK_TOPIC).map_or(0, super::reader::Series::len);
    let (parameters, texts) = (log.parameters.len(), log.texts.len());
    Ok(format!(
        "{}: {ticks} ticks, {parameters} parameters, {texts} texts{}; written to {}\n",
        from.display(),
        log.damage,
        to.display()
    ))
}
