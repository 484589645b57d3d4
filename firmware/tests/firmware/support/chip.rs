//! Flash like that of the boards: programmed by words, each once between erasures; it fails, and loses its power, on
//! demand.

use firmware::hardware::{Fault, Flash, Record};
use std::cell::RefCell;

/// Records in a sector of the test's flash, and its bytes.
pub const FLASH_RECORDS: usize = 6;
pub const SECTOR_BYTES: usize = FLASH_RECORDS * RECORD_BYTES;
const RECORD_BYTES: usize = size_of::<Record>();

/// What a power cut leaves of the word that was being programmed or erased.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Torn {
    /// Some of its bits, anything.
    Bits,
    /// Something that cannot be read: its error-correcting code is wrong.
    Unreadable,
    /// What looks blank and takes no other value any more.
    Blank,
}

/// What is in the flash, and how it is.
#[derive(Clone)]
pub struct Chip {
    /// Its content.
    pub bytes: Vec<u8>,
    /// Every call ends in a fault.
    pub fails: bool,
    /// What is programmed does not stick, and the flash does not report it.
    pub worn: bool,
    /// Records that it was commanded to program.
    pub writes: usize,
    /// Words that it may still program or erase before the power fails; then nothing changes any more.
    pub power: usize,
    /// What the word in work is then.
    pub torn: Torn,
    /// Bytes of words that cannot be read.
    unreadable: Vec<bool>,
    /// Bytes of words that cannot be programmed.
    bad: Vec<bool>,
}

impl Chip {
    /// As it comes from the factory.
    pub fn erased() -> RefCell<Self> {
        RefCell::new(Self {
            bytes: vec![0xFF; 2 * SECTOR_BYTES],
            fails: false,
            worn: false,
            writes: 0,
            power: usize::MAX,
            torn: Torn::Bits,
            unreadable: vec![false; 2 * SECTOR_BYTES],
            bad: vec![false; 2 * SECTOR_BYTES],
        })
    }

    /// One word programmed or erased: whole while there is power, torn when it fails, left alone after that.
    fn work(&mut self, start: usize, value: &[u8], erasing: bool) -> Result<(), Fault> {
        let word = start..start + value.len();
        let Some(left) = self.power.checked_sub(1) else { return Err(Fault) };
        self.power = left;
        if left > 0 && erasing {
            self.bytes[word.clone()].fill(0xFF);
            self.unreadable[word.clone()].fill(false);
            self.bad[word].fill(false);
        } else if left > 0 {
            let spoilt = self.worn || self.bad[start];
            self.bytes[word].iter_mut().zip(value).for_each(|(byte, value)| *byte = value ^ u8::from(spoilt));
        } else {
            match self.torn {
                Torn::Bits => {
                    let bytes = self.bytes[word].iter_mut().zip(value);
                    bytes.for_each(|(byte, value)| *byte = (*byte & 0x96) | (value & !0x96));
                }
                Torn::Unreadable => self.unreadable[word].fill(true),
                Torn::Blank => {
                    self.bytes[word.clone()].fill(0xFF);
                    self.bad[word].fill(true);
                }
            }
        }
        if left > 0 { Ok(()) } else { Err(Fault) }
    }
}

/// Flash that programs `WORD` bytes at once, as the F405 does 4 and the H743 does 32.
pub struct Words<'a, const WORD: usize>(pub &'a RefCell<Chip>);

impl<const WORD: usize> Flash for Words<'_, WORD> {
    const RECORDS_PER_SECTOR: usize = FLASH_RECORDS;

    fn read(&mut self, place: usize) -> Result<Record, Fault> {
        let chip = self.0.borrow();
        let bytes = place * RECORD_BYTES..(place + 1) * RECORD_BYTES;
        if chip.fails || chip.unreadable[bytes.clone()].contains(&true) {
            return Err(Fault);
        }
        let mut words = chip.bytes[bytes].as_chunks().0.iter();
        Ok([(); _].map(|()| u32::from_le_bytes(*words.next().unwrap())))
    }

    fn write(&mut self, place: usize, record: &Record) -> Result<(), Fault> {
        let mut chip = self.0.borrow_mut();
        chip.writes += 1;
        if chip.fails {
            return Err(Fault);
        }
        let bytes: Vec<u8> = record.iter().flat_map(|word| word.to_le_bytes()).collect();
        let blank = chip.bytes[place * RECORD_BYTES..(place + 1) * RECORD_BYTES].iter().all(|&byte| byte == 0xFF);
        assert!(blank || chip.power == 0, "written twice");
        for (index, word) in bytes.chunks(WORD).enumerate() {
            chip.work(place * RECORD_BYTES + index * WORD, word, false)?;
        }
        Ok(())
    }

    fn erase(&mut self, sector: usize) -> Result<(), Fault> {
        let mut chip = self.0.borrow_mut();
        if chip.fails {
            return Err(Fault);
        }
        for start in (sector * SECTOR_BYTES..(sector + 1) * SECTOR_BYTES).step_by(WORD) {
            chip.work(start, &[0xFF; WORD], true)?;
        }
        Ok(())
    }
}
