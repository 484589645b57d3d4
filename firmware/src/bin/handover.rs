//! Starts twice on an emulated board. The first start spoils all that a bootloader may leave of the core, and jumps to
//! the image's first instruction as a bootloader does; the second looks whether it begins as after a reset. Then it
//! leaves last words and resets the chip; the third start finds them, and its stack overflows. Run by
//! `.ci/emulated handover`.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod target {
    use core::arch::asm;
    use core::hint::black_box;
    use core::mem::MaybeUninit;
    use cortex_m::Peripherals;
    use cortex_m::register::{basepri, control, primask};
    use cortex_m_rt::exception;
    use cortex_m_semihosting::hprintln;
    use firmware::boards::mps2::{self, exit};
    use firmware::boards::{guard, kept};
    use firmware::last_words::LastWords;

    /// Which start this is: memory that no start clears.
    #[unsafe(link_section = ".uninit.starts")]
    static mut STARTS: MaybeUninit<u32> = MaybeUninit::uninit();

    /// Why the third start comes about.
    const RESTART_WORDS: &str = "a restart of the test's own";

    /// What [`STARTS`] holds once the first start is over.
    const SECOND_START: u32 = 0x5EC0_4D00;

    /// A bootloader's task has its stack somewhere.
    static mut TASK: [u64; 128] = [0; 128];

    unsafe extern "C" {
        fn Reset() -> !;
    }

    /// The registers of which `cortex-m` has none: FPCCR, FPDSCR.
    const FPCCR: *mut u32 = 0xE000_EF34 as *mut u32;
    const FPDSCR: *mut u32 = 0xE000_EF3C as *mut u32;

    #[cortex_m_rt::entry]
    fn main() -> ! {
        let control = control::read();
        // SAFETY: one thread, aligned memory that nothing else touches; any bits are a number.
        if let Some(words) = kept::take(false) {
            check("kept over the reset", words.as_str() == RESTART_WORDS);
            let _ = mps2::begin();
            hprintln!("kept over the reset");
            hprintln!("{}", overflow(black_box(1)));
            exit::fail("no stack overflow")
        }
        let is_first = unsafe { (&raw const STARTS).cast::<u32>().read_volatile() } != SECOND_START;
        if is_first {
            // SAFETY: as above; all that it spoils is there for this.
            unsafe {
                (&raw mut STARTS).cast::<u32>().write_volatile(SECOND_START);
                spoil(&mut Peripherals::steal())
            }
        }
        check("main stack", control.spsel().is_msp());
        check("no float in use before the first", !control.fpca().is_active());
        // SAFETY: registers that may be read at any time.
        let (saving, default) = unsafe { (FPCCR.read_volatile(), FPDSCR.read_volatile()) };
        check("floats saved, lazily, none left to save (FPCCR)", saving & 0xC000_0001 == 0xC000_0000);
        check("rounding by default (FPDSCR)", default == 0);
        let mut core = mps2::begin();
        check("interrupts on", primask::read().is_active() && basepri::read() == 0);
        check("no line armed", core.NVIC.iser.iter().all(|lines| lines.read() == 0));
        check("no line pending", core.NVIC.ispr.iter().all(|lines| lines.read() == 0));
        check("every line's priority", core.NVIC.ipr.iter().all(|priority| priority.read() == 0));
        check("the core's own priorities", core.SCB.shpr.iter().all(|priority| priority.read() == 0));
        check("handlers of faults off", core.SCB.shcsr.read() == 0);
        check("no deep sleep", core.SCB.scr.read() == 0);
        check("configuration", core.SCB.ccr.read() & 0xFFFF == 1 << 9);
        check("SysTick off", core.SYST.csr.read() & 0b111 == 0 && core.SCB.icsr.read() & 1 << 26 == 0);
        check("no region of protected memory but the guard", is_unprotected(&mut core));
        check("an interrupt's floats survive a more urgent one", floats_survive(&mut core));
        hprintln!("as after a reset");
        kept::keep(&LastWords::new(RESTART_WORDS));
        cortex_m::peripheral::SCB::sys_reset()
    }

    fn check(what: &str, is_so: bool) {
        if !is_so {
            exit::fail(what);
        }
    }

    /// Leaves what bootloaders were seen to leave, all of it at once, and starts the image.
    ///
    /// # Safety
    /// Nothing else runs.
    unsafe fn spoil(core: &mut Peripherals) -> ! {
        // SAFETY: what is armed and pending here is of the masked priority.
        unsafe {
            core.NVIC.ipr.iter().for_each(|priority| priority.write(0x80));
            core.SCB.shpr.iter().for_each(|priority| priority.write(0x80));
            basepri::write(0x40);
            core.NVIC.iser.iter().for_each(|lines| lines.write(u32::MAX));
            core.NVIC.ispr.iter().for_each(|lines| lines.write(u32::MAX));
            core.SYST.rvr.write(1_000);
            core.SYST.csr.write(0b111);
            core.SCB.shcsr.write(0b111 << 16);
            core.SCB.scr.write(0b110);
            core.SCB.ccr.write(1 << 9 | 1 << 4);
            // Code and data as they are, and the last quarter of the memory for reading only.
            for (region, base, attributes) in
                [(0, 0, 0b011 << 24 | 31 << 1 | 1), (5, 0x2030_0000, 0b111 << 24 | 19 << 1 | 1)]
            {
                core.MPU.rnr.write(region);
                core.MPU.rbar.write(base);
                core.MPU.rasr.write(attributes);
            }
            FPCCR.write_volatile(0);
            FPDSCR.write_volatile(0b111 << 22);
            let task = (&raw mut TASK).cast::<u64>().add(128);
            asm!(
                "msr PSP, r1",
                "mov r0, #6",
                "msr CONTROL, r0",
                "isb",
                "b {reset}",
                in("r1") task,
                reset = sym Reset,
                options(noreturn),
            )
        }
    }

    fn is_unprotected(core: &mut Peripherals) -> bool {
        (guard::REGION_COUNT as u32..core.MPU._type.read() >> 8 & 0xFF).all(|region| {
            // SAFETY: only chooses what is read.
            unsafe { core.MPU.rnr.write(region) };
            core.MPU.rasr.read() & 1 == 0
        })
    }

    /// What the less urgent of two interrupts finds of its float.
    static mut FOUND: u32 = 0;

    /// A float that no code makes by chance.
    const PI_BITS: u32 = 0x4049_0FDB;

    /// Lets PendSV hold a float while SVCall, more urgent, uses the same register.
    fn floats_survive(core: &mut Peripherals) -> bool {
        /// The most and the least urgent of the emulated core's priorities; where PendSV's is.
        const PENDSV_PRIORITY: (usize, u8) = (10, 0xE0);
        // SAFETY: no critical section relies on it.
        unsafe { core.SCB.shpr[PENDSV_PRIORITY.0].write(PENDSV_PRIORITY.1) };
        cortex_m::peripheral::SCB::set_pendsv();
        cortex_m::asm::dsb();
        cortex_m::asm::isb();
        // SAFETY: its only writer is done.
        unsafe { (&raw const FOUND).read_volatile() == PI_BITS }
    }

    #[exception]
    fn PendSV() {
        let found: u32;
        // SAFETY: the register is named, and what the supervisor call does is below.
        unsafe {
            asm!("vmov s0, {0}", "svc #0", "vmov {0}, s0", inout(reg) PI_BITS => found, out("s0") _);
            (&raw mut FOUND).write_volatile(found);
        }
    }

    #[exception]
    fn SVCall() {
        // SAFETY: the register is named.
        unsafe { asm!("vmov s0, {0}", in(reg) 1, out("s0") _) };
    }

    #[inline(never)]
    #[allow(unconditional_recursion)] // it ends in a fault
    fn overflow(depth: u32) -> u32 {
        black_box([depth; 64]).iter().sum::<u32>() + overflow(depth + 1)
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this runs on the emulated boards: `.ci/emulated handover`");
}
