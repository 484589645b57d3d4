//! How late poses are beside the vehicle's own sensors, moment by moment.
//!
//! Motion capture and the vehicle write their times by different clocks, and a radio link between them stalls. Both saw
//! the same body turn: with the gyro's rates omega and the poses' attitudes q,
//!
//! ```text
//! G(t) = integral of omega dt          P(s) = sum of log(q_j^-1 q_j+1) up to s          both along the body's axes
//! P(s) = G(s + d) + a + b s + noise    within a second: a is where they began, b the gyro's bias
//! ```
//!
//! For each of many instants, a quarter of a second apart, what is left of P - G without its straight line says how
//! well a delay d fits. The course of d is the one that fits best in all, with what it costs to change: the shortest
//! path through a grid of delays (R. Bellman). Nothing is differentiated. A vehicle that does not turn shows no delay.

use super::recording::of_row;
use super::series::Series;
use nalgebra::{UnitQuaternion, Vector3};

/// Between two samples, and two delays, s.
const STEP_S: f64 = 0.01;
/// Between two instants, s.
const NODE_S: f64 = 0.25;
/// The time within which a delay is constant, s.
const WINDOW_S: f64 = 1.0;
/// How far a delay may be from the whole flight's, s.
const WANDER_MAX_S: f64 = 0.3;
/// The greatest delay of a whole flight, s, and in which windows and steps it is sought.
const WHOLE_MAX_S: f64 = 3.0;
const WHOLE_WINDOW_S: f64 = 4.0;
/// What is left beside the right delay, rad: poses' noise, the gyro's between samples.
const NOISE_RAD: f64 = 0.004;
/// How many of a window's samples are news.
const NEWS_PER_WINDOW: f64 = 10.0;
/// By how much a delay changes from node to node, s.
const CHANGE_S: f64 = 0.02;
/// A constant delay that nobody expects, s.
const NOTABLE_S: f64 = 0.1;
/// The longest gap of a stream that is bridged, s.
pub const BRIDGED_MAX_S: f64 = 0.1;

/// The delays.
#[derive(Debug, Clone, PartialEq)]
pub struct Alignment {
    /// Of the first, on the poses' clock, s.
    start: f64,
    /// s: what a pose's time lacks to be the vehicle's.
    pub delays: Vec<f64>,
    /// The best constant one, s.
    pub whole: f64,
    /// What is left of the turning, RMS, rad: with the constant delay, and with these.
    pub left: [f64; 2],
    /// How much there was by the gyro, RMS, rad.
    pub turned: f64,
    /// The same over how much there was by poses.
    pub gyro_over_poses: f64,
    /// By how much the gyro turns more than poses on the whole, rad/s.
    pub gyro_bias: Vector3<f64>,
}

/// Both turnings on one grid of times.
struct Turnings {
    start: f64,
    gyro: Vec<Vector3<f64>>,
    pose: Vec<Option<Vector3<f64>>>,
}

impl Turnings {
    fn new(poses: &Series, imu: &Series) -> Self {
        let start = imu.first().max(poses.first());
        let count = ((imu.last().min(poses.last()) - start) / STEP_S).max(0.0) as usize;
        let (mut gyro, mut pose) = (Vec::with_capacity(count), Vec::with_capacity(count));
        let (mut turned, mut seen) = (Vector3::zeros(), Vector3::zeros());
        let mut before: Option<UnitQuaternion<f64>> = None;
        for sample in 0..count {
            let time = start + sample as f64 * STEP_S;
            gyro.push(turned);
            let rates = imu.at(time, BRIDGED_MAX_S).map_or_else(Vector3::zeros, |row| three(&row));
            turned += rates * STEP_S;
            let now = poses.at(time, BRIDGED_MAX_S).map(|row| of_row(&row).1);
            if let (Some(before), Some(now)) = (&before, &now) {
                seen += (before.inverse() * now).scaled_axis();
            }
            pose.push(now.map(|_| seen));
            before = now;
        }
        Self { start, gyro, pose }
    }

