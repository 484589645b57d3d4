use super::*;
use crate::vehicle::{Vehicle, VehicleParameters};

/// Filters so fast, and slow, that the weights of a step reach their ends; states and inputs at and near the walls.
#[test]
fn no_bandwidth_and_no_period_leads_out_of_the_box() {
    let vehicle = VehicleParameters { mass: 0.46, inertia: Vector3::new(2.24e-3, 2.9e-3, 5.3e-3), gravity: 9.81 };
    let vehicle = Vehicle::new(vehicle).unwrap();
    let mut random = 1_u32;
    let mut within = |level: f32| {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let share = f64::from(random >> 8) / 16_777_215.0 * 2.0 - 1.0;
        // A third at a wall, a third within some roundings of one, a third anywhere.
        match random % 3 {
            0 => level.copysign(share as f32),
            1 => (f64::from(level) * (1.0 - share.abs() * 1e-6)) as f32 * 1.0_f32.copysign(share as f32),
            _ => (f64::from(level) * share) as f32,
        }
    };
    for (k_f, k_s) in [(999.0, 999.0), (2.0, 999.0), (999.0, 2.0), (160.0, 170.0), (2.0, 20.0), (1e-6, 999.0)] {
        for period in [1e-4, 1e-3, 0.01, 0.1] {
            for m_p in [2.0, 0.3, 7.77, 1e-3] {
                let gains = GainParameters { k_f, k_s, m_p, ..GainParameters::TABLE_1 };
                let gains = Gains::new(gains, &vehicle).unwrap();
                let transition = FilterTransition::new(gains.k_f, gains.k_s, period).unwrap();
                for _ in 0..3000 {
                    let mut vector = || Vector3::new(within(m_p), within(m_p), within(m_p));
                    let state = FilterState { filtered: vector(), intermediate: vector() };
                    let FilterState { filtered, intermediate } = transition.advance(&state, &vector());
                    let inside = filtered.amax() <= m_p && intermediate.amax() <= m_p;
                    assert!(inside, "{k_f} {k_s} {period} {m_p}: {state:?} {filtered} {intermediate}");
                }
            }
        }
    }
}
