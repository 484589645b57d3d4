//! The firmware of the Matek H743.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod target {
    use defmt_rtt as _;

    #[cortex_m_rt::entry]
    fn main() -> ! {
        firmware::boards::stm32::tasks::run()
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this is firmware: docs/boards.md says how to build and flash it");
}
