//! Copying, filling and comparing memory, one word or byte at a time.
//!
//! The compiler calls functions for these by name, and brings its own, which are unrolled for speed: 3.3 KB of flash. The
//! boards put these in their place (`boards/memory.rs`): 0.3 KB, and a microsecond more for all that a tick copies.
//!
//! Every access is volatile: an ordinary loop that copies would be recognised, and become a call of itself.

const WORD: usize = size_of::<u32>();

/// The greatest multiple of a word in `count`, if all `addresses` are those of words; otherwise 0.
fn by_words(addresses: usize, count: usize) -> usize {
    if addresses.is_multiple_of(WORD) { count - count % WORD } else { 0 }
}

/// Copies `count` bytes, the first first.
///
/// # Safety
/// Both must be valid for as many bytes, and `to` must not lie within those that start at `from`.
#[inline(never)]
pub unsafe fn copy(to: *mut u8, from: *const u8, count: usize) {
    let words = by_words(to as usize | from as usize, count);
    let mut done = 0;
    // SAFETY: below `count`, and of words only where both are aligned to them.
    unsafe {
        while done < words {
            to.add(done).cast::<u32>().write_volatile(from.add(done).cast::<u32>().read_volatile());
            done += WORD;
        }
        while done < count {
            to.add(done).write_volatile(from.add(done).read_volatile());
            done += 1;
        }
    }
}

/// Copies `count` bytes that may overlap.
///
/// # Safety
/// Both must be valid for as many bytes.
pub unsafe fn shift(to: *mut u8, from: *const u8, count: usize) {
    // How far `to` is behind `from`, and far more than `count` if it is before it.
    let ahead = (to as usize).wrapping_sub(from as usize);
    if ahead >= count {
        // SAFETY: as promised; nothing is overwritten before it has been copied.
        return unsafe { copy(to, from, count) };
    }
    for index in (0..count).rev() {
        // SAFETY: below `count`.
        unsafe { to.add(index).write_volatile(from.add(index).read_volatile()) };
    }
}

/// Sets `count` bytes to `value`.
///
/// # Safety
/// `to` must be valid for as many bytes.
#[inline(never)]
pub unsafe fn fill(to: *mut u8, count: usize, value: u8) {
    let words = by_words(to as usize, count);
    let mut done = 0;
    // SAFETY: below `count`, and of words only where `to` is aligned to them.
    unsafe {
        while done < words {
            to.add(done).cast::<u32>().write_volatile(u32::from_ne_bytes([value; WORD]));
            done += WORD;
        }
        while done < count {
            to.add(done).write_volatile(value);
            done += 1;
        }
    }
}

/// The first byte that differs, as the difference of the two; 0 if none does.
///
/// # Safety
/// Both must be valid for `count` bytes.
pub unsafe fn difference(a: *const u8, b: *const u8, count: usize) -> i32 {
    for index in 0..count {
        // SAFETY: below `count`.
        let (a, b) = unsafe { (a.add(index).read_volatile(), b.add(index).read_volatile()) };
        if a != b {
            return i32::from(a) - i32::from(b);
        }
    }
    0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Room for everything that follows, aligned to words.
    #[repr(align(4))]
    #[derive(Clone)]
    struct Bytes([u8; 48]);

    fn counted() -> Bytes {
        Bytes(core::array::from_fn(|index| index as u8 + 1))
    }

    /// Every start and length that matters to words.
    fn places() -> impl Iterator<Item = (usize, usize, usize)> {
        (0..12).flat_map(|to| (0..12).flat_map(move |from| (0..20).map(move |count| (to, from, count))))
    }

    #[test]
    fn copies_are_those_of_the_standard_library() {
        for (to, from, count) in places() {
            let (source, mut copied) = (counted(), Bytes([0; 48]));
            let mut wanted = copied.clone();
            wanted.0[to..to + count].copy_from_slice(&source.0[from..from + count]);
            unsafe { copy(copied.0.as_mut_ptr().add(to), source.0.as_ptr().add(from), count) };
            assert_eq!(copied.0, wanted.0, "{count} from {from} to {to}");
        }
    }

    #[test]
    fn overlapping_bytes_arrive_as_they_were() {
        for (to, from, count) in places() {
            let (mut shifted, mut wanted) = (counted(), counted());
            wanted.0.copy_within(from..from + count, to);
            let start = shifted.0.as_mut_ptr();
            unsafe { shift(start.add(to), start.add(from), count) };
            assert_eq!(shifted.0, wanted.0, "{count} from {from} to {to}");
        }
    }

    #[test]
    fn nothing_but_what_was_asked_for_is_filled() {
        for (to, _, count) in places() {
            let (mut filled, mut wanted) = (counted(), counted());
            wanted.0[to..to + count].fill(0xA5);
            unsafe { fill(filled.0.as_mut_ptr().add(to), count, 0xA5) };
            assert_eq!(filled.0, wanted.0, "{count} to {to}");
        }
    }

    #[test]
    fn the_first_difference_decides() {
        for (a, b, count) in [("", "", 0), ("ab", "ac", 1), ("ab", "ac", 2), ("b", "a", 1), ("\u{80}", "a", 2)] {
            let found = unsafe { difference(a.as_ptr(), b.as_ptr(), count.min(a.len()).min(b.len())) };
            let length = count.min(a.len()).min(b.len());
            assert_eq!(found.signum(), a.as_bytes()[..length].cmp(&b.as_bytes()[..length]) as i32, "{a} {b}");
        }
    }
}
