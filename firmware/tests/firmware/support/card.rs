//! A memory card in memory: formatted, damaged, slow, failing, or without power from any write on; and an independent
//! reader of its files.

use super::Simulated;
use fatfs::{FatType, FileSystem, FormatVolumeOptions, FsOptions, format_volume};
use firmware::hardware::{Card, Fault, SECTOR_BYTES};
use firmware::recorder::{gyro, tick};
use std::cell::RefCell;
use std::collections::{BTreeMap, HashMap};
use std::io::{Error, Read, Result, Seek, SeekFrom, Write};
use std::rc::Rc;

/// Where the partition begins.
pub const PARTITION_START: u32 = 64;

/// Sectors that are not zero, by their numbers.
pub type Image = HashMap<u32, [u8; SECTOR_BYTES]>;

/// What the card does.
#[derive(Default)]
pub struct Medium {
    pub image: Image,
    pub sectors: u32,
    /// Every write so far, in order.
    pub written: Vec<(u32, [u8; SECTOR_BYTES])>,
    /// Whether there is a card in the slot.
    pub is_absent: bool,
    /// Whether writes fail.
    pub fails: bool,
    /// What the sector that cannot be read holds.
    pub worn: Option<Vec<u8>>,
    /// How long the card keeps its task at a write, us, by the number of the write.
    pub takes: Option<fn(usize) -> u64>,
}

/// The card, and the clock that goes on while it keeps its task.
#[derive(Clone)]
pub struct Simulation<'c> {
    pub medium: Rc<RefCell<Medium>>,
    clock: &'c Simulated,
}

impl<'c> Simulation<'c> {
    pub fn new(image: Image, sectors: u32, clock: &'c Simulated) -> Self {
        let medium = Medium { image, sectors, ..Medium::default() };
        Self { medium: Rc::new(RefCell::new(medium)), clock }
    }
}

impl Card for Simulation<'_> {
    fn start(&mut self) -> core::result::Result<(), Fault> {
        if self.medium.borrow().is_absent { Err(Fault) } else { Ok(()) }
    }

    fn sectors(&self) -> u32 {
        self.medium.borrow().sectors
    }

    fn read(&mut self, sector: u32, data: &mut [u8; SECTOR_BYTES]) -> core::result::Result<(), Fault> {
        let medium = self.medium.borrow();
        *data = medium.image.get(&sector).copied().unwrap_or([0; SECTOR_BYTES]);
        let is_worn = medium.worn.as_deref() == Some(data.as_slice());
        if medium.is_absent || is_worn || sector >= medium.sectors { Err(Fault) } else { Ok(()) }
    }

    fn write(&mut self, sector: u32, data: &[u8; SECTOR_BYTES]) -> core::result::Result<(), Fault> {
        let mut medium = self.medium.borrow_mut();
        if medium.is_absent || medium.fails || sector >= medium.sectors {
            return Err(Fault);
        }
        let time = medium.takes.map_or(0, |takes| takes(medium.written.len()));
        self.clock.0.set(self.clock.0.get() + time);
        medium.image.insert(sector, *data);
        medium.written.push((sector, *data));
        Ok(())
    }
}

/// The partition of an image, for `fatfs`.
struct Partition<'i> {
    image: &'i mut Image,
    sectors: u32,
    at: u64,
}

impl Partition<'_> {
    /// The sector at the present place, where in it that is, and how much of it is left for so many bytes.
    fn place(&self, bytes: usize) -> (u32, usize, usize) {
        let (sector, offset) = (self.at / SECTOR_BYTES as u64, (self.at % SECTOR_BYTES as u64) as usize);
        let left = if sector < u64::from(self.sectors) { SECTOR_BYTES - offset } else { 0 };
        (PARTITION_START + sector as u32, offset, left.min(bytes))
    }
}

impl Read for Partition<'_> {
    fn read(&mut self, out: &mut [u8]) -> Result<usize> {
        let (sector, offset, count) = self.place(out.len());
        match self.image.get(&sector) {
            Some(bytes) => out[..count].copy_from_slice(&bytes[offset..offset + count]),
            None => out[..count].fill(0),
        }
        self.at += count as u64;
        Ok(count)
    }
}

impl Write for Partition<'_> {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        let (sector, offset, count) = self.place(bytes.len());
        let bytes = &bytes[..count];
        if self.image.contains_key(&sector) || bytes.iter().any(|byte| *byte != 0) {
            self.image.entry(sector).or_insert([0; SECTOR_BYTES])[offset..offset + count].copy_from_slice(bytes);
        }
        self.at += count as u64;
        Ok(count)
    }

    fn flush(&mut self) -> Result<()> {
        Ok(())
    }
}

