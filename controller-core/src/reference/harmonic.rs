//! A cosine on each axis, and a heading that turns and swings: the paper's experiment and its relatives.
//!
//! p_i(t) = center_i + A_i cos(omega_i t + phi_i), so with c, s the cosine and sine of that phase the derivatives are
//! -A omega s, -A omega^2 c, A omega^3 s, A omega^4 c. psi(t) = psi_0 + r t + B sin(w t), psi' = r + B w cos(w t),
//! psi'' = -B w^2 sin(w t). World frame, SI units, radians.
//!
//! All phases are integers on the circle ([`Phase`]), so they are as good after a month as on the first day. The swing
//! B sin(w t) is computed in single precision: psi carries 3e-7 B, at most 3e-4 rad for the largest B accepted.
//!
//! Bounds: axes that share a frequency are combined exactly, sup over t of sum A_i^2 cos^2(omega t + phi_i) = (sum
//! A_i^2 + |sum A_i^2 e^(2 i phi_i)|) / 2, and the same for sines; axes of different frequencies are taken at their
//! worst together, which they may never quite meet.

use super::bernstein::Supremum;
use super::phase::{self, Phase};
use super::{DERIVATIVE_RANGE, Reference, ReferenceBounds, Trajectory, outwards};
use crate::error::{ParameterError, Reason, require};
use crate::heading::Heading;
use crate::math;
use crate::state::STATE_RANGE;
use nalgebra::{Vector2, Vector3};

/// Largest |center| and |amplitude|, m: both together are in the law's range.
const LENGTH_MAX_M: f64 = 0.5 * STATE_RANGE as f64;
/// Largest amplitude of one axis' acceleration, jerk and snap: three of them together are in the law's range.
const DERIVATIVE_MAX: f64 = 0.5 * DERIVATIVE_RANGE as f64;
/// Largest |r| and |B w|, rad/s: psi'^2 <= 6.4e5 and |psi''| <= [`DERIVATIVE_MAX`] stay in the law's range.
const HEADING_RATE_MAX_RAD_PER_S: f64 = 400.0;
/// Largest |B|, rad.
const SWING_MAX_RAD: f64 = 1000.0;
/// Relative error of a derivative evaluated in single precision, and of its bound: with u = 2^-24 a coefficient carries
/// u, the sine 2 u, their product u and a sum u; squares double that to 10 u = 6e-7, vector norms add 5 u.
const EVALUATION_ROUNDING: f64 = 2e-6;

/// psi(t) = offset + rate t + amplitude sin(frequency t).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeadingParameters {
    /// psi_0, rad.
    pub offset: f64,
    /// r, rad/s.
    pub rate: f64,
    /// B, rad.
    pub amplitude: f64,
    /// w, rad/s.
    pub frequency: f64,
}

/// p_i(t) = center_i + amplitude_i cos(frequency_i t + phase_i); see [`Harmonic`] for the validated form.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HarmonicParameters {
    /// Center of the motion, m.
    pub center: [f64; 3],
    /// A, m.
    pub amplitude: [f64; 3],
    /// omega, rad/s.
    pub frequency: [f64; 3],
    /// phi, rad.
    pub phase: [f64; 3],
    /// The heading's motion.
    pub heading: HeadingParameters,
}

/// Names of one axis' numbers, for errors.
struct Names {
    center: &'static str,
    amplitude: &'static str,
    frequency: &'static str,
    phase: &'static str,
}

const NAMES: [Names; 3] = [
    Names {
        center: "reference.center[0]",
        amplitude: "reference.amplitude[0]",
        frequency: "reference.frequency[0]",
        phase: "reference.phase[0]",
    },
    Names {
        center: "reference.center[1]",
        amplitude: "reference.amplitude[1]",
        frequency: "reference.frequency[1]",
        phase: "reference.phase[1]",
    },
    Names {
        center: "reference.center[2]",
        amplitude: "reference.amplitude[2]",
        frequency: "reference.frequency[2]",
        phase: "reference.phase[2]",
    },
];

/// Refuses anything but a finite number below `limit` in magnitude.
fn require_within(value: f64, limit: f64, field: &'static str) -> Result<(), ParameterError> {
    require(value.is_finite(), field, Reason::NotFinite)?;
    require(value.abs() < limit, field, Reason::NotBelow(limit as f32))
}

/// One axis: its phase, its center, and the amplitudes of position to snap with the signs of the derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Axis {
    phase: Phase,
    center: f32,
    amplitudes: [f32; 5],
}

