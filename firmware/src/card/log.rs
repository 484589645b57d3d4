//! A flight's file: its beginning, then [sectors](super::sector) in order, then blank ones to its end.
//!
//! The file is made as long as a flight before the flight begins, so that in flight nothing is written but the sector
//! that is due, over a blank one: neither a table nor the directory changes, and what power cuts short is that sector
//! and no other. A longer flight lengthens its file by [`GROWTH_BYTES`] at a time; one that reaches [`SIZE_MAX_BYTES`]
//! goes on in the next file.
//!
//! Every length that the directory ever notes is a multiple of 64 KB below 16 MB, which differs from the one before in
//! one byte: no cut leaves a length that mixes two.

use super::file_header::{FileHeader, HEAD_SECTORS};
use super::sector::{BLANK_SECTOR, Content, SECTOR_CAPACITY_BYTES, Sector};
use super::volume::{File, Kind, Trouble, Volume};
use crate::hardware::{Card, SECTOR_BYTES};
use crate::recorder::gyro::{self, Block};
use crate::recorder::{tick, ulog};
use crate::shared::{Event, Severity, Text};
use embassy_sync::blocking_mutex::raw::RawMutex;

/// What a file grows by: 3.8 s of flight.
pub const GROWTH_BYTES: u32 = 64 << 10;

/// The longest file: 16 minutes.
pub const SIZE_MAX_BYTES: u32 = 0x00FF_0000;

/// Room for what is written between two looks at [`Log::is_full`]: a record, a block of the gyro, every event that
/// waits, and the sector that had begun.
const RESERVE_BYTES: u32 = 9 * SECTOR_STEP_BYTES;

/// Bytes before the first record's sector.
const BEGINNING_BYTES: u32 = (HEAD_SECTORS * SECTOR_BYTES) as u32;

/// Bytes of a sector, as offsets in a file count.
const SECTOR_STEP_BYTES: u32 = SECTOR_BYTES as u32;

const _: () = assert!(ulog::DATA_HEAD.len() + tick::TICK_BYTES <= SECTOR_CAPACITY_BYTES);
const _: () = assert!(2 * (gyro::DATA_HEAD.len() + gyro::BLOCK_BYTES) <= SECTOR_CAPACITY_BYTES);

/// A file that is being filled.
pub struct Log {
    file: File,
    number: u32,
    size: u32,
    /// Where the next sector goes.
    next: u32,
    sector: Sector,
    /// Records in the sector.
    pending: u32,
    /// Records in the file.
    written: u32,
}

impl Log {
    /// Takes the newest file if nothing was logged in it, and else makes a new one. The newest loses its last sector if
    /// that is torn.
    /// Fails if there is no room for it, or the card fails.
    pub fn prepare<C: Card, M: RawMutex>(
        volume: &Volume<'_, C>,
        beginning: &FileHeader<'_, M>,
    ) -> Result<Self, Trouble> {
        // A file that was cut short while it got its first length may be at odds with the tables: it is left alone.
        let newest = volume.newest(&[Kind::Log])?;
        if let Some(entry) = newest.filter(|entry| entry.size.is_multiple_of(SECTOR_STEP_BYTES) && entry.is_sound) {
            let file = volume.open_file(entry.kind, entry.number)?;
            let mut end = end(volume, file, entry.size)?;
            if end > BEGINNING_BYTES && read(volume, file, end - SECTOR_STEP_BYTES)? == Content::Torn {
                end -= SECTOR_STEP_BYTES;
                volume.overwrite(file, end, &BLANK_SECTOR)?;
            }
            if end <= BEGINNING_BYTES {
                return Self::new(file, entry.number, entry.size).begun(volume, beginning);
            }
            volume.close(file)?;
        }
        let (file, number) = volume.create(Kind::Log)?;
        Self::new(file, number, 0).begun(volume, beginning)
    }

    /// With a first chunk.
    fn begun<C: Card, M: RawMutex>(
        mut self,
        volume: &Volume<'_, C>,
        beginning: &FileHeader<'_, M>,
    ) -> Result<Self, Trouble> {
        if self.size < GROWTH_BYTES {
            self.lengthen(
                volume,
                |place| if place < HEAD_SECTORS { beginning.sector(place, 0) } else { BLANK_SECTOR },
            )?;
        }
        Ok(self)
    }

    const fn new(file: File, number: u32, size: u32) -> Self {
        Self { file, number, size, next: BEGINNING_BYTES, sector: Sector::new(), pending: 0, written: 0 }
    }

    /// Its number.
    pub fn number(&self) -> u32 {
        self.number
    }

    /// Whether there is a record in it.
    pub fn has_begun(&self) -> bool {
        self.written + self.pending > 0
    }

    /// Records that are on the card.
    pub fn written(&self) -> u32 {
        self.written
    }

    /// Records that are not on the card yet.
    pub fn pending(&self) -> u32 {
        self.pending
    }

    /// Bytes that it has, used or not.
    pub fn size(&self) -> u32 {
        self.size
    }

    /// Whether it is to be finished: it may not become longer, and has room for no more than what is still to be
    /// written.
    pub fn is_full(&self) -> bool {
        self.next >= SIZE_MAX_BYTES - RESERVE_BYTES
    }

    /// Makes it longer, up to the next multiple of [`GROWTH_BYTES`].
    /// Errors: [`Trouble::Full`] if there is no room. What there was room for is noted as well: nothing else can have
    /// it.
    pub fn grow<C: Card>(&mut self, volume: &Volume<'_, C>) -> Result<(), Trouble> {
        self.lengthen(volume, |_| BLANK_SECTOR)
    }

