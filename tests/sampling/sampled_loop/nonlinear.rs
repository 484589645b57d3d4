//! One body axis with the law's saturations, flown in time: what the linear loop predicts, happens.
//!
//! ```text
//! theta = tan(angle / 4),  tau = -(1 + theta^2) / 4 s(k_theta theta) - s(k_omega rate),  s(x) = M x / sqrt(M^2 + x^2)
//! ```

use super::common::{IDEAL_TIMING, body_axis, model, vehicle};
use controller_core::gains::GainParameters;
use scenario::sampled_loop::{Axis, Timing};
use std::collections::VecDeque;

const ATTITUDE_AXES: [Axis; 3] = [Axis::Roll, Axis::Pitch, Axis::Yaw];

/// Peak |angle| in each window of `window` seconds, from rest at `angle` rad.
fn peaks(axis: Axis, timing: Timing, mut angle: f64, window: f64, windows: usize) -> Vec<f64> {
    /// Of the midpoint rule.
    const SUBSTEPS_PER_PERIOD: usize = 100;
    let inertia = f64::from(vehicle().inertia[body_axis(axis).unwrap()]);
    let saturated = |x: f64, level: f64| level * x / (level * level + x * x).sqrt();
    let whole = timing.delay_samples as usize;
    let late = ((timing.delay_samples - whole as f64) * SUBSTEPS_PER_PERIOD as f64).round() as usize;
    let dt = timing.period / SUBSTEPS_PER_PERIOD as f64;
    let ticks = (window / timing.period).round() as usize;

    let (mut rate, mut torque) = (0.0_f64, 0.0_f64);
    let mut commands = VecDeque::from(vec![0.0; whole + 2]);
    let mut peaks = Vec::new();
    for _ in 0..windows {
        let mut peak = 0.0_f64;
        for _ in 0..ticks {
            peak = peak.max(angle.abs());
            let mrp = (angle / 4.0).tan();
            let attitude =
                saturated(f64::from(GainParameters::TABLE_1.k_theta) * mrp, f64::from(GainParameters::TABLE_1.m_theta));
            let damping = saturated(
                f64::from(GainParameters::TABLE_1.k_omega) * rate,
                f64::from(GainParameters::TABLE_1.m_omega),
            );
            commands.push_front(-0.25 * (1.0 + mrp * mrp) * attitude - damping);
            commands.pop_back();
            for substep in 0..SUBSTEPS_PER_PERIOD {
                let command = if substep < late { commands[whole + 1] } else { commands[whole] };
                let towards =
                    |torque: f64| if timing.rotor_lag > 0.0 { (command - torque) / timing.rotor_lag } else { 0.0 };
                if timing.rotor_lag == 0.0 {
                    torque = command;
                }
                let middle = torque + 0.5 * dt * towards(torque);
                angle += dt * (rate + 0.5 * dt * torque / inertia);
                rate += dt * middle / inertia;
                torque += dt * towards(middle);
            }
        }
        peaks.push(peak);
    }
    peaks
}

#[test]
fn five_milliseconds_of_lag_settle_from_any_angle() {
    let timing = Timing { rotor_lag: 0.005, ..IDEAL_TIMING };
    for axis in ATTITUDE_AXES {
        assert!(model(GainParameters::TABLE_1, timing).spectral_radius(axis) < 1.0);
        for start in [0.01, 0.5, 3.0] {
            let last = peaks(axis, timing, start, 1.0, 10)[9];
            assert!(last < 1e-6, "{axis:?} from {start}: {last:e} rad left");
        }
    }
}

/// From a small and from a large angle the same oscillation remains, rad.
fn limit_cycle(axis: Axis, timing: Timing) -> f64 {
    assert!(model(GainParameters::TABLE_1, timing).spectral_radius(axis) > 1.0);
    let ends = [1e-3, 1.0].map(|start| {
        let peaks = peaks(axis, timing, start, 5.0, 40);
        assert!((peaks[39] / peaks[38] - 1.0).abs() < 0.01, "{axis:?} {timing:?} not settled: {peaks:?}");
        peaks[39]
    });
    assert!((ends[0] / ends[1] - 1.0).abs() < 0.02, "{axis:?} {timing:?}: {ends:?}");
    ends[0]
}

#[test]
fn ten_milliseconds_of_lag_and_more_end_in_a_limit_cycle() {
    for axis in ATTITUDE_AXES {
        let amplitudes = [0.010, 0.015, 0.030].map(|rotor_lag| limit_cycle(axis, Timing { rotor_lag, ..IDEAL_TIMING }));
        assert!(amplitudes[0] > 1e-3 && amplitudes.is_sorted(), "{axis:?} {amplitudes:?}");
    }
}

#[test]
fn one_sample_of_delay_cannot_hold_still() {
    for axis in ATTITUDE_AXES {
        let amplitude = limit_cycle(axis, Timing { delay_samples: 1.0, ..IDEAL_TIMING });
        assert!(amplitude > 1e-3, "{axis:?}: {amplitude}");
    }
}

#[test]
fn small_motions_grow_and_shrink_at_the_predicted_rate() {
    for (rotor_lag, delay_samples) in [(0.005, 0.0), (0.008, 0.0), (0.010, 0.0), (0.0, 0.5), (0.0, 1.0), (0.005, 1.25)]
    {
        let timing = Timing { rotor_lag, delay_samples, ..IDEAL_TIMING };
        for axis in ATTITUDE_AXES {
            // So small that it stays linear however it grows. Peaks of windows show the rate but for half an
            // oscillation (9 samples at most) and for what a peak between two samples hides (4 %).
            let peaks = peaks(axis, timing, 1e-60, 1.0, 5);
            let flown = (peaks[4] / peaks[1]).ln() / 300.0;
            let predicted = model(GainParameters::TABLE_1, timing).spectral_radius(axis).ln();
            let tolerance = (9.0 * predicted.abs() + 0.04) / 300.0;
            assert!((flown - predicted).abs() < tolerance, "{axis:?} {timing:?}: {flown} against {predicted}");
        }
    }
}
