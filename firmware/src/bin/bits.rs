//! The paper's flight replayed on an emulated board, from the states in the file `states.f32` of the emulator's working
//! directory; prints the number that [`firmware::replay`] makes of it. Run by `.ci/emulated bits`.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod target {
    use core::panic::PanicInfo;
    use cortex_m as _; // the critical section that printing takes
    use cortex_m_semihosting::debug::{self, EXIT_FAILURE, EXIT_SUCCESS};
    use cortex_m_semihosting::hprintln;
    use firmware::replay::{RECORD, Replay, TICKS};
    use semihosting::fs::File;
    use semihosting::io::Read;

    #[cortex_m_rt::entry]
    fn main() -> ! {
        let code = match replay() {
            Ok(digest) => {
                hprintln!("{}", digest);
                EXIT_SUCCESS
            }
            Err(problem) => {
                hprintln!("error: {}", problem);
                EXIT_FAILURE
            }
        };
        debug::exit(code);
        loop {
            cortex_m::asm::wfi();
        }
    }

    fn replay() -> Result<heapless::String<64>, &'static str> {
        let mut file = File::open(c"states.f32").map_err(|_| "states.f32: cannot be opened")?;
        let mut replay = Replay::new().ok_or("Table I is not certified on this machine")?;
        let mut record = [0; RECORD];
        for _ in 0..TICKS {
            file.read_exact(&mut record).map_err(|_| "states.f32: too short")?;
            replay.tick(&record).map_err(|_| "the law refuses a recorded state")?;
        }
        Ok(replay.digest())
    }

    #[panic_handler]
    fn panicked(info: &PanicInfo<'_>) -> ! {
        hprintln!("{}", info);
        debug::exit(EXIT_FAILURE);
        loop {
            cortex_m::asm::wfi();
        }
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this runs on the emulated boards: `.ci/emulated bits`");
}
