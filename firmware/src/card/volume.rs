//! The card's file system: numbered files in its root directory, over the `embedded-sdmmc` crate.
//!
//! Each step declares what it may write, and any other write fails: a new file's name never makes the root directory
//! longer (the crate links a directory's new part before it clears it, so a cut in between would fill it with what was
//! there before), and a record's sector goes nowhere but among the data.
//!
//! Nothing is ever deleted, and a number is never given again while its file is there. The clock is not known: files
//! are of 1980.

use super::geometry::{Geometry, partition};
use crate::hardware::{Card, Fault, SECTOR_BYTES};
use crate::words::worded;
use core::cell::{Cell, RefCell};
use core::ops::ControlFlow;
use embedded_sdmmc::{
    Block, BlockCount, BlockDevice, BlockIdx, ClusterId, DirEntry, Error, Mode, RawDirectory, RawFile, ShortFileName,
    TimeSource, Timestamp, VolumeIdx, VolumeManager,
};

/// Files have numbers of five digits, from 1 on.
pub const NUMBER_MAX: u32 = 99_999;

worded! {
    /// Why flights are not logged.
    pub enum Trouble {
        /// No card answers.
        Absent = "No card: flights are not logged",
        /// It holds nothing that can be written to.
        Foreign = "Card unusable: format it as FAT32 (MBR)",
        /// It has no room, or its root directory has none.
        Full = "Card full: move logs off it",
        /// It failed.
        Failed = "Card failed: flights are not logged",
    }
}

worded! {
    /// What went wrong with a card that was read from or written to.
    enum Denied {
        /// It did not take it or give it.
        Failed = "the card failed",
        /// Nothing may be written there now.
        Forbidden = "the sector may not be written now",
    }
}

impl core::error::Error for Denied {}

impl From<Error<Denied>> for Trouble {
    fn from(error: Error<Denied>) -> Self {
        match error {
            Error::DiskFull | Error::NotEnoughSpace | Error::DeviceError(Denied::Forbidden) => Self::Full,
            Error::DeviceError(Denied::Failed) => Self::Failed,
            _ => Self::Foreign,
        }
    }
}

impl From<Fault> for Trouble {
    fn from(_: Fault) -> Self {
        Self::Failed
    }
}

/// What may be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Permission {
    /// Everything.
    All,
    /// All but the tables of clusters.
    NoTables,
    /// Data only.
    Data,
}

/// The card as the crate sees it.
struct Sectors<'c, C> {
    card: RefCell<&'c mut C>,
    geometry: Geometry,
    permission: Cell<Permission>,
}

impl<C: Card> BlockDevice for Sectors<'_, C> {
    type Error = Denied;

    fn read(&self, blocks: &mut [Block], start: BlockIdx) -> Result<(), Denied> {
        let mut card = self.card.try_borrow_mut().map_err(|_| Denied::Failed)?;
        let (start, count) = (start.0, card.sectors());
        for (sector, block) in (start..).zip(blocks) {
            // What a damaged table points at may be beyond the card's end.
            let read = if sector < count { card.read(sector, &mut block.contents) } else { Err(Fault) };
            read.map_err(|_| Denied::Failed)?;
        }
        Ok(())
    }

    fn write(&self, blocks: &[Block], start: BlockIdx) -> Result<(), Denied> {
        let mut card = self.card.try_borrow_mut().map_err(|_| Denied::Failed)?;
        for (sector, block) in (start.0..).zip(blocks) {
            let Geometry { tables, data } = &self.geometry;
            let is_permitted = match self.permission.get() {
                Permission::All => (tables.start.saturating_sub(RESERVED_SECTORS_MAX)..data.end).contains(&sector),
                Permission::NoTables => !tables.contains(&sector) && (tables.end..data.end).contains(&sector),
                Permission::Data => data.contains(&sector),
            };
            if !is_permitted {
                return Err(Denied::Forbidden);
            }
            card.write(sector, &block.contents).map_err(|_| Denied::Failed)?;
        }
        Ok(())
    }

    fn num_blocks(&self) -> Result<BlockCount, Denied> {
        self.card.try_borrow().map(|card| BlockCount(card.sectors())).map_err(|_| Denied::Failed)
    }
}

