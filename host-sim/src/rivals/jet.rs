//! Quantities with their first two derivatives with respect to time.
//!
//! The laws of the [rivals](super) need the angular velocity and acceleration of an attitude that they build from a
//! force. Product and chain rule over (x, x', x'') give them without a formula of their own for each law:
//!
//! ```text
//! (a b)'' = a'' b + 2 a' b' + a b''      f(x)'' = f'' x'^2 + f' x''
//! ```

use nalgebra::Vector3;

/// A scalar, its rate and its rate's rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scalar(pub [f64; 3]);

/// A vector likewise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jet(pub [Vector3<f64>; 3]);

impl Scalar {
    /// f of it, for f, f' and f'' at its value.
    pub fn chain(&self, [f, first, second]: [f64; 3]) -> Self {
        let [_, rate, acceleration] = self.0;
        Self([f, first * rate, second * rate * rate + first * acceleration])
    }

    /// M tanh(x / M): the paper's smooth saturation, of slope one at zero.
    pub fn saturated(&self, level: f64) -> Self {
        let tanh = (self.0[0] / level).tanh();
        let slope = 1.0 - tanh * tanh;
        self.chain([level * tanh, slope, -2.0 * tanh * slope / level])
    }
}

impl Jet {
    /// Nothing, at rest.
    pub const ZERO: Self = Self([Vector3::new(0.0, 0.0, 0.0); 3]);

    /// A constant.
    pub fn constant(value: Vector3<f64>) -> Self {
        Self([value, Vector3::zeros(), Vector3::zeros()])
    }

    /// Component by component times `factors`.
    pub fn scaled(&self, factors: &Vector3<f64>) -> Self {
        Self(self.0.map(|part| part.component_mul(factors)))
    }

    /// The sum.
    pub fn plus(&self, other: &Self) -> Self {
        Self([0, 1, 2].map(|order| self.0[order] + other.0[order]))
    }

    /// `function` of each component with its derivatives.
    pub fn each(&self, function: impl Fn(Scalar) -> Scalar) -> Self {
        let [x, y, z] = [0, 1, 2].map(|axis| function(Scalar(self.0.map(|part| part[axis]))).0);
        Self([0, 1, 2].map(|order| Vector3::new(x[order], y[order], z[order])))
    }

    /// Each component saturated at its level.
    pub fn saturated(&self, level: f64) -> Self {
        self.each(|component| component.saturated(level))
    }

    /// a . b.
    pub fn dot(&self, other: &Self) -> Scalar {
        Scalar(products(self, other, |a, b| a.dot(b)))
    }

    /// a x b.
    pub fn cross(&self, other: &Self) -> Self {
        Self(products(self, other, |a, b| a.cross(b)))
    }

    /// Along it, of length one. A vector shorter than `least` is taken to be `least` long, so that the rates stay
    /// finite.
    pub fn unit(&self, least: f64) -> Self {
        let square = self.dot(self);
        let length = square.0[0].sqrt().max(least);
        let inverse = square.chain([1.0 / length, -0.5 / length.powi(3), 0.75 / length.powi(5)]).0;
        let [value, rate, second] = self.0;
        Self([
            value * inverse[0],
            value * inverse[1] + rate * inverse[0],
            value * inverse[2] + rate * (2.0 * inverse[1]) + second * inverse[0],
        ])
    }
}

/// A product of any kind with its derivatives.
fn products<T: std::ops::Add<Output = T>>(
    Jet(a): &Jet,
    Jet(b): &Jet,
    times: impl Fn(&Vector3<f64>, &Vector3<f64>) -> T,
) -> [T; 3] {
    [
        times(&a[0], &b[0]),
        times(&a[1], &b[0]) + times(&a[0], &b[1]),
        times(&a[2], &b[0]) + (times(&a[1], &b[1]) + times(&a[1], &b[1])) + times(&a[0], &b[2]),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A curve and its derivatives at a time.
    fn curve(t: f64) -> Jet {
        Jet([
            Vector3::new(t.sin(), (2.0 * t).cos(), 2.0 + t * t),
            Vector3::new(t.cos(), -2.0 * (2.0 * t).sin(), 2.0 * t),
            Vector3::new(-t.sin(), -4.0 * (2.0 * t).cos(), 2.0),
        ])
    }

    #[test]
    fn derivatives_are_those_of_differences() {
        let made = |t: f64| {
            let other = curve(t + 1.0);
            curve(t).unit(1e-9).cross(&other).plus(&other.saturated(0.7)).each(|c| c.saturated(1.5))
        };
        let (t, h) = (0.4, 1e-4);
        let [before, now, after] = [t - h, t, t + h].map(|t| made(t).0);
        let rate = (after[0] - before[0]) / (2.0 * h);
        let second = (after[0] + before[0] - now[0] * 2.0) / (h * h);
        assert!((rate - now[1]).amax() < 1e-6, "{rate} {}", now[1]);
        assert!((second - now[2]).amax() < 1e-5, "{second} {}", now[2]);
    }

    #[test]
    fn a_unit_vector_has_length_one_and_moves_across_itself() {
        let unit = curve(0.8).unit(1e-9);
        let square = unit.dot(&unit).0;
        assert!((square[0] - 1.0).abs() < 1e-12 && square[1].abs() < 1e-12 && square[2].abs() < 1e-9);
        assert_eq!(Jet::ZERO.unit(1e-3), Jet::ZERO);
    }
}