impl Seek for Partition<'_> {
    fn seek(&mut self, to: SeekFrom) -> Result<u64> {
        let end = u64::from(self.sectors) * SECTOR_BYTES as u64;
        let at = match to {
            SeekFrom::Start(at) => Some(at),
            SeekFrom::Current(by) => self.at.checked_add_signed(by),
            SeekFrom::End(by) => end.checked_add_signed(by),
        };
        self.at = at.ok_or_else(|| Error::other("before the beginning"))?;
        Ok(self.at)
    }
}

/// A card with a partition table and an empty file system; the image, and how many sectors it has.
pub fn formatted(kind: FatType, sectors: u32, cluster: u32) -> (Image, u32) {
    let mut image = Image::new();
    let options = FormatVolumeOptions::new().fat_type(kind).bytes_per_cluster(cluster);
    format_volume(Partition { image: &mut image, sectors, at: 0 }, options).unwrap();
    let mut table = [0; SECTOR_BYTES];
    table[446 + 4] = if kind == FatType::Fat32 { 0x0C } else { 0x06 };
    table[446 + 8..446 + 12].copy_from_slice(&PARTITION_START.to_le_bytes());
    table[446 + 12..446 + 16].copy_from_slice(&sectors.to_le_bytes());
    table[510..].copy_from_slice(&[0x55, 0xAA]);
    image.insert(0, table);
    (image, PARTITION_START + sectors)
}

/// A small card of FAT16.
pub fn small() -> (Image, u32) {
    formatted(FatType::Fat16, 20_000, 2_048)
}

/// Every file in the root directory with its bytes, as `fatfs` reads them.
pub fn files(image: &mut Image, sectors: u32) -> BTreeMap<String, Vec<u8>> {
    let partition = Partition { image, sectors: sectors - PARTITION_START, at: 0 };
    let system = FileSystem::new(partition, FsOptions::new()).unwrap();
    let mut files = BTreeMap::new();
    for entry in system.root_dir().iter() {
        let entry = entry.unwrap();
        let mut bytes = vec![];
        entry.to_file().read_to_end(&mut bytes).unwrap();
        files.insert(String::from_utf8_lossy(entry.short_file_name_as_bytes()).into_owned(), bytes);
    }
    files
}

/// The content of a ULog file.
#[derive(Debug, Default, PartialEq)]
pub struct Parsed {
    /// The time in its head.
    pub time: u64,
    /// The times of its records, us.
    pub ticks: Vec<u64>,
    /// Its records.
    pub records: Vec<Vec<u8>>,
    /// The times of the gyro's blocks, us.
    pub gyro: Vec<u64>,
    /// The texts, with levels and times.
    pub texts: Vec<(char, u64, String)>,
    /// Gaps, ms.
    pub gaps: Vec<u16>,
    /// Whether all of it could be read.
    pub is_whole: bool,
}

/// Reads a file as any reader of ULog does: message by message, kinds that it does not know skipped.
pub fn parsed(file: &[u8]) -> Parsed {
    assert_eq!(&file[..8], b"ULog\x01\x12\x35\x01");
    let number = |bytes: &[u8]| u64::from_le_bytes(bytes.try_into().unwrap());
    let mut parsed = Parsed { time: number(&file[8..16]), ..Parsed::default() };
    let mut rest = &file[16..];
    while let [low, high, kind, behind @ ..] = rest {
        let length = usize::from(u16::from_le_bytes([*low, *high]));
        let Some((body, behind)) = behind.split_at_checked(length) else { return parsed };
        match kind {
            b'D' if length == 2 + tick::TICK_BYTES => {
                parsed.ticks.push(number(&body[2..10]));
                parsed.records.push(body[2..].to_vec());
            }
            b'D' if body[..2] == [1, 0] && length == 2 + gyro::BLOCK_BYTES => parsed.gyro.push(number(&body[2..10])),
            b'L' => {
                let text = String::from_utf8(body[9..].to_vec()).unwrap();
                parsed.texts.push((char::from(body[0]), number(&body[1..9]), text));
            }
            b'O' => parsed.gaps.push(u16::from_le_bytes(body.try_into().unwrap())),
            b'B' | b'I' | b'P' | b'F' | b'A' | b'Z' => {}
            _ => return parsed,
        }
        rest = behind;
    }
    parsed.is_whole = rest.is_empty();
    parsed
}
