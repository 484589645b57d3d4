//! Logging: blocks of variables that a client puts together and has sent at a rate of its own.
//!
//! | channel 1: command, block's number | does | besides |
//! |---|---|---|
//! | 6, 7 | begins a block; appends to it | entries: kind it is sent as (low 4 bits), variable's number (2 bytes) |
//! | 3, 8 | sends it again and again | the period: 10 ms (1 byte); 1 ms (2 bytes); 0 once |
//! | 4, 2 | stops it; removes it | |
//! | 5 | removes all | |
//!
//! The answer repeats command and number, with 0 or an error of POSIX. A block goes out on channel 2: its number, the
//! time in ms (3 bytes), the values. Kinds convert into each other; what does not fit is the nearest that does.

use super::contents::{Contents, Entry};
use super::errors::{ALREADY_THERE, NOT_THERE, TOO_LARGE, TOO_MANY, UNKNOWN_COMMAND};
use super::fields::Fields;
use super::packet::{DATA_MAX_BYTES, Packet};
use super::ports;
use heapless::Vec;
use kind::Kind;
pub use variables::View;
use variables::{VARIABLES, Variable};

mod kind;
mod variables;

/// Blocks at a time, and variables in all of them.
pub const BLOCKS_MAX: usize = 16;
/// See [`BLOCKS_MAX`].
pub const ENTRIES_MAX: usize = 128;

/// Data of a block: what its number and the time leave.
const VALUES_MAX_BYTES: usize = DATA_MAX_BYTES - 4;

/// The shortest period that is granted.
const PERIOD_MIN_US: u64 = 10_000;

/// Channels.
const CONTROL: u8 = 1;
const DATA: u8 = 2;

/// What there is to log.
pub struct Variables;

impl Contents for Variables {
    const COUNT: usize = VARIABLES.len();
    const ROOM: &'static [u8] = &[BLOCKS_MAX as u8, ENTRIES_MAX as u8];

    fn entry(index: usize) -> Option<Entry> {
        VARIABLES.get(index).map(|variable| (variable.kind as u8, variable.group, variable.name))
    }
}

/// A block that there is.
#[derive(Debug)]
struct Block {
    number: u8,
    /// us; 0 for one that is sent once.
    period: u64,
    /// When it is to be sent, us; none while it is stopped.
    due: Option<u64>,
}

/// A variable in a block.
#[derive(Debug, Clone, Copy)]
struct Logged {
    block: u8,
    /// A place in the table.
    variable: u8,
    kind: Kind,
}

const _: () = assert!(VARIABLES.len() <= u8::MAX as usize);

/// The blocks that there are.
#[derive(Debug)]
pub struct Log {
    blocks: Vec<Block, BLOCKS_MAX>,
    /// Of all blocks, each block's in their order.
    entries: Vec<Logged, ENTRIES_MAX>,
}

impl Log {
    /// None.
    pub const fn new() -> Self {
        Self { blocks: Vec::new(), entries: Vec::new() }
    }

    /// Does as a packet on the control channel says; the answer.
    pub fn control(&mut self, packet: &Packet, now: u64) -> Option<Packet> {
        let mut fields = Fields::new(packet.data());
        let command = fields.u8()?;
        let number = fields.u8().unwrap_or(0);
        let done = match command {
            2 => self.remove(number),
            3 => fields.u8().map_or(Err(UNKNOWN_COMMAND), |tens| self.start(number, u64::from(tens) * 10_000, now)),
            4 => self.block(number).map(|block| block.due = None),
            5 => {
                self.blocks.clear();
                self.entries.clear();
                Ok(())
            }
            6 => self.create(number, fields),
            7 => self.append(number, fields),
            8 => fields.u16().map_or(Err(UNKNOWN_COMMAND), |ms| self.start(number, u64::from(ms) * 1_000, now)),
            _ => Err(UNKNOWN_COMMAND),
        };
        Some(Packet::new(ports::LOG, CONTROL).with(&[command, number, done.err().unwrap_or(0)]))
    }

    fn block(&mut self, number: u8) -> Result<&mut Block, u8> {
        self.blocks.iter_mut().find(|block| block.number == number).ok_or(NOT_THERE)
    }

    fn create(&mut self, number: u8, fields: Fields<'_>) -> Result<(), u8> {
        if self.block(number).is_ok() {
            return Err(ALREADY_THERE);
        }
        self.blocks.push(Block { number, period: 0, due: None }).map_err(|_| TOO_MANY)?;
        self.append(number, fields).inspect_err(|_| {
            // As if it had never been begun.
            let _ = self.remove(number);
        })
    }

    /// Appends all of these variables or, if one cannot be, none.
    fn append(&mut self, number: u8, mut fields: Fields<'_>) -> Result<(), u8> {
        self.block(number)?;
        let before = self.entries.len();
        let result = self.append_each(number, &mut fields);
        if result.is_err() {
            self.entries.truncate(before);
        }
        result
    }

    fn append_each(&mut self, number: u8, fields: &mut Fields<'_>) -> Result<(), u8> {
        while let (Some(kind), Some(variable)) = (fields.u8(), fields.u16()) {
            // Places in memory, which others log as number 65535, are nobody's business here.
            let variable = u8::try_from(variable).ok().filter(|place| usize::from(*place) < VARIABLES.len());
            let (Some(kind), Some(variable)) = (Kind::read(kind), variable) else { return Err(NOT_THERE) };
            if self.size(number) + kind.size() > VALUES_MAX_BYTES {
                return Err(TOO_LARGE);
            }
            self.entries.push(Logged { block: number, variable, kind }).map_err(|_| TOO_MANY)?;
        }
        Ok(())
    }

    /// Bytes of a block's values.
    fn size(&self, number: u8) -> usize {
        self.entries.iter().filter(|entry| entry.block == number).map(|entry| entry.kind.size()).sum()
    }

    fn remove(&mut self, number: u8) -> Result<(), u8> {
        self.block(number)?;
        self.blocks.retain(|block| block.number != number);
        self.entries.retain(|entry| entry.block != number);
        Ok(())
    }

    fn start(&mut self, number: u8, period: u64, now: u64) -> Result<(), u8> {
        let block = self.block(number)?;
        block.period = if period == 0 { 0 } else { period.max(PERIOD_MIN_US) };
        block.due = Some(now.saturating_add(block.period));
        Ok(())
    }

    /// When a block is to be sent, us.
    pub fn due(&self) -> u64 {
        self.blocks.iter().filter_map(|block| block.due).min().unwrap_or(u64::MAX)
    }

    /// The block whose turn it is at `now`, us, with the values of that time.
    pub fn next(&mut self, now: u64, view: &View) -> Option<Packet> {
        let due = |block: &Block| block.due.unwrap_or(u64::MAX);
        let block = self.blocks.iter_mut().min_by_key(|block| due(block)).filter(|block| due(block) <= now)?;
        // What is late is not made up for.
        let next = due(block).saturating_add(block.period);
        block.due = (block.period > 0).then_some(if next > now { next } else { now.saturating_add(block.period) });
        let [first, second, third, ..] = ((now / 1_000) as u32).to_le_bytes();
        let number = block.number;
        let packet = Packet::new(ports::LOG, DATA).with(&[number, first, second, third]);
        let entries = self.entries.iter().filter(|entry| entry.block == number);
        Some(entries.fold(packet, |packet, entry| match VARIABLES.get(usize::from(entry.variable)) {
            Some(Variable { value, .. }) => entry.kind.write(packet, value(view)),
            None => packet,
        }))
    }
}

#[cfg(test)]
mod tests;
