//! The position law: feedback gets the part of the envelope that the wind does not use, and the horizontal the part
//! that the vertical does not use. Section 1 of
//! `docs/extended-law.md`.
//!
//! c is the part of u that is neither gravity nor reference, x the filter before it, y the one before that, d the
//! observed force per mass (section 2). The paper has two filters; the third takes the noise of measurements out of
//! u'', which turns the vehicle. Filters bound how the direction of u turns. Thrust needs no such bound, so along the
//! vertical it takes y, the first filter's output, at once:
//!
//! | here | equation |
//! |---|---|
//! | across: `z_1` = p~ + (1/k_f + 1/k_s + 1/k_d) v~ + (1/k_s + 1/k_d) (c + d) / k_f + (x + d) / (k_s k_d) | the paper's (9) for three filters |
//! | `z_2` = v~ + (c + d) / k_f + (x + d) / k_s + (y + d) / k_d | |
//! | along the vertical: `z_1` = p~ + v~ / k_d, `z_2` = v~ + (y + d) / k_d | the same for one filter |
//! | phi(z_1) = k_v s(v(z_1); v_c) | [`Approach`], which brakes with a share of the level M that pulls back |
//! | `feedback` = -s(phi(z_1) + k_v z_2; M) - d | ubar |
//! | s(x; M) = M x / sqrt(M^2 + \|x\|^2) | [`super::saturation`]: radial across |
//! | M_z+ = U - g + d_z upwards, M_z- = A_- - d_z downwards | the vertical gets the part that the force does not use |
//! | M_h = min(A_h, u_z tan gamma, sqrt(U^2 - u_z^2)) - \|d_h\|, u_z = g + ubar_z | across gets the part that the vertical does not use |
//! | c' = k_f (x - c), x' = `drive`, wanted: k_s (y - x), y' = k_d (ubar - y) | the paper's (7); [`super::direction_limiter`] may change the drive |
//!
//! So ubar is in the envelope -A_- <= ubar_z <= U - g, |g e3 + ubar| <= U, |ubar_h| <= A_h, and every level is as wide
//! as that allows. Where d leaves less than the least level, 0.3 m/s^2, the least level holds and ubar may be outside;
//! [`super::direction_limiter`] bounds u itself. World frame; accelerations in m/s^2. The theorems on ubar need only
//! that s is monotone, has a slope of at most one and the sign of its argument.

use super::approach::Approach;
use super::parameters::ExtendedParameters;
use crate::error::{ParameterError, Reason, require, require_positive};
use crate::math;
use crate::position::FilterTransition;
use crate::reference::Reference;
use crate::state::State;
use core::hint::cold_path;
use nalgebra::{Vector2, Vector3};

/// The least level of a feedback, m/s^2, where a force takes the whole envelope.
const LEVEL_MIN_M_PER_S2: f32 = 0.3;

/// The share of tilt and horizontal thrust for the feedback: the reference needs the rest.
const SHARE_ACROSS: f32 = 0.95;

/// The filters' states, m/s^2, world frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Filters {
    /// c.
    pub command: Vector3<f32>,
    /// x.
    pub intermediate: Vector3<f32>,
    /// y.
    pub smoothed: Vector3<f32>,
}

impl Filters {
    /// All three at `value`.
    pub const fn at(value: Vector3<f32>) -> Self {
        Self { command: value, intermediate: value, smoothed: value }
    }
}

/// How far x may be, in U: a reference within what the rotors hold needs two at most.
const FILTER_REACH: f32 = 2.0;

/// The errors that the feedback sees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PositionErrors {
    /// p~, m.
    pub position: Vector3<f32>,
    /// v~, m/s.
    pub velocity: Vector3<f32>,
    /// z_1, m.
    pub z_1: Vector3<f32>,
    /// z_2, m/s.
    pub z_2: Vector3<f32>,
}

/// The position law's command, with the quantities on the way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PositionFeedback {
    /// What it answers.
    pub errors: PositionErrors,
    /// ubar, m/s^2.
    pub feedback: Vector3<f32>,
    /// c', m/s^3.
    pub rate: Vector3<f32>,
    /// y at the next tick, m/s^2.
    pub smoothed: Vector3<f32>,
    /// The drive that the law wants, m/s^3.
    pub drive: Vector3<f32>,
}

/// The greatest levels of feedback, whatever the envelope leaves, m/s^2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FeedbackLimits {
    /// Upwards.
    pub up: f32,
    /// Downwards.
    pub down: f32,
    /// Across.
    pub across: f32,
}

impl FeedbackLimits {
    /// What the envelope leaves.
    pub const UNLIMITED: Self = Self::each(f32::MAX);

    /// The same every way.
    pub const fn each(level: f32) -> Self {
        Self { up: level, down: level, across: level }
    }
}

