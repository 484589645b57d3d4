//! Flash for parameters: in memory, and in a file if they are to outlast the program.
//!
//! The file is the flash's image, word by word, written whole each time: parameters change seldom.

use crate::output::whole_file::WholeFile;
use firmware::hardware::{Fault, Flash, Record};
use std::cell::RefCell;
use std::io::{self, Write};
use std::path::PathBuf;
use std::rc::Rc;

const SECTOR_RECORDS: usize = 8;
const RECORD_BYTES: usize = size_of::<Record>();
const BLANK_RECORD: Record = [u32::MAX; _];

/// Two sectors; clones are the same flash, which outlasts a restart.
#[derive(Debug, Clone)]
pub struct DeskFlash {
    records: Rc<RefCell<Vec<Record>>>,
    file: Option<PathBuf>,
    /// Held for the session: two of them would undo each other's parameters.
    _alone: Option<Rc<WholeFile>>,
}

impl DeskFlash {
    /// The content of `file`, or blank flash if it does not exist.
    ///
    /// # Errors
    /// In words, if the file cannot be read, is something else, or could not be written later: what is set in a session
    /// is to outlast it.
    pub fn open(file: Option<PathBuf>) -> Result<Self, String> {
        let unreadable = |path: &PathBuf, error| format!("--parameters {}: cannot be read: {error}", path.display());
        // Before it is opened for writing, which waits where it is a pipe.
        if let Some(path) = &file {
            scenario::text::regular(path).map_err(|error| unreadable(path, error))?;
        }
        let unwritable = |path: &PathBuf, error| format!("--parameters {}: cannot be written: {error}", path.display());
        let alone = |path: &PathBuf| WholeFile::alone(path).map_err(|error| unwritable(path, error));
        let _alone = file.as_ref().map(alone).transpose()?.map(Rc::new);
        let flash = Self { records: Rc::new(RefCell::new(vec![BLANK_RECORD; 2 * SECTOR_RECORDS])), file, _alone };
        let Some(path) = &flash.file else { return Ok(flash) };
        let wanted = 2 * SECTOR_RECORDS * RECORD_BYTES;
        let image = match scenario::text::bytes(path, wanted as u64) {
            Ok(image) => image,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(flash),
            Err(error) => return Err(unreadable(path, error)),
        };
        if image.len() != wanted {
            return Err(format!(
                "--parameters {}: is no file of parameters: it has not {wanted} bytes",
                path.display()
            ));
        }
        for (record, bytes) in flash.records.borrow_mut().iter_mut().zip(image.chunks_exact(RECORD_BYTES)) {
            for (word, bytes) in record.iter_mut().zip(bytes.as_chunks().0) {
                *word = u32::from_le_bytes(*bytes);
            }
        }
        Ok(flash)
    }

    fn store(&self) -> Result<(), Fault> {
        let Some(path) = &self.file else { return Ok(()) };
        let image: Vec<u8> = self.records.borrow().iter().flatten().flat_map(|word| word.to_le_bytes()).collect();
        let write = || {
            // The key that signs frames may be among them.
            let mut file = WholeFile::private(path)?;
            file.write_all(&image)?;
            file.finish()
        };
        write().map_err(|_| Fault)
    }
}

impl Flash for DeskFlash {
    const RECORDS_PER_SECTOR: usize = SECTOR_RECORDS;

    fn read(&mut self, place: usize) -> Result<Record, Fault> {
        self.records.borrow().get(place).copied().ok_or(Fault)
    }

    fn write(&mut self, place: usize, record: &Record) -> Result<(), Fault> {
        *self.records.borrow_mut().get_mut(place).ok_or(Fault)? = *record;
        self.store()
    }

    fn erase(&mut self, sector: usize) -> Result<(), Fault> {
        self.records.borrow_mut().chunks_mut(SECTOR_RECORDS).nth(sector).ok_or(Fault)?.fill(BLANK_RECORD);
        self.store()
    }
}
