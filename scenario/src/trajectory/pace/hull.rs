//! Whether a curve in Bernstein form stays where it is to stay, at every instant: it is in the hull of its control
//! points, and so is each of its halves in that of its own.

use nalgebra::Vector3;

/// How often a curve is halved before it counts as outside.
const HALVINGS_MAX: u32 = 12;

/// Whether a curve stays in a convex region, of which `is_out` knows the outside.
pub fn stays<const N: usize>(controls: &[Vector3<f64>; N], is_out: impl Fn(&Vector3<f64>) -> bool) -> bool {
    halved(controls, &is_out, HALVINGS_MAX)
}

fn halved<const N: usize>(
    controls: &[Vector3<f64>; N],
    is_out: &impl Fn(&Vector3<f64>) -> bool,
    halvings: u32,
) -> bool {
    if !controls.iter().any(is_out) {
        return true;
    }
    if halvings == 0 || is_out(&controls[0]) || is_out(&controls[N - 1]) {
        return false;
    }
    // De Casteljau's: the first of each round builds the left half, what is left at the end is the right one.
    let (mut left, mut right) = (*controls, *controls);
    for (round, first) in left.iter_mut().enumerate() {
        *first = right[0];
        for i in 0..N - 1 - round {
            right[i] = (right[i] + right[i + 1]) / 2.0;
        }
    }
    halved(&left, is_out, halvings - 1) && halved(&right, is_out, halvings - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// (s, s^2, 0) on [-1, 1].
    const PARABOLA: [Vector3<f64>; 3] =
        [Vector3::new(-1.0, 1.0, 0.0), Vector3::new(0.0, -1.0, 0.0), Vector3::new(1.0, 1.0, 0.0)];

    #[test]
    fn a_curve_inside_is_found_inside_though_its_control_points_are_not() {
        assert!(stays(&PARABOLA, |point| point.y < -0.001));
    }

    #[test]
    fn a_peak_between_the_ends_is_found() {
        assert!(!stays(&PARABOLA, |point| point.y < 0.001));
        assert!(!stays(&PARABOLA, |point| point.x > 0.999));
    }
}
