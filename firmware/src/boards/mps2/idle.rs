//! What the processor does when no task has anything to do: it sleeps, unless it waits for the simulator.
//!
//! The emulator counts time in instructions (`-icount shift=0,sleep=off`: 1 ns each), and while the processor sleeps,
//! time jumps to the next alarm. So ticks come on time however slow the machine underneath is, and an hour of waiting
//! takes no time. But a jump must not pass over the answer of the simulator, which lives in the machine's own time:
//! from the moment the motors' commands have gone out until the sensors' answer is in, the processor stays awake, and
//! time creeps on with the few instructions of this loop. An alarm still comes when its time comes: a simulator that is
//! gone stops nothing.

use cortex_m::asm;
use cortex_m::interrupt;

/// Sleeps while `awake` is false; it is checked again after every interrupt.
pub fn idle(awake: impl Fn() -> bool) -> ! {
    loop {
        // With interrupts held back, `awake` cannot change before the processor sleeps; it wakes up all the same.
        interrupt::free(|_| {
            if !awake() {
                asm::wfi();
            }
        });
        // The emulator does not sleep here: it gives way to its own input and output, for one instruction's time.
        asm::wfe();
    }
}
