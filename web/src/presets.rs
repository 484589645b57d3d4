//! Vehicles to begin with: those of `vehicles/`, of `vehicles/published/` some of each size, and the paper's.

use serde::Serialize;

/// A vehicle to begin with.
#[derive(Debug, Serialize)]
pub struct Preset {
    /// Its name in links.
    pub id: &'static str,
    /// Its name in the menu.
    pub name: &'static str,
    /// What it is, and where its numbers come from.
    pub about: &'static str,
    /// The file's name.
    pub file: &'static str,
    /// The file.
    pub text: &'static str,
}

macro_rules! preset {
    ($id:literal, $folder:literal, $name:literal, $about:literal) => {
        Preset {
            id: $id,
            name: $name,
            about: $about,
            file: concat!($id, ".toml"),
            text: include_str!(concat!("../../vehicles/", $folder, $id, ".toml")),
        }
    };
}

/// All of them, in the order of the menu.
pub fn all() -> [Preset; 10] {
    [
        preset!("hummingbird", "", "Hummingbird, 0.5 kg", "AscTec's research quadrotor, with RotorPy's numbers."),
        preset!("cf2x-pybullet", "published/", "Crazyflie 2, 27 g", "With the numbers of gym-pybullet-drones."),
        preset!("cfb-rotorpy", "published/", "Crazyflie Brushless, 44 g", "With RotorPy's numbers."),
        preset!("x500", "published/", "x500, 2.1 kg", "Holybro's frame as PX4 simulates it in Gazebo."),
        preset!("iris", "published/", "iris, 1.5 kg", "3DR's quadrotor, with the numbers of rotors_simulator."),
        preset!("pelican", "published/", "pelican, 1.0 kg", "AscTec's quadrotor in a plus, from rotors_simulator."),
        preset!("firefly", "published/", "firefly, 1.5 kg", "AscTec's hexacopter, from rotors_simulator."),
        preset!("racer-pybullet", "published/", "racer, 0.8 kg", "A racing frame, from gym-pybullet-drones."),
        preset!("study", "", "design study, 0.46 kg", "The paper's body with slow rotors: no vehicle that exists."),
        preset!(
            "paper",
            "../scenarios/",
            "the paper's vehicle, 0.46 kg",
            "Under the paper's law. It has no rotors: thrust and torque act at once."
        ),
    ]
}
