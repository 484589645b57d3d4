//! An image to be looked at, not run: one step of the law, all that the estimator does in a tick, the runtime's reset
//! and a panic handler. `.ci/budgets` finds none of the panic machinery in it: none of these can panic.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod target {
    use controller_core::error::InputError;
    use controller_core::law::{Command, Law};
    use controller_core::reference::Reference;
    use controller_core::state::State;
    use core::hint::black_box;
    use core::panic::PanicInfo;
    use estimation::estimator::{Accepted, EstimatedState, Estimator, Health, Increment, PoseMeasurement, Rejected};
    use estimation::imu::{Conditioned, Conditioner};
    use flight::Stamped;
    use nalgebra::Vector3;

    type Step = fn(&mut Law, &State, &Reference) -> Result<Command, InputError>;
    type Sample = fn(&mut Conditioner, u64, &Vector3<f32>, Option<&Vector3<f32>>) -> Conditioned;
    type Fuse = fn(&mut Estimator, &Stamped<PoseMeasurement>, u64) -> Result<Accepted, Rejected>;
    type Estimation = (
        Sample,
        fn(&mut Estimator, &Increment),
        Fuse,
        fn(&Estimator, u64, &Vector3<f32>, Option<&Increment>) -> Option<EstimatedState>,
        fn(&Estimator, u64) -> Health,
    );

    #[cortex_m_rt::entry]
    fn main() -> ! {
        let step: Step = Law::command;
        let estimation: Estimation =
            (Conditioner::sample, Estimator::imu, Estimator::pose, Estimator::state, Estimator::health);
        black_box((step, estimation));
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
