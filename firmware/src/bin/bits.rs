//! The paper's flight, a recovery, the estimate of it and the same behind a shield replayed on an emulated board, from
//! the states in the files `states.f32` and `recovery.f32` of the emulator's working directory; prints the numbers that
//! [`firmware::replay`] makes of them, a line each. Run by `.ci/emulated bits`.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod target {
    use cortex_m_semihosting::hprintln;
    use firmware::boards::mps2::exit;
    use firmware::replay::estimate::Estimate;
    use firmware::replay::recovery::{self, Recovery};
    use firmware::replay::shielded::Shielded;
    use firmware::replay::{RECORD, Replay, TICKS};
    use semihosting::fs::File;
    use semihosting::io::Read;

    #[cortex_m_rt::entry]
    fn main() -> ! {
        match replay() {
            Ok(numbers) => numbers.iter().for_each(|number| hprintln!("{}", number)),
            Err(problem) => exit::fail(problem),
        }
        exit::end(true)
    }

    fn replay() -> Result<[heapless::String<64>; 4], &'static str> {
        let mut file = File::open(c"states.f32").map_err(|_| "states.f32: cannot be opened")?;
        let mut replay = Replay::new().ok_or("Table I is not certified on this machine")?;
        let mut record = [0; RECORD];
        for _ in 0..TICKS {
            file.read_exact(&mut record).map_err(|_| "states.f32: too short")?;
            replay.tick(&record).map_err(|_| "the law refuses a recorded state")?;
        }
        let mut file = File::open(c"recovery.f32").map_err(|_| "recovery.f32: cannot be opened")?;
        let mut recovery = Recovery::new().ok_or("the embedded scenario is not certified on this machine")?;
        let mut estimate = Estimate::new().ok_or("the estimator's figures are refused on this machine")?;
        let mut shielded = Shielded::new().ok_or("the embedded scenario is shielded on no machine")?;
        for _ in 0..recovery::TICKS {
            file.read_exact(&mut record).map_err(|_| "recovery.f32: too short")?;
            estimate.tick(&record);
            recovery.tick(&record).map_err(|_| "the law refuses a recorded state of the recovery")?;
            shielded.tick(&record).map_err(|_| "the law refuses a recorded state behind the shield")?;
        }
        let estimate = estimate.digest().ok_or("no estimate at the end of the recovery")?;
        let shielded = shielded.digest().ok_or("behind the shield law and network do not both fly")?;
        Ok([replay.digest(), recovery.digest(), estimate, shielded])
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this runs on the emulated boards: `.ci/emulated bits`");
}
