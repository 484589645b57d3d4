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
//! Each file appears whole or not at all, and is on the disk before it has its name. So whatever ends a campaign,
//! chunks that were finished are there when it goes on. A part that cannot be read is flown again, and so is a result
//! that is not the one that was written.
//!
//! The manifest comes first: a directory without it is no campaign's, and no file there is touched. A writer holds a
//! [lock](crate::output::directory_lock) on it.

use super::CampaignError;
use super::batches;
use super::manifest::{MANIFEST_FILE, Manifest};
use super::rows::schema;
use crate::output::directory_lock::DirectoryLock;
use crate::output::whole_file::{WholeFile, is_unfinished};
use arrow_array::RecordBatch;
use arrow_array::cast::AsArray;
use arrow_array::types::UInt64Type;
use std::fmt::Display;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// The flights' name in a directory.
pub const RESULT_FILE: &str = "campaign.arrow";
/// The scenario's.
pub const SCENARIO_FILE: &str = "scenario.toml";
/// The summary.
pub const SUMMARY_FILE: &str = "summary.txt";
/// The same as a page.
pub const REPORT_FILE: &str = "report.html";
const PARTS_DIRECTORY: &str = "parts";
/// Files that a campaign overwrites or removes, besides its manifest.
const OWN_FILES: [&str; 5] = [SCENARIO_FILE, PARTS_DIRECTORY, RESULT_FILE, SUMMARY_FILE, REPORT_FILE];

/// A directory and what it is to hold.
#[derive(Debug)]
pub struct Store {
    directory: PathBuf,
    manifest: Manifest,
    /// Of who writes, if the file system has locks.
    _lock: Option<DirectoryLock>,
}

impl Store {
    /// Begins a campaign in `directory`, or goes on with the same one.
    ///
    /// # Errors
    /// If it holds another campaign or other files of these names, if another program is at work in it, or if it cannot
    /// be written.
    pub fn open(directory: &Path, manifest: &Manifest, text: &str) -> Result<Self, CampaignError> {
        let lock = DirectoryLock::take(directory).map_err(unwritable(directory))?;
        let found = Manifest::read_in(directory)?;
        if let Some(difference) = found.as_ref().and_then(|found| found.difference(manifest)) {
            return Err(CampaignError::Input(format!(
                "{}: holds another campaign: not the same {difference}; choose another --out, or remove that directory",
                directory.display()
            )));
        }
        let is_there = |name: &&str| fs::symlink_metadata(directory.join(name)).is_ok();
        if let (None, Some(name)) = (&found, OWN_FILES.iter().find(|name| is_there(name))) {
            return Err(CampaignError::Input(format!(
                "{}: holds {name} but no {MANIFEST_FILE}, so it is no campaign's of this program; choose another --out",
                directory.display()
            )));
        }
        let result = found.and_then(|found| found.result);
        let manifest = Manifest { result, ..manifest.clone() };
        let store = Self { directory: directory.to_owned(), manifest, _lock: Some(lock) };
        store.write(MANIFEST_FILE, &store.manifest.written())?;
        store.write(SCENARIO_FILE, text)?;
        let parts = directory.join(PARTS_DIRECTORY);
        fs::create_dir_all(&parts).map_err(unwritable(&parts))?;
        for path in [RESULT_FILE, SUMMARY_FILE, REPORT_FILE].map(|name| directory.join(name)) {
            WholeFile::try_name(&path).map_err(unwritable(&path))?;
        }
        Ok(store)
    }

    /// A campaign, or a shard of one, that is complete.
    ///
    /// # Errors
    /// If the campaign is missing or incomplete.
    pub fn complete(directory: &Path) -> Result<(Self, Vec<RecordBatch>), CampaignError> {
        let manifest = Manifest::read_in(directory)?.ok_or_else(|| {
            CampaignError::Input(format!("{}: holds no campaign: there is no {MANIFEST_FILE}", directory.display()))
        })?;
        let store = Self { directory: directory.to_owned(), manifest, _lock: None };
        let flown = store.result().ok_or_else(|| {
            CampaignError::Input(format!(
                "{}: is not complete: {RESULT_FILE} is missing or damaged; run its campaign command again",
                directory.display()
            ))
        })?;
        Ok((store, flown))
    }

    /// Its manifest.
    #[must_use]
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// Where it is.
    #[must_use]
    pub fn directory(&self) -> &Path {
        &self.directory
    }

    /// Where the scenario's text is.
    #[must_use]
    pub fn scenario_file(&self) -> PathBuf {
        self.directory.join(SCENARIO_FILE)
    }

