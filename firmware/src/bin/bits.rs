//! The paper's flight replayed on an emulated board, from the states in the file `states.f32` of the emulator's working
//! directory; prints the number that [`firmware::replay`] makes of it. Run by `.ci/emulated bits`.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod target {
    use cortex_m_semihosting::hprintln;
    use firmware::boards::mps2::exit;
    use firmware::replay::{RECORD, Replay, TICKS};
    use semihosting::fs::File;
    use semihosting::io::Read;

    #[cortex_m_rt::entry]
    fn main() -> ! {
        match replay() {
            Ok(digest) => hprintln!("{}", digest),
            Err(problem) => exit::fail(problem),
        }
        exit::end(true)
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
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this runs on the emulated boards: `.ci/emulated bits`");
}
