//! `host-sim log`: a log of the firmware in, a log of PX4's topics out, or a picture of the gyro's spectrum.

use super::reader::Ulog;
use super::spectrum::{GYRO_TOPIC, Spectrum};
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
    let log = read(from, TICK_TOPIC)?;
    let file = written(&log).map_err(|what| in_file(from, format!("{what}{}", log.damage)))?;
    store(to, &file)?;
    let ticks = log.topic(TICK_TOPIC).map_or(0, super::reader::Series::len);
    let (parameters, texts) = (log.parameters.len(), log.texts.len());
    Ok(format!(
        "{}: {ticks} ticks, {parameters} parameters, {texts} texts{}; written to {}\n",
        from.display(),
        log.damage,
        to.display()
    ))
}

/// Reads `from`, draws the spectrum of its raw gyro into `to`, and names the greatest peaks.
///
/// # Errors
/// As [`run`].
pub fn draw(from: &Path, to: &Path) -> Result<String, String> {
    let log = read(from, GYRO_TOPIC)?;
    let spectrum = Spectrum::of(&log).map_err(|what| in_file(from, format!("{what}{}", log.damage)))?;
    store(to, spectrum.svg().as_bytes())?;
    Ok(format!("{}: {}drawn in {}\n", from.display(), spectrum.told(), to.display()))
}

fn in_file(path: &Path, what: String) -> String {
    format!("{}: {what}", path.display())
}

/// A log, of which one topic is wanted.
fn read(from: &Path, topic: &str) -> Result<Ulog, String> {
    let bytes = scenario::text::bytes(from, LOG_MAX_BYTES)
        .map_err(|error| in_file(from, format!("cannot be read: {error}")))?;
    Ulog::read(&bytes, &[topic]).map_err(|what| in_file(from, what))
}

fn store(to: &Path, file: &[u8]) -> Result<(), String> {
    let stored = WholeFile::create(to).and_then(|mut out| out.write_all(file).and_then(|()| out.finish()));
    stored.map_err(|error| in_file(to, format!("cannot be written: {error}")))
}
