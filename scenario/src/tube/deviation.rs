//! By how much at most a vehicle and its law differ from the loops that [`super`] adds up, while every signal stays
//! within a bound. Section numbers are those of `docs/recovery.md`, which derives each line. SI units.
//!
//! The motion is in one vertical plane: along x and z. e is the angle from the desired thrust axis to the thrust axis,
//! c and y the filters, lambda = atan(c_x / (g + c_z)) the desired tilt.

use super::bounds::{Deviation, Peaks};
use crate::sampled_loop::disturbed::Input;
use controller_core::configuration::{Configuration, ExtendedLaw};
use controller_core::extended::budget::TorqueBudget;
use core::ops::{Add, Mul};
use nalgebra::Vector3;

/// A bound on a number, on its change within a tick, and on h^2 times its second derivative.
#[derive(Debug, Clone, Copy)]
struct Moving {
    value: f64,
    step: f64,
    bend: f64,
}

impl Mul for Moving {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            step: self.step * other.value + self.value * other.step,
            bend: self.bend * other.value + 2.0 * self.step * other.step + self.value * other.bend,
        }
    }
}

impl Add for Moving {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, step: self.step + other.step, bend: self.bend + other.bend }
    }
}

/// Forces that the loops do not have, m/s^2: the estimate knows of the thrust that makes them, but for `mistaken`;
/// across and along the vertical. There one comes and goes, and is uneven within a tick.
struct Forces {
    unseen: [f64; 2],
    mistaken: [f64; 2],
    shaken: f64,
    uneven: f64,
}

/// A vehicle and its law.
#[derive(Debug, Clone)]
pub struct Plane<'a> {
    pub(super) configuration: &'a Configuration,
    pub(super) law: &'a ExtendedLaw,
    pub(super) budget: TorqueBudget,
    /// J about the axis that tilts in this plane, kg m^2.
    pub(super) inertia: f64,
    pub(super) ages: Ages,
}

/// Times, s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ages {
    /// Of a tick.
    pub period: f64,
    /// How long ago, on average over a tick, what an actuator delivers was commanded, and at most half of a tick
    /// before.
    pub acting: f64,
    /// By how much the law's model of that is off.
    pub unknown: f64,
}

impl<'a> Plane<'a> {
    pub fn new(configuration: &'a Configuration, law: &'a ExtendedLaw, inertia: f64, ages: Ages) -> Self {
        let budget = TorqueBudget::new(law.parameters.floor_margin, configuration.limits(), configuration.rotors());
        Self { configuration, law, budget, inertia, ages }
    }

    /// A bound on ubar along the vertical, m/s^2: feedback saturates what it wants, less the force.
    fn vertical_feedback(&self, vertical: &Peaks) -> f64 {
        vertical.wanted + f64::from(self.law.parameters.k_p_vertical) * vertical.z_1 + vertical.force
    }

    pub(super) fn gravity(&self) -> f64 {
        self.configuration.vehicle().gravity.into()
    }

    /// U, m/s^2, beside the bias that is estimated at most.
    pub(super) fn acceleration_max(&self, across: &Peaks) -> f64 {
        let bias = Vector3::new((across.bias * self.inertia) as f32, 0.0, 0.0);
        let ceiling = self.budget.ceiling(self.configuration.vehicle(), self.configuration.limits());
        f64::from(ceiling.at(1.0, &bias))
    }

    /// Section 3: k_v z_2 + phi(z_1) saturated, beside k_p z_1 + k_v z_2.
    fn saturated(peaks: &Peaks, [k_p, k_v]: [f64; 2], speed: f64, braking: f64, level: f64) -> f64 {
        let answering = k_v / k_p;
        let factor = 2.0 / (answering + (answering * answering + 2.0 * peaks.z_1 / (braking * level)).sqrt());
        let approach = factor * speed / speed.hypot(factor * peaks.z_1);
        let lacking = k_v * peaks.z_1 * (k_p / k_v - approach).max(0.0);
        let most = peaks.wanted + lacking;
        lacking + most * (1.0 - level / level.hypot(most))
    }

