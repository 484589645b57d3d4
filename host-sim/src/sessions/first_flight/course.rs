//! One check after the other, as far as they have not passed.

use super::checks::{CHECKS, Check};
use super::outcome::Outcome;
use super::page;
use super::record::{Entry, Record};
use super::vehicle::Stop;
use super::walk::Walk;

/// Makes the checks that have not passed, or `only` one; whether all of these passed or were skipped.
///
/// # Errors
/// Why the walk ended before them.
pub fn make(walk: &mut Walk<'_>, record: &mut Record, only: Option<&str>) -> Result<bool, Stop> {
    let is_done = |record: &Record, check: &Check| match only {
        Some(id) => check.id != id,
        // It may be another image than the last time: the first check says whether it is.
        None if check.id == CHECKS[0].id => false,
        None => record.outcome(check.id).is_some_and(|entry| matches!(entry.outcome, Outcome::Passed(_))),
    };
    for (number, check) in CHECKS.iter().enumerate() {
        if is_done(record, check) {
            continue;
        }
        let heading = format!("\n{} of {}: {}\n{}", number + 1, CHECKS.len(), check.title, check.about);
        walk.person.tell(check.id, &heading);
        walk.vehicle.texts();
        let outcome = (check.run)(walk)?;
        walk.person.tell(check.id, &format!("{}: {}", outcome.word(), outcome.figures()));
        let has_failed = matches!(outcome, Outcome::Failed(_));
        let entry = Entry { id: check.id.to_owned(), outcome, time: page::now() };
        record.add(entry).map_err(Stop::Unwritable)?;
        if has_failed {
            return Ok(false);
        }
    }
    Ok(true)
}
