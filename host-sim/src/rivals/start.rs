//! Where the search for a rival's gains starts on a vehicle.
//!
//! A rival's `START` serves a vehicle like the Hummingbird, with little lag. Slow rotors bear a slower attitude loop
//! only; a small vehicle turns, and is turned by an off-centre mass, far more quickly. Which speeds suit is tried out
//! with the trials of the search: START itself; START with its attitude loops made faster or slower
//! ([`Start::attitudes`]); the best of these with its position loops made faster or slower ([`Speed::positions`]). The
//! search starts at the best of all, so never at worse gains than START.

/// Which loop a gain belongs to, and by which power of that loop's speed it grows: one in 1/s^n by the n-th.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pace {
    /// Of the attitude.
    Attitude(i32),
    /// Of the attitude, and a torque: it grows with the vehicle's inertia as well.
    Torque(i32),
    /// Of the position.
    Position(i32),
    /// Of neither: a limit, a share or a filter.
    Kept,
}

/// Stiffness and damping of the position across and vertical and of the attitude in tilt and yaw, in 1/s^2 and 1/s.
pub const STIFFNESS_AND_DAMPING: [Pace; 8] = [
    Pace::Position(2),
    Pace::Position(1),
    Pace::Position(2),
    Pace::Position(1),
    Pace::Attitude(2),
    Pace::Attitude(1),
    Pace::Attitude(2),
    Pace::Attitude(1),
];

/// The factors of START.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Speed {
    /// How many times as fast the attitude loops are.
    pub attitude: f64,
    /// Likewise the position loops.
    pub position: f64,
    /// How many times as much inertia is turned.
    pub inertia: f64,
}

impl Speed {
    /// START's own.
    pub const UNSCALED: Self = Self { attitude: 1.0, position: 1.0, inertia: 1.0 };

    /// Itself, and with other position loops.
    pub fn positions(self) -> Vec<Self> {
        [1.0, 2.0, 1.4, 0.7, 0.5, 0.35].map(|position| Self { position, ..self }).into()
    }
}

/// A rival's START on a vehicle.
#[derive(Debug, Clone, Copy)]
pub struct Start {
    /// START.
    pub gains: &'static [f64],
    /// The speed that each of them scales with.
    pub paces: &'static [Pace],
    /// How many times as much inertia the vehicle has as the one of START.
    pub inertia: f64,
}

impl Start {
    /// Its own speed, and other attitude loops for the vehicle's inertia.
    pub fn attitudes(&self) -> Vec<Speed> {
        let of_vehicle = |attitude| Speed { attitude, inertia: self.inertia, ..Speed::UNSCALED };
        let all = [2.8, 2.0, 1.4, 1.0, 0.7, 0.5, 0.35].map(of_vehicle);
        std::iter::once(Speed::UNSCALED).chain(all).collect()
    }

    /// The gains at `speed`.
    pub fn at(&self, speed: Speed) -> Vec<f64> {
        let gain = |(gain, pace): (&f64, &Pace)| match *pace {
            Pace::Attitude(power) => gain * speed.attitude.powi(power),
            Pace::Torque(power) => gain * speed.attitude.powi(power) * speed.inertia,
            Pace::Position(power) => gain * speed.position.powi(power),
            Pace::Kept => *gain,
        };
        self.gains.iter().zip(self.paces).map(gain).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const START: Start = Start {
        gains: &[10.0, 20.0, 30.0, 40.0],
        paces: &[Pace::Attitude(2), Pace::Torque(1), Pace::Position(2), Pace::Kept],
        inertia: 0.5,
    };

    #[test]
    fn each_gain_follows_its_loop_by_its_power() {
        assert_eq!(START.at(Speed::UNSCALED), START.gains);
        assert_eq!(START.at(Speed { attitude: 2.0, position: 0.5, inertia: 0.25 }), [40.0, 10.0, 7.5, 40.0]);
    }

    #[test]
    fn the_speeds_that_are_tried_begin_with_the_one_they_are_made_from() {
        let attitudes = START.attitudes();
        assert_eq!(attitudes[0], Speed::UNSCALED);
        assert!(attitudes[1..].iter().all(|speed| speed.inertia == 0.5 && speed.position == 1.0), "{attitudes:?}");
        let positions = attitudes[2].positions();
        assert_eq!(positions[0], attitudes[2]);
        assert!(positions.iter().all(|speed| speed.attitude == 2.0), "{positions:?}");
    }
}