    /// The levels of feedback across and along the vertical.
    pub(super) fn levels(&self, across: &Peaks, vertical: &Peaks) -> [f64; 2] {
        let p = &self.law.parameters;
        let [a_across, a_down, tilt_max] = [p.a_across, p.a_down, p.tilt_max].map(f64::from);
        let max = self.acceleration_max(across);
        let g = self.gravity();
        let up_or_down = (max - g).min(a_down) - vertical.force;
        // ubar_z is s(...) - d, and s is no longer than what it saturates; the reach is least at an end.
        let lift = self.vertical_feedback(vertical);
        let reach = [g - lift, g + lift]
            .map(|lift| {
                a_across.min(0.95 * lift * tilt_max.tan()).min(0.95 * (max * max - lift * lift).max(0.0).sqrt())
            })
            .into_iter()
            .fold(f64::INFINITY, f64::min);
        [reach - across.force, up_or_down]
    }

    /// What differs across and along the vertical, for signals within these bounds.
    pub fn deviations(&self, across: &Peaks, vertical: &Peaks) -> [Deviation; 2] {
        let p = &self.law.parameters;
        let [level_across, level_vertical] = self.levels(across, vertical);
        let gains = |k_p: f32, k_v: f32| [k_p.into(), k_v.into()];
        let speed = f64::from(p.v_up.min(p.v_down));
        let feedback = [
            Self::saturated(
                across,
                gains(p.k_p_across, p.k_v_across),
                p.v_across.into(),
                p.braking_across.into(),
                level_across,
            ),
            Self::saturated(
                vertical,
                gains(p.k_p_vertical, p.k_v_vertical),
                speed,
                p.braking_vertical.into(),
                level_vertical,
            ),
        ];
        let bend = self.bend(across, vertical);
        let Forces { unseen, mistaken, shaken, uneven } = self.forces(across, vertical, bend.value);
        let [feedback_across, feedback_vertical] = feedback;
        [
            Deviation::of([
                (Input::Feedback, feedback_across),
                (Input::Command, self.torque(across)),
                (Input::Estimate, mistaken[0]),
                (Input::Unseen, unseen[0]),
                (Input::Bend, bend.value),
                // A tick begins with the mean less half of the change until the next begins: half of that is taken back
                // then. Beside it there is a trapezoid's error, and half of a jump.
                (Input::Late, 0.5 * bend.value),
                (Input::Stray, bend.bend / 12.0 + 0.5 * self.jump(across, vertical)),
                (Input::Uneven, bend.step),
            ]),
            Deviation::of([
                (Input::Feedback, feedback_vertical),
                (Input::Estimate, mistaken[1]),
                (Input::Unseen, unseen[1]),
                (Input::Shaken, shaken),
                (Input::Uneven, uneven),
            ]),
        ]
    }

    /// How fast at most the velocity changes across and along the vertical, m/s^2.
    pub fn accelerations(
        &self,
        [across, vertical]: [&Peaks; 2],
        taken: &[Deviation; 2],
        [gust_across, gust_vertical]: [f64; 2],
    ) -> [f64; 2] {
        // An unseen force is at most twice its mean.
        let [pushed, lifted] = taken.map(|taken| 2.0 * taken.at(Input::Unseen));
        let delivered = vertical.behind + taken[1].at(Input::Actuator) + taken[1].at(Input::Uneven);
        [
            across.desired[0] + self.gravity() * across.error[0] + pushed + gust_across,
            vertical.desired[0] + delivered + lifted + gust_vertical,
        ]
    }

