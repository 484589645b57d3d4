//! One writer for a directory of flights, campaigns or comparisons.
//!
//! The lock is the operating system's on the directory itself. It ends with the process, however that ends, and leaves
//! no file behind. Some file systems across a network have no locks; there it does nothing.

use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};
use std::{fs, io};

/// Held as long as something writes. Dropped, it takes away the directories it made, if nothing was written.
#[derive(Debug)]
pub struct DirectoryLock {
    _directory: Option<File>,
    /// The missing directories, the innermost first.
    made: Vec<PathBuf>,
}

impl DirectoryLock {
    /// Makes `directory` where it is missing, and locks it.
    ///
    /// # Errors
    /// If it cannot be made, or another process writes into it; the text says what to do.
    pub fn take(directory: &Path) -> io::Result<Self> {
        let missing = directory.ancestors().take_while(|path| !path.as_os_str().is_empty() && !path.exists());
        let made = missing.map(Path::to_owned).collect();
        fs::create_dir_all(directory)?;
        let Ok(file) = File::open(directory) else { return Ok(Self { _directory: None, made }) };
        match file.try_lock() {
            Ok(()) => Ok(Self { _directory: Some(file), made }),
            Err(TryLockError::Error(_)) => Ok(Self { _directory: None, made }),
            Err(TryLockError::WouldBlock) => Err(io::Error::new(
                io::ErrorKind::WouldBlock,
                "another run writes into it; wait for its end, or choose another --out",
            )),
        }
    }
}

impl Drop for DirectoryLock {
    fn drop(&mut self) {
        for directory in &self.made {
            // One that holds something stays, and so do those around it.
            let _ = fs::remove_dir(directory);
        }
    }
}
