//! Files that people give: read whole, and no further than a file of theirs can reasonably be long. What is no file is
//! not waited for.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// The longest file of settings, bytes: thousands of times a scenario.
pub const FILE_MAX_BYTES: u64 = 4 << 20;

/// The text of `path`.
///
/// # Errors
/// If it cannot be read, is neither UTF-8 nor UTF-16, or is longer than [`FILE_MAX_BYTES`].
pub fn read(path: &Path) -> io::Result<String> {
    decoded(&bytes(path, FILE_MAX_BYTES)?).map_err(|problem| io::Error::new(io::ErrorKind::InvalidData, problem))
}

/// Text in UTF-8 or, as spreadsheets and PowerShell write it, in UTF-16; with a byte order mark or without.
fn decoded(bytes: &[u8]) -> Result<String, String> {
    let units = |pair: fn([u8; 2]) -> u16| bytes.chunks_exact(2).map(|bytes| pair([bytes[0], bytes[1]])).collect();
    let wide: Option<Vec<u16>> = match bytes {
        // A mark, or a first letter of which the upper byte is zero.
        [0xFF, 0xFE, ..] | [1..=255, 0, ..] => Some(units(u16::from_le_bytes)),
        [0xFE, 0xFF, ..] | [0, 1..=255, ..] => Some(units(u16::from_be_bytes)),
        _ => None,
    };
    let text = match wide {
        Some(units) => String::from_utf16(&units).map_err(|_| "is no UTF-16; save it as UTF-8".to_owned())?,
        None => {
            let problem = |error: std::str::Utf8Error| {
                format!("is no UTF-8 from byte {} on; save it as UTF-8", error.valid_up_to())
            };
            std::str::from_utf8(bytes).map_err(problem)?.to_owned()
        }
    };
    Ok(text.strip_prefix('\u{FEFF}').map(str::to_owned).unwrap_or(text))
}

/// Where what the program was started with is, a pipe or a device as well: standard input, and a shell's `<(...)`.
const OPEN_FILE_PATHS: [&str; 4] = ["/dev/stdin", "/dev/fd", "/proc/self/fd", "/proc/thread-self/fd"];

/// Opens a file for reading. Opening a pipe waits until a writer opens it, and reading a device may never end.
///
/// # Errors
/// If the file is missing, or is [not a regular file](regular).
pub fn open(path: &Path) -> io::Result<File> {
    regular(path)?;
    File::open(path)
}

/// Whether a path may be opened: where there is nothing, that is for who opens it to find.
///
/// # Errors
/// If it is no regular file, unless it was opened already by who started the program.
pub fn regular(path: &Path) -> io::Result<()> {
    let is_given = OPEN_FILE_PATHS.iter().any(|given| path.starts_with(given));
    match std::fs::metadata(path) {
        Ok(what) if !what.is_file() && !is_given => {
            Err(io::Error::new(io::ErrorKind::InvalidInput, "is no regular file"))
        }
        _ => Ok(()),
    }
}

/// The bytes of `path`.
///
/// # Errors
/// If it cannot be opened or read, or is longer than `longest` bytes.
pub fn bytes(path: &Path, longest: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open(path)?.take(longest + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > longest {
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, format!("longer than {longest} bytes")));
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_encoding_of_a_text_is_read_and_what_is_none_is_refused_with_the_remedy() {
        let text = "t;x [µm];y\r\n";
        let wide = |text: &str, pair: fn(u16) -> [u8; 2]| text.encode_utf16().flat_map(pair).collect::<Vec<u8>>();
        for start in ["", "\u{FEFF}"] {
            let marked = format!("{start}{text}");
            for bytes in [marked.clone().into(), wide(&marked, u16::to_le_bytes), wide(&marked, u16::to_be_bytes)] {
                assert_eq!(decoded(&bytes).as_deref(), Ok(text));
            }
        }
        assert_eq!(decoded(b"t;x [\xB0]"), Err("is no UTF-8 from byte 5 on; save it as UTF-8".to_owned()));
        assert_eq!(decoded(b"\xFF\xFE\x00\xD8"), Err("is no UTF-16; save it as UTF-8".to_owned()));
        assert_eq!(decoded(b""), Ok(String::new()));
    }

    #[test]
    fn a_file_of_the_greatest_length_is_read_and_a_longer_one_refused() {
        let path = std::env::temp_dir().join(format!("scenario-text-{}", std::process::id()));
        for (length, fits) in [(FILE_MAX_BYTES, true), (FILE_MAX_BYTES + 1, false)] {
            std::fs::write(&path, vec![b'#'; length as usize]).unwrap();
            assert_eq!(read(&path).map(|text| text.len() as u64).ok(), fits.then_some(length));
        }
        std::fs::remove_file(&path).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn what_is_no_regular_file_is_neither_waited_for_nor_read_to_exhaustion() {
        let pipe = std::env::temp_dir().join(format!("scenario-text-pipe-{}", std::process::id()));
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        for path in [pipe.as_path(), Path::new("/dev/zero"), Path::new("/")] {
            let error = bytes(path, 1 << 30).unwrap_err();
            assert_eq!(
                (error.kind(), error.to_string()),
                (io::ErrorKind::InvalidInput, "is no regular file".to_owned())
            );
        }
        std::fs::remove_file(&pipe).unwrap();
    }
}