    /// Section 4: the forces that the loops do not have, and by how much the estimate mistakes them, across and along
    /// the vertical.
    fn forces(&self, across: &Peaks, vertical: &Peaks, bend: f64) -> Forces {
        let Ages { period: h, acting, unknown } = self.ages;
        let g = self.gravity();
        let [c, c_rate, c_acceleration] = across.desired;
        let [y, y_rate, _] = self.vertical_filters(vertical);
        let ([e, e_rate], least) = (across.error, g - y);
        // tan lambda, sin of the thrust axis' tilt, and how fast both turn.
        let tangent = c / least;
        let lean = tangent + e;
        let turning = (c_rate + y_rate * tangent) / least;
        let leaning = turning + e_rate;
        // How fast the thrust's command changes: y, 1 / cos lambda and cos e do.
        let per_cosine = 1.0f64.hypot(tangent);
        let thrust = (g + y) * per_cosine;
        let thrust_rate = per_cosine * (y_rate + (g + y) * (tangent * turning + e_rate * e));
        let beside = 2.0 * y * tangent;
        let pushed = beside + c * e * e + y * e + 0.67 * g * e * e * e + thrust_rate * acting * lean;
        // How far the thrust is from g, either way.
        let beside_g = (thrust - g).max(y + 0.5 * g * e * e);
        // An interval's mean, and that of its two ends: a twelfth of h^2 times a second derivative.
        let turned = across.turned + bend + c_acceleration / g;
        let uneven = h * h / 12.0;
        // Along the vertical the thrust's part that lags behind the tilt is g (1 - cos beta), between zero and this,
        // later less now; the rest of the thrust lags behind it as well.
        let sunk = 0.5 * g * lean * lean;
        let lifted = (g + y) * e * e
            + (c + beside) * e
            + beside_g * lean * leaning * acting
            + g * uneven * (leaning * leaning + lean * turned);
        let mistaken = thrust_rate * (unknown * lean + 0.25 * h * h * leaning)
            + g * uneven * (0.5 * lean * lean * turned + lean * leaning * leaning + bend)
            + beside_g * uneven * (turned + lean * leaning * leaning);
        let mislifted = unknown * (thrust_rate * lean * lean + thrust * (tangent * turning + e * e_rate))
            + 0.25 * h * h * thrust_rate * lean * leaning
            + thrust * uneven * (leaning * leaning + lean * turned);
        Forces {
            unseen: [pushed, lifted],
            mistaken: [mistaken, mislifted],
            // Held over a tick, it is off a straight line by an eighth of h^2 times how fast it changes.
            shaken: 0.5 * sunk * acting / h + 0.125 * h * g * lean * leaning,
            uneven: 2.0 * thrust * lean * leaning * acting,
        }
    }

    /// |y|, |c_z'| and |c_z''| of the filters behind y: x and c follow it, so they stay within its bound, and change no
    /// faster.
    pub(super) fn vertical_filters(&self, vertical: &Peaks) -> [f64; 3] {
        let [y, y_rate, _] = vertical.desired;
        [y, y_rate, 2.0 * f64::from(self.law.parameters.k_f) * y_rate]
    }

    /// cos lambda / n beside 1 / g, and sin lambda / n, for |c| and the least g + c_z.
    fn slopes(&self, c: f64, c_z: f64) -> [f64; 2] {
        let g = self.gravity();
        let least = g - c_z;
        [c_z / (g * least) + c * c / (least * (least * least + c * c)), c / (least * least)]
    }

    /// By how much the bend jumps where c'' does.
    fn jump(&self, across: &Peaks, vertical: &Peaks) -> f64 {
        let [c_z, z_rate, _] = self.vertical_filters(vertical);
        let [along, beside] = self.slopes(across.desired[0], c_z);
        // x' follows y' by 1 - e^(-k_s h) in a tick, and c'' = k_f (x' - c').
        let p = &self.law.parameters;
        let follows = -(-f64::from(p.k_s) * self.ages.period).exp_m1();
        along * across.jump + beside * 2.0 * follows * f64::from(p.k_f) * z_rate
    }

