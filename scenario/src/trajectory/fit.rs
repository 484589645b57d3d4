//! A smooth path near rows of time and place: the coarsest of a family of splines that stays near enough.
//!
//! The spline is made of quintic polynomials over intervals of one length h, with continuous snap: with the uniform
//! B-spline's six weights B_k(u), u in [0, 1] the place inside interval i,
//!
//! p(t) = sum over k = 0..5 of B_k(u) c_(i+k).
//!
//! The coefficients c minimise, by least squares, what the rows' positions deviate by, in units of the distance
//! requested for; with velocities and accelerations, where rows have them, in units of that distance per h and h^2;
//! and, by next to nothing, the fifth differences of c, which decide where there are no rows. The normal equations are
//! banded.
//!
//! The number of intervals grows by a third until every row's position is within the distance of the path as flown. So
//! noise and rounding of a recording are left out as far as that distance allows, and the path asks for little
//! jerk and snap.

use super::band::Band;
use super::row::Row;
use super::stretch::path;
use controller_core::reference::Trajectory;
use controller_core::reference::knot::{Derivatives, Knot, REST};
use nalgebra::{Vector3, Vector4};

/// The coefficients' number beyond that of the intervals.
const SPLINE_DEGREE: usize = 5;
/// The polynomials B_0 to B_5 times 120, lowest power first.
const BASIS_TIMES_120: [[f64; 6]; 6] = [
    [1.0, -5.0, 10.0, -10.0, 5.0, -1.0],
    [26.0, -50.0, 20.0, 20.0, -20.0, 5.0],
    [66.0, 0.0, -60.0, 0.0, 30.0, -10.0],
    [26.0, 50.0, 20.0, -20.0, -20.0, 10.0],
    [1.0, 5.0, 10.0, 10.0, 5.0, -5.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
];
/// The weight of the fifth differences beside that of a row.
const SMOOTHNESS_WEIGHT: f64 = 1e-6;
const HEADING_TOLERANCE_RAD: f64 = 0.05;
/// The first number of intervals, by how much it grows, and the maximum.
const INTERVALS_MIN: usize = 4;
const INTERVALS_GROWTH: f64 = 1.3;
const INTERVALS_MAX: usize = 20_000;

/// What was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// How each of the spline's joints is passed, times from zero; at rest at neither end if the rows are not.
    pub knots: Vec<Knot>,
    /// The maximum distance of a row from it, m, and the row's time, s.
    pub farthest: (f64, f64),
}

/// B_0 to B_5, or their derivative of an order, at u.
fn weights(u: f64, order: usize) -> [f64; 6] {
    BASIS_TIMES_120.map(|polynomial| {
        let falling = |power: usize| (0..order).map(|less| power as f64 - less as f64).product::<f64>();
        let powers = polynomial.iter().enumerate().skip(order).rev();
        powers.fold(0.0, |sum, (power, coefficient)| sum * u + coefficient * falling(power)) / 120.0
    })
}

/// The path near `rows`, whose times begin at zero and whose headings go the way that is meant, within `near`, m.
///
/// # Errors
/// The nearest path of those tried, if none is near enough.
pub fn fit(rows: &[(f64, Row)], near: f64) -> Result<Fit, Fit> {
    let last = rows.last().map_or(0.0, |(time, _)| *time);
    let mut intervals = INTERVALS_MIN;
    let mut best: Option<Fit> = None;
    loop {
        // Whole microseconds, so that every joint is one of the clock's instants.
        let interval_us = (last * 1e6 / intervals as f64).ceil().max(1.0) as u64;
        let spline = Spline::near(rows, interval_us, intervals, near);
        let fit = spline.fit(rows, near);
        if fit.farthest.0 <= near && spline.turned(rows) <= HEADING_TOLERANCE_RAD {
            return Ok(fit);
        }
        if best.as_ref().is_none_or(|best| fit.farthest.0 < best.farthest.0) {
            best = Some(fit);
        }
        let more = (intervals as f64 * INTERVALS_GROWTH).ceil() as usize;
        // More coefficients than rows tell nothing new.
        if more > INTERVALS_MAX || intervals > 4 * rows.len() + INTERVALS_MIN {
            return Err(best.unwrap_or(Fit { knots: Vec::new(), farthest: (f64::INFINITY, 0.0) }));
        }
        intervals = more;
    }
}

