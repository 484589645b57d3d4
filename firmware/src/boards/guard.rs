//! The stack's end: a guard that no code may touch, and a fault that is handled on a stack of its own.
//!
//! ```text
//! statics | guard | <- stack, growing down | top
//! ```
//!
//! A stack that overflows runs into the guard, and the memory protection unit faults before anything is overwritten.
//! The handler cannot use that stack any more. What is on it is of no use either, as nothing that was interrupted goes
//! on: so the handler begins again at its top.
//!
//! A function whose frame is larger than the guard could step over it; `.ci/budgets` holds every frame to less.

use super::fault::Fault;
use core::ptr;
use cortex_m::peripheral::{MPU, SCB};
use cortex_m_rt::ExceptionFrame;

#[cfg(feature = "mps2")]
use super::mps2::exit::faulted;
#[cfg(feature = "stm32")]
use super::stm32::fault::faulted;

/// Bytes of the guard.
pub const GUARD_BYTES: usize = 16 * 1024;

/// Regions of the memory protection unit that it consists of, and their bytes, a power of two: the place of each is a
/// multiple of that.
pub const REGION_COUNT: usize = 4;
const REGION_BYTES: usize = GUARD_BYTES / REGION_COUNT;

unsafe extern "C" {
    /// Where the stack begins, and where it would meet what lies below it: the linker's.
    static _stack_start: u8;
    static _stack_end: u8;
}

/// Where the guard begins: as far down as its regions' alignment allows.
fn guard() -> usize {
    (&raw const _stack_end).addr().next_multiple_of(REGION_BYTES)
}

/// Guards the stack from here on. What the guard does not cover is as without the unit; a fault's handler is not held
/// to it.
pub fn watch(mpu: &mut MPU) {
    /// Privileged code has the default map elsewhere; the unit is on.
    const ENABLE_BITS: u32 = 0b101;
    /// No execution; the size as a power of two, less one; on. No access.
    const NO_ACCESS_BITS: u32 = 1 << 28 | (REGION_BYTES.trailing_zeros() - 1) << 1 | 1;
    // SAFETY: nothing lies in the guard but what a stack of this size never reaches.
    unsafe {
        for region in 0..REGION_COUNT {
            mpu.rnr.write(region as u32);
            mpu.rbar.write((guard() + region * REGION_BYTES) as u32);
            mpu.rasr.write(NO_ACCESS_BITS);
        }
        mpu.ctrl.write(ENABLE_BITS);
    }
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}

/// The core's account of the fault that it saved at `frame`.
fn fault_at(frame: *const ExceptionFrame) -> Fault {
    // SAFETY: status registers; reading has no effect.
    let core = unsafe { &*SCB::PTR };
    let (status, memory_address) = (core.cfsr.read(), core.mmfar.read() as usize);
    let (first, end) = ((&raw const _stack_end).addr(), (&raw const _stack_start).addr());
    // Where they could not be saved (MSTKERR), nothing is there.
    let is_saved = status & 0x10 == 0;
    let is_stack =
        is_saved && (first..=end - size_of::<ExceptionFrame>()).contains(&frame.addr()) && frame.is_aligned();
    // SAFETY: aligned, and within the memory that the linker gives to the stack, where any bits are numbers.
    let frame = is_stack.then(|| unsafe { ptr::read(frame) });
    // An access to the guard is named (DACCVIOL, MMARVALID).
    let in_guard = status & 0x82 == 0x82 && (guard()..guard() + GUARD_BYTES).contains(&memory_address);
    let is_overflow = !is_saved || in_guard;
    let place = frame.map(|frame| (frame.pc(), frame.lr()));
    Fault { place, status, hard_status: core.hfsr.read(), bus_address: core.bfar.read(), is_overflow }
}

// The stack that the core has saved registers on is the first argument; the main stack begins anew.
core::arch::global_asm!(
    ".section .HardFault.guard, \"ax\"",
    ".global HardFault",
    ".type HardFault, %function",
    ".thumb_func",
    "HardFault:",
    "tst lr, #4",
    "ite eq",
    "mrseq r0, MSP",
    "mrsne r0, PSP",
    "ldr r1, =_stack_start",
    "msr MSP, r1",
    "isb",
    "b {handler}",
    ".size HardFault, . - HardFault",
    ".text",
    handler = sym on_fault,
);

extern "C" fn on_fault(frame: *const ExceptionFrame) -> ! {
    faulted(&fault_at(frame))
}