/// Sectors before the tables, at most: how many clusters are free is noted among them.
const RESERVED_SECTORS_MAX: u32 = u16::MAX as u32;

/// The clock that there is not.
struct NoTime;

impl TimeSource for NoTime {
    fn get_timestamp(&self) -> Timestamp {
        Timestamp { year_since_1970: 10, zero_indexed_month: 0, zero_indexed_day: 0, hours: 0, minutes: 0, seconds: 0 }
    }
}

/// What a file is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A flight, as it was logged.
    Log,
    /// The recorder's last seconds of a flight, copied at boot.
    Recording,
}

impl Kind {
    /// What its name begins with.
    const fn prefix(self) -> &'static str {
        match self {
            Self::Log => "LOG",
            Self::Recording => "REC",
        }
    }
}

/// A file in the root directory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Entry {
    /// What it is.
    pub kind: Kind,
    /// Its number.
    pub number: u32,
    /// Bytes.
    pub size: u32,
    /// Whether it consists of something if it has a length, and of nothing if it has none.
    pub is_sound: bool,
}

impl Entry {
    /// A file of this program's, by its name.
    fn read(entry: &DirEntry) -> Option<Self> {
        let (name, extension) = (entry.name.base_name(), entry.name.extension());
        let kind = [Kind::Log, Kind::Recording].into_iter().find(|kind| name.starts_with(kind.prefix().as_bytes()))?;
        let digits = name.get(3..).filter(|digits| digits.len() == 5 && extension == b"ULG")?;
        let number = core::str::from_utf8(digits).ok()?.parse().ok()?;
        Some(Self { kind, number, size: entry.size, is_sound: (entry.size > 0) == (entry.cluster > ClusterId::EMPTY) })
    }
}

/// An open file.
#[derive(Debug, Clone, Copy)]
pub struct File(RawFile);

/// A card's file system.
pub struct Volume<'c, C: Card> {
    manager: VolumeManager<Sectors<'c, C>, NoTime, 1, 2, 1>,
    root: RawDirectory,
}

impl<'c, C: Card> Volume<'c, C> {
    /// Opens the file system of a card that has started.
    /// Errors: [`Trouble::Foreign`] if it has no usable file system, [`Trouble::Failed`] if the card fails.
    pub fn open(card: &'c mut C) -> Result<Self, Trouble> {
        let mut sector = [0; SECTOR_BYTES];
        card.read(0, &mut sector)?;
        let start = partition(&sector).filter(|&start| start < card.sectors()).ok_or(Trouble::Foreign)?;
        card.read(start, &mut sector)?;
        let geometry = Geometry::read(&sector, start, card.sectors()).ok_or(Trouble::Foreign)?;
        let sectors = Sectors { card: RefCell::new(card), geometry, permission: Cell::new(Permission::All) };
        let manager = VolumeManager::new_with_limits(sectors, NoTime, 1);
        let volume = manager.open_raw_volume(VolumeIdx(0))?;
        let root = manager.open_root_dir(volume)?;
        Ok(Self { manager, root })
    }

    /// Calls `each` with every file of this program's, until it breaks.
    /// Fails if the directory cannot be read.
    pub fn list(&self, mut each: impl FnMut(Entry) -> ControlFlow<()>) -> Result<(), Trouble> {
        let each = |entry: &DirEntry| Entry::read(entry).map_or(ControlFlow::Continue(()), &mut each);
        Ok(self.manager.iterate_dir(self.root, each)?)
    }

    /// The file with the greatest number, of these kinds.
    /// Fails if the directory cannot be read.
    pub fn newest(&self, kinds: &[Kind]) -> Result<Option<Entry>, Trouble> {
        let mut newest: Option<Entry> = None;
        self.list(|entry| {
            if kinds.contains(&entry.kind) && newest.is_none_or(|newest| entry.number > newest.number) {
                newest = Some(entry);
            }
            ControlFlow::Continue(())
        })?;
        Ok(newest)
    }

