//! The line code of a speed controller's answer: 16 bits as 21 levels of the line.
//!
//! | step | equation |
//! |---|---|
//! | checksum, as the answer's last 4 bits | c = not (a xor b xor d), of the 12 bits before it, four by four |
//! | each 4 bits n as 5 bits g(n), never more than two zeros in a row | `QUINTETS` |
//! | 20 bits as 21 levels: a one changes the level, a zero keeps it | l_0 = 0, l_(k+1) = l_k xor g_k |
//!
//! The line rests high, so that the first level, low, is an edge. A lost or an added edge changes one quintet, and so
//! one group of four bits or none that exists: the checksum refuses it. A level that is wrong for one bit is two edges,
//! and may lie in two quintets: a test counts how few of those pass.

/// Bits of an answer on the line.
pub const LEVEL_COUNT: usize = 21;

/// Bits that say something: the rest is the checksum.
pub const VALUE_BITS: usize = 12;

/// g(n).
const QUINTETS: [u32; 16] = [
    0b11001, 0b11011, 0b10010, 0b10011, 0b11101, 0b10101, 0b10110, 0b10111, 0b11010, 0b01001, 0b01010, 0b01011,
    0b11110, 0b01101, 0b01110, 0b01111,
];

/// Where each group of four bits, and each quintet, begins; the first to leave first.
const NIBBLE_SHIFTS: [u32; 4] = [12, 8, 4, 0];
const QUINTET_SHIFTS: [u32; 4] = [15, 10, 5, 0];

/// The checksum of 12 bits, inverted as everything on a line that rests high.
const fn checksum(value: u16) -> u16 {
    !(value ^ value >> 4 ^ value >> 8) & 0xF
}

/// The 21 levels of an answer's 12 bits, the first to leave highest.
pub fn encoded(value: u16) -> u32 {
    let value = value & 0xFFF;
    let bits = u32::from(value << 4 | checksum(value));
    let quintet = |shift: u32| QUINTETS.get((bits >> shift & 0xF) as usize).copied().unwrap_or(0);
    let groups = NIBBLE_SHIFTS.into_iter().zip(QUINTET_SHIFTS);
    let coded = groups.fold(0, |coded, (from, to)| coded | quintet(from) << to);
    (0..LEVEL_COUNT as u32 - 1).rev().fold(0, |levels, place| levels << 1 | (levels ^ coded >> place) & 1)
}

/// The 12 bits of an answer's 21 levels; none where they are no answer.
pub fn decoded(levels: u32) -> Option<u16> {
    let coded = levels ^ levels >> 1;
    let nibble = |shift: u32| QUINTETS.iter().position(|quintet| *quintet == coded >> shift & 0x1F);
    let mut bits = 0;
    for shift in QUINTET_SHIFTS {
        bits = bits << 4 | nibble(shift)? as u16;
    }
    let value = bits >> 4;
    (levels >> (LEVEL_COUNT - 1) == 0 && checksum(value) == bits & 0xF).then_some(value)
}

#[cfg(test)]
mod tests;
