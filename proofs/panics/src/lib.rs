//! Parts of a tick under names that `../no_panic` finds in the library. `checked_…` is searched, for any arguments;
//! `make_…` of the same name makes what its first argument points to, for the Hummingbird.

#[path = "../../../controller-core/tests/support/hummingbird.rs"]
mod hummingbird;

use controller_core::configuration::LawParameters;
use controller_core::extended::budget::{TickBudget, TorqueBudget};
use controller_core::extended::parameters::ExtendedParameters;
use controller_core::math;
use nalgebra::Vector2;

#[unsafe(no_mangle)]
extern "C" fn checked_whole(x: f32) -> i64 {
    math::f32_to_i64(x)
}

#[unsafe(no_mangle)]
extern "C" fn checked_single(x: i64) -> f32 {
    math::i64_to_f32(x)
}

#[unsafe(no_mangle)]
extern "C" fn checked_turns(phase: u64) -> f32 {
    let (sine, cosine) = math::sin_cos_turns(phase);
    sine + cosine
}

#[unsafe(no_mangle)]
extern "C" fn checked_tanh(z: f32) -> f32 {
    math::tanh_of_scaled(z)
}

#[unsafe(no_mangle)]
extern "C" fn checked_spend(budget: &TickBudget, x: f32, y: f32, kept: f32) -> f32 {
    budget.spending(1.0).spend(&Vector2::new(x, y), kept)
}

fn constants() -> ExtendedParameters {
    let LawParameters::Extended(law) = *hummingbird::extended_law().law() else { panic!("the extended law") };
    *law.parameters
}

/// Puts `made` where there is room for it; how many bytes it has.
///
/// # Safety
/// `room` is aligned and has that many bytes.
unsafe fn put<T>(made: T, room: *mut T) -> usize {
    // SAFETY: as the caller promises.
    unsafe { room.write(made) };
    size_of::<T>()
}

#[unsafe(no_mangle)]
unsafe extern "C" fn make_spend(room: *mut TickBudget) -> usize {
    let (configuration, p) = (hummingbird::extended_law(), constants());
    let budget = TorqueBudget::new(p.floor_margin, configuration.limits(), configuration.rotors());
    // SAFETY: `no_panic` gives ROOM bytes of its own, more than any budget has.
    unsafe { put(TickBudget::new(&budget, [p.scale_least, p.scale_greatest]), room) }
}

/// One that can panic, so that a search that finds nothing is noticed.
#[unsafe(no_mangle)]
extern "C" fn can_panic(a: i32, x: f32) -> i32 {
    if x > 3.0 { a + 1 } else { a }
}