    /// The mean squared remainder of `count` poses from `first` on, if they are late by `delay` steps; none where one
    /// is missing.
    fn left(&self, first: usize, count: usize, delay: i64) -> Option<f64> {
        let mut sums = [0.0; 3];
        let mut along = [0.0; 3];
        let mut squares = 0.0;
        let middle = (count as f64 - 1.0) / 2.0;
        let mut spread = 0.0;
        let begin = usize::try_from(first as i64 + delay).ok()?;
        let (gyro, pose) = (self.gyro.get(begin..begin + count)?, self.pose.get(first..first + count)?);
        for (sample, (gyro, pose)) in gyro.iter().zip(pose).enumerate() {
            let apart = (*pose)? - gyro;
            let place = sample as f64 - middle;
            for axis in 0..3 {
                sums[axis] += apart[axis];
                along[axis] += apart[axis] * place;
            }
            squares += apart.norm_squared();
            spread += place * place;
        }
        let straight: f64 =
            (0..3).map(|axis| sums[axis] * sums[axis] / count as f64 + along[axis] * along[axis] / spread).sum();
        Some(((squares - straight) / count as f64).max(0.0))
    }

    /// The gyro's mean rate less that of the poses, over the longest run of poses that are late by `delay` steps.
    fn bias(&self, delay: i64) -> Vector3<f64> {
        let both = |sample: usize| {
            let gyro = self.gyro.get(usize::try_from(sample as i64 + delay).ok()?)?;
            Some((*self.pose.get(sample)?)? - gyro)
        };
        let first = (0..self.pose.len()).find_map(|sample| Some((sample, both(sample)?)));
        let last = (0..self.pose.len()).rev().find_map(|sample| Some((sample, both(sample)?)));
        match (first, last) {
            (Some((first, before)), Some((last, after))) if last > first => {
                (before - after) / ((last - first) as f64 * STEP_S)
            }
            _ => Vector3::zeros(),
        }
    }

    /// The mean square over the flight with one delay in windows of `count` samples.
    fn left_of_all(&self, count: usize, delay: i64) -> Option<f64> {
        let lefts: Vec<f64> =
            (0..self.gyro.len()).step_by(count / 2).filter_map(|first| self.left(first, count, delay)).collect();
        // A delay that leaves out half of the flight does not count.
        (lefts.len() * count > self.gyro.len()).then(|| lefts.iter().sum::<f64>() / lefts.len() as f64)
    }
}

