//! An image to be looked at, not run: one step of the law, the runtime's reset and a panic handler. `.ci/budgets` finds
//! none of the panic machinery in it: the step cannot panic.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod target {
    use controller_core::controller::{Command, Controller};
    use controller_core::error::InputError;
    use controller_core::reference::Reference;
    use controller_core::state::State;
    use core::hint::black_box;
    use core::panic::PanicInfo;

    type Step = fn(&mut Controller, &State, &Reference) -> Result<Command, InputError>;

    #[cortex_m_rt::entry]
    fn main() -> ! {
        let step: Step = Controller::command;
        black_box(step);
        loop {
            cortex_m::asm::wfi();
        }
    }

    #[panic_handler]
    fn panicked(_: &PanicInfo<'_>) -> ! {
        loop {
            cortex_m::asm::wfi();
        }
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this image is to be looked at: `.ci/budgets probe`");
}