impl Axis {
    fn new(center: f64, amplitude: f64, frequency: f64, phase: f64, names: &Names) -> Result<Self, ParameterError> {
        let phase = Phase::new(frequency, phase, names.frequency, names.phase)?;
        require_within(center, LENGTH_MAX_M, names.center)?;
        let omega2 = frequency * frequency;
        let steepest = omega2.max(omega2 * omega2);
        let limit = if steepest > 0.0 { LENGTH_MAX_M.min(DERIVATIVE_MAX / steepest) } else { LENGTH_MAX_M };
        require_within(amplitude, limit, names.amplitude)?;
        let velocity = amplitude * frequency;
        let acceleration = amplitude * omega2;
        let amplitudes = [amplitude, -velocity, -acceleration, velocity * omega2, acceleration * omega2];
        Ok(Self { phase, center: center as f32, amplitudes: amplitudes.map(|a| a as f32) })
    }

    /// Position, velocity, acceleration, jerk, snap.
    fn at(&self, time_us: u64) -> [f32; 5] {
        let (sin, cos) = math::sin_cos_turns(self.phase.at(time_us));
        let [position, velocity, acceleration, jerk, snap] = self.amplitudes;
        [self.center + position * cos, velocity * sin, acceleration * cos, jerk * sin, snap * cos]
    }
}

/// What a bound needs to know of one axis: its squared amplitude, frequency, and phase doubled.
struct Wave {
    square: f64,
    frequency: f64,
    doubled: Vector2<f64>,
}

impl Wave {
    /// The `order`-th derivative of an axis. A negative frequency is a positive one with the phase mirrored.
    fn new(axis: &Axis, amplitude: f64, frequency: f64, order: u32) -> Self {
        let scale = (0..order).fold(amplitude, |scale, _| scale * frequency);
        let (sin, cos) = math::sin_cos_turns(axis.phase.at(0).wrapping_mul(2));
        let mirror = if frequency < 0.0 { -1.0 } else { 1.0 };
        Self {
            square: scale * scale,
            frequency: frequency.abs(),
            doubled: Vector2::new(f64::from(cos), mirror * f64::from(sin)),
        }
    }

    /// The least number known to be above the norm of the waves together.
    fn bound(waves: &[Self]) -> f64 {
        let mut total = 0.0;
        for (i, wave) in waves.iter().enumerate() {
            let same = |other: &&Self| other.frequency == wave.frequency;
            if waves.iter().take(i).any(|earlier| same(&earlier)) {
                continue;
            }
            let sum: f64 = waves.iter().filter(same).map(|other| other.square).sum();
            let turned = waves.iter().filter(same).fold(Vector2::zeros(), |t, other| t + other.doubled * other.square);
            total += 0.5 * (sum + math::sqrt_f64(turned.x * turned.x + turned.y * turned.y));
        }
        math::sqrt_f64(total)
    }
}

/// A harmonic reference. Costs four sines with their cosines per tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Harmonic {
    axes: [Axis; 3],
    turn: Phase,
    swing: Phase,
    swing_amplitude: f32,
    turn_rate: f32,
    swing_rate: f32,
    swing_acceleration: f32,
    bounds: ReferenceBounds,
    fifth_derivative: f64,
}

