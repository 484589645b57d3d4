//! The log: a few lines a second and one for each event. On boards only; a desktop has the events themselves.

use crate::shared::{Event, Report, StatusView};
use embassy_sync::blocking_mutex::raw::RawMutex;
use flight::Stamped;

/// Logs an event.
#[cfg(target_os = "none")]
pub fn event(event: &Event) {
    use crate::shared::{Severity, Text};
    let text = Text::new(event);
    match event.severity() {
        Severity::Information => defmt::info!("{=str}", text.as_str()),
        Severity::Warning => defmt::warn!("{=str}", text.as_str()),
        Severity::Critical => defmt::error!("{=str}", text.as_str()),
    }
}

/// Logs how the vehicle does.
#[cfg(target_os = "none")]
pub fn summary<M: RawMutex>(report: Option<&Stamped<Report>>, shared: StatusView<'_, M>) {
    let Some(Stamped { value: report, time }) = report else {
        defmt::warn!("no report from control");
        return;
    };
    let timing = report.timing;
    defmt::info!(
        "{=u64} ms: {}, longest tick {=u32} us, jitter {=u32} us, missed {=u32}, {=u32} gaps of the IMU",
        *time / 1000,
        report.mode,
        timing.worst_duration,
        timing.worst_jitter,
        timing.missed,
        timing.gaps
    );
    if let Some(state) = report.state {
        let p = state.position;
        let angles = super::euler(&state.attitude);
        defmt::info!("at {=f32} {=f32} {=f32} m, {} degrees", p.x, p.y, p.z, angles);
    }
    if let Some(sample) = shared.imu().get() {
        let (rate, force) = (sample.value.angular_velocity, sample.value.specific_force);
        defmt::info!(
            "imu {=f32} {=f32} {=f32} rad/s, {=f32} {=f32} {=f32} m/s^2, {=u64} ms old",
            rate.x,
            rate.y,
            rate.z,
            force.x,
            force.y,
            force.z,
            time.saturating_sub(sample.time) / 1000
        );
    }
    if let Some(voltage) = shared.voltage().get() {
        defmt::info!("battery {=f32} V", voltage.value);
    }
    if let Some(traffic) = shared.traffic().get() {
        let traffic = traffic.value;
        defmt::info!(
            "link: {=u32} frames, {=u32} bytes of noise, {=u32} refused",
            traffic.frames,
            traffic.discarded,
            traffic.refused
        );
    }
    let lost = shared.lost_increments().get();
    if lost > 0 {
        defmt::warn!("{=u32} IMU increments lost", lost);
    }
    let lost = shared.lost_events().get();
    if lost > 0 {
        defmt::warn!("{=u32} events lost", lost);
    }
}

/// There is no log on a desktop.
#[cfg(not(target_os = "none"))]
pub fn event(_: &Event) {}

/// There is no log on a desktop.
#[cfg(not(target_os = "none"))]
pub fn summary<M: RawMutex>(_: Option<&Stamped<Report>>, _: StatusView<'_, M>) {}