    fn lengthen<C: Card>(
        &mut self,
        volume: &Volume<'_, C>,
        sector: impl Fn(usize) -> [u8; SECTOR_BYTES],
    ) -> Result<(), Trouble> {
        let end = (self.size / GROWTH_BYTES + 1) * GROWTH_BYTES;
        for place in self.size / SECTOR_STEP_BYTES..end / SECTOR_STEP_BYTES {
            if let Err(trouble) = volume.append(self.file, &sector(place as usize)) {
                if trouble == Trouble::Full {
                    volume.note(self.file)?;
                }
                return Err(trouble);
            }
        }
        volume.note(self.file)?;
        self.size = end;
        Ok(())
    }

    /// Adds a record; before the first, what is to be said of the vehicle by now.
    /// Fails if a sector cannot be written.
    pub fn record<C: Card, M: RawMutex>(
        &mut self,
        volume: &Volume<'_, C>,
        beginning: &FileHeader<'_, M>,
        record: &[u8; tick::TICK_BYTES],
    ) -> Result<(), Trouble> {
        if !self.has_begun() {
            let time = record.first_chunk().map_or(0, |time| u64::from_le_bytes(*time));
            // But for the time and values it is what is there already, so a cut does no harm.
            for (offset, place) in (0..).step_by(SECTOR_BYTES).zip(0..HEAD_SECTORS) {
                volume.overwrite(self.file, offset, &beginning.sector(place, time))?;
            }
        }
        self.put(volume, &[&ulog::DATA_HEAD, record])?;
        self.pending += 1;
        Ok(())
    }

    /// Adds a block of the gyro.
    /// Fails if a sector cannot be written.
    pub fn gyro<C: Card>(&mut self, volume: &Volume<'_, C>, block: &Block) -> Result<(), Trouble> {
        self.put(volume, &[&gyro::DATA_HEAD, block])
    }

    /// Adds an event of `time`, us.
    /// Fails if a sector cannot be written.
    pub fn event<C: Card>(&mut self, volume: &Volume<'_, C>, time: u64, event: &Event) -> Result<(), Trouble> {
        let text = Text::new(event);
        // As syslog numbers them, in ASCII.
        let level = match event.severity() {
            Severity::Information => b'6',
            Severity::Warning => b'4',
            Severity::Critical => b'2',
        };
        let words = text.as_str().as_bytes();
        let head = ulog::head(b'L', 1 + size_of_val(&time) + words.len());
        self.put(volume, &[&head, &[level], &time.to_le_bytes(), words])
    }

    /// Notes that so many records, each `spacing` us after the last, are missing here.
    /// Fails if a sector cannot be written.
    pub fn gap<C: Card>(&mut self, volume: &Volume<'_, C>, missed: u32, spacing: u64) -> Result<(), Trouble> {
        let milliseconds = u64::from(missed) * spacing / 1_000;
        let duration = u16::try_from(milliseconds).unwrap_or(u16::MAX);
        self.put(volume, &[&ulog::head(b'O', size_of_val(&duration)), &duration.to_le_bytes()])
    }

    /// Writes what is still in the sector: the next message goes to the one behind it.
    /// Fails if it cannot be written.
    pub fn flush<C: Card>(&mut self, volume: &Volume<'_, C>) -> Result<(), Trouble> {
        if self.sector.is_empty() {
            return Ok(());
        }
        if self.next >= self.size {
            self.grow(volume)?;
        }
        volume.overwrite(self.file, self.next, &self.sector.finish())?;
        self.next += SECTOR_STEP_BYTES;
        self.written += core::mem::take(&mut self.pending);
        Ok(())
    }

    /// Writes what is left and closes the file.
    /// Fails if the card fails.
    pub fn finish<C: Card>(mut self, volume: &Volume<'_, C>) -> Result<u32, Trouble> {
        self.flush(volume)?;
        volume.close(self.file)?;
        Ok(self.written)
    }

    fn put<C: Card>(&mut self, volume: &Volume<'_, C>, parts: &[&[u8]]) -> Result<(), Trouble> {
        if !self.sector.put(parts) {
            self.flush(volume)?;
            // Every message fits an empty sector.
            let _ = self.sector.put(parts);
        }
        Ok(())
    }
}

/// What a sector of a file holds.
fn read<C: Card>(volume: &Volume<'_, C>, file: File, offset: u32) -> Result<Content, Trouble> {
    let mut sector = [0; SECTOR_BYTES];
    let _ = volume.read(file, offset, &mut sector)?;
    Ok(Content::from_bytes(&sector))
}

/// Where the blank end of a file of `size` bytes begins. Sectors are written in order, so half of the search
/// can be left out at a time.
/// Fails if the file cannot be read.
pub fn end<C: Card>(volume: &Volume<'_, C>, file: File, size: u32) -> Result<u32, Trouble> {
    let (mut used, mut blank) = (HEAD_SECTORS as u32, size / SECTOR_STEP_BYTES);
    while used < blank {
        let middle = used + (blank - used) / 2;
        match read(volume, file, middle * SECTOR_STEP_BYTES)? {
            Content::Blank => blank = middle,
            Content::Whole | Content::Torn => used = middle + 1,
        }
    }
    Ok(blank * SECTOR_STEP_BYTES)
}
