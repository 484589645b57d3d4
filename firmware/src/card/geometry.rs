//! Where a card's file system has its parts, and whether it is one that can be written to.
//!
//! The file system's library trusts a card's boot sector. Invalid values (sizes of zero, tables beyond the card's end)
//! are found here, before it reads it. A card has a partition table, and in its first partition FAT16 or FAT32 in
//! sectors of 512 bytes.

use crate::hardware::SECTOR_BYTES;
use core::ops::Range;

/// The last bytes of the table and of a file system's first sector.
const BOOT_SIGNATURE: u16 = 0xAA55;

/// Where the first partition is described.
const PARTITION_OFFSET: usize = 446;

/// Kinds of partition that hold FAT16 or FAT32.
const FAT_PARTITION_KINDS: [u8; 5] = [0x04, 0x06, 0x0B, 0x0C, 0x0E];

/// Bytes of a directory's entry.
const DIRECTORY_ENTRY_BYTES: u32 = 32;

/// Clusters from which on it is FAT32.
const FAT32_CLUSTERS_MIN: u32 = 65_525;

/// The parts of a file system, in sectors of the card.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Geometry {
    /// The tables of clusters.
    pub tables: Range<u32>,
    /// What files consist of; on FAT32 directories, too.
    pub data: Range<u32>,
}

/// A sector's bytes as numbers.
struct Numbers<'a>(&'a [u8; SECTOR_BYTES]);

impl Numbers<'_> {
    fn byte(&self, at: usize) -> u8 {
        self.0.get(at).copied().unwrap_or(0)
    }

    fn short(&self, at: usize) -> u16 {
        u16::from_le_bytes([self.byte(at), self.byte(at + 1)])
    }

    fn long(&self, at: usize) -> u32 {
        u32::from(self.short(at)) | u32::from(self.short(at + 2)) << 16
    }
}

/// The first sector of the first partition, if the card's first sector describes one of a known kind.
pub fn partition(table: &[u8; SECTOR_BYTES]) -> Option<u32> {
    let table = Numbers(table);
    let is_known =
        FAT_PARTITION_KINDS.contains(&table.byte(PARTITION_OFFSET + 4)) && table.byte(PARTITION_OFFSET) & 0x7F == 0;
    (table.short(SECTOR_BYTES - 2) == BOOT_SIGNATURE && is_known)
        .then(|| table.long(PARTITION_OFFSET + 8))
        .filter(|&start| start > 0)
}

impl Geometry {
    /// Reads the first sector of a file system that begins at sector `start` of a card of `sectors`. None if it is not
    /// one that can be used.
    pub fn read(first: &[u8; SECTOR_BYTES], start: u32, sectors: u32) -> Option<Self> {
        let first = Numbers(first);
        let nonzero = |short: u16, long: u32| if short > 0 { u32::from(short) } else { long };
        let cluster = u32::from(first.byte(13));
        let (reserved, tables) = (u32::from(first.short(14)), u32::from(first.byte(16)));
        let table = nonzero(first.short(22), first.long(36));
        let total = nonzero(first.short(19), first.long(32));
        let root = (u32::from(first.short(17)) * DIRECTORY_ENTRY_BYTES).div_ceil(SECTOR_BYTES as u32);
        let data = table.checked_mul(tables)?.checked_add(reserved)?.checked_add(root)?;
        let end = start.checked_add(total).filter(|&end| end <= sectors)?;
        let clusters = total.checked_sub(data)?.checked_div(cluster)?;
        let entry_bytes = if clusters < FAT32_CLUSTERS_MIN { 2 } else { 4 };
        let is_sound = first.short(SECTOR_BYTES - 2) == BOOT_SIGNATURE
            && first.short(11) == SECTOR_BYTES as u16
            && cluster.is_power_of_two()
            && reserved > 0
            && (1..=2).contains(&tables)
            // A table has room for every cluster, in 16 bits or 32.
            && clusters + 2 <= table.saturating_mul(SECTOR_BYTES as u32 / entry_bytes)
            && (clusters < FAT32_CLUSTERS_MIN || (2..clusters + 2).contains(&first.long(44)) && u32::from(first.short(48)) < reserved);
        is_sound.then(|| Self { tables: start + reserved..start + data - root, data: start + data..end })
    }
}
