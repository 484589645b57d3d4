//! Files that appear whole or not at all.

use std::fs::{File, TryLockError};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// As Linux has it.
const LINK_CHAIN_MAX: usize = 40;

/// Of the name under which a file grows.
const UNFINISHED_SUFFIX: &str = ".part";

/// Unix's mode of a file that only its owner reads and writes.
#[cfg(unix)]
const OWNER_ONLY_MODE: u32 = 0o600;

/// How many files this program has started: no two grow under one name.
static STARTED: AtomicU64 = AtomicU64::new(0);

/// A file that shows up under its name only when it is complete; dropped before that, it leaves nothing behind.
///
/// It has the owner and the mode of the file that it replaces. A device or a pipe is written to as it stands: it must
/// not be replaced by a file of its name.
#[derive(Debug)]
pub struct WholeFile {
    writer: BufWriter<File>,
    /// Under which name it grows, and which one it gets; none for what is no regular file.
    names: Option<(PathBuf, PathBuf)>,
}

impl WholeFile {
    /// Starts a file that will be called `path`. It grows under a hidden name in the same directory.
    ///
    /// # Errors
    /// If it cannot be created, or the name is a directory's: at once, not when the work is done.
    pub fn create(path: &Path) -> io::Result<Self> {
        Self::begin(path, false)
    }

    /// As [`Self::create`], for what nobody else is to read: where it replaces nothing, only its owner may.
    ///
    /// # Errors
    /// As [`Self::create`]'s.
    pub fn private(path: &Path) -> io::Result<Self> {
        Self::begin(path, true)
    }

    fn begin(path: &Path, is_private: bool) -> io::Result<Self> {
        if path.is_dir() {
            return Err(io::ErrorKind::IsADirectory.into());
        }
        if is_special(path) {
            return Ok(Self { writer: BufWriter::new(File::options().write(true).open(path)?), names: None });
        }
        let path = followed(path)?;
        let beginning = hidden(&path).ok_or(io::ErrorKind::InvalidInput)?;
        loop {
            let (number, process) = (STARTED.fetch_add(1, Ordering::Relaxed), std::process::id());
            let temporary = path.with_file_name(format!("{beginning}{process}.{number}{UNFINISHED_SUFFIX}"));
            match opened(&temporary, &path, is_private) {
                // What a killed program of this number left, or a link that somebody laid there.
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                file => return Ok(Self { writer: BufWriter::new(file?), names: Some((temporary, path)) }),
            }
        }
    }

    /// As [`Self::create`], and keeps other programs from starting the same file in this way until it is dropped or
    /// finished: of two runs of minutes the later one would silently replace the other's result.
    ///
    /// # Errors
    /// As [`Self::create`]'s, or if another program is at it; the text says what to do.
    pub fn alone(path: &Path) -> io::Result<Self> {
        let file = Self::create(path)?;
        let Some((temporary, path)) = &file.names else { return Ok(file) };
        // The lock is on what grows: it ends with the program and leaves nothing behind. A file
        // system without locks gets none.
        let _ = file.writer.get_ref().lock();
        let directory = temporary.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let locked = |found: PathBuf| {
            let other = File::open(found).map(|other| other.try_lock_shared());
            matches!(other, Ok(Err(TryLockError::WouldBlock)))
        };
        let others = std::fs::read_dir(directory)?.flatten().map(|entry| entry.path());
        if others.filter(|found| is_unfinished(found, path) && !is_own(found)).any(locked) {
            return Err(io::Error::new(
                io::ErrorKind::WouldBlock,
                "another run writes it; wait for its end, or choose another name",
            ));
        }
        Ok(file)
    }

    /// Whether [`Self::create`] would find nothing to refuse, for asking before long work; nothing is left behind.
    ///
    /// # Errors
    /// As [`Self::create`]'s. A device or a pipe is not tried: its reader would take the trial for the end.
    pub fn try_name(path: &Path) -> io::Result<()> {
        if is_special(path) { Ok(()) } else { Self::create(path).map(drop) }
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

/// Opens the new file `temporary`, which is to replace `path`. Nobody may read what only some may read in the end.
fn opened(temporary: &Path, path: &Path, is_private: bool) -> io::Result<File> {
    let mut options = File::options();
    options.write(true).create_new(true);
    #[cfg(unix)]
    {
        use std::os::unix::fs::{MetadataExt, OpenOptionsExt, fchown};
        let replaced = path.metadata().ok();
        if is_private || replaced.is_some() {
            options.mode(OWNER_ONLY_MODE);
        }
        let file = options.open(temporary)?;
        if let Some(replaced) = replaced {
            // Only a superuser may: it then stays the owner's file. Before the mode, which this would change.
            let _ = fchown(&file, Some(replaced.uid()), Some(replaced.gid()));
            file.set_permissions(replaced.permissions()).inspect_err(|_| remove(temporary))?;
        }
        Ok(file)
    }
    #[cfg(not(unix))]
    {
        // There a file has its directory's permissions.
        let _ = (path, is_private);
        options.open(temporary)
    }
}

/// How the name begins under which the file called `path` grows. Not its own name, which may be as long as names can
/// be; but one of its own also among programs that share a number, as in containers.
fn hidden(path: &Path) -> Option<String> {
    let mut name = DefaultHasher::new();
    path.file_name()?.hash(&mut name);
    Some(format!(".{:016x}.", name.finish()))
}

/// Whether `found` is what a program that was killed left of a file that was to be called `path`.
#[must_use]
pub fn is_unfinished(found: &Path, path: &Path) -> bool {
    let name = found.file_name().map(|name| name.to_string_lossy());
    let beginning = hidden(path);
    name.zip(beginning)
        .is_some_and(|(name, beginning)| name.starts_with(&beginning) && name.ends_with(UNFINISHED_SUFFIX))
}

/// Whether this program started what grows under the name `found`.
fn is_own(found: &Path) -> bool {
    let name = found.file_name().map(|name| name.to_string_lossy());
    let process = std::process::id().to_string();
    name.is_some_and(|name| name.split('.').nth(2) == Some(process.as_str()))
}

/// What a name stands for that is a symbolic link, whether that exists or not: the link stays one.
fn followed(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..LINK_CHAIN_MAX {
        match std::fs::read_link(&path) {
            Ok(target) => path = path.with_file_name("").join(target),
            Err(_) => return Ok(path),
        }
    }
    Err(io::Error::other("too many symbolic links"))
}

/// Whether the name belongs to a device or a pipe.
fn is_special(path: &Path) -> bool {
    path.metadata().is_ok_and(|found| !found.is_file() && !found.is_dir())
}

/// Nothing more can be done where even this fails.
fn remove(temporary: &Path) {
    let _ = std::fs::remove_file(temporary);
}

#[cfg(test)]
mod tests;