    /// The scenario's text.
    ///
    /// # Errors
    /// If it cannot be read, or is not what was flown.
    pub fn scenario(&self) -> Result<String, CampaignError> {
        let path = self.scenario_file();
        let text = scenario::text::read(&path)
            .map_err(|error| CampaignError::Input(format!("{}: cannot be read: {error}", path.display())))?;
        if batches::sha256(text.as_bytes()) == self.manifest.scenario {
            return Ok(text);
        }
        Err(CampaignError::Input(format!(
            "{}: was changed after its flights were flown: its SHA-256 is not the scenario_sha256 of {MANIFEST_FILE}; put the text back that \
             was flown, or fly it anew into another --out",
            path.display()
        )))
    }

    /// All flights, a batch a chunk, if they are there.
    #[must_use]
    pub fn result(&self) -> Option<Vec<RecordBatch>> {
        let batches = batches::read(&self.directory.join(RESULT_FILE), self.manifest.result.as_deref())?;
        let chunks = self.manifest.chunks();
        let is_whole = batches.len() == chunks.len()
            && batches.iter().zip(chunks).all(|(batch, chunk)| is_chunk(batch, &self.manifest, chunk));
        is_whole.then_some(batches)
    }

    /// The flights of a chunk, if they are there.
    #[must_use]
    pub fn part(&self, chunk: u64) -> Option<RecordBatch> {
        let batches = batches::read_sealed(&self.path_of(chunk))?;
        let [batch] = batches.as_slice() else { return None };
        is_chunk(batch, &self.manifest, chunk).then(|| batch.clone())
    }

    /// Keeps the flights of a chunk.
    ///
    /// # Errors
    /// If they cannot be written.
    pub fn keep(&self, chunk: u64, flights: &RecordBatch) -> Result<(), CampaignError> {
        let path = self.path_of(chunk);
        batches::write_sealed(&path, &schema(&self.manifest), flights).map_err(unwritable(&path))
    }

    /// Writes all flights and what they hash to; the parts go.
    ///
    /// # Errors
    /// If they cannot be written.
    pub fn finish(&self, flights: &[RecordBatch]) -> Result<(), CampaignError> {
        let path = self.directory.join(RESULT_FILE);
        let hash = batches::write(&path, &schema(&self.manifest), flights).map_err(unwritable(&path))?;
        self.write(MANIFEST_FILE, &Manifest { result: Some(hash), ..self.manifest.clone() }.written())?;
        let parts = self.directory.join(PARTS_DIRECTORY);
        self.remove_parts(&parts).map_err(unwritable(&parts))
    }

    /// Removes the files of its chunks, what a killed campaign left of one, and their directory if nothing else is in
    /// it.
    fn remove_parts(&self, parts: &Path) -> io::Result<()> {
        let chunks = self.manifest.chunks();
        let entries = match fs::read_dir(parts) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
            entries => entries?,
        };
        for entry in entries {
            let entry = entry?;
            let (name, path) = (entry.file_name(), entry.path());
            let is_own = chunk_of(&name.to_string_lossy()).is_some_and(|chunk| chunks.binary_search(&chunk).is_ok());
            if is_own || chunks.iter().any(|&chunk| is_unfinished(&path, &self.path_of(chunk))) {
                fs::remove_file(path)?;
            }
        }
        match fs::remove_dir(parts) {
            Err(error) if error.kind() == io::ErrorKind::DirectoryNotEmpty => Ok(()),
            removed => removed,
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
        self.directory.join(PARTS_DIRECTORY).join(format!("{chunk:06}.arrow"))
    }
}

/// Whether a batch holds the flights of a chunk.
fn is_chunk(batch: &RecordBatch, manifest: &Manifest, chunk: u64) -> bool {
    *batch.schema() == schema(manifest)
        && batch.column(0).as_primitive::<UInt64Type>().values().iter().copied().eq(manifest.flights_of(chunk))
}

/// Of which chunk a part has the name, finished or under way.
fn chunk_of(name: &str) -> Option<u64> {
    let under_way =
        name.strip_prefix('.').and_then(|name| name.strip_suffix(".part")).and_then(|name| name.rsplit_once('.'));
    let digits = under_way.map_or(name, |(name, _)| name).strip_suffix(".arrow")?;
    digits.parse().ok().filter(|chunk: &u64| format!("{chunk:06}") == digits)
}

fn unwritable<E: Display>(path: &Path) -> impl FnOnce(E) -> CampaignError {
    |error| CampaignError::Output(format!("{}: cannot be written: {error}", path.display()))
}
