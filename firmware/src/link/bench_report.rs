//! The bench report: what a probe's log says of the boot and of the ticks, line by line, for whoever has only the link.
//!
//! Command 401 (RUN_PREARM_CHECKS) asks for it, disarmed. Lines that do not apply are left out:
//!
//! ```text
//! Started by Power on MicoAir H743 V2
//! Scenario study
//! T1 greatest thrust: 12.1034 of 13.2435              a line for each inequality of the certificate
//! Certified
//! Calibration: gyro yes, accel no, level no
//! Tick 410 us, late 12 us, missed 0, IMU gaps 0
//! Ready to arm                                        or why it is not
//! Report ends
//! ```
//!
//! The numbers are those that were required and those that are available; names are cut to fit.

use crate::shared::{Calibrated, Event, Report, Severity, Started, Verdict};
use controller_core::certificate::certified::{Certified, Refused};

/// Its lines besides those of the certificate.
const HEAD_LINES: usize = 2;

/// What the report is made of.
pub struct Sources<'a> {
    /// What made the chip start, where that is known.
    pub started: Option<Started>,
    /// The name of what was built in.
    pub vehicle: &'a str,
    /// The certificate's verdict.
    pub verdict: Option<Verdict>,
    /// What has been calibrated.
    pub calibrated: Calibrated,
    /// Control's last report, if it is recent.
    pub report: Option<Report>,
}

/// A line: one to be sent, one that does not apply, or none any more.
#[derive(Debug, Clone, PartialEq)]
pub enum Line {
    /// To be sent.
    Text(Event),
    /// To be left out.
    LeftOut,
    /// The report has ended.
    End,
}

impl Sources<'_> {
    /// The line of this number.
    pub fn line(&self, number: usize) -> Line {
        let certificate = match self.verdict {
            Some(Ok(certified)) => Some(certified.certificate()),
            Some(Err(Refused::Fails(certificate))) => Some(certificate),
            Some(Err(Refused::Undefined(_))) | None => None,
        };
        let Some(row) = number.checked_sub(HEAD_LINES) else { return self.head(number) };
        let rows = certificate.map_or(0, |certificate| certificate.inequalities().count());
        if let Some(inequality) = certificate.and_then(|certificate| certificate.inequalities().nth(row)) {
            // In single precision: double has words of its own, 2 KB.
            let (required, available) = (inequality.required as f32, inequality.available as f32);
            let severity = if inequality.holds() { Severity::Information } else { Severity::Critical };
            // 28, 2, 8, 4 and 8 characters.
            let words = format_args!("{:.28}: {required:.4} of {available:.4}", inequality.name);
            return Line::Text(Event::new(severity, words));
        }
        self.tail(row - rows)
    }

    fn head(&self, number: usize) -> Line {
        match (number, self.started) {
            (0, Some((cause, board))) => information(format_args!("Started by {cause} on {board}")),
            (0, None) => Line::LeftOut,
            _ => information(format_args!("Scenario {}", self.vehicle)),
        }
    }

    fn tail(&self, number: usize) -> Line {
        let Calibrated { gyro, accelerometer, level } = self.calibrated;
        match (number, &self.report) {
            (0, _) => self.verdict.map_or(Line::LeftOut, judged),
            (1, _) => {
                let [gyro, accelerometer, level] = [gyro, accelerometer, level].map(|is| if is { "yes" } else { "no" });
                information(format_args!("Calibration: gyro {gyro}, accel {accelerometer}, level {level}"))
            }
            (2, Some(Report { timing, .. })) => information(format_args!(
                "Tick {} us, late {} us, missed {}, IMU gaps {}",
                timing.worst_duration, timing.worst_jitter, timing.missed, timing.gaps
            )),
            (2, None) => Line::Text(Event::new(Severity::Critical, "No report from control")),
            (3, Some(Report { refusal: Some(refusal), .. })) => Line::Text(Event::Refused(*refusal)),
            (3, Some(Report { ready: true, .. })) => information(format_args!("Ready to arm")),
            (3, _) => Line::LeftOut,
            (4, _) => information(format_args!("Report ends")),
            _ => Line::End,
        }
    }
}

fn judged(verdict: &Result<Certified, Refused>) -> Line {
    match verdict {
        Ok(_) => information(format_args!("Certified")),
        Err(Refused::Fails(_)) => Line::Text(Event::new(Severity::Critical, "Not certified")),
        Err(Refused::Undefined(error)) => {
            Line::Text(Event::new(Severity::Critical, format_args!("Not certified: {}", error.field)))
        }
    }
}

fn information(words: core::fmt::Arguments<'_>) -> Line {
    Line::Text(Event::new(Severity::Information, words))
}
