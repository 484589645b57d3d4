//! The `compare` command: our law and its rivals on one set of scenes.
//!
//! Every law flies the same [`scenes`] and the same random flights, those of [`crate::studies::campaign`]: same vehicle,
//! allocation, sensors and clock. The table has every figure, less is better, with the vehicle's own [`limit`] where it
//! is worked out, and marks the rows that ours loses;
//! `compare.csv` has them in full, two pictures the courses, `report.html` all of it. Our claim decides the exit
//! status: every random flight of our law settles, and none of its commands is cut or leaves its certified bounds.

pub mod limit;
pub mod page;
pub mod pictures;
pub mod realism;
pub mod rotor_loss;
pub mod rows;
pub mod scene_figures;
pub mod scenes;

use crate::flight::law_on_vehicle::LawOnVehicle;
use crate::output::directory_lock::DirectoryLock;
use crate::output::interrupt::Interrupt;
use crate::output::progress::Progress;
use crate::output::whole_file::WholeFile;
use crate::rivals::choice::LawChoice;
use crate::rivals::gains::Set;
use crate::studies::campaign::step;
use controller_core::certificate::certified::{Certified, Refused};
use controller_core::error::ParameterError;
use limit::Limit;
use rotor_loss::Landing;
use rows::FigureRow;
use scenario::Scenario;
use scene_figures::RandomFlights;
use scenes::Scene;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// The result of a comparison.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// The table.
    pub text: String,
    /// Whether our claim holds.
    pub holds: bool,
    /// compare.csv, report.html and the pictures, by name.
    pub files: Vec<(&'static str, String)>,
}

/// Why there is no comparison.
#[derive(Debug)]
pub enum CompareError {
    /// The scenario's law is undefined.
    Parameter(ParameterError),
    /// Its certificate fails: this inequality is the tightest.
    NotCertified(&'static str),
    /// The law of this name is undefined for its gains.
    Undefined(&'static str),
    /// A file or directory could not be written.
    Output(PathBuf, io::Error),
    /// This signal interrupted it.
    Interrupted(u8),
}

impl fmt::Display for CompareError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Parameter(error) => write!(f, "{error}"),
            Self::NotCertified(inequality) => {
                write!(f, "not certified ({inequality}): ours flies in a comparison as boards fly it, or not at all")
            }
            Self::Undefined(law) => write!(f, "the law {law} is undefined for its gains"),
            Self::Output(path, error) => write!(f, "{}: cannot be written: {error}", path.display()),
            Self::Interrupted(signal) => write!(f, "interrupted by signal {signal}; nothing is written"),
        }
    }
}

impl std::error::Error for CompareError {}

impl From<ParameterError> for CompareError {
    fn from(error: ParameterError) -> Self {
        Self::Parameter(error)
    }
}

/// Ours, certified: it flies in a comparison as boards fly it, or not at all.
///
/// # Errors
/// [`CompareError::Parameter`] and [`CompareError::NotCertified`].
pub fn certified(file: &Scenario) -> Result<Certified, CompareError> {
    Certified::new(file.configuration.clone()).map_err(|refused| match refused {
        Refused::Undefined(error) => CompareError::Parameter(error),
        Refused::Fails(certificate) => {
            CompareError::NotCertified(certificate.tightest().map_or("", |tightest| tightest.name))
        }
    })
}

/// A law, and the file at its rate.
type Law<'a> = (LawOnVehicle, &'a Scenario);
/// Each law's figures in each scene; none where it could not be flown to its end.
type Figures<T> = Vec<(&'static str, Vec<Option<T>>)>;

/// Ours on `file`, then those of `set` on `theirs`.
fn laws<'a>(
    (file, theirs): (&'a Scenario, &'a Scenario),
    set: &Set,
    certified: &Certified,
) -> Result<Vec<Law<'a>>, CompareError> {
    let on_vehicle = |(law, file): (LawChoice, &'a Scenario)| {
        Ok((LawOnVehicle::new(&law, file, Some(certified)).ok_or(CompareError::Undefined(law.name()))?, file))
    };
    let others = set.laws().map(|law| (law, theirs));
    std::iter::once((LawChoice::Ours, file)).chain(others).map(on_vehicle).collect()
}

/// Shows a progress of so many steps, one at each call.
///
/// # Errors
/// After an interrupt.
fn steps(work: usize, interrupt: &Interrupt) -> impl FnMut() -> Result<(), CompareError> {
    let mut progress = Progress::new("comparing", work as u64);
    let mut done = 0;
    move || {
        progress.show(done);
        done += 1;
        interrupt.signal().map_or(Ok(()), |signal| Err(CompareError::Interrupted(signal)))
    }
}

/// Flies all laws in all `scenes`, each made from the file at a law's rate.
fn flown<T>(
    laws: &[Law],
    scenes: fn(&Scenario) -> Result<Vec<Scene>, ParameterError>,
    show: fn(&LawOnVehicle, &Scene) -> Option<T>,
    next: &mut impl FnMut() -> Result<(), CompareError>,
) -> Result<Figures<T>, CompareError> {
    let mut figures = Figures::new();
    for (law, file) in laws {
        for (place, scene) in scenes(file)?.iter().enumerate() {
            next()?;
            if figures.len() == place {
                figures.push((scene.name, Vec::new()));
            }
            figures[place].1.push(show(law, scene));
        }
    }
    Ok(figures)
}

