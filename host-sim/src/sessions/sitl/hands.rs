//! A person's hands on a simulated vehicle that stands, told by words, one a line: a bench walk rehearsed on a desk.
//!
//! | word | the hands |
//! |---|---|
//! | `flat`, `nose-up`, `left-up`, `nose-down`, `right-up` | hold it so, tilted by 30 degrees |
//! | `on-nose`, `on-tail`, `on-left`, `on-right`, `on-back` | put it down on that side |
//! | `turned-left`, `turned-right` | turn it on the flat, until another word comes |
//! | `carry X Y Z` | carry it there, m from where it stands: east, north, up |
//! | `hide`, `show` | cover its markers, and uncover them |
//! | `kill`, `unkill` | move the kill switch of a radio |
//!
//! What the vehicle's sensors and camera show follows; the vehicle itself stands on.

use super::simulated_hardware::Hands;
use nalgebra::{UnitQuaternion, Vector3};
use std::f32::consts::{FRAC_PI_2, FRAC_PI_6, PI};

/// How fast hands turn it, rad/s, and carry it, m/s.
const TURN_RAD_PER_S: f32 = 1.2;
const CARRY_M_PER_S: f32 = 0.5;

/// What the person does, and how far that is.
#[derive(Debug, Clone, PartialEq)]
pub struct Holder {
    turn: UnitQuaternion<f32>,
    spin: f32,
    carried: Vector3<f32>,
    /// Whether the kill switch is on.
    pub is_killed: bool,
    /// What is felt and seen now.
    pub hands: Hands,
}

impl Default for Holder {
    /// Beside it, with the hands off.
    fn default() -> Self {
        Self {
            turn: UnitQuaternion::identity(),
            spin: 0.0,
            carried: Vector3::zeros(),
            is_killed: false,
            hands: Hands::OFF,
        }
    }
}

impl Holder {
    /// Does as a line says.
    ///
    /// # Errors
    /// In words: the line, and which there are.
    pub fn take(&mut self, line: &str) -> Result<(), String> {
        let words: Vec<&str> = line.split_whitespace().collect();
        let (x, y) = (Vector3::x(), Vector3::y());
        // Nose up is a turn about left by a negative angle.
        let turn = match words[..] {
            [] => return Ok(()),
            ["flat" | "turned-left" | "turned-right"] => Vector3::zeros(),
            ["nose-up"] => y * -FRAC_PI_6,
            ["nose-down"] => y * FRAC_PI_6,
            ["left-up"] => x * FRAC_PI_6,
            ["right-up"] => x * -FRAC_PI_6,
            ["on-tail"] => y * -FRAC_PI_2,
            ["on-nose"] => y * FRAC_PI_2,
            ["on-right"] => x * FRAC_PI_2,
            ["on-left"] => x * -FRAC_PI_2,
            ["on-back"] => x * PI,
            _ => return self.take_other(line, &words),
        };
        self.turn = UnitQuaternion::from_scaled_axis(turn);
        self.spin = match words[..] {
            ["turned-left"] => 1.0,
            ["turned-right"] => -1.0,
            _ => 0.0,
        };
        Ok(())
    }

    fn take_other(&mut self, line: &str, words: &[&str]) -> Result<(), String> {
        let place = |words: &[&str]| words.iter().map(|word| word.parse().ok()).collect::<Option<Vec<f32>>>();
        match words {
            ["hide"] => self.hands.is_seen = false,
            ["show"] => self.hands.is_seen = true,
            ["kill"] => self.is_killed = true,
            ["unkill"] => self.is_killed = false,
            ["carry", rest @ ..] if rest.len() == 3 && place(rest).is_some() => {
                self.carried = Vector3::from_vec(place(rest).unwrap_or_default());
            }
            _ => {
                return Err(format!(
                    "{line:?}: hands know flat, nose-up, left-up, nose-down, right-up, on-nose, on-tail, on-left, \
                     on-right, on-back, turned-left, turned-right, carry X Y Z, hide, show, kill, unkill"
                ));
            }
        }
        Ok(())
    }

    /// Goes on for some time, s.
    pub fn pass(&mut self, seconds: f32) {
        if seconds <= 0.0 {
            return;
        }
        let towards = self.hands.turn.inverse() * self.turn;
        let step = towards.scaled_axis().cap_magnitude(TURN_RAD_PER_S * seconds);
        self.hands.carried += (self.carried - self.hands.carried).cap_magnitude(CARRY_M_PER_S * seconds);
        self.hands.turn *= UnitQuaternion::from_scaled_axis(step);
        self.hands.rate = step / seconds + Vector3::new(0.0, 0.0, self.spin);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hands_get_where_they_are_told_and_the_rates_add_up_to_it() {
        let mut holder = Holder::default();
        for (line, up) in [
            ("nose-up", Vector3::new(0.5, 0.0, 0.866)),
            ("left-up", Vector3::new(0.0, 0.5, 0.866)),
            ("on-back", Vector3::new(0.0, 0.0, -1.0)),
            ("on-left", Vector3::new(0.0, -1.0, 0.0)),
            ("flat", Vector3::z()),
        ] {
            let before = holder.hands.turn;
            holder.take(line).unwrap();
            let mut turned = before;
            for _ in 0..1_000 {
                holder.pass(0.005);
                turned *= UnitQuaternion::from_scaled_axis(holder.hands.rate * 0.005);
            }
            assert!((holder.hands.turn.inverse() * Vector3::z() - up).norm() < 1e-2, "{line}");
            assert!(turned.angle_to(&holder.hands.turn) < 1e-2 && holder.hands.rate.norm() < 1e-3, "{line}");
        }
        holder.take("carry 1 2 -0.5").unwrap();
        (0..2_000).for_each(|_| holder.pass(0.005));
        assert!((holder.hands.carried - Vector3::new(1.0, 2.0, -0.5)).norm() < 1e-3);
        holder.take("turned-left").unwrap();
        holder.pass(0.005);
        assert!((holder.hands.rate.z - 1.0).abs() < 1e-3);
        for line in ["up", "carry 1 2", "carry 1 2 x", "carry", "flat now"] {
            assert!(holder.take(line).unwrap_err().contains("nose-up"), "{line}");
        }
    }
}
