//! Errors in answers: numbers of POSIX, as clients put them into words.

/// ENOENT.
pub const NOT_THERE: u8 = 2;
/// EIO.
pub const FAILED: u8 = 5;
/// E2BIG.
pub const TOO_LARGE: u8 = 7;
/// ENOEXEC.
pub const UNKNOWN_COMMAND: u8 = 8;
/// ENOMEM.
pub const TOO_MANY: u8 = 12;
/// EACCES.
pub const READ_ONLY: u8 = 13;
/// EBUSY.
pub const BUSY: u8 = 16;
/// EEXIST.
pub const ALREADY_THERE: u8 = 17;
/// EINVAL.
pub const INVALID: u8 = 22;

/// An error in words.
pub fn words(error: u8) -> &'static str {
    match error {
        NOT_THERE => "there is no such thing",
        TOO_LARGE => "too large",
        UNKNOWN_COMMAND => "not understood",
        TOO_MANY => "no room",
        READ_ONLY => "read-only",
        BUSY => "not armed",
        ALREADY_THERE => "is there already",
        INVALID => "cannot be flown",
        _ => "failed",
    }
}