    /// Creates a file with the number after the greatest there is.
    /// Errors: [`Trouble::Full`] if the root directory has no room or the numbers are used up.
    pub fn create(&self, kind: Kind) -> Result<(File, u32), Trouble> {
        let newest = self.newest(&[Kind::Log, Kind::Recording])?;
        let number = newest.map_or(0, |newest| newest.number) + 1;
        if number > NUMBER_MAX {
            return Err(Trouble::Full);
        }
        let create = || self.manager.open_file_in_dir(self.root, name(kind, number)?, Mode::ReadWriteCreate);
        Ok((File(self.permitting(Permission::NoTables, create)?), number))
    }

    /// Opens a file that is there.
    /// Fails if it cannot be opened.
    pub fn open_file(&self, kind: Kind, number: u32) -> Result<File, Trouble> {
        let name = name(kind, number)?;
        Ok(File(self.manager.open_file_in_dir(self.root, name, Mode::ReadWriteAppend)?))
    }

    /// Opens a file that is there, for reading only.
    /// Fails if it cannot be opened.
    pub fn open_to_read(&self, kind: Kind, number: u32) -> Result<File, Trouble> {
        Ok(File(self.manager.open_file_in_dir(self.root, name(kind, number)?, Mode::ReadOnly)?))
    }

    /// Reads from `offset` on; how many bytes there were.
    /// Fails if the offset is beyond the file's end, or the card fails.
    pub fn read(&self, file: File, offset: u32, out: &mut [u8]) -> Result<usize, Trouble> {
        self.manager.file_seek_from_start(file.0, offset)?;
        Ok(self.manager.read(file.0, out)?)
    }

    /// Writes a sector over one that the file has.
    /// Fails if the file has none there, or the card fails.
    pub fn overwrite(&self, file: File, offset: u32, sector: &[u8; SECTOR_BYTES]) -> Result<(), Trouble> {
        if offset.saturating_add(SECTOR_BYTES as u32) > self.manager.file_length(file.0)? {
            return Err(Trouble::Failed);
        }
        let write = || {
            self.manager.file_seek_from_start(file.0, offset)?;
            self.manager.write(file.0, sector)
        };
        Ok(self.permitting(Permission::Data, write)?)
    }

    /// Writes behind the file's end. The file is longer only once this is [noted](Self::note).
    /// Errors: [`Trouble::Full`] if there is no room.
    pub fn append(&self, file: File, bytes: &[u8]) -> Result<(), Trouble> {
        self.manager.file_seek_from_end(file.0, 0)?;
        Ok(self.manager.write(file.0, bytes)?)
    }

    /// Notes in the directory how long a file is.
    /// Fails if the card fails.
    pub fn note(&self, file: File) -> Result<(), Trouble> {
        Ok(self.manager.flush_file(file.0)?)
    }

    /// Notes how long a file is, and closes it.
    /// Fails if the card fails; it is closed all the same.
    pub fn close(&self, file: File) -> Result<(), Trouble> {
        Ok(self.manager.close_file(file.0)?)
    }

    fn permitting<T>(&self, permission: Permission, act: impl FnOnce() -> T) -> T {
        self.permit(permission);
        let done = act();
        self.permit(Permission::All);
        done
    }

    /// The crate drops its cached sector when the card is borrowed, which costs one reading.
    fn permit(&self, permission: Permission) {
        self.manager.device(|sectors| sectors.permission.set(permission));
    }
}

fn name(kind: Kind, number: u32) -> Result<ShortFileName, Error<Denied>> {
    use core::fmt::Write;
    let mut name: heapless::String<12> = heapless::String::new();
    // Eight characters, a dot and three more are what it has room for.
    let _ = write!(name, "{}{number:05}.ULG", kind.prefix());
    ShortFileName::create_from_str(&name).map_err(Error::FilenameError)
}
