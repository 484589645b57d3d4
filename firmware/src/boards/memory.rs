//! [`crate::memory`] under the names that the compiler calls: those of C, and those of the processor's run-time interface,
//! where addresses are said to be aligned (4, 8) and filling has its arguments in another order.
//!
//! The compiler's own are weak symbols: these take their place.

use crate::memory::{copy, difference, fill, shift};

/// The same function under several names.
macro_rules! named {
    ($($name:ident)+ = $arguments:tt $body:expr) => {$(
        #[unsafe(no_mangle)]
        unsafe extern "C" fn $name $arguments {
            // SAFETY: the caller's promise, the same for all of them.
            unsafe { $body }
        }
    )+};
}

type To = *mut u8;
type From = *const u8;

named!(__aeabi_memcpy __aeabi_memcpy4 __aeabi_memcpy8 = (to: To, from: From, count: usize) copy(to, from, count));
named!(__aeabi_memmove __aeabi_memmove4 __aeabi_memmove8 = (to: To, from: From, count: usize) shift(to, from, count));
named!(__aeabi_memset __aeabi_memset4 __aeabi_memset8 = (to: To, count: usize, value: i32) fill(to, count, value as u8));
named!(__aeabi_memclr __aeabi_memclr4 __aeabi_memclr8 = (to: To, count: usize) fill(to, count, 0));

#[unsafe(no_mangle)]
unsafe extern "C" fn memcmp(a: From, b: From, count: usize) -> i32 {
    // SAFETY: the caller's promise.
    unsafe { difference(a, b, count) }
}
