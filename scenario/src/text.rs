//! Text files that people give: read whole, and no further than a file of theirs can reasonably be long.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// The longest file of settings, bytes: thousands of times a scenario.
pub const LONGEST: u64 = 4 << 20;

/// The text of `path`.
///
/// # Errors
/// If it cannot be read, is no UTF-8, or is longer than [`LONGEST`]: a device without an end is not read to exhaustion.
pub fn read(path: &Path) -> io::Result<String> {
    let mut text = String::new();
    File::open(path)?.take(LONGEST + 1).read_to_string(&mut text)?;
    if text.len() as u64 > LONGEST {
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, format!("longer than {LONGEST} bytes")));
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_of_the_greatest_length_is_read_and_a_longer_one_or_a_device_without_end_refused() {
        let path = std::env::temp_dir().join(format!("scenario-text-{}", std::process::id()));
        for (length, fits) in [(LONGEST, true), (LONGEST + 1, false)] {
            std::fs::write(&path, vec![b'#'; length as usize]).unwrap();
            assert_eq!(read(&path).map(|text| text.len() as u64).ok(), fits.then_some(length));
        }
        std::fs::remove_file(&path).unwrap();
        if Path::new("/dev/zero").exists() {
            assert_eq!(read(Path::new("/dev/zero")).unwrap_err().kind(), io::ErrorKind::FileTooLarge);
        }
    }
}
