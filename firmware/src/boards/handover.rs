//! The core's first instructions: whatever ran before, here it is as after a reset.
//!
//! A bootloader may hand over from a task of its own operating system: on that task's stack, with its interrupts armed
//! and at its priorities, its memory protection on, the tightly coupled memories off, and the saving of floating-point
//! registers off. A thread that stays on that stack overwrites memory that has another owner now; an interrupt that no
//! code handles is a fault; one whose floats are not saved has them overwritten by a more urgent one; and one that is
//! more urgent than control delays it. `docs/boards.md` has the table of what each bootloader leaves.
//!
//! [`begin_anew`] alone takes the core's peripherals and hands them on: who needs them has them from there, and cannot
//! find them gone. `.ci/emulated handover` spoils all of it, starts the image again, and looks.

use cortex_m::Peripherals;
use cortex_m::peripheral::SCB;

// By the runtime's own hook, which comes before memory is set up: without using a stack (it may lie in a memory that is
// off) and without a float. No interrupt until `begin_anew` has ended those that are armed, none masked by priority;
// the floating-point unit saves registers by itself and lazily (FPCCR), none are left to be saved, an interrupt begins
// with the default rounding (FPDSCR); the main stack; no float is in use (CONTROL.FPCA). On a Cortex-M7, whose part
// number is 0xC27, both tightly coupled memories are on (ITCMCR, DTCMCR), and the instruction cache holds nothing
// (ICIALLU): a bootloader may have left it on, with what was in flash before it wrote there.
core::arch::global_asm!(
    ".section .text.__pre_init, \"ax\"",
    ".global __pre_init",
    ".type __pre_init, %function",
    ".thumb_func",
    "__pre_init:",
    "cpsid i",
    "cpsie f",
    "movs r0, #0",
    "msr BASEPRI, r0",
    "ldr r1, =0xE000EF34",
    "mov r2, #0xC0000000",
    "str r2, [r1]",
    "str r0, [r1, #0x08]",
    "ldr r2, =0xE000ED00",
    "ldr r2, [r2]",
    "ubfx r2, r2, #4, #12",
    "movw r3, #0xC27",
    "cmp r2, r3",
    "bne 1f",
    "ldr r2, [r1, #0x5C]",
    "orr r2, r2, #1",
    "str r2, [r1, #0x5C]",
    "ldr r2, [r1, #0x60]",
    "orr r2, r2, #1",
    "str r2, [r1, #0x60]",
    "str r0, [r1, #0x1C]",
    "1:",
    "mrs r0, CONTROL",
    "bic r0, r0, #6",
    "msr CONTROL, r0",
    "dsb",
    "isb",
    "bx lr",
    ".size __pre_init, . - __pre_init",
    ".text",
);

/// The core's own two interrupts that may wait: SysTick (PENDSTCLR) and PendSV (PENDSVCLR).
const END_PENDING_BITS: u32 = 1 << 25 | 1 << 27;

/// What a reset leaves in the configuration and control register beside the caches' bits.
const CONFIGURATION_RESET_BIT: u32 = 1 << 9;

/// The caches' bits there, of data and of instructions: each is turned on and off in an order of its own.
const CACHE_BITS: u32 = 0b11 << 16;

/// The rest of what may be on, and the core's peripherals, taken here for the first time. `quiet` ends what the chip
/// adds to them, with every interrupt still off.
///
/// # Panics
/// The second time.
pub fn begin_anew(quiet: impl FnOnce(&mut Peripherals)) -> Peripherals {
    let mut core = Peripherals::take().expect("begun twice");
    // SAFETY: the runtime has set up memory and all handlers, and nothing else runs; from here on nothing is pending
    // but what this firmware starts.
    unsafe {
        core.SYST.csr.write(0);
        core.SCB.icsr.write(END_PENDING_BITS);
        core.NVIC.icer.iter().for_each(|lines| lines.write(u32::MAX));
        core.NVIC.icpr.iter().for_each(|lines| lines.write(u32::MAX));
        core.NVIC.ipr.iter().for_each(|priority| priority.write(0));
        core.SCB.shpr.iter().for_each(|priority| priority.write(0));
        core.SCB.shcsr.write(0);
        core.SCB.scr.write(0);
        core.SCB.ccr.modify(|bits| bits & CACHE_BITS | CONFIGURATION_RESET_BIT);
        core.SCB.cfsr.write(u32::MAX);
        core.SCB.hfsr.write(u32::MAX);
        core.MPU.ctrl.write(0);
        for region in 0..core.MPU._type.read() >> 8 & 0xFF {
            core.MPU.rnr.write(region);
            core.MPU.rasr.write(0);
        }
    }
    quiet(&mut core);
    // SAFETY: as above.
    unsafe { cortex_m::interrupt::enable() };
    core
}

/// A Cortex-M7's part number, and where the identification register has it.
const CORTEX_M7_PART: u32 = 0xC27;

/// Turns the instruction cache on, where the core has one; whether it is as it should be then. One that is on already
/// was emptied by the first instructions.
pub fn cache_instructions(core: &mut Peripherals) -> bool {
    let has_cache = core.CPUID.base.read() >> 4 & 0xFFF == CORTEX_M7_PART;
    if has_cache {
        core.SCB.enable_icache();
    }
    SCB::icache_enabled() == has_cache
}
