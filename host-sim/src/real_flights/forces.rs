//! Thrust, rotor lag and drag of a real flight, by its accelerometer.
//!
//! With S the sum of the rotors' thrusts by the scenario's curve, behind the rotors' lag, S_0 its mean, and v the
//! velocity along the body's axes, an accelerometer shows, over mass m:
//!
//! ```text
//! f_z = a_b + s (S - S_0) - (D_z/m) v_z              a_b: one for each part b of the flight
//! f_x = b_x - (D_x/m) v_x,   f_y likewise            b: where the accelerometer is not level
//! w' = (c - w)/T                                     speeds of rotors, T one lag up, another down
//! ```
//!
//! a_b/S_0 is thrust scale over mass: as batteries empty and motors warm it drifts, so each part has its own, and its
//! interval is where a part of a next flight would be. s S_0/a is what becomes of a change of thrust: 1 where thrust
//! goes with the curve. Lags are sought on a grid, then as unknowns of the linearised equations. The accelerometer's
//! scale is the poses': on the whole, what it shows upwards carries the weight.
//!
//! Without an accelerometer f is how speed changes, softened over 0.2 s; then S and v are softened alike.
//!
//! Measured speeds of rotors have their lag behind them: there T is zero.

use super::columns::MotorMeasure;
use super::flown::{Flown, PERIOD_S, Sample};
use super::regression::{PART_COUNT, Parts, Shown, part_of};
use super::slopes::softened;
use nalgebra::{DVector, Vector3};

/// The lags that are tried, s.
const LAG_STEP_S: f64 = 0.01;
const LAG_MAX_STEPS: i32 = 25;
/// How far the two may be apart, steps of the grid.
const APART_MAX_STEPS: i32 = 6;
/// For slopes over the lags, s.
const LAG_SLOPE_S: f64 = 1e-3;
/// At the start of a flight the rotors' speeds are unknown, samples.
const UNKNOWN_START_SAMPLES: usize = 50;

/// What a flight shows of forces.
#[derive(Debug, Clone, PartialEq)]
pub struct Forces {
    /// Thrust scale over mass, 1/kg.
    pub strength: Shown,
    /// Of each part, 1/kg.
    pub strengths: Vec<f64>,
    /// What becomes of a change of thrust.
    pub response: Shown,
    /// s, up and down; none of measured speeds.
    pub lags: Option<[Shown; 2]>,
    /// D/m, 1/s, body.
    pub drag: [Shown; 3],
    /// S_0, N.
    pub mean_thrust: f64,
    /// The share of the weight that the accelerometer shows.
    pub accelerometer_scale: f64,
    /// How much of f_z is left, m/s^2, RMS, and how much there was.
    pub left: [f64; 2],
}

/// Where the unknowns stand: a_b, s, D_z/m, changes of the two lags.
const RESPONSE_INDEX: usize = PART_COUNT;
const DRAG_INDEX: usize = PART_COUNT + 1;
const LAGS_INDEX: usize = PART_COUNT + 2;

/// One sample's thrusts behind lags up and down, N: the speeds' roots follow.
pub fn lagged(samples: &[Sample], [up, down]: [f64; 2]) -> Vec<Vec<f64>> {
    let shares = [up, down].map(|lag| if lag > 0.0 { 1.0 - (-PERIOD_S / lag).exp() } else { 1.0 });
    let root = |thrust: &f64| thrust.max(0.0).sqrt();
    let mut speeds: Vec<f64> =
        samples.first().map(|sample| sample.thrusts.iter().map(root).collect()).unwrap_or_default();
    let mut behind = Vec::with_capacity(samples.len());
    for sample in samples {
        behind.push(speeds.iter().map(|speed| speed * speed).collect());
        for (speed, thrust) in speeds.iter_mut().zip(&sample.thrusts) {
            let apart = root(thrust) - *speed;
            *speed += apart * if apart > 0.0 { shares[0] } else { shares[1] };
        }
    }
    behind
}

