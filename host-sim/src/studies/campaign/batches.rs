//! Files of record batches: written whole, and read only if they hold what was written.
//!
//! A campaign's result has its SHA-256 in the manifest; a part has it after the Arrow file, as its last 32 bytes. Files
//! of campaigns that knew neither are read as they are.

use crate::output::whole_file::WholeFile;
use arrow_array::RecordBatch;
use arrow_ipc::reader::FileReader;
use arrow_ipc::writer::FileWriter;
use arrow_schema::{ArrowError, Schema};
use sha2::{Digest, Sha256};
use std::cell::Cell;
use std::io::{Cursor, Read, Write};
use std::panic;
use std::path::Path;
use std::sync::Once;

/// The last bytes of an Arrow file.
const ARROW_END: &[u8] = b"ARROW1";
/// Of a SHA-256.
const DIGEST_BYTES: usize = 32;

/// Writes a result; returns its SHA-256, hexadecimal.
///
/// # Errors
/// If it cannot be written.
pub fn write(path: &Path, schema: &Schema, batches: &[RecordBatch]) -> Result<String, ArrowError> {
    let bytes = encoded(schema, batches)?;
    store(path, &[&bytes])?;
    Ok(sha256(&bytes))
}

/// Writes a part, sealed.
///
/// # Errors
/// If it cannot be written.
pub fn write_sealed(path: &Path, schema: &Schema, batch: &RecordBatch) -> Result<(), ArrowError> {
    let bytes = encoded(schema, std::slice::from_ref(batch))?;
    store(path, &[&bytes, &Sha256::digest(&bytes)])
}

/// All of a file, however long: this program wrote it.
fn whole(path: &Path) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    scenario::text::open(path)?.read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// The batches of a result, if they are there and of that SHA-256, where it is known.
#[must_use]
pub fn read(path: &Path, expected: Option<&str>) -> Option<Vec<RecordBatch>> {
    let bytes = whole(path).ok()?;
    expected.is_none_or(|expected| sha256(&bytes) == expected).then(|| decoded(&bytes)).flatten()
}

/// The batches of a part, if they are there and whole.
#[must_use]
pub fn read_sealed(path: &Path) -> Option<Vec<RecordBatch>> {
    let bytes = whole(path).ok()?;
    if bytes.ends_with(ARROW_END) {
        return decoded(&bytes);
    }
    let (bytes, seal) = bytes.split_at_checked(bytes.len().checked_sub(DIGEST_BYTES)?)?;
    (Sha256::digest(bytes).as_slice() == seal).then(|| decoded(bytes)).flatten()
}

/// The SHA-256 of `bytes`, hexadecimal.
#[must_use]
pub fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

fn encoded(schema: &Schema, batches: &[RecordBatch]) -> Result<Vec<u8>, ArrowError> {
    let mut writer = FileWriter::try_new(Vec::new(), schema)?;
    batches.iter().try_for_each(|batch| writer.write(batch))?;
    writer.finish()?;
    writer.into_inner()
}

fn store(path: &Path, pieces: &[&[u8]]) -> Result<(), ArrowError> {
    let mut file = WholeFile::create(path)?;
    pieces.iter().try_for_each(|piece| file.write_all(piece))?;
    Ok(file.finish()?)
}

thread_local! {
    /// Whether this thread is reading a file that may be damaged.
    static READING: Cell<bool> = const { Cell::new(false) };
}

/// The batches in `bytes`; none if they are damaged. Arrow's reader panics on a file whose buffers lie outside it. That
/// panic is caught, and not printed.
fn decoded(bytes: &[u8]) -> Option<Vec<RecordBatch>> {
    static QUIET: Once = Once::new();
    QUIET.call_once(|| {
        let report = panic::take_hook();
        panic::set_hook(Box::new(move |panic| {
            if !READING.get() {
                report(panic);
            }
        }));
    });
    READING.set(true);
    let read = panic::catch_unwind(|| FileReader::try_new(Cursor::new(bytes), None)?.collect());
    READING.set(false);
    read.ok().and_then(Result::ok)
}
