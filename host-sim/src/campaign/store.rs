//! A campaign's directory.
//!
//! | file | |
//! |---|---|
//! | `campaign.json` | of what the flights are ([`super::manifest`]) |
//! | `scenario.toml` | the text they were read from |
//! | `parts/000012.arrow` | the flights of a chunk, while the campaign is under way |
//! | `campaign.arrow` | all flights, one record batch a chunk, in the order of their numbers ([`super::rows`]) |
//! | `summary.txt`, `report.html` | what they showed |
//!
//! Each file appears whole or not at all, and is on the disk before it has its name. So whatever ends a campaign, chunks that were
//! finished are there when it goes on. A part that cannot be read is flown again.

use super::CampaignError;
use super::manifest::{MANIFEST, Manifest};
use super::rows::schema;
use crate::whole_file::WholeFile;
use arrow_array::RecordBatch;
use arrow_array::cast::AsArray;
use arrow_array::types::UInt64Type;
use arrow_ipc::reader::FileReader;
use arrow_ipc::writer::FileWriter;
use arrow_schema::ArrowError;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

/// The flights' name in a directory.
pub const RESULT: &str = "campaign.arrow";
/// The scenario's.
pub const SCENARIO: &str = "scenario.toml";
/// What they showed.
pub const SUMMARY: &str = "summary.txt";
/// The same as a page.
pub const REPORT: &str = "report.html";
const PARTS: &str = "parts";

/// A directory and what it is to hold.
#[derive(Debug, Clone)]
pub struct Store {
    directory: PathBuf,
    manifest: Manifest,
}

impl Store {
    /// Begins a campaign in `directory`, or goes on with the same one.
    ///
    /// # Errors
    /// If it holds another campaign, or cannot be written.
    pub fn open(directory: &Path, manifest: &Manifest, text: &str) -> Result<Self, CampaignError> {
        let found = Manifest::of(directory)?;
        if let Some(difference) = found.and_then(|found| found.difference(manifest)) {
            return Err(CampaignError::Input(format!(
                "{}: holds another campaign: not the same {difference}; choose another --out, or remove that directory",
                directory.display()
            )));
        }
        let parts = directory.join(PARTS);
        fs::create_dir_all(&parts).map_err(unwritable(&parts))?;
        let store = Self { directory: directory.to_owned(), manifest: manifest.clone() };
        store.write(SCENARIO, text)?;
        store.write(MANIFEST, &manifest.written())?;
        Ok(store)
    }

    /// A campaign, or a shard of one, that is complete.
    ///
    /// # Errors
    /// If there is none, or it is still under way.
    pub fn complete(directory: &Path) -> Result<(Self, Vec<RecordBatch>), CampaignError> {
        let manifest = Manifest::of(directory)?.ok_or_else(|| {
            CampaignError::Input(format!("{}: holds no campaign: there is no {MANIFEST}", directory.display()))
        })?;
        let store = Self { directory: directory.to_owned(), manifest };
        let flown = store.result().ok_or_else(|| {
            CampaignError::Input(format!(
                "{}: is not complete: {RESULT} is missing or damaged; run its campaign command again",
                directory.display()
            ))
        })?;
        Ok((store, flown))
    }

    /// What it is to hold.
    #[must_use]
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// The scenario's text.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn scenario(&self) -> Result<String, CampaignError> {
        let path = self.directory.join(SCENARIO);
        fs::read_to_string(&path)
            .map_err(|error| CampaignError::Input(format!("{}: cannot be read: {error}", path.display())))
    }

    /// All flights, a batch a chunk, if they are there.
    #[must_use]
    pub fn result(&self) -> Option<Vec<RecordBatch>> {
        let batches = read(&self.directory.join(RESULT)).ok()?;
        let chunks = self.manifest.chunks();
        let is_whole = batches.len() == chunks.len()
            && batches.iter().zip(chunks).all(|(batch, chunk)| is_chunk(batch, &self.manifest, chunk));
        is_whole.then_some(batches)
    }

    /// The flights of a chunk, if they are there.
    #[must_use]
    pub fn part(&self, chunk: u64) -> Option<RecordBatch> {
        let batches = read(&self.path_of(chunk)).ok()?;
        let [batch] = batches.as_slice() else { return None };
        is_chunk(batch, &self.manifest, chunk).then(|| batch.clone())
    }

    /// Keeps the flights of a chunk.
    ///
    /// # Errors
    /// If they cannot be written.
    pub fn keep(&self, chunk: u64, flights: &RecordBatch) -> Result<(), CampaignError> {
        self.write_batches(&self.path_of(chunk), std::slice::from_ref(flights))
    }

    /// Writes all flights; the parts go.
    ///
    /// # Errors
    /// If they cannot be written.
    pub fn finish(&self, flights: &[RecordBatch]) -> Result<(), CampaignError> {
        self.write_batches(&self.directory.join(RESULT), flights)?;
        let parts = self.directory.join(PARTS);
        match fs::remove_dir_all(&parts) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => Err(unwritable(&parts)(error)),
            _ => Ok(()),
        }
    }

    /// Writes a text, whole.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&self, name: &str, text: &str) -> Result<(), CampaignError> {
        let path = self.directory.join(name);
        WholeFile::write(&path, text).map_err(unwritable(&path))
    }

    fn path_of(&self, chunk: u64) -> PathBuf {
        self.directory.join(PARTS).join(format!("{chunk:06}.arrow"))
    }

    fn write_batches(&self, path: &Path, batches: &[RecordBatch]) -> Result<(), CampaignError> {
        let write = || -> Result<(), ArrowError> {
            let mut writer = FileWriter::try_new(WholeFile::create(path)?, &schema(&self.manifest))?;
            batches.iter().try_for_each(|batch| writer.write(batch))?;
            writer.finish()?;
            Ok(writer.into_inner()?.finish()?)
        };
        write().map_err(|error| CampaignError::Output(format!("{}: cannot be written: {error}", path.display())))
    }
}

fn read(path: &Path) -> Result<Vec<RecordBatch>, ArrowError> {
    FileReader::try_new_buffered(File::open(path)?, None)?.collect()
}

/// Whether a batch holds the flights of a chunk.
fn is_chunk(batch: &RecordBatch, manifest: &Manifest, chunk: u64) -> bool {
    *batch.schema() == schema(manifest)
        && batch.column(0).as_primitive::<UInt64Type>().values().iter().copied().eq(manifest.flights_of(chunk))
}

fn unwritable(path: &Path) -> impl FnOnce(io::Error) -> CampaignError {
    |error| CampaignError::Output(format!("{}: cannot be written: {error}", path.display()))
}