impl Alignment {
    /// How late `poses` are beside an IMU's rates; none if the flight is too short or does not turn.
    pub fn new(poses: &Series, imu: &Series) -> Option<Self> {
        let turnings = Turnings::new(poses, imu);
        let steps = |seconds: f64| (seconds / STEP_S).round() as i64;
        let count = steps(WHOLE_WINDOW_S) as usize;
        let whole = (-steps(WHOLE_MAX_S)..=steps(WHOLE_MAX_S))
            .filter_map(|delay| Some((turnings.left_of_all(count, delay)?, delay)))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let (_, whole) = whole?;
        let window = steps(WINDOW_S) as usize;
        let wander = steps(WANDER_MAX_S);
        let delays: Vec<i64> = (whole - wander..=whole + wander).collect();
        let firsts: Vec<usize> =
            (0..turnings.gyro.len().saturating_sub(window)).step_by(steps(NODE_S) as usize).collect();
        let fits = |first: &usize| -> Vec<f64> {
            let cost = |delay: &i64| {
                // Where nothing is known, nothing is preferred.
                turnings.left(*first, window, *delay).map_or(0.0, |left| NEWS_PER_WINDOW * left / NOISE_RAD.powi(2))
            };
            delays.iter().map(cost).collect()
        };
        let costs: Vec<Vec<f64>> = firsts.iter().map(fits).collect();
        let course = shortest(&costs)?;
        let chosen: Vec<i64> = course.iter().filter_map(|index| delays.get(*index).copied()).collect();
        let mean_left = |delay: &dyn Fn(usize) -> i64| {
            let lefts: Vec<f64> = firsts
                .iter()
                .enumerate()
                .filter_map(|(node, first)| turnings.left(*first, window, delay(node)))
                .collect();
            (lefts.iter().sum::<f64>() / lefts.len().max(1) as f64).sqrt()
        };
        let chosen_at = |node: usize| chosen.get(node).copied().unwrap_or(whole);
        let by_gyro: Vec<Option<Vector3<f64>>> = turnings.gyro.iter().map(|turned| Some(*turned)).collect();
        let size = |turned: &[Option<Vector3<f64>>]| {
            let squares: Vec<f64> = firsts.iter().filter_map(|first| turned_within(turned, *first, window)).collect();
            (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
        };
        let turned = size(&by_gyro);
        Some(Self {
            start: turnings.start + WINDOW_S / 2.0,
            whole: whole as f64 * STEP_S,
            left: [mean_left(&|_| whole), mean_left(&chosen_at)],
            turned,
            gyro_bias: turnings.bias(whole),
            gyro_over_poses: turned / size(&turnings.pose).max(f64::MIN_POSITIVE),
            delays: refined(&costs, &course, &chosen),
        })
    }

    /// How late a pose is that has this time, s.
    pub fn of_pose(&self, time: f64) -> f64 {
        let place = ((time - self.start) / NODE_S).clamp(0.0, self.delays.len().saturating_sub(1) as f64);
        let before = place.floor() as usize;
        let share = place - before as f64;
        let delay = |index: usize| self.delays.get(index).or(self.delays.last()).copied().unwrap_or(self.whole);
        delay(before) * (1.0 - share) + delay(before + 1) * share
    }

    /// How late the pose is that was true at this time of the vehicle's clock, s.
    pub fn at(&self, time: f64) -> f64 {
        // What is sought changes slowly: a few steps towards it are enough.
        (0..4).fold(self.whole, |late, _| self.of_pose(time - late))
    }

    /// The least and the greatest delay, s.
    pub fn range(&self) -> [f64; 2] {
        let ends = |end: fn(f64, f64) -> f64, start: f64| self.delays.iter().copied().fold(start, end);
        [ends(f64::min, f64::INFINITY), ends(f64::max, f64::NEG_INFINITY)]
    }

    /// In words.
    pub fn described(&self) -> String {
        // A pose whose time must be set back is late.
        let [most, least] = self.range().map(|delay| -1e3 * delay);
        let [constant, wandering] = self.left.map(f64::to_degrees);
        let off = if self.whole.abs() > NOTABLE_S { "THE TIMES OF POSES ARE OFF: " } else { "" };
        format!(
            "{off}poses are {:.0} ms late beside the gyro, {least:.0} to {most:.0} ms as the flight goes on: put \
             right\n  (turning left over: {constant:.2} degrees with one delay, {wandering:.2} with these, of {:.2})",
            -1e3 * self.whole,
            self.turned.to_degrees()
        )
    }
}

/// How much `count` samples turn from `first` on, without their straight line: the mean square.
fn turned_within(turned: &[Option<Vector3<f64>>], first: usize, count: usize) -> Option<f64> {
    let pose = turned.get(first..first + count)?.to_vec();
    Turnings { start: 0.0, gyro: vec![Vector3::zeros(); count], pose }.left(0, count, 0)
}

/// For each node the index of its delay, on the way of least cost.
fn shortest(costs: &[Vec<f64>]) -> Option<Vec<usize>> {
    let change = (STEP_S / CHANGE_S).powi(2);
    let mut total = costs.first()?.clone();
    let mut ways: Vec<Vec<usize>> = Vec::with_capacity(costs.len());
    for cost in costs.iter().skip(1) {
        let best = |to: usize| {
            let through = |(from, before): (usize, &f64)| {
                let apart = to as f64 - from as f64;
                (before + change * apart * apart, from)
            };
            total.iter().enumerate().map(through).min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, to))
        };
        let reached: Vec<(f64, usize)> = (0..cost.len()).map(best).collect();
        ways.push(reached.iter().map(|(_, from)| *from).collect());
        total = reached.iter().zip(cost).map(|((before, _), here)| before + here).collect();
    }
    let mut place = (0..total.len()).min_by(|a, b| total[*a].total_cmp(&total[*b]))?;
    let mut course = vec![place];
    for way in ways.iter().rev() {
        place = *way.get(place)?;
        course.push(place);
    }
    course.reverse();
    Some(course)
}

/// Between the steps: where a parabola through the costs beside each choice is least.
fn refined(costs: &[Vec<f64>], course: &[usize], chosen: &[i64]) -> Vec<f64> {
    let refine = |((cost, place), delay): ((&Vec<f64>, &usize), &i64)| {
        let at = |index: usize| cost.get(index).copied();
        let beside = place.checked_sub(1).and_then(at).zip(at(*place)).zip(at(*place + 1));
        let moved = beside.map_or(0.0, |((before, here), after)| {
            let bend = before - 2.0 * here + after;
            if bend > 0.0 { (0.5 * (before - after) / bend).clamp(-0.5, 0.5) } else { 0.0 }
        });
        (*delay as f64 + moved) * STEP_S
    };
    costs.iter().zip(course).zip(chosen).map(refine).collect()
}

/// The first three numbers of a row.
pub fn three(row: &[f64]) -> Vector3<f64> {
    Vector3::from_fn(|axis, _| row.get(axis).copied().unwrap_or(0.0))
}
