//! Files that appear whole or not at all.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// A file that shows up under its name only when it is complete; dropped before that, it leaves nothing behind.
///
/// A device or a pipe is written to as it stands: it must not be replaced by a file of its name.
pub struct WholeFile {
    writer: BufWriter<File>,
    /// Under which name it grows, and which one it gets; none for what is no regular file.
    names: Option<(PathBuf, PathBuf)>,
}

impl WholeFile {
    /// Starts a file that will be called `path`. It grows under a hidden name in the same directory.
    ///
    /// # Errors
    /// If it cannot be created.
    pub fn create(path: &Path) -> io::Result<Self> {
        let special = |found: std::fs::Metadata| !found.is_file() && !found.is_dir();
        if path.metadata().is_ok_and(special) {
            return Ok(Self { writer: BufWriter::new(File::options().write(true).open(path)?), names: None });
        }
        let name = path.file_name().ok_or(io::ErrorKind::InvalidInput)?.to_string_lossy();
        let temporary = path.with_file_name(format!(".{name}.{}.part", std::process::id()));
        let writer = BufWriter::new(File::create(&temporary)?);
        Ok(Self { writer, names: Some((temporary, path.to_owned())) })
    }

    /// Writes `contents` to `path`, whole.
    ///
    /// # Errors
    /// If it cannot be created, written or renamed.
    pub fn write(path: &Path, contents: &str) -> io::Result<()> {
        let mut file = Self::create(path)?;
        file.write_all(contents.as_bytes())?;
        file.finish()
    }

    /// Makes sure that everything written so far is on the disk.
    ///
    /// # Errors
    /// If what is left cannot be written.
    pub fn store(&mut self) -> io::Result<()> {
        self.writer.flush()?;
        if self.names.is_some() { self.writer.get_ref().sync_all() } else { Ok(()) }
    }

    /// Gives the complete file its name.
    ///
    /// # Errors
    /// If what is left cannot be written, or the file not renamed.
    pub fn finish(mut self) -> io::Result<()> {
        self.store()?;
        match self.names.take() {
            None => Ok(()),
            Some((temporary, path)) => std::fs::rename(&temporary, path).inspect_err(|_| remove(&temporary)),
        }
    }
}

impl Write for WholeFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.writer.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer.flush()
    }
}

impl Drop for WholeFile {
    fn drop(&mut self) {
        if let Some((temporary, _)) = &self.names {
            remove(temporary);
        }
    }
}

/// Nothing more can be done where even this fails.
fn remove(temporary: &Path) {
    let _ = std::fs::remove_file(temporary);
}

#[cfg(test)]
mod tests;