    /// Section 5: lambda'' beside c_x'' / g,
    ///
    /// (cos lambda / n - 1 / g) c_x'' - sin lambda / n c_z'' - 2 r p / n,  r = rho . u',  p = lambda'.
    fn bend(&self, across: &Peaks, vertical: &Peaks) -> Moving {
        let h = self.ages.period;
        let [c, rate, acceleration] = across.desired;
        let [c_z, z_rate, z_acceleration] = self.vertical_filters(vertical);
        let least = self.gravity() - c_z;
        let tangent = c / least;
        let sine = tangent / 1.0f64.hypot(tangent);
        // Within a tick c'' goes back towards zero by k_f h of itself.
        let fades = h * f64::from(self.law.parameters.k_f);
        let fading = |value: f64| Moving { value, step: fades * value, bend: fades * fades * value };
        // How far u moves, over n: so far, at most, its direction turns, and n changes relative to itself.
        let moved = h * (rate + z_rate) / least;
        let bent = h * h * (acceleration + z_acceleration) / least + moved * moved;
        let [along, beside] = self.slopes(c, c_z);
        // cos lambda / n changes by 2 c / n^3 for each unit of c, and by 1 / n^2 for each of c_z.
        let along = Moving {
            value: along,
            step: h * (2.0 * tangent * rate + z_rate) / (least * least),
            bend: h * h * (2.0 * tangent * acceleration + z_acceleration) / (least * least)
                + 6.0 * moved * moved / least,
        };
        let beside = Moving { value: beside, step: moved / least, bend: (bent + 6.0 * moved * moved) / least };
        let [step, z_step] = [h * acceleration, h * z_acceleration];
        let (both, steps) = (rate + z_rate, step + z_step);
        let growing = Moving {
            value: rate * sine + z_rate,
            step: step * sine + z_step + both * moved,
            bend: fades * steps + 2.0 * steps * moved + both * bent,
        };
        let across_u = Moving {
            value: rate + z_rate * sine,
            step: step + z_step * sine + both * moved,
            bend: fades * steps + 2.0 * steps * moved + both * bent,
        };
        let per_length = Moving { value: 1.0 / least, step: moved / least, bend: (bent + 2.0 * moved * moved) / least };
        let twice = Moving { value: 2.0, step: 0.0, bend: 0.0 };
        along * fading(acceleration)
            + beside * fading(z_acceleration)
            + twice * growing * across_u * per_length * per_length
    }

    /// Section 6: the tilt's torque over the moment of inertia beside the linear one.
    fn torque(&self, across: &Peaks) -> f64 {
        let p = &self.law.parameters;
        let [k_tilt, damping, r_0] = [p.k_tilt, p.k_omega_t, p.r_0].map(f64::from);
        let late = f64::from(self.law.actuators.lag + self.law.actuators.delay);
        // The projected angle: twice the arc tangent of T e' / 2.
        let [projected, projected_rate] = across.projected;
        let turned = (late * across.error[1]).powi(3) / 12.0;
        let angle = projected + turned;
        let quarter = (0.25 * angle).tan();
        let level = self.pull_level(across);
        let pulled = k_tilt * quarter;
        let ratio = (4.0 * quarter / angle - 1.0).max(1.0 - level / level.hypot(pulled)).max(0.0);
        let pull = if angle > 0.0 { 0.25 * k_tilt * (turned + angle * ratio) } else { 0.0 };
        let eased = 1.0 + ((0.5 * angle).sin() / r_0).powi(2);
        (pull + damping * projected_rate * (1.0 - eased.powf(-0.25))) / self.inertia
    }

    /// M, N m, beside the torque bias.
    fn pull_level(&self, across: &Peaks) -> f64 {
        let p = &self.law.parameters;
        let level = f64::from(p.m_tilt);
        level.min(0.999 * self.budget.radius(1.0) - across.bias * self.inertia - self.reserve()).max(0.05 * level)
    }

    pub(super) fn reserve(&self) -> f64 {
        let inertia = self.configuration.vehicle().inertia;
        f64::from(inertia.x.max(inertia.y)) * f64::from(self.law.parameters.turn_reserve)
    }
}
