//! The raw gyro of a session as a ULog, as a board's card has it with `LOG_GYRO`.

use crate::identification::ulog::writer::{Topic, Writer};
use crate::output::whole_file::WholeFile;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use firmware::recorder::gyro::{BLOCK_BYTES, Block, FORMAT, GyroLog};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Blocks that wait, of 32 samples each: more than come between two looks.
const GYRO_BLOCK_COUNT: usize = 64;

/// Memory for a vehicle that is starting.
pub fn memory() -> &'static mut [Block] {
    Box::leak(vec![[0; BLOCK_BYTES]; GYRO_BLOCK_COUNT].into_boxed_slice())
}

/// A file under way.
pub struct GyroFile {
    file: WholeFile,
    path: PathBuf,
    written: Writer,
}

impl GyroFile {
    /// Begins one at `path`, where it shows up when it is finished.
    ///
    /// # Errors
    /// In words, if it cannot be written.
    pub fn create(path: &Path) -> Result<Self, String> {
        let file = WholeFile::alone(path).map_err(failed(path))?;
        let (name, fields) = FORMAT.split_once(':').unwrap_or_default();
        Ok(Self { file, path: path.to_owned(), written: Writer::new(0, &[Topic { name, fields }], &[], &[]) })
    }

    /// Adds what has come.
    pub fn take(&mut self, log: &GyroLog<NoopRawMutex>) {
        while let Some(block) = log.take() {
            let (time, rest) =
                block.split_first_chunk().map_or((0, &[][..]), |(time, rest)| (u64::from_le_bytes(*time), rest));
            self.written.record(0, time, rest);
        }
    }

    /// Gives it its name.
    ///
    /// # Errors
    /// In words, if it cannot be written.
    pub fn finish(mut self) -> Result<(), String> {
        let written = self.written.finish();
        self.file.write_all(&written).and_then(|()| self.file.finish()).map_err(failed(&self.path))
    }
}

fn failed(path: &Path) -> impl FnOnce(std::io::Error) -> String {
    |error| format!("{}: cannot be written: {error}", path.display())
}
