//! The paper's flight, and at 100 Hz, 500 Hz and 1 kHz a recovery, the estimate of it and the same behind a shield,
//! with two networks, replayed on an emulated board from the states in the files `states.f32` and `recovery.f32` of the
//! emulator's working directory, the latter one after the other. Prints the numbers that [`firmware::replay`] makes of
//! them, a line each.
//! Run by `.ci/emulated bits`.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod target {
    use cortex_m_semihosting::hprintln;
    use firmware::boards::mps2::exit;
    use firmware::replay::estimate::Estimate;
    use firmware::replay::recovery::{self, Recovery};
    use firmware::replay::shielded::Shielded;
    use firmware::replay::{FLIGHT_TICKS, PERIODS_US, Replay, STATE_BYTES};
    use semihosting::fs::File;
    use semihosting::io::Read;

    #[cortex_m_rt::entry]
    fn main() -> ! {
        match replay() {
            Ok(()) => exit::end(true),
            Err(problem) => exit::fail(problem),
        }
    }

    fn replay() -> Result<(), &'static str> {
        let mut file = File::open(c"states.f32").map_err(|_| "states.f32: cannot be opened")?;
        let mut replay = Replay::new().ok_or("Table I is not certified on this machine")?;
        let mut record = [0; STATE_BYTES];
        for _ in 0..FLIGHT_TICKS {
            file.read_exact(&mut record).map_err(|_| "states.f32: too short")?;
            replay.tick(&record).map_err(|_| "the law refuses a recorded state")?;
        }
        hprintln!("{}", replay.digest());
        let mut file = File::open(c"recovery.f32").map_err(|_| "recovery.f32: cannot be opened")?;
        PERIODS_US.iter().try_for_each(|period| recover(&mut file, *period))
    }

    /// The recovery in ticks of `period` us.
    fn recover(file: &mut File, period: u64) -> Result<(), &'static str> {
        let mut record = [0; STATE_BYTES];
        let mut recovery = Recovery::new(period).ok_or("the embedded scenario is not certified on this machine")?;
        let mut estimate = Estimate::new(period).ok_or("the estimator's figures are refused on this machine")?;
        let mut shielded = Shielded::new(period).ok_or("the embedded scenario is shielded on no machine")?;
        let mut remembers = Shielded::recurrent(period).ok_or("the network that remembers is refused")?;
        for _ in 0..recovery::RECOVERY_DURATION_US / period {
            file.read_exact(&mut record).map_err(|_| "recovery.f32: too short")?;
            estimate.tick(&record);
            recovery.tick(&record).map_err(|_| "the law refuses a recorded state of the recovery")?;
            shielded.tick(&record).map_err(|_| "the law refuses a recorded state behind the shield")?;
            remembers.tick(&record).map_err(|_| "the law refuses a recorded state beside rotor speeds")?;
        }
        hprintln!("{}", recovery.digest());
        hprintln!("{}", estimate.digest().ok_or("no estimate at the end of the recovery")?);
        hprintln!("{}", shielded.digest().ok_or("behind the shield law and network do not both fly")?);
        hprintln!("{}", remembers.digest().ok_or("law and network that remembers do not both fly")?);
        Ok(())
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this runs on the emulated boards: `.ci/emulated bits`");
}