struct Spline {
    interval_us: u64,
    intervals: usize,
    coefficients: Vec<Vector4<f64>>,
}

impl Spline {
    fn near(rows: &[(f64, Row)], interval_us: u64, intervals: usize, near: f64) -> Self {
        let interval = interval_us as f64 * 1e-6;
        let mut normal = Band::new(intervals + SPLINE_DEGREE);
        let unit = Vector4::new(near, near, near, HEADING_TOLERANCE_RAD);
        for (time, row) in rows {
            let (i, u) = place(*time, interval, intervals);
            let position = row.position.push(row.heading);
            let velocity = row.velocity.map(|velocity| (1, velocity));
            let acceleration = row.acceleration.map(|acceleration| (2, acceleration));
            normal.add(i, &weights(u, 0), &position.component_div(&unit), &unit.map(|unit| 1.0 / unit));
            for (order, derivative) in velocity.into_iter().chain(acceleration) {
                let unit = near / interval.powi(order);
                let weights = weights(u, order as usize).map(|weight| weight / interval.powi(order));
                let scale = Vector3::repeat(1.0 / unit).push(0.0);
                normal.add(i, &weights, &(derivative / unit).push(0.0), &scale);
            }
        }
        // Beside the rows of an interval on average.
        let share = (SMOOTHNESS_WEIGHT * rows.len() as f64 / intervals as f64).sqrt();
        for i in 0..intervals {
            let differences = [-1.0, 5.0, -10.0, 10.0, -5.0, 1.0];
            normal.add(i, &differences, &Vector4::zeros(), &unit.map(|unit| share / unit));
        }
        Self { interval_us, intervals, coefficients: normal.solve() }
    }

    /// The derivative of an order, per second to that order, at u in interval i.
    fn at(&self, i: usize, u: f64, order: usize) -> Vector4<f64> {
        let interval = self.interval_us as f64 * 1e-6;
        let coefficients = self.coefficients.iter().skip(i);
        let sum: Vector4<f64> = coefficients.zip(weights(u, order)).map(|(c, weight)| c * weight).sum();
        sum / interval.powi(order as i32)
    }

    /// How far its heading is off at worst, rad.
    fn turned(&self, rows: &[(f64, Row)]) -> f64 {
        let off = |(time, row): &(f64, Row)| {
            let (i, u) = place(*time, self.interval_us as f64 * 1e-6, self.intervals);
            (self.at(i, u, 0).w - row.heading).abs()
        };
        rows.iter().map(off).fold(0.0, f64::max)
    }

    /// Its joints, at rest at an end where its motion there is within `near` in an interval, and the farthest row.
    fn fit(&self, rows: &[(f64, Row)], near: f64) -> Fit {
        let interval = self.interval_us as f64 * 1e-6;
        let knot = |joint: usize| {
            // The last joint is the end of the last interval.
            let (i, u) = if joint < self.intervals { (joint, 0.0) } else { (joint - 1, 1.0) };
            let place = self.at(i, u, 0);
            let derivatives: Derivatives = [1, 2, 3, 4].map(|order| self.at(i, u, order));
            let moved = derivatives[0].norm() * interval + derivatives[1].norm() * (interval * interval);
            let rests = (joint == 0 || joint == self.intervals) && moved < near;
            let time_us = joint as u64 * self.interval_us;
            let derivatives = if rests { REST } else { derivatives };
            Knot { time_us, position: place.xyz(), heading: place.w, derivatives }
        };
        let knots: Vec<Knot> = (0..=self.intervals).map(knot).collect();
        let farthest = match path(&knots) {
            Ok(Some(path)) => rows.iter().fold((0.0, 0.0), |most, (time, row)| {
                let there = path.at((time * 1e6).round() as u64).position.map(f64::from);
                let distance = (there - row.position).norm();
                if distance > most.0 { (distance, *time) } else { most }
            }),
            // Beyond what the law takes: another spline may not be.
            _ => (f64::INFINITY, 0.0),
        };
        Fit { knots, farthest }
    }
}

/// The interval in which a time is, and the place in it.
fn place(time: f64, interval: f64, intervals: usize) -> (usize, f64) {
    let along = time / interval;
    let i = (along as usize).min(intervals - 1);
    (i, along - i as f64)
}
