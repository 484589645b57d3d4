//! Status: the light, the battery's voltage, and the log.
//!
//! | light | means |
//! |---|---|
//! | a short flash once a second | disarmed |
//! | two short flashes once a second | motor test |
//! | three short flashes once a second | stopped or locked: inspect the vehicle |
//! | slow blinking (1 Hz) | armed, on the ground |
//! | on | flying |
//! | fast blinking (5 Hz) | going down without a pose |
//! | flickering (10 Hz) | no report from control for [`REPORT_AGE_MAX_US`] |

mod euler;
mod log;
mod restart_report;

use crate::hardware::{Battery, Clock, Light};
use crate::parameters::table::Name;
use crate::shared::{Event, Severity, StatusView};
use embassy_futures::select::{Either, select};
use embassy_sync::blocking_mutex::raw::RawMutex;
use flight::Mode;

pub use euler::{Euler, euler};
pub use restart_report::{RESTART_REPORT_INTERVAL_US, RestartReport};

/// Time between steps.
pub const LIGHT_STEP_US: u64 = 50_000;

/// Time between readings of the battery.
const BATTERY_INTERVAL_US: u64 = 200_000;

/// The longest a reading may take.
const BATTERY_TIMEOUT_US: u64 = 20_000;

/// Time between log lines.
const SUMMARY_INTERVAL_US: u64 = 1_000_000;

/// Time between warnings of a low battery.
const WARNING_INTERVAL_US: u64 = 10_000_000;

/// The greatest age of a report that counts.
pub const REPORT_AGE_MAX_US: u64 = 1_000_000;

/// Whether the light is on at `now` (us), a multiple of [`LIGHT_STEP_US`] or close behind one; no mode without a fresh
/// report.
pub fn is_lit(mode: Option<Mode>, now: u64) -> bool {
    // Steps into the present second, 0 to 19.
    let step = now % 1_000_000 / LIGHT_STEP_US;
    match mode {
        Some(Mode::Boot | Mode::Checks | Mode::Ready) => step == 0,
        Some(Mode::MotorTest) => step == 0 || step == 4,
        Some(Mode::Stopped | Mode::Locked) => step == 0 || step == 4 || step == 8,
        Some(Mode::Idling) => step < 10,
        Some(Mode::TakingOff | Mode::Flying | Mode::Holding | Mode::Landing) => true,
        Some(Mode::Descending) => step % 4 < 2,
        None => step.is_multiple_of(2),
    }
}

/// Shows, measures and logs for ever.
pub async fn run<M: RawMutex>(
    mut light: impl Light,
    mut battery: impl Battery,
    clock: &impl Clock,
    shared: StatusView<'_, M>,
) -> ! {
    let (mut reading, mut summary, mut warning) = (0, 0, 0);
    let mut is_card_silent = false;
    let mut restart = RestartReport::default();
    loop {
        let now = clock.now();
        let report = shared.report().get().filter(|report| report.age(now) <= REPORT_AGE_MAX_US);
        light.set(is_lit(report.map(|report| report.value.mode), now));
        if now >= reading {
            reading = now.saturating_add(BATTERY_INTERVAL_US);
            measure(&mut battery, clock, shared, &mut warning).await;
        }
        restart.tick(shared, now);
        let is_silent = shared.card().is_silent(now);
        if is_silent && !is_card_silent {
            shared.announce(Event::new(Severity::Warning, "Card does not answer: flights are not logged"));
        }
        is_card_silent = is_silent;
        while let Some(event) = shared.log().take() {
            log::event(&event);
        }
        if now >= summary {
            summary = now.saturating_add(SUMMARY_INTERVAL_US);
            log::summary(report.as_ref(), shared);
        }
        // By whole steps, so that the pattern does not drift through the second.
        let now = clock.now();
        clock.until(now - now % LIGHT_STEP_US + LIGHT_STEP_US).await;
    }
}

/// Reads the battery and warns when it is low, no more often than `warning` allows.
async fn measure<M: RawMutex>(
    battery: &mut impl Battery,
    clock: &impl Clock,
    shared: StatusView<'_, M>,
    warning: &mut u64,
) {
    let end = clock.now().saturating_add(BATTERY_TIMEOUT_US);
    let Either::First(Some(voltage)) = select(battery.voltage(), clock.until(end)).await else { return };
    if !voltage.is_finite() {
        return;
    }
    let now = clock.now();
    shared.voltage().put(voltage, now);
    if voltage < shared.parameters().get(Name::BatteryLow) && now >= *warning {
        *warning = now.saturating_add(WARNING_INTERVAL_US);
        shared.announce(Event::new(Severity::Warning, format_args!("Battery low: {voltage:.1} V")));
    }
}
