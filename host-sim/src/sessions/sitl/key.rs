//! The key that frames are signed with, from a file: 64 hexadecimal digits.

use firmware::link::signing::{KEY_BYTES, Key, Stamp};
use std::path::Path;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// 2015 began so long after 1970.
const EPOCH_2015: Duration = Duration::from_secs(1_420_070_400);

/// A key with some white space.
const KEY_FILE_MAX_BYTES: u64 = 4_096;

/// The key in a file.
///
/// # Errors
/// In words, if the file cannot be read or holds no key. What it holds is not shown.
pub fn read(path: &Path) -> Result<Key, String> {
    let text = scenario::text::bytes(path, KEY_FILE_MAX_BYTES)
        .map_err(|error| format!("--signing-key {}: cannot be read: {error}", path.display()))?;
    parsed(text.trim_ascii()).ok_or_else(|| {
        let digits = 2 * KEY_BYTES;
        format!(
            "--signing-key {}: must hold {digits} hexadecimal digits, not all 0; 'openssl rand -hex {KEY_BYTES}' makes some",
            path.display()
        )
    })
}

fn parsed(digits: &[u8]) -> Option<Key> {
    let digit = |&digit: &u8| char::from(digit).to_digit(16);
    let digits: Vec<u32> = digits.iter().map(digit).collect::<Option<_>>()?;
    let bytes: Vec<u8> =
        digits.chunks(2).map(|pair| pair.iter().fold(0, |byte, digit| byte << 4 | *digit as u8)).collect();
    if digits.len() == 2 * KEY_BYTES { Key::new(bytes.try_into().ok()?) } else { None }
}

/// The desk's time as stamps count it.
#[must_use]
pub fn now() -> Stamp {
    let since = SystemTime::now().duration_since(UNIX_EPOCH + EPOCH_2015).unwrap_or_default();
    since.as_micros() as Stamp / 10
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_is_64_hexadecimal_digits_and_its_file_is_never_shown() {
        let path = std::env::temp_dir().join(format!("sitl-key-{}", std::process::id()));
        let read = |text: &str| {
            std::fs::write(&path, text).unwrap();
            super::read(&path)
        };
        let secret = "00112233445566778899aabbccddeeffFFEEDDCCBBAA99887766554433221100";
        let key = read(secret).unwrap();
        assert_eq!(read(&format!("{secret}\n")).unwrap(), key);
        for wrong in
            ["", &secret[1..], &format!("{secret}0"), &"0".repeat(64), &secret.replace('a', "g"), &"1".repeat(999)]
        {
            let refused = read(wrong).unwrap_err();
            assert!(refused.contains("64 hexadecimal digits") && !refused.contains("5566"), "{refused}");
        }
        assert!(super::read(Path::new("/dev/zero")).is_err());
        std::fs::remove_file(&path).unwrap();
        assert!(super::read(&path).unwrap_err().contains("cannot be read"));
    }
}
