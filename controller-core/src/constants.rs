//! The one declaration of every constant: gains of both laws and the bounds of references.
//!
//! A constant is one entry: section and key as in scenario files, symbol and meaning, unit, range, and whether `tune`
//! searches it. The struct, its table, its checks, the scenario's keys, the search space, the board's image and the
//! documents' table follow from it.

use crate::error::{ParameterError, Reason, require, require_finite};

/// The range of a constant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Least.
    pub min: f32,
    /// Greatest.
    pub max: f32,
}

impl Range {
    /// A gain or a level: its square stays above zero and, with the largest states, below overflow.
    pub const POSITIVE: Self = Self { min: 1e-7, max: 1e3 };
    /// A level that may be zero, which turns its term off.
    pub const LEVEL: Self = Self { min: 0.0, max: 1e3 };
    /// A bandwidth of a filter, 1/s: slower ones add up rounding, faster ones are beyond every tick.
    pub const BANDWIDTH: Self = Self { min: 0.2, max: 100.0 };
    /// The bound of a motion.
    pub const BOUND: Self = Self { min: 0.0, max: f32::MAX };
    /// A share of one, above zero.
    pub const SHARE: Self = Self { min: 1e-7, max: 1.0 };

    /// A range of its own.
    pub const fn between(least: f32, greatest: f32) -> Self {
        Self { min: least, max: greatest }
    }

    /// Checks one value.
    ///
    /// # Errors
    /// Names `field`.
    pub fn check(&self, value: f32, field: &'static str) -> Result<(), ParameterError> {
        require_finite(value, field)?;
        require(self.min <= 0.0 || value > 0.0, field, Reason::NotPositive)?;
        require(self.min < 0.0 || value >= 0.0, field, Reason::Negative)?;
        require(value >= self.min, field, Reason::Below(self.min))?;
        require(value <= self.max, field, Reason::Above(self.max))
    }
}

/// A constant as declared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Constant {
    /// Section and key in scenario files.
    pub path: &'static str,
    /// Section in scenario files.
    pub section: &'static str,
    /// Key in that section.
    pub key: &'static str,
    /// Symbol, meaning and unit.
    pub about: &'static str,
    /// Its range.
    pub range: Range,
    /// Whether `tune` searches it.
    pub searched: bool,
    /// The formula of its default, as written in its declaration; empty without one.
    pub formula: &'static str,
}

/// Declares a struct of constants, each with its entry of the table. With `by Quantities |d|` each entry ends with its
/// default: a formula of the quantities d, which have a method for every constant.
macro_rules! constants {
    (
        $(#[$outer:meta])*
        pub struct $name:ident {
            $( #[doc = $about:literal] $section:ident . $key:ident : $range:expr, $searched:ident; )*
        }
    ) => {
        $crate::constants::constants! { @table
            $(#[$outer])* pub struct $name { $( #[doc = $about] $section.$key: $range, $searched, ""; )* }
        }
    };
    (
        $(#[$outer:meta])*
        pub struct $name:ident by $quantities:ident |$of:ident| {
            $( #[doc = $about:literal] $section:ident . $key:ident : $range:expr, $searched:ident, $formula:expr; )*
        }
    ) => {
        $crate::constants::constants! { @table
            $(#[$outer])*
            pub struct $name { $( #[doc = $about] $section.$key: $range, $searched, stringify!($formula); )* }
        }

        impl $name {
            /// Every constant as it is given or by its formula, in the table's order.
            pub(super) fn defaults(of: &$quantities) -> [f64; Self::COUNT] {
                [$(of.$key()),*]
            }
        }

        impl $quantities<'_> {
            $( #[doc = $about] #[allow(unused_variables)] pub(super) fn $key(&self) -> f64 {
                let $of = self;
                self.given(stringify!($key)).unwrap_or_else(|| $formula)
            } )*
        }
    };
    (@table
        $(#[$outer:meta])*
        pub struct $name:ident {
            $( #[doc = $about:literal] $section:ident . $key:ident : $range:expr, $searched:ident, $formula:expr; )*
        }
    ) => {
        $(#[$outer])*
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct $name {
            $( #[doc = $about] pub $key: f32, )*
        }

        impl $name {
            /// How many constants there are.
            pub const COUNT: usize = [$(stringify!($key)),*].len();

            /// Section and key of every constant, in the order of [`Self::values`].
            pub const PATHS: [&'static str; Self::COUNT] =
                [$(concat!(stringify!($section), ".", stringify!($key))),*];

            /// Every constant, in the order of [`Self::values`].
            pub const TABLE: [$crate::constants::Constant; Self::COUNT] = [
                $( $crate::constants::Constant {
                    path: concat!(stringify!($section), ".", stringify!($key)),
                    section: stringify!($section),
                    key: stringify!($key),
                    about: $about,
                    range: $range,
                    searched: $crate::constants::$searched,
                    formula: $formula,
                } ),*
            ];

            /// The values, in the table's order.
            pub fn values(&self) -> [f32; Self::COUNT] {
                [$(self.$key),*]
            }

            /// Checks that every constant is in its range.
            ///
            /// # Errors
            /// Names the first that is not.
            pub fn check(&self) -> Result<(), $crate::error::ParameterError> {
                $( $range.check(self.$key, concat!(stringify!($section), ".", stringify!($key)))?; )*
                Ok(())
            }

            /// Each constant with its value.
            pub fn entries(&self) -> impl Iterator<Item = ($crate::constants::Constant, f32)> {
                Self::TABLE.into_iter().zip(self.values())
            }

            /// The struct of these values, in the table's order.
            pub fn from_values(values: [f32; Self::COUNT]) -> Self {
                let [$($key),*] = values;
                Self { $($key),* }
            }
        }
    };
}

pub(crate) use constants;

/// `tune` searches it.
pub const SEARCHED: bool = true;
/// `tune` leaves it.
pub const FIXED: bool = false;
