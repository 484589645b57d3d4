//! What the generator of the force estimate can reach, axis by axis, from histories it is driven through.
//!
//! An axis starts at rest at one end of its level, is driven to the other end for a time, and back for another: the
//! extremes of (d, d') lie on such histories. d'' is what the core makes of the input at hand.

use controller_core::extended::force::{ForceEstimate, ForceGenerator};
use controller_core::extended::parameters::EstimateParameters;
use nalgebra::{Vector2, Vector3};

/// Ticks towards the other end, and back.
const AWAY: usize = 320;
const BACK: usize = 80;

/// Histories of an axis across and of the vertical one.
pub struct Histories {
    generator: ForceGenerator,
    levels: Vector3<f32>,
    /// (d, d') after `away * (BACK + 1) + back`.
    across: Vec<[f32; 2]>,
    vertical: Vec<[f32; 2]>,
}

impl Histories {
    /// Drives the generator, which the core's own arithmetic advances.
    pub fn new(parameters: &EstimateParameters) -> Self {
        let slowest = parameters.force_bandwidth_across.min(parameters.force_bandwidth_vertical);
        let fastest = parameters.force_bandwidth_across.max(parameters.force_bandwidth_vertical);
        let level = parameters.force_across;
        // The whole way at the rate's limit, and four time constants.
        let crossing = if parameters.force_snap_across > 0.0 {
            2.0 * level * slowest / parameters.force_snap_across + 4.0 / slowest
        } else {
            0.0
        };
        let period = (crossing / AWAY as f32).max(0.02 / fastest).min(0.3 / fastest);
        let generator = ForceGenerator::new(parameters, period).unwrap();
        let levels = Vector3::new(level, level, parameters.force_vertical);
        let advanced = |estimate: &ForceEstimate, side: f32| {
            let estimate = ForceEstimate { average: levels * side, ..*estimate };
            generator.advanced(&estimate, &generator.acceleration(&estimate))
        };
        let mut away = ForceEstimate { value: -levels, ..ForceEstimate::NONE };
        let (mut across, mut vertical) = (Vec::new(), Vec::new());
        for _ in 0..=AWAY {
            let mut back = away;
            for _ in 0..=BACK {
                across.push([back.value.x, back.rate.x]);
                vertical.push([back.value.z, back.rate.z]);
                back = advanced(&back, -1.0);
            }
            away = advanced(&away, 1.0);
        }
        Self { generator, levels, across, vertical }
    }

    /// d, d' and d'' for codes in [-1, 1]: per axis the start's side and how long the way there took, the way back, and the
    /// input now as a share of the level.
    pub fn reached(&self, codes: [[f64; 3]; 3]) -> [Vector3<f32>; 3] {
        let point = |table: &[[f32; 2]], [away, back, _]: [f64; 3]| {
            let place = |share: f64, ticks: usize| (share * ticks as f64).round() as usize;
            let row = place(away.abs(), AWAY) * (BACK + 1) + place(0.5 + 0.5 * back, BACK);
            Vector2::from(table[row]) * away.signum() as f32
        };
        let [x, y, z] = [point(&self.across, codes[0]), point(&self.across, codes[1]), point(&self.vertical, codes[2])];
        let input = Vector3::new(codes[0][2], codes[1][2], codes[2][2]).cast::<f32>();
        let estimate = ForceEstimate {
            average: input.component_mul(&self.levels),
            value: Vector3::new(x.x, y.x, z.x),
            rate: Vector3::new(x.y, y.y, z.y),
        };
        [estimate.value, estimate.rate, self.generator.acceleration(&estimate)]
    }
}
