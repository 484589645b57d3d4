//! How the desired frame can move under the extended law. Section 10 of `docs/extended-law.md`.
//!
//! The frame's third axis is rho = u / n and it turns about it with W, |W| <= W_max, |W'| <= A, whatever the heading does. With w and p
//! the parts of u'' and u' orthogonal to rho and r = rho . u',
//!
//! ```text
//! omega_12  = p / n turned by a right angle,          omega_3  = W,
//! omega'_12 = (w - 2 r p / n) / n turned likewise + W (omega_2, -omega_1),   omega'_3 = W'.
//! ```
//!
//! The last two terms of omega'_12 are orthogonal, so |omega'_12| <= |w| / n + (p / n) sqrt(4 r^2 / n^2 + W^2).
//!
//! Everything is evaluated over cells of (|u_x, u_y|, u_z) that cover all that is reachable, at the end of a cell where it is worst.
//! In a cell with tilt at most gamma a vector whose horizontal part is at most H long and whose vertical one at most Z has a part
//! orthogonal to rho of at most H cos gamma + Z sin gamma while Z cos gamma >= H sin gamma, and sqrt(H^2 + Z^2) beyond, and a part along
//! rho of at most Z cos gamma_least + H sin gamma. Shares of one u': p^2 + r^2 <= |u'|^2.

use super::reach::Reach;
use crate::math;

/// Cells of |u_x, u_y|.
pub const ACROSS_CELLS: usize = 24;
/// Cells of u_z: narrow near its least value, where the desired frame moves fastest.
pub const VERTICAL_CELLS: usize = 32;

/// One cell of u, with what the desired frame does there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell {
    /// Least |u|, m/s^2.
    pub least: f64,
    /// Greatest |u|, m/s^2.
    pub greatest: f64,
    /// Greatest |w| / n, rad/s^2.
    pub swing: f64,
    /// Greatest p and r, and the squared length of u' that they share.
    tangential: f64,
    radial: f64,
    square: f64,
}

impl Cell {
    fn new(reach: &Reach, across: [f64; 2], vertical: [f64; 2]) -> Self {
        let ([h_0, h_1], [z_0, z_1]) = (across, vertical);
        let least = math::hypot(h_0, z_0);
        // The steepest and the most upright of the cell.
        let steep = math::hypot(h_1, z_0);
        let (sin, cos) = (h_1 / steep, z_0 / steep);
        let cos_greatest = z_1 / math::hypot(h_0, z_1);
        let rate = reach.vertical_rate(z_0, z_1);
        Self {
            least,
            greatest: math::hypot(h_1, z_1),
            swing: orthogonal(reach.across_acceleration, reach.vertical_acceleration, sin, cos) / least,
            tangential: orthogonal(reach.across_rate, rate, sin, cos),
            radial: rate * cos_greatest + reach.across_rate * sin,
            square: reach.across_rate * reach.across_rate + rate * rate,
        }
    }

    /// Greatest |omega_12| = p / n, rad/s.
    #[must_use]
    pub fn rate(&self) -> f64 {
        self.tangential / self.least
    }

    /// Greatest (p / n) sqrt(4 r^2 / n^2 + `turn`^2), rad/s^2.
    #[must_use]
    pub fn curl(&self, turn: f64) -> f64 {
        let Self { least: n, tangential, radial, square, .. } = *self;
        let most = math::lesser_f64(tangential * tangential, square);
        // In x = p^2 with r^2 the lesser of its own bound and what p leaves: rising, then a parabola.
        let together = math::lesser_f64(math::greater_f64(square - radial * radial, 0.0), most);
        let peak = 0.5 * (square + 0.25 * turn * turn * n * n);
        let x = math::lesser_f64(math::greater_f64(peak, together), most);
        let r_squared = math::greater_f64(math::lesser_f64(square - x, radial * radial), 0.0);
        math::sqrt_f64(x * (4.0 * r_squared / (n * n) + turn * turn)) / n
    }

    /// Greatest |omega'_12| while the frame turns about rho by `turn` at most, rad/s^2.
    #[must_use]
    pub fn acceleration(&self, turn: f64) -> f64 {
        self.swing + self.curl(turn)
    }
}

/// The greatest part orthogonal to rho of a vector in a cylinder of radius `across` and half height `vertical`, for tilts of at
/// most that with sine `sin` and cosine `cos`.
fn orthogonal(across: f64, vertical: f64, sin: f64, cos: f64) -> f64 {
    if vertical * cos >= across * sin { across * cos + vertical * sin } else { math::hypot(across, vertical) }
}

