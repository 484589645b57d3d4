//! Lines of standard input as they come, for a session that must not wait for them.

use std::sync::mpsc::{self, Receiver};

/// The lines, read on a thread of its own, which ends with its reader or with the input.
pub fn lines() -> Receiver<String> {
    let (lines, received) = mpsc::channel();
    std::thread::spawn(move || {
        for line in std::io::stdin().lines().map_while(Result::ok) {
            if lines.send(line).is_err() {
                break;
            }
        }
    });
    received
}