impl Forces {
    /// # Errors
    /// If there is no accelerometer, or the flight does not show them.
    pub fn new(flown: &Flown, measure: MotorMeasure, gravity: f64) -> Result<Self, String> {
        let scale = accelerometer_scale(flown, gravity)?;
        let problem = Problem::new(flown, scale);
        // Two steps of Gauss and Newton from the grid's best.
        let sought = || problem.searched().and_then(|start| problem.stepped(problem.stepped(start)?));
        let lags = (measure != MotorMeasure::Speed).then(sought).transpose()?;
        let parts = problem.parts(lags.unwrap_or_default(), lags.is_some());
        let whole = parts.whole().ok_or("shows no thrust")?;
        let (unknowns, left) = whole.solved().ok_or("shows no thrust")?;
        let mean_thrust = problem.mean_thrust;
        let strengths: Vec<f64> = unknowns.iter().take(PART_COUNT).map(|level| level / mean_thrust).collect();
        let mean = strengths.iter().sum::<f64>() / PART_COUNT as f64;
        let spread = strengths.iter().map(|part| (part - mean).powi(2)).sum::<f64>() / (PART_COUNT - 1) as f64;
        let shown = |of: &dyn Fn(&DVector<f64>) -> f64| parts.shown(of).ok_or("shows no thrust");
        let of_lag = |lags: [f64; 2], which: usize| shown(&|unknowns| lags[which] + unknowns[LAGS_INDEX + which]);
        Ok(Self {
            strength: Shown { value: mean, uncertainty: (spread * (1.0 + 1.0 / PART_COUNT as f64)).sqrt() },
            strengths,
            response: shown(&|unknowns| unknowns[RESPONSE_INDEX] / mean)?,
            lags: lags.map(|lags| Ok::<_, String>([of_lag(lags, 0)?, of_lag(lags, 1)?])).transpose()?,
            drag: [problem.drag_across(0)?, problem.drag_across(1)?, shown(&|unknowns| unknowns[DRAG_INDEX])?],
            mean_thrust,
            accelerometer_scale: scale,
            left: [(left / whole.count).sqrt(), problem.variation()],
        })
    }

    /// s; zero of measured speeds.
    pub fn lag_values(&self) -> [f64; 2] {
        self.lags.map_or([0.0; 2], |lags| lags.map(|lag| lag.value.max(0.0)))
    }
}

/// What of the weight the accelerometer shows: over a flight, its mean upwards is gravity and what was gained of speed.
fn accelerometer_scale(flown: &Flown, gravity: f64) -> Result<f64, String> {
    let samples = &flown.samples;
    let up = samples.iter().map(|sample| Some((sample.attitude * sample.force?).z)).sum::<Option<f64>>();
    let up = up.ok_or("shows no forces")? / samples.len() as f64;
    let gained =
        samples.last().map_or(0.0, |last| last.velocity.z) - samples.first().map_or(0.0, |first| first.velocity.z);
    Ok(up / (gravity + gained / flown.seconds()))
}

/// The equations of one flight.
struct Problem<'a> {
    samples: &'a [Sample],
    /// m/s^2, body, by the corrected accelerometer.
    forces: Vec<Vector3<f64>>,
    /// m/s, body.
    velocities: Vec<Vector3<f64>>,
    mean_thrust: f64,
    /// Whether forces are softened, and so all must be that is compared with them.
    is_soft: bool,
}

impl<'a> Problem<'a> {
    fn new(flown: &'a Flown, scale: f64) -> Self {
        let samples = &flown.samples;
        let velocities: Vec<Vector3<f64>> =
            samples.iter().map(|sample| sample.attitude.inverse_transform_vector(&sample.velocity)).collect();
        let along = |axis: usize| velocities.iter().map(|velocity| velocity[axis]).collect::<Vec<_>>();
        let soft = [0, 1, 2].map(|axis| softened(&along(axis)));
        let softer = (0..samples.len()).map(|sample| Vector3::from_fn(|axis, _| soft[axis][sample])).collect();
        let total: f64 = samples.iter().map(|sample| sample.thrusts.iter().sum::<f64>()).sum();
        Self {
            samples,
            forces: samples.iter().map(|sample| sample.force.unwrap_or_default() / scale).collect(),
            velocities: if flown.is_felt { velocities } else { softer },
            is_soft: !flown.is_felt,
            mean_thrust: total / samples.len() as f64,
        }
    }

    /// S, N, of each sample.
    fn sums(&self, lags: [f64; 2]) -> Vec<f64> {
        let sums: Vec<f64> = lagged(self.samples, lags).iter().map(|thrusts| thrusts.iter().sum()).collect();
        if self.is_soft { softened(&sums) } else { sums }
    }