/// All cells of what is reachable, `reach.vertical_least` being positive.
pub fn cells(reach: &Reach) -> impl Iterator<Item = Cell> + '_ {
    let ends = |cell: usize, count: usize| [cell, cell + 1].map(|end| end as f64 / count as f64);
    (0..VERTICAL_CELLS).flat_map(move |vertical| {
        let span = reach.vertical_greatest - reach.vertical_least;
        let vertical =
            ends(vertical, VERTICAL_CELLS).map(|end| reach.vertical_least + span * end * math::sqrt_f64(end));
        (0..ACROSS_CELLS).map(move |across| {
            let across = ends(across, ACROSS_CELLS).map(|end| reach.across * end);
            Cell::new(reach, across, vertical)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::super::torque::Torques;
    use super::*;
    use crate::extended::example;
    use crate::extended::parameters::Extended;
    use nalgebra::Vector3;

    /// |omega_12|, |w| / n and (p / n) sqrt(4 r^2 / n^2 + `turn`^2), for u and its derivatives.
    fn motion(u: &Vector3<f64>, rate: &Vector3<f64>, acceleration: &Vector3<f64>, turn: f64) -> [f64; 3] {
        let (n, rho) = (u.norm(), u.normalize());
        let r = rho.dot(rate);
        let p = (rate - rho * r).norm();
        let w = (acceleration - rho * rho.dot(acceleration)).norm();
        [p / n, w / n, p / n * (4.0 * r * r / (n * n) + turn * turn).sqrt()]
    }

    fn reach() -> (Extended, Reach) {
        let parameters = Extended::new(example::PARAMETERS, &example::vehicle()).unwrap();
        let reach = Reach::new(&parameters, &example::REFERENCES, 9.81);
        (parameters, reach)
    }

    /// Calls `meet` with u at the four corners of cell `number` and u', u'' all round the cylinders in which they are.
    fn all_round(reach: &Reach, number: usize, mut meet: impl FnMut(Vector3<f64>, Vector3<f64>, Vector3<f64>)) {
        let ends = |cell: usize, count: usize| [cell, cell + 1].map(|end| end as f64 / count as f64);
        let across = ends(number % ACROSS_CELLS, ACROSS_CELLS).map(|end| reach.across * end);
        let span = reach.vertical_greatest - reach.vertical_least;
        let vertical =
            ends(number / ACROSS_CELLS, VERTICAL_CELLS).map(|end| reach.vertical_least + span * end.powf(1.5));
        let vertical_rate = reach.vertical_rate(vertical[0], vertical[1]);
        for (x, z) in across.iter().flat_map(|x| vertical.iter().map(move |z| (*x, *z))) {
            for direction in 0..32 {
                let (sin, cos) = (f64::from(direction) * core::f64::consts::TAU / 32.0).sin_cos();
                for up in [-1.0, -0.5, 0.0, 0.5, 1.0] {
                    let within = |across: f64, vertical: f64| Vector3::new(across * cos, across * sin, vertical * up);
                    let acceleration = within(reach.across_acceleration, reach.vertical_acceleration);
                    meet(Vector3::new(x, 0.0, z), within(reach.across_rate, vertical_rate), acceleration);
                }
            }
        }
    }

    #[test]
    fn the_desired_frame_moves_no_faster_than_its_cell_says_and_hardly_slower() {
        let (_, reach) = reach();
        for turn in [0.0, 1.5, 10.0] {
            for (number, cell) in cells(&reach).enumerate() {
                let mut most = [0.0_f64; 3];
                all_round(&reach, number, |u, rate, acceleration| {
                    assert!(u.norm() >= cell.least * (1.0 - 1e-12) && u.norm() <= cell.greatest * (1.0 + 1e-12));
                    let moves = motion(&u, &rate, &acceleration, turn);
                    most = core::array::from_fn(|i| most[i].max(moves[i]));
                });
                let bounds = [cell.rate(), cell.swing, cell.curl(turn)];
                let parts: [f64; 3] = core::array::from_fn(|i| most[i] / bounds[i]);
                assert!(parts.iter().all(|part| *part <= 1.0 + 1e-12), "turn {turn}, cell {number}: {parts:?}");
                assert!(parts.iter().all(|part| *part > 0.97), "turn {turn}, cell {number}: only {parts:?}");
            }
        }
    }

    /// J omega' + omega x J omega of a frame on rho, whatever it does about it.
    #[test]
    fn without_an_attitude_error_no_motion_asks_for_more_torque_than_its_cell_says() {
        let (parameters, reach) = reach();
        let inertia = Vector3::new(3e-3, 4e-3, 7e-3);
        let torques = Torques::new(&parameters, &inertia);
        let (most_turn, most_turning) =
            (f64::from(parameters.heading.rate), f64::from(parameters.heading.acceleration));
        for (direction, close) in
            [(Vector3::x(), 0.8), (Vector3::y(), 0.8), (Vector3::z(), 0.8), (Vector3::new(0.6, -0.5, 0.4), 0.6)]
        {
            let mut closest = 1.0_f64;
            for (number, cell) in cells(&reach).enumerate().step_by(37) {
                let mut most = 0.0_f64;
                all_round(&reach, number, |u, rate, acceleration| {
                    let (n, rho) = (u.norm(), u.normalize());
                    let r = rho.dot(&rate);
                    let tilting = (rate - rho * r) / n;
                    let bending = (acceleration - rho * rho.dot(&acceleration) - tilting * (2.0 * r)) / n;
                    for (quarter, sign) in (0..16).flat_map(|quarter| [(quarter, 1.0), (quarter, -1.0)]) {
                        let angle = f64::from(quarter) * core::f64::consts::TAU / 16.0;
                        let ahead = rho.cross(&Vector3::y()).normalize() * angle.cos() + Vector3::y() * angle.sin();
                        let axes = [ahead, rho.cross(&ahead), rho];
                        let turn = most_turn * sign;
                        let omega = rho.cross(&tilting) + rho * turn;
                        for turning in [most_turning, -most_turning] {
                            let change = rho.cross(&bending) + tilting * turn + rho * turning;
                            let [omega, change] = [omega, change].map(|v| Vector3::from(axes.map(|axis| axis.dot(&v))));
                            let torque = inertia.component_mul(&change) + omega.cross(&inertia.component_mul(&omega));
                            most = most.max(direction.dot(&torque));
                        }
                    }
                });
                let part = most / torques.feedforward(&direction, &cell);
                assert!(part <= 1.0 + 1e-12, "along {direction}, cell {number}: {part}");
                closest = closest.min(part);
            }
            assert!(closest > close, "along {direction}: only {closest}");
        }
    }
}