/// Flies ours, and all laws of `set`, in all scenes of the file, which was read from `text`, and in `flights` random
/// flights. `files`: the file, and the same at the others' rate.
///
/// # Errors
/// [`CompareError`].
pub fn compare(
    files: (&Scenario, &Scenario),
    text: &str,
    set: &Set,
    flights: u64,
    interrupt: &Interrupt,
) -> Result<Comparison, CompareError> {
    let certified = certified(files.0)?;
    let file = files.0;
    let laws = laws(files, set, &certified)?;
    let names: Vec<&'static str> = laws.iter().map(|(law, _)| law.name()).collect();
    let scenes = scenes::all(file)?;
    let mut next = steps((scenes.len() + 1) * laws.len(), interrupt);
    let figures = flown(&laws, scenes::all, scene_figures::fly_scene, &mut next)?;
    let mut thrown = Vec::new();
    for (law, file) in &laws {
        next()?;
        thrown.push(scene_figures::fly_random_flights(
            law,
            &step::with_longest_step(file),
            certified.certificate(),
            flights,
            interrupt,
        ));
    }
    next()?;
    drop(next);
    let rows = rows::all(&figures, &thrown, &Limit::new(file), file.configuration.rotors().is_some());
    let clean = |thrown: &RandomFlights| thrown.outcomes.iter().all(|outcome| outcome.holds() && outcome.clipped == 0);
    let holds = thrown.first().and_then(Option::as_ref).is_some_and(clean);
    let compared = page::Compared {
        file,
        text,
        set,
        names: &names,
        rows: &rows,
        scenes: &scenes,
        figures: &figures,
        thrown: &thrown,
        flights,
        holds,
    };
    let files = vec![
        ("report.html", page::page(&compared).html()),
        ("compare.csv", rows::csv(&names, &rows)),
        ("scenes.svg", pictures::scenes(&names, &figures)),
        ("random.svg", pictures::random(&names, &thrown, &figures)),
    ];
    Ok(Comparison { text: rows::table(&names, &rows), holds, files })
}

/// Flies ours, and all laws of `set`, on a vehicle that is not as its file says: [`realism`]. `files` as in
/// [`compare`].
///
/// # Errors
/// [`CompareError`].
pub fn compare_in_reality(
    files: (&Scenario, &Scenario),
    set: &Set,
    interrupt: &Interrupt,
) -> Result<Comparison, CompareError> {
    in_scenes(files, set, realism::all, (realism::fly_realism_scene, realism::rows, realism::is_held), interrupt)
}

/// Flies ours, and all laws of `set`, as a rotor fails, to the ground: [`rotor_loss`]. `files` as in [`compare`], of a
/// vehicle with rotors.
///
/// # Errors
/// [`CompareError`].
pub fn compare_without_a_rotor(
    files: (&Scenario, &Scenario),
    set: &Set,
    interrupt: &Interrupt,
) -> Result<Comparison, CompareError> {
    in_scenes(files, set, rotor_loss::all, (rotor_loss::fly_loss_scene, rotor_loss::rows, Landing::is_soft), interrupt)
}

/// How a law is flown in a scene, the rows of such figures, and whether ours are as they must be.
type Judged<T> =
    (fn(&LawOnVehicle, &Scene) -> Option<T>, fn(&[(&'static str, Vec<Option<T>>)]) -> Vec<FigureRow>, fn(&T) -> bool);

/// A comparison in scenes of its own: a table, and whether ours `holds` in all of them.
fn in_scenes<T>(
    files: (&Scenario, &Scenario),
    set: &Set,
    scenes: fn(&Scenario) -> Result<Vec<Scene>, ParameterError>,
    (show, rows, holds): Judged<T>,
    interrupt: &Interrupt,
) -> Result<Comparison, CompareError> {
    let laws = laws(files, set, &certified(files.0)?)?;
    let names: Vec<&'static str> = laws.iter().map(|(law, _)| law.name()).collect();
    let mut next = steps(scenes(files.0)?.len() * laws.len(), interrupt);
    let figures = flown(&laws, scenes, show, &mut next)?;
    next()?;
    drop(next);
    let rows = rows(&figures);
    let holds = figures.iter().all(|(_, figures)| figures.first().and_then(Option::as_ref).is_some_and(holds));
    let files = vec![("compare.csv", rows::csv(&names, &rows))];
    Ok(Comparison { text: rows::table(&names, &rows), holds, files })
}

/// Makes `directory` and keeps others from writing into it; before long work, not after it.
///
/// # Errors
/// [`CompareError::Output`].
pub fn reserve(directory: &Path) -> Result<DirectoryLock, CompareError> {
    let reserved = DirectoryLock::take(directory)
        .and_then(|lock| WholeFile::try_name(&directory.join("compare.csv")).map(|()| lock));
    reserved.map_err(|error| CompareError::Output(directory.to_owned(), error))
}

/// Writes all files of `comparison` into `directory`, which is reserved, after all of them were written in full.
///
/// # Errors
/// [`CompareError::Output`].
pub fn write(comparison: &Comparison, directory: &Path) -> Result<(), CompareError> {
    let failed = |path: &Path| {
        let path = path.to_owned();
        |error| CompareError::Output(path, error)
    };
    for (name, text) in &comparison.files {
        let path = directory.join(name);
        WholeFile::write(&path, text).map_err(failed(&path))?;
    }
    Ok(())
}
