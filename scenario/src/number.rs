//! Numbers in files: CSV's and TOML's.

use std::fmt;

/// A number as files have it: the fewest digits that are read back to the same bits, always with a point or an
/// exponent, so that TOML takes it for a float. From 1e-4 to 1e16 it stands without an exponent, zero as well.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Number<T>(pub T);

macro_rules! displayed {
    ($float:ty) => {
        impl fmt::Display for Number<$float> {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                let Self(number) = *self;
                if number != 0.0 && !(1e-4..1e16).contains(&number.abs()) && !number.is_nan() {
                    write!(f, "{number:e}")
                } else if number.fract() == 0.0 {
                    write!(f, "{number}.0")
                } else {
                    write!(f, "{number}")
                }
            }
        }
    };
}

displayed!(f32);
displayed!(f64);

/// Several as an array of TOML.
#[must_use]
pub fn array<T: Copy>(numbers: &[T]) -> String
where
    Number<T>: fmt::Display,
{
    let numbers: Vec<String> = numbers.iter().map(|number| Number(*number).to_string()).collect();
    format!("[{}]", numbers.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_in_one_way_that_is_read_back_to_their_bits() {
        for (number, text) in [
            (0.0, "0.0"),
            (-0.0, "-0.0"),
            (1.0, "1.0"),
            (-1.5, "-1.5"),
            (0.1 + 0.2, "0.30000000000000004"),
            (1e-4, "0.0001"),
            (9.9e-5, "9.9e-5"),
            (123456789.0, "123456789.0"),
            (9999999999999998.0, "9999999999999998.0"),
            (1e16, "1e16"),
            (f64::MIN_POSITIVE, "2.2250738585072014e-308"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(Number(number).to_string(), text);
            assert_eq!(text.parse::<f64>().unwrap().to_bits(), number.to_bits());
        }
        assert_eq!(Number(f64::NAN).to_string(), "NaN");
        for (number, text) in [(0.1_f32, "0.1"), (1e-4, "0.0001"), (123456789.0, "123456790.0"), (1e-7, "1e-7")] {
            assert_eq!(Number(number).to_string(), text);
            assert_eq!(text.parse::<f32>().unwrap().to_bits(), number.to_bits());
        }
        assert_eq!(array(&[0.5, -2.0]), "[0.5, -2.0]");
    }
}
