//! How the browser calls: it asks for room for a request, writes it there, calls, and reads the answer.
//!
//! | exported | |
//! |---|---|
//! | `input(bytes)` | where to write a request of so many bytes |
//! | `call()` | answers it; how many bytes the answer has |
//! | `output()` | where the answer stands, until the next `input` |

use std::cell::RefCell;

thread_local! {
    static INPUT: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
    static OUTPUT: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Room for a request of so many bytes.
// SAFETY: no other symbol of this name is linked into the module.
#[unsafe(no_mangle)]
pub extern "C" fn input(bytes: usize) -> *mut u8 {
    OUTPUT.take();
    INPUT.with_borrow_mut(|input| {
        input.clear();
        input.resize(bytes, 0);
        input.as_mut_ptr()
    })
}

/// Answers the request that was written; the number of bytes of the answer.
// SAFETY: no other symbol of this name is linked into the module.
#[unsafe(no_mangle)]
pub extern "C" fn call() -> usize {
    let answer = crate::answer(&String::from_utf8_lossy(&INPUT.take()));
    OUTPUT.with_borrow_mut(|output| {
        *output = answer;
        output.len()
    })
}

/// Where the answer stands.
// SAFETY: no other symbol of this name is linked into the module.
#[unsafe(no_mangle)]
pub extern "C" fn output() -> *const u8 {
    OUTPUT.with_borrow(|output| output.as_ptr())
}
