//! The equations of a Newton step of [`super::quickest`]: the slopes of its value, and what stands for its second
//! derivatives.
//!
//! A row with share s adds b'(s) times the slope of s to the value's slope, and b''(s) times the square of that slope
//! and b'(s) times [`CURVATURE_PER_SLOPE_SQUARED`] times its square in all directions to the second derivative. The
//! corridor's own second derivative is known.

use super::blocks::{BLOCK_SIZE, Blocks, Part};
use super::limits::{PathLimits, ROW_COUNT, VARIABLE_COUNT};
use super::piece::{KNOT_ORDERS, Motion, PiecePlace, powers};
use super::places::Places;
use super::sloped::Sloped;
use super::way::Way;
use nalgebra::{Vector3, Vector4};

/// The share below which a row counts as idle.
pub const IDLE_SHARE: f64 = 0.7;
/// The second derivative of a share, of its slope's square.
const CURVATURE_PER_SLOPE_SQUARED: f64 = 3.0;
/// The unknown of a block that is the logarithm of the piece's duration; the others are 4 times the order and the axis.
pub const DURATION_UNKNOWN: usize = BLOCK_SIZE - 1;
/// The shares of a place and the one after it: all rows, and the corridor at both.
pub const SHARE_COUNT: usize = ROW_COUNT + 2;

/// b, b' and b'' at a share.
pub fn barrier(share: f64) -> [f64; 3] {
    if share < IDLE_SHARE {
        return [0.0; 3];
    }
    let scale = 1.0 / (1.0 - IDLE_SHARE);
    let (left, x) = ((1.0 - share) * scale, (share - IDLE_SHARE) * scale);
    [-left.ln() - x - 0.5 * x * x, scale * (1.0 / left - 1.0 - x), scale * scale * (1.0 / (left * left) - 1.0)]
}

/// The equations of a step from `way`, with `shares` at its places, for a weight `rho` of the duration.
pub fn equations(limits: &PathLimits, places: &Places, way: &Way, shares: &[f64], rho: f64) -> Blocks {
    let mut equations = Blocks::new(way.knots.len());
    let mut shares = shares.chunks(SHARE_COUNT);
    for (piece, (_, duration)) in way.pieces.iter().enumerate() {
        equations.right[piece][DURATION_UNKNOWN] -= rho * duration;
        equations.diagonal[piece][(DURATION_UNKNOWN, DURATION_UNKNOWN)] += rho * duration;
        for ((place, between), shares) in places.each().zip(&mut shares) {
            let is_busy = |share: &f64| *share > IDLE_SHARE;
            if shares[..ROW_COUNT].iter().any(is_busy) {
                add_rows(&mut equations, limits, way, piece, place);
            }
            for (place, _) in [place, between].into_iter().zip(&shares[ROW_COUNT..]).filter(|(_, share)| is_busy(share))
            {
                add_corridor(&mut equations, way, piece, place);
            }
        }
    }
    // At rest at both ends, and through each point.
    let last = way.knots.len() - 1;
    for knot in 0..=last {
        let held = match (knot == 0 || knot == last, way.is_point(knot)) {
            (true, _) => 4 * KNOT_ORDERS,
            (false, true) => 4,
            (false, false) => 0,
        };
        (0..held).for_each(|unknown| equations.hold(knot, unknown));
    }
    equations.hold(last, DURATION_UNKNOWN);
    equations
}

fn add_rows(equations: &mut Blocks, limits: &PathLimits, way: &Way, piece: usize, place: &PiecePlace) {
    let (motion, speed) = (way.motion(piece, place), way.legs[way.pieces[piece].0].speed);
    let dependence = Dependence::at(way, piece, place);
    let mut curvature = [[0.0; 2]; KNOT_ORDERS - 1];
    for Sloped { value, slopes, .. } in limits.sloped(&motion, speed) {
        let [_, slope, bend] = barrier(value);
        if slope == 0.0 {
            continue;
        }
        let mut parts = [Part::zeros(); 2];
        for (order, curvature) in curvature.iter_mut().enumerate() {
            let along = axes(&slopes, order);
            dependence.add_slope(&mut parts, order + 1, &along);
            curvature[0] += CURVATURE_PER_SLOPE_SQUARED * slope * along.xyz().norm_squared();
            curvature[1] += CURVATURE_PER_SLOPE_SQUARED * slope * along.w * along.w;
        }
        add_square(equations, piece, &parts, slope, bend);
    }
    for (order, [position, heading]) in curvature.into_iter().enumerate() {
        for (axis, curvature) in [position, position, position, heading].into_iter().enumerate() {
            dependence.add_curvature(equations, piece, (order + 1, axis), curvature);
        }
    }
}

