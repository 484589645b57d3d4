//! Holds the firmware's copying and filling of memory to their definition, on an emulated board. Run by
//! `.ci/emulated memory`.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod target {
    use core::hint::black_box;
    use core::panic::PanicInfo;
    use core::{array, ptr};
    use cortex_m as _; // the critical section that printing takes
    use cortex_m_semihosting::hprintln;
    use firmware::boards::mps2::exit; // and with it the functions under test

    /// Bytes to work in: the longest block at the farthest offset, and room to see what is beside it.
    const ROOM: usize = 64;

    /// Blocks are shorter than this: nine words and what is left over.
    const LENGTHS: usize = 40;

    /// Blocks start below this: every place within a word, and distances below and above one.
    const OFFSETS: usize = 12;

    type Bytes = [u8; ROOM];

    #[cortex_m_rt::entry]
    fn main() -> ! {
        let mut cases = 0_u32;
        let mut wrong = 0_u32;
        for length in 0..LENGTHS {
            for to in 0..OFFSETS {
                let mut judge = |right: bool| {
                    cases += 1;
                    wrong += u32::from(!right);
                };
                judge(fills(to, length, 0));
                judge(fills(to, length, 0xA5));
                for from in 0..OFFSETS {
                    judge(moves(from, to, length));
                    judge(copies(from, to, length));
                }
            }
        }
        hprintln!("{} of {} blocks wrong", wrong, cases);
        exit::end(wrong == 0)
    }

    /// Bytes that tell each place from its neighbours.
    fn numbered() -> Bytes {
        array::from_fn(|place| place as u8 ^ 0x5A)
    }

    /// What `length` bytes from `to` on become when byte by byte taken from `from` on in `source`.
    fn expected(source: &Bytes, from: usize, to: usize, length: usize) -> Bytes {
        array::from_fn(|place| {
            let copied = place.checked_sub(to).filter(|offset| *offset < length);
            let origin = copied.map_or(place, |offset| from + offset);
            source.get(origin).copied().unwrap_or_default()
        })
    }

    fn moves(from: usize, to: usize, length: usize) -> bool {
        let mut bytes = numbered();
        let start = bytes.as_mut_ptr();
        // SAFETY: both blocks lie within `bytes`: OFFSETS and LENGTHS together are less than ROOM.
        unsafe { ptr::copy(start.add(from), start.add(to), black_box(length)) };
        black_box(&bytes) == &expected(&numbered(), from, to, length)
    }

    fn copies(from: usize, to: usize, length: usize) -> bool {
        let source = numbered().map(|byte| !byte);
        let mut bytes = numbered();
        // SAFETY: as above, and the blocks are two.
        unsafe { ptr::copy_nonoverlapping(source.as_ptr().add(from), bytes.as_mut_ptr().add(to), black_box(length)) };
        let copied = expected(&source, from, to, length);
        let is_right = |(place, byte): (usize, &u8)| {
            let inside = place >= to && place - to < length;
            *byte == if inside { copied[place] } else { place as u8 ^ 0x5A }
        };
        black_box(&bytes).iter().enumerate().all(is_right)
    }

    fn fills(to: usize, length: usize, value: u8) -> bool {
        let mut bytes = numbered();
        // SAFETY: as above.
        unsafe { ptr::write_bytes(bytes.as_mut_ptr().add(to), black_box(value), black_box(length)) };
        let is_right = |(place, byte): (usize, &u8)| {
            *byte == if place >= to && place - to < length { value } else { place as u8 ^ 0x5A }
        };
        black_box(&bytes).iter().enumerate().all(is_right)
    }

    #[panic_handler]
    fn panicked(info: &PanicInfo<'_>) -> ! {
        exit::fail(info)
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this runs on the emulated boards: `.ci/emulated memory`");
}
