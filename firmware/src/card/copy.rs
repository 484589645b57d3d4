//! The flight recorder's recording as a file of its own: what led to a reset, safe from the next flight and from a loss
//! of power.

use super::volume::{Kind, Trouble, Volume};
use crate::hardware::{Card, SECTOR_BYTES};
use crate::recorder::Recorder;
use crate::shared::Read;
use embassy_sync::blocking_mutex::raw::RawMutex;

/// Copies the recording that the start found, unless the newest copy is the same; the number of the file that holds it.
/// `None` without a recording, or if a flight has begun meanwhile, which ends it.
///
/// A copy that a cut has shortened differs, and the next start makes another.
/// Fails if there is no room for it, or the card fails.
pub fn copy<C: Card, M: RawMutex>(
    volume: &Volume<'_, C>,
    recorder: Read<'_, Recorder<M>>,
) -> Result<Option<u32>, Trouble> {
    let Some(size) = recorder.size() else { return Ok(None) };
    let newest = volume.newest(&[Kind::Recording])?;
    if let Some(newest) = newest.filter(|newest| newest.size == size)
        && is_copy(volume, newest.number, size, recorder)?
    {
        return Ok(Some(newest.number));
    }
    let (file, number) = volume.create(Kind::Recording)?;
    let (mut offset, mut sector) = (0, [0; SECTOR_BYTES]);
    while offset < size {
        let count = recorder.read(offset, &mut sector);
        if count == 0 {
            break;
        }
        volume.append(file, sector.get(..count).unwrap_or_default())?;
        offset += count as u32;
    }
    volume.close(file)?;
    Ok((offset == size).then_some(number))
}

/// Whether a file holds the recording.
fn is_copy<C: Card, M: RawMutex>(
    volume: &Volume<'_, C>,
    number: u32,
    size: u32,
    recorder: Read<'_, Recorder<M>>,
) -> Result<bool, Trouble> {
    let file = volume.open_file(Kind::Recording, number)?;
    let (mut there, mut here) = ([0; SECTOR_BYTES], [0; SECTOR_BYTES]);
    let mut is_same = true;
    for offset in (0..size).step_by(SECTOR_BYTES) {
        let count = volume.read(file, offset, &mut there)?;
        is_same &= recorder.read(offset, &mut here) == count && there.get(..count) == here.get(..count);
        if !is_same {
            break;
        }
    }
    volume.close(file)?;
    Ok(is_same)
}