fn add_corridor(equations: &mut Blocks, way: &Way, piece: usize, place: &PiecePlace) {
    let leg = &way.legs[way.pieces[piece].0];
    let off: Vector3<f64> = leg.off(&way.motion(piece, place)[0].xyz());
    let inverse = 1.0 / (leg.corridor * leg.corridor);
    let [_, slope, bend] = barrier(off.norm_squared() * inverse);
    let dependence = Dependence::at(way, piece, place);
    let mut parts = [Part::zeros(); 2];
    dependence.add_slope(&mut parts, 0, &(off * (2.0 * inverse)).push(0.0));
    add_square(equations, piece, &parts, slope, bend);
    (0..3).for_each(|axis| dependence.add_curvature(equations, piece, (0, axis), 2.0 * inverse * slope));
}

/// What the derivatives of a place depend on: W T^(l - k) of [`super::piece`], and how they change with ln T.
struct Dependence {
    weights: [[[f64; KNOT_ORDERS]; 2]; KNOT_ORDERS],
    with_duration: Motion,
}

impl Dependence {
    fn at(way: &Way, piece: usize, place: &PiecePlace) -> Self {
        let powers = powers(way.pieces[piece].1);
        let weights: [[[f64; KNOT_ORDERS]; 2]; KNOT_ORDERS] =
            std::array::from_fn(|order| place.weights(order, &powers));
        let with_duration = std::array::from_fn(|order| {
            let mut sum = Vector4::zeros();
            for (end, weights) in way.knots[piece..].iter().zip(&weights[order]) {
                for (l, (derivative, weight)) in end.iter().zip(weights).enumerate() {
                    sum += derivative * (weight * (l as f64 - order as f64));
                }
            }
            sum
        });
        Self { weights, with_duration }
    }

    /// Both blocks' part of a slope along one derivative.
    fn add_slope(&self, parts: &mut [Part; 2], order: usize, slope: &Vector4<f64>) {
        for (part, weights) in parts.iter_mut().zip(&self.weights[order]) {
            for (l, weight) in weights.iter().enumerate() {
                for axis in 0..4 {
                    part[4 * l + axis] += slope[axis] * weight;
                }
            }
        }
        parts[0][DURATION_UNKNOWN] += slope.dot(&self.with_duration[order]);
    }

    /// Adds `curvature` along one axis of one derivative to the equations of a piece.
    fn add_curvature(&self, equations: &mut Blocks, piece: usize, (order, axis): (usize, usize), curvature: f64) {
        let [start, end] = &self.weights[order];
        let time = self.with_duration[order][axis];
        let unknown = |l: usize| 4 * l + axis;
        for (l, start_l) in start.iter().enumerate() {
            for (m, start_m) in start.iter().enumerate() {
                equations.diagonal[piece][(unknown(l), unknown(m))] += curvature * start_l * start_m;
                equations.diagonal[piece + 1][(unknown(l), unknown(m))] += curvature * end[l] * end[m];
                equations.below[piece][(unknown(l), unknown(m))] += curvature * end[l] * start_m;
            }
            let mixed = curvature * start_l * time;
            equations.diagonal[piece][(unknown(l), DURATION_UNKNOWN)] += mixed;
            equations.diagonal[piece][(DURATION_UNKNOWN, unknown(l))] += mixed;
            equations.below[piece][(unknown(l), DURATION_UNKNOWN)] += curvature * end[l] * time;
        }
        equations.diagonal[piece][(DURATION_UNKNOWN, DURATION_UNKNOWN)] += curvature * time * time;
    }
}

/// A row's slopes along a derivative of the position, velocity first, and of the heading.
fn axes(slopes: &[f64; VARIABLE_COUNT], order: usize) -> Vector4<f64> {
    let heading = slopes.get(12 + order).copied().unwrap_or(0.0);
    Vector4::new(slopes[3 * order], slopes[3 * order + 1], slopes[3 * order + 2], heading)
}

/// Adds a row with this slope and bend of the barrier to the equations of a piece.
fn add_square(equations: &mut Blocks, piece: usize, [start, end]: &[Part; 2], slope: f64, bend: f64) {
    equations.right[piece] -= start * slope;
    equations.right[piece + 1] -= end * slope;
    equations.diagonal[piece].ger(bend, start, start, 1.0);
    equations.diagonal[piece + 1].ger(bend, end, end, 1.0);
    equations.below[piece].ger(bend, end, start, 1.0);
}
