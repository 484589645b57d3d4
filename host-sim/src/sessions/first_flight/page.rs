//! The page to sign: what was checked, with its figures, as Markdown that prints well.

use super::checks::Check;
use super::record::{Record, Subject};
use std::fmt::Write;
use std::time::{SystemTime, UNIX_EPOCH};

/// The page of a record, at a time.
#[must_use]
pub fn page(record: &Record, checks: &[Check], file: &str, time: &str) -> String {
    let Subject { board, scenario, image } = &record.subject;
    let mut page = format!("# First flight: {file} on {board}\n\n{time}\n\n");
    let _ = write!(page, "| what | |\n|---|---|\n| board | {board} |\n| scenario file | {file} |\n");
    let _ = write!(page, "| its SHA-256 | `{scenario}` |\n| image | `{image}` |\n\n");
    let _ = write!(page, "| check | outcome | figures | when |\n|---|---|---|---|\n");
    for check in checks {
        let (outcome, figures, when) = match record.outcome(check.id) {
            Some(entry) => (entry.outcome.word(), entry.outcome.figures(), entry.time.as_str()),
            None => ("not made", "", ""),
        };
        let _ = writeln!(page, "| {} | {outcome} | {} | {when} |", check.title, figures.replace('|', "\\|"));
    }
    let _ = write!(
        page,
        "\nA check that was skipped was not made: its reason stands beside it. A check that failed forbids the \
         flight.\n\n\
         Propellers on, tether fixed, room clear, both people know the four ways to stop:\n\n\
         | | name | signature | date |\n|---|---|---|---|\n\
         | at the ground station | | | |\n| at the vehicle | | | |\n"
    );
    page
}

/// The time of this computer's clock, UTC, to the minute.
#[must_use]
pub fn now() -> String {
    let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    utc(seconds)
}

/// Seconds since 1970 as a date, by the Gregorian calendar.
fn utc(seconds: u64) -> String {
    let (mut days, minutes) = (seconds / 86_400, seconds % 86_400 / 60);
    let is_leap = |year: u64| year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400));
    let mut year = 1970;
    while days >= 365 + u64::from(is_leap(year)) {
        days -= 365 + u64::from(is_leap(year));
        year += 1;
    }
    let lengths = [31, 28 + u64::from(is_leap(year)), 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
    let mut month = 1;
    for length in lengths {
        if days < length {
            break;
        }
        days -= length;
        month += 1;
    }
    format!("{year}-{month:02}-{:02} {:02}:{:02} UTC", days + 1, minutes / 60, minutes % 60)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_those_of_the_calendar() {
        for (seconds, date) in [
            (0, "1970-01-01 00:00 UTC"),
            (951_782_400, "2000-02-29 00:00 UTC"),
            (1_709_251_199, "2024-02-29 23:59 UTC"),
            (1_795_874_340, "2026-11-28 13:59 UTC"),
            (4_107_542_400, "2100-03-01 00:00 UTC"),
        ] {
            assert_eq!(utc(seconds), date);
        }
    }
}