/// The position law's constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PositionLaw {
    /// 1 / k_f, 1 / k_s, 1 / k_d and their sum, s.
    lags: [f32; 3],
    all_lags: f32,
    /// (1/k_s + 1/k_d) / k_f and 1 / (k_s k_d), s^2.
    products: [f32; 2],
    /// k_f, 1/s.
    k_f: f32,
    /// (1 - e^(-k_s h)) / h, 1/s: brings x to y as its filter would.
    k_s_held: f32,
    /// 1 - e^(-k_d h).
    smoothing: f32,
    period: f32,
    /// 1 - e^(-k_f h), and h - (1 - e^(-k_f h)) / k_f, s: the step of c.
    towards: f32,
    ramp: f32,
    k_v_across: f32,
    k_v_vertical: f32,
    approach_across: Approach,
    approach_up: Approach,
    approach_down: Approach,
    /// The share of a level that the approach counts to brake with, across and along the vertical.
    braking: [f32; 2],
    a_across: f32,
    a_down: f32,
    tangent: f32,
    gravity: f32,
}

impl PositionLaw {
    /// Under `gravity`, m/s^2, for steps of `period`, s.
    ///
    /// # Errors
    /// Names `control.period` if it is outside (0, 0.1].
    pub fn new(parameters: &ExtendedParameters, gravity: f32, period: f32) -> Result<Self, ParameterError> {
        let p = parameters;
        require_positive(period, "control.period")?;
        let longest = FilterTransition::PERIOD_MAX_S;
        require(period <= longest, "control.period", Reason::Above(longest))?;
        let lags = [p.k_f, p.k_s, p.k_d].map(|bandwidth| 1.0 / bandwidth);
        let [of_command, of_intermediate, of_smoothed] = lags;
        let gone = |bandwidth: f32| -math::exp_m1(-f64::from(bandwidth) * f64::from(period));
        let towards = gone(p.k_f);
        Ok(Self {
            lags,
            all_lags: of_command + of_intermediate + of_smoothed,
            products: [(of_intermediate + of_smoothed) * of_command, of_intermediate * of_smoothed],
            k_f: p.k_f,
            k_s_held: (gone(p.k_s) / f64::from(period)) as f32,
            smoothing: gone(p.k_d) as f32,
            period,
            towards: towards as f32,
            ramp: (f64::from(period) - towards / f64::from(p.k_f)) as f32,
            k_v_across: p.k_v_across,
            k_v_vertical: p.k_v_vertical,
            approach_across: Approach::new(p.k_p_across, p.k_v_across, p.v_across),
            approach_up: Approach::new(p.k_p_vertical, p.k_v_vertical, p.v_up),
            approach_down: Approach::new(p.k_p_vertical, p.k_v_vertical, p.v_down),
            braking: [p.braking_across, p.braking_vertical],
            a_across: p.a_across,
            a_down: p.a_down,
            tangent: math::tan(f64::from(p.tilt_max)) as f32 * SHARE_ACROSS,
            gravity,
        })
    }

    /// k_f, 1/s.
    pub fn k_f(&self) -> f32 {
        self.k_f
    }

    /// Evaluates the law at one instant; the filters are read, not advanced. `force` is d, `max` U, m/s^2.
    #[inline(always)] // into the law's step
    pub fn feedback(
        &self,
        state: &State,
        reference: &Reference,
        filters: &Filters,
        force: &Vector3<f32>,
        max: f32,
        most: &FeedbackLimits,
    ) -> PositionFeedback {
        let errors = self.errors(state, reference, filters, force);
        self.passed_on(&errors, filters, self.saturated([&errors.z_1, &errors.z_2], force, max, most))
    }

    /// The same with a demand in place of feedback: `wanted`, m/s^2, cut to the envelope.
    #[inline(always)] // likewise
    pub fn feedback_on_demand(
        &self,
        state: &State,
        reference: &Reference,
        filters: &Filters,
        force: &Vector3<f32>,
        max: f32,
        wanted: &Vector3<f32>,
    ) -> PositionFeedback {
        self.passed_on(&self.errors(state, reference, filters, force), filters, self.within(wanted, max))
    }

    /// p~, v~, z_1 and z_2.
    #[inline(always)]
    pub fn errors(
        &self,
        state: &State,
        reference: &Reference,
        filters: &Filters,
        force: &Vector3<f32>,
    ) -> PositionErrors {
        let Filters { command: c, intermediate: x, smoothed: y } = filters;
        let (p, v) = (state.position - reference.position, state.velocity - reference.velocity);
        let [of_command, of_intermediate, of_smoothed] = self.lags;
        let [with_command, with_intermediate] = self.products;
        let (c_d, x_d, y_d) = (c + force, x + force, y + force);
        let mut z_1 = p + v * self.all_lags + c_d * with_command + x_d * with_intermediate;
        let mut z_2 = v + c_d * of_command + x_d * of_intermediate + y_d * of_smoothed;
        z_1.z = p.z + v.z * of_smoothed;
        z_2.z = v.z + y_d.z * of_smoothed;
        PositionErrors { position: p, velocity: v, z_1, z_2 }
    }

