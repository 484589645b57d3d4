//! Typed errors: every one names the field it is about.
//!
//! [`ParameterError`] comes from constructors, once, before flight. [`InputError`] comes from a control tick and is
//! the only way a tick can fail.

use core::fmt;

/// What is wrong with a configuration value.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Reason {
    /// NaN or infinite.
    NotFinite,
    /// Zero or negative where only positive makes sense.
    NotPositive,
    /// Negative where zero is the least.
    Negative,
    /// Not below the value given, with that value.
    NotBelow(f32),
    /// Not above the value given, with that value.
    NotAbove(f32),
    /// Above the greatest value there may be, with that value.
    Above(f32),
    /// Below the least value there may be, with that value.
    Below(f32),
    /// Moments of inertia of a rigid body: none exceeds the sum of the other two.
    TriangleInequality,
    /// Too few elements, with the least number.
    TooFew(usize),
    /// Too many elements, with the greatest number.
    TooMany(usize),
    /// Not zero where only zero makes sense.
    NotZero,
    /// Not in strictly increasing order.
    NotIncreasing,
    /// A heading direction that is not a unit vector, or a derivative not tangent to the circle.
    NotOnCircle,
    /// Geometry that cannot produce the commanded wrench.
    DoesNotSpan,
    /// An option of a law other than the one that flies.
    OtherLaw,
    /// The paper's law, which carries no policy.
    CarriesNoPolicy,
    /// Loops that were not found stable with their margin.
    WithoutMargin,
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite => write!(f, "must be a finite number"),
            Self::NotPositive => write!(f, "must be greater than zero"),
            Self::Negative => write!(f, "must not be negative"),
            Self::NotBelow(limit) => write!(f, "must be below {limit}"),
            Self::NotAbove(limit) => write!(f, "must be above {limit}"),
            Self::Above(limit) => write!(f, "must be at most {limit}"),
            Self::Below(limit) => write!(f, "must be at least {limit}"),
            Self::TriangleInequality => {
                write!(
                    f,
                    "violates the triangle inequality of a rigid body (no moment may exceed the sum of the others)"
                )
            }
            Self::TooFew(min) => write!(f, "needs at least {min} elements"),
            Self::TooMany(max) => write!(f, "takes at most {max} elements"),
            Self::NotZero => write!(f, "must be zero"),
            Self::NotIncreasing => write!(f, "must be strictly increasing"),
            Self::NotOnCircle => write!(f, "must be a unit vector with derivatives along the circle"),
            Self::OtherLaw => write!(f, "belongs to another law than control.law"),
            Self::CarriesNoPolicy => write!(f, "must be \"extended\": the paper's law carries no policy"),
            Self::WithoutMargin => write!(f, "without margin at these gains"),
            Self::DoesNotSpan => write!(f, "cannot produce thrust and all three torques independently"),
        }
    }
}

/// A configuration value that was refused: which, and why.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ParameterError {
    /// The field's name as in scenario files, e.g. `"vehicle.mass"`.
    pub field: &'static str,
    /// What is wrong with it.
    pub reason: Reason,
}

impl fmt::Display for ParameterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.field, self.reason)
    }
}

impl core::error::Error for ParameterError {}

/// Shorthand for constructors.
///
/// # Errors
/// `field`, for `reason`, unless `condition` holds.
pub fn require(condition: bool, field: &'static str, reason: Reason) -> Result<(), ParameterError> {
    if condition { Ok(()) } else { Err(ParameterError { field, reason }) }
}

/// Requires a finite number.
///
/// # Errors
/// `field`, if it is not.
pub fn require_finite(value: f32, field: &'static str) -> Result<(), ParameterError> {
    require(value.is_finite(), field, Reason::NotFinite)
}

/// Requires a finite number above zero.
///
/// # Errors
/// `field`, if it is not.
pub fn require_positive(value: f32, field: &'static str) -> Result<(), ParameterError> {
    require_finite(value, field)?;
    require(value > 0.0, field, Reason::NotPositive)
}

/// An input to a control tick that the law cannot use. The controller's memory is as it was before the tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum InputError {
    /// The field holds a NaN or an infinity.
    NotFinite {
        /// The offending input.
        field: &'static str,
    },
    /// The field's magnitude is beyond what single precision can square without overflow.
    OutOfRange {
        /// The offending input.
        field: &'static str,
    },
    /// The quaternion's length differs from one by more than [`crate::state::UNIT_TOLERANCE`].
    NotARotation {
        /// The offending input.
        field: &'static str,
    },
    /// The reference falls so fast that the thrust direction could vanish: a_z must stay above M_p - g.
    FallsTooFast,
}

impl InputError {
    /// The input that it is about.
    pub fn field(&self) -> &'static str {
        match *self {
            Self::NotFinite { field } | Self::OutOfRange { field } | Self::NotARotation { field } => field,
            Self::FallsTooFast => "reference.acceleration",
        }
    }
}

impl fmt::Display for InputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite { field } => write!(f, "{field}: must be finite"),
            Self::OutOfRange { field } => write!(f, "{field}: magnitude out of range"),
            Self::NotARotation { field } => write!(f, "{field}: quaternion must have unit length within 1e-3"),
            Self::FallsTooFast => {
                write!(f, "reference.acceleration: its vertical part must stay above m_p - gravity")
            }
        }
    }
}

impl core::error::Error for InputError {}
