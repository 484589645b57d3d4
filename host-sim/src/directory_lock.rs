//! One writer for a directory: who writes flights, campaigns or comparisons into it keeps everybody else out.
//!
//! The lock is the operating system's on the directory itself. It ends with the process, however that ends, and leaves
//! no file behind. Where a file system has no locks, as some across a network, there is none.

use std::fs::{File, TryLockError};
use std::path::Path;
use std::{fs, io};

/// Held as long as something writes.
#[derive(Debug)]
pub struct DirectoryLock {
    _directory: Option<File>,
}

impl DirectoryLock {
    /// Makes `directory` where it is missing, and locks it.
    ///
    /// # Errors
    /// If it cannot be made, or another process writes into it; the text says what to do.
    pub fn take(directory: &Path) -> io::Result<Self> {
        fs::create_dir_all(directory)?;
        let Ok(file) = File::open(directory) else { return Ok(Self { _directory: None }) };
        match file.try_lock() {
            Ok(()) => Ok(Self { _directory: Some(file) }),
            Err(TryLockError::Error(_)) => Ok(Self { _directory: None }),
            Err(TryLockError::WouldBlock) => Err(io::Error::new(
                io::ErrorKind::WouldBlock,
                "another run writes into it; wait for its end, or choose another --out",
            )),
        }
    }
}