    /// Passes ubar, `feedback`, on to the filters.
    #[inline(always)]
    fn passed_on(&self, errors: &PositionErrors, filters: &Filters, feedback: Vector3<f32>) -> PositionFeedback {
        let Filters { intermediate: x, smoothed: y, .. } = filters;
        let smoothed = y + (feedback - y) * self.smoothing;
        PositionFeedback {
            errors: *errors,
            feedback,
            rate: self.rate(filters),
            smoothed,
            drive: (smoothed - x) * self.k_s_held,
        }
    }

    /// How far ubar may reach across, m/s^2, where `lift` is g + ubar_z.
    #[inline(always)]
    fn reach(&self, lift: f32, max: f32) -> f32 {
        let thrust_left = math::sqrt(math::max(max * max - lift * lift, 0.0)) * SHARE_ACROSS;
        math::min(self.a_across, math::min(lift * self.tangent, thrust_left))
    }

    /// A demand cut to the envelope: the vertical first, then what it leaves across.
    fn within(&self, wanted: &Vector3<f32>, max: f32) -> Vector3<f32> {
        let vertical = math::max(math::min(wanted.z, max - self.gravity), -self.a_down);
        let reach = math::max(self.reach(self.gravity + vertical, max), 0.0);
        let length = math::sqrt(wanted.xy().norm_squared());
        let share = if length > reach { reach / length } else { 1.0 };
        Vector3::new(wanted.x * share, wanted.y * share, vertical)
    }

    /// The filters' states where the law has long commanded `wanted`, m/s^2, changing it by `rate`, m/s^3: each cut to
    /// the envelope.
    pub fn filters_at(&self, wanted: &Vector3<f32>, rate: &Vector3<f32>, max: f32) -> Filters {
        let [of_command, of_intermediate, _] = self.lags;
        let ahead = |time: f32| self.within(&(wanted + rate * time), max);
        Filters { command: ahead(0.0), intermediate: ahead(of_command), smoothed: ahead(of_command + of_intermediate) }
    }

    /// c', m/s^3.
    #[inline(always)]
    pub fn rate(&self, filters: &Filters) -> Vector3<f32> {
        (filters.intermediate - filters.command) * self.k_f
    }

    /// ubar.
    #[inline(always)] // into the step, also where a shield has a step of its own
    fn saturated(
        &self,
        [z_1, z_2]: [&Vector3<f32>; 2],
        force: &Vector3<f32>,
        max: f32,
        most: &FeedbackLimits,
    ) -> Vector3<f32> {
        let [braking_across, braking_vertical] = self.braking;
        let up = math::max(max - self.gravity + force.z, LEVEL_MIN_M_PER_S2);
        let down = math::max(self.a_down - force.z, LEVEL_MIN_M_PER_S2);
        let (up, down) = (math::min(up, most.up), math::min(down, most.down));
        // Above the reference the vehicle descends, and what pushes up brakes it.
        let (approach, braking) = if z_1.z > 0.0 { (&self.approach_down, up) } else { (&self.approach_up, down) };
        let closing = z_1.z * approach.factor(z_1.z * z_1.z, braking_vertical * braking);
        let vertical = (z_2.z + closing) * self.k_v_vertical;
        let level = if vertical > 0.0 { down } else { up };
        let vertical = -vertical * unit_factor(level, vertical * vertical) - force.z;

        let reach = self.reach(self.gravity + vertical, max);
        let (across, wind) = (z_1.xy(), force.xy());
        let level = math::max(reach - math::sqrt(wind.norm_squared()), LEVEL_MIN_M_PER_S2);
        let level = math::min(level, most.across);
        let closing = across * self.approach_across.factor(across.norm_squared(), braking_across * level);
        let wanted = (z_2.xy() + closing) * self.k_v_across;
        let across: Vector2<f32> = -wanted * unit_factor(level, wanted.norm_squared()) - wind;
        Vector3::new(across.x, across.y, vertical)
    }

    /// The filters' states one period later, with `drive` held and y at `smoothed`, where U is `max`. c_z never
    /// falls below -A_-, to the last bit; x_z does not lead it there. x stays within `FILTER_REACH` U along each axis,
    /// and c with it: a reference whose derivatives fit no motion cannot drive them away.
    pub fn advance(&self, filters: &Filters, smoothed: &Vector3<f32>, drive: &Vector3<f32>, max: f32) -> Filters {
        let Filters { command: c, intermediate: x, .. } = filters;
        let (mut drive, mut intermediate) = (*drive, x + drive * self.period);
        let farthest = FILTER_REACH * max;
        let near = intermediate.amax() <= farthest;
        if !near {
            cold_path();
            intermediate = intermediate.map(|x| math::saturate(x, farthest));
            drive = (intermediate - x) / self.period;
        }
        let mut command = c + ((x - c) * self.towards + drive * self.ramp);
        if command.z < -self.a_down {
            cold_path();
            command.z = -self.a_down;
            intermediate.z = math::max(intermediate.z, -self.a_down);
        }
        Filters { command, intermediate, smoothed: *smoothed }
    }
}

/// What makes s(x; `level`) of a vector x with this `square`.
fn unit_factor(level: f32, square: f32) -> f32 {
    level / math::sqrt(level * level + square)
}

mod stopping;