impl Harmonic {
    /// Checks that every number is finite and every derivative in the law's range, and works out the bounds.
    ///
    /// # Errors
    /// Names the first field that is not, as in the scenario file.
    pub fn new(parameters: HarmonicParameters) -> Result<Self, ParameterError> {
        let HarmonicParameters { center, amplitude, frequency, phase, heading } = parameters;
        let axes = [
            Axis::new(center[0], amplitude[0], frequency[0], phase[0], &NAMES[0])?,
            Axis::new(center[1], amplitude[1], frequency[1], phase[1], &NAMES[1])?,
            Axis::new(center[2], amplitude[2], frequency[2], phase[2], &NAMES[2])?,
        ];
        let turn = Phase::new(heading.rate, heading.offset, "reference.heading.rate", "reference.heading.offset")?;
        let swing = Phase::new(heading.frequency, 0.0, "reference.heading.frequency", "reference.heading.frequency")?;
        require_within(heading.rate, HEADING_RATE_MAX_RAD_PER_S, "reference.heading.rate")?;
        let w = heading.frequency.abs();
        let mut limit = SWING_MAX_RAD;
        if w > 0.0 {
            limit = limit.min(HEADING_RATE_MAX_RAD_PER_S / w).min(DERIVATIVE_MAX / (w * w));
        }
        require_within(heading.amplitude, limit, "reference.heading.amplitude")?;
        let swing_rate = heading.amplitude * heading.frequency;

        let wave = |order| {
            let [x, y, z] = &axes;
            [
                Wave::new(x, amplitude[0], frequency[0], order),
                Wave::new(y, amplitude[1], frequency[1], order),
                Wave::new(z, amplitude[2], frequency[2], order),
            ]
        };
        let [x, y, _] = wave(1);
        let speed = Wave::bound(&[x, y]);
        let [x, y, z] = wave(2);
        let (heading_rate, heading_second_derivative) = heading_bounds(heading.rate, swing_rate, heading.frequency);
        let round = |bound: f64| outwards(bound * (1.0 + EVALUATION_ROUNDING));
        let bounds = ReferenceBounds {
            horizontal_speed: round(speed),
            horizontal_acceleration: round(Wave::bound(&[x, y])),
            vertical_acceleration: round(Wave::bound(&[z])),
            jerk: round(Wave::bound(&wave(3))),
            snap: round(Wave::bound(&wave(4))),
            heading_rate: round(heading_rate),
            heading_second_derivative: round(heading_second_derivative),
        };
        Ok(Self {
            axes,
            turn,
            swing,
            swing_amplitude: heading.amplitude as f32,
            turn_rate: heading.rate as f32,
            swing_rate: swing_rate as f32,
            swing_acceleration: (-swing_rate * heading.frequency) as f32,
            bounds,
            fifth_derivative: Wave::bound(&wave(5)) * (1.0 + EVALUATION_ROUNDING),
        })
    }

    /// omega_i t + phi_i of the three axes, in 2^-64 turns.
    pub fn axis_phases(&self, time_us: u64) -> [u64; 3] {
        self.axes.map(|axis| axis.phase.at(time_us))
    }

    /// psi_0 + r t, the heading without its swing, in 2^-64 turns.
    pub fn turn_phase(&self, time_us: u64) -> u64 {
        self.turn.at(time_us)
    }

    /// w t of the heading's swing, in 2^-64 turns.
    pub fn swing_phase(&self, time_us: u64) -> u64 {
        self.swing.at(time_us)
    }

    fn heading(&self, time_us: u64) -> Heading {
        let (sin, cos) = math::sin_cos_turns(self.swing.at(time_us));
        let psi = self.turn.at(time_us).wrapping_add(phase::swing(self.swing_amplitude * sin));
        Heading::from_phase(psi, self.turn_rate + self.swing_rate * cos, self.swing_acceleration * sin)
    }
}

/// Suprema of |psi'| and (psi''^2 + psi'^4)^(1/2) with psi' = r + b cos(w t), psi'' = -b w sin(w t).
///
/// With c = cos(w t), signed so that r + b c is largest at c = 1, both are functions of the curve
/// (|r| + |b| c, b^2 w^2 (1 - c^2)), which for c < 0 only repeats its second component with a smaller first one.
fn heading_bounds(r: f64, b: f64, w: f64) -> (f64, f64) {
    let (r, b) = (r.abs(), b.abs());
    let square = b * w * b * w;
    // psi''^2 + psi'^4 is convex in (psi', psi''^2).
    let mut second = Supremum::new(|point: &Vector2<f64>| {
        let rate2 = point.x * point.x;
        point.y + rate2 * rate2
    });
    second.include(&[Vector2::new(r, square), Vector2::new(r + 0.5 * b, square), Vector2::new(r + b, 0.0)]);
    (r + b, second.bound())
}

impl Trajectory for Harmonic {
    fn at(&self, time_us: u64) -> Reference {
        let [x, y, z] = self.axes.map(|axis| axis.at(time_us));
        Reference {
            position: Vector3::new(x[0], y[0], z[0]),
            velocity: Vector3::new(x[1], y[1], z[1]),
            acceleration: Vector3::new(x[2], y[2], z[2]),
            jerk: Vector3::new(x[3], y[3], z[3]),
            snap: Vector3::new(x[4], y[4], z[4]),
            heading: self.heading(time_us),
        }
    }

    fn bounds(&self) -> ReferenceBounds {
        self.bounds
    }

    fn fifth_derivative(&self, _from_us: u64, _to_us: u64) -> f64 {
        self.fifth_derivative
    }
}