    /// The sums of each part with these lags; with the lags as unknowns too, if so.
    fn parts(&self, lags: [f64; 2], with_lags: bool) -> Parts {
        let thrusts = self.sums(lags);
        let slopes: Vec<Vec<f64>> = if with_lags {
            let moved = |which: usize| {
                let mut lags = lags;
                lags[which] += LAG_SLOPE_S;
                self.sums(lags).iter().zip(&thrusts).map(|(moved, here)| (moved - here) / LAG_SLOPE_S).collect()
            };
            vec![moved(0), moved(1)]
        } else {
            Vec::new()
        };
        let rise = if with_lags { self.rise(&thrusts) } else { 0.0 };
        let mut parts = Parts::new(LAGS_INDEX + slopes.len());
        for sample in UNKNOWN_START_SAMPLES..self.samples.len() {
            let mut row = DVector::zeros(LAGS_INDEX + slopes.len());
            row[part_of(sample, self.samples.len())] = 1.0;
            row[RESPONSE_INDEX] = thrusts[sample] - self.mean_thrust;
            row[DRAG_INDEX] = -self.velocities[sample].z;
            for (which, slope) in slopes.iter().enumerate() {
                row[LAGS_INDEX + which] = rise * slope[sample];
            }
            parts.add(sample, self.samples.len(), &row, self.forces[sample].z);
        }
        parts
    }

    /// s, of a fit without lags as unknowns.
    fn rise(&self, thrusts: &[f64]) -> f64 {
        let (mut along, mut square) = (0.0, 0.0);
        let mean = self.forces.iter().map(|force| force.z).sum::<f64>() / self.forces.len() as f64;
        for (force, thrust) in self.forces.iter().zip(thrusts) {
            let apart = thrust - self.mean_thrust;
            along += apart * (force.z - mean);
            square += apart * apart;
        }
        along / square.max(f64::MIN_POSITIVE)
    }

    /// The sum of squares that these lags leave.
    fn left(&self, lags: [f64; 2]) -> f64 {
        let solved = self.parts(lags, false).whole().and_then(|whole| whole.solved());
        solved.map_or(f64::INFINITY, |(_, left)| left)
    }

    /// The best lags of the grid: first alike, then apart.
    fn searched(&self) -> Result<[f64; 2], String> {
        let best = |pairs: &mut dyn Iterator<Item = [i32; 2]>| {
            let tried = pairs.map(|steps| (self.left(steps.map(|step| f64::from(step) * LAG_STEP_S)), steps));
            tried.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, steps)| steps)
        };
        let alike = best(&mut (0..=LAG_MAX_STEPS).map(|step| [step, step])).ok_or("shows no lag")?;
        let near = |middle: i32| (middle - APART_MAX_STEPS).max(0)..=middle + APART_MAX_STEPS;
        let apart = best(&mut near(alike[0]).flat_map(|up| near(alike[1]).map(move |down| [up, down])));
        Ok(apart.unwrap_or(alike).map(|step| f64::from(step) * LAG_STEP_S))
    }

    /// A step of Gauss and Newton for the lags.
    fn stepped(&self, lags: [f64; 2]) -> Result<[f64; 2], String> {
        let solved = self.parts(lags, true).whole().and_then(|whole| whole.solved());
        let (unknowns, _) = solved.ok_or("shows no lag")?;
        let step = |which: usize| unknowns[LAGS_INDEX + which].clamp(-LAG_STEP_S, LAG_STEP_S);
        Ok([0, 1].map(|which| (lags[which] + step(which)).max(0.0)))
    }

    fn drag_across(&self, axis: usize) -> Result<Shown, String> {
        let mut parts = Parts::new(2);
        for sample in UNKNOWN_START_SAMPLES..self.samples.len() {
            let row = DVector::from_vec(vec![-self.velocities[sample][axis], 1.0]);
            parts.add(sample, self.samples.len(), &row, self.forces[sample][axis]);
        }
        Ok(parts.shown(|unknowns| unknowns[0]).ok_or("shows no drag")?)
    }

    /// RMS of f_z about its mean, m/s^2.
    fn variation(&self) -> f64 {
        let count = self.forces.len() as f64;
        let mean = self.forces.iter().map(|force| force.z).sum::<f64>() / count;
        (self.forces.iter().map(|force| (force.z - mean).powi(2)).sum::<f64>() / count).sqrt()
    }
}
