"""What a flight changes about RotorPy's vehicle, against mechanics worked out by hand."""

import unittest

import numpy as np
from scipy.spatial.transform import Rotation

from vehicle import GRAVITY, PARAMETERS, Conditions, Start, Vehicle

MASS, K_ETA = PARAMETERS["mass"], PARAMETERS["k_eta"]
HOVER = np.full(4, np.sqrt(MASS * GRAVITY / 4 / K_ETA))  # rad/s
STEP, TICK = 0.005, 0.01  # s


def moved(conditions, speeds, ticks=10, start=Start(), step=STEP):
    """The state after some ticks of constant commands."""
    vehicle = Vehicle(conditions, start, step)
    for tick in range(ticks):
        vehicle.hold(speeds, tick * TICK, TICK)
    return vehicle.state


def acceleration(conditions, start=Start()):
    """Of the vehicle at rest with hovering rotors, and its angular acceleration, by a step so short that nothing bends."""
    short = 1e-6
    vehicle = Vehicle(conditions, start, short)
    vehicle.hold(HOVER, 0.0, short)
    return vehicle.state["v"] / short, vehicle.state["w"] / short


class Conditioned(unittest.TestCase):
    def test_nominal_hover_stays(self):
        state = moved(Conditions(), HOVER, 100)
        np.testing.assert_allclose(np.concatenate([state["x"], state["v"], state["w"]]), 0.0, atol=1e-9)

    def test_still_rotors_fall_freely(self):
        start = Start(position=(1.0, 2.0, 3.0), velocity=(0.5, -0.25, 1.0))
        state = moved(Conditions(drag=False, lag=False), np.zeros(4), 100, start)
        np.testing.assert_allclose(state["x"], [1.5, 1.75, 4.0 - GRAVITY / 2], rtol=1e-9)

    def test_without_lag_the_command_acts_at_once(self):
        # Thrust of twice the weight for a second.
        state = moved(Conditions(drag=False, lag=False), np.sqrt(2) * HOVER, 100)
        np.testing.assert_allclose(state["x"], [0.0, 0.0, GRAVITY / 2], rtol=1e-9, atol=1e-12)

    def test_a_constant_acceleration_acts_in_the_world(self):
        upside_down = Start(roll=180.0)
        for start in (Start(), upside_down):
            found = acceleration(Conditions(acceleration=(1.0, 2.0, 3.0)), start)[0] - acceleration(Conditions(), start)[0]
            np.testing.assert_allclose(found, [1.0, 2.0, 3.0], rtol=1e-6)

    def test_thrust_and_mass_scale_the_climb(self):
        for conditions, ratio in ((Conditions(rotor_thrust=(0.8,) * 4), 0.8), (Conditions(rotor_thrust=(1.2,) * 4), 1.2),
                                  (Conditions(mass=1.2), 1 / 1.2)):
            linear, angular = acceleration(conditions)
            np.testing.assert_allclose(linear, [0.0, 0.0, GRAVITY * (ratio - 1)], rtol=1e-6, atol=1e-9)
            np.testing.assert_allclose(angular, 0.0, atol=1e-9)

    def test_a_centre_of_mass_ahead_of_the_rotors_tips_forward(self):
        _, angular = acceleration(Conditions(centre_of_mass=(0.005, 0.0, 0.0)))
        np.testing.assert_allclose(angular, [0.0, 0.005 * MASS * GRAVITY / PARAMETERS["Iyy"], 0.0], rtol=1e-6, atol=1e-9)

    def test_a_weak_rotor_lacks_its_thrust_and_its_drag_torque(self):
        linear, angular = acceleration(Conditions(rotor_thrust=(0.95, 1.0, 1.0, 1.0)))
        lacking = 0.05 * MASS * GRAVITY / 4
        x, y, _ = PARAMETERS["rotor_pos"]["r1"]
        torque = np.array([-y * lacking, x * lacking, -PARAMETERS["k_m"] / K_ETA * lacking])
        np.testing.assert_allclose(linear, [0.0, 0.0, -lacking / MASS], rtol=1e-6, atol=1e-9)
        np.testing.assert_allclose(angular, torque / [PARAMETERS[name] for name in ("Ixx", "Iyy", "Izz")], rtol=1e-6)

    def test_wind_pushes_by_rotor_and_frame_drag_and_lifts(self):
        linear, _ = acceleration(Conditions(wind=(5.0, 0.0, 0.0)))
        push = 4 * PARAMETERS["k_d"] * HOVER[0] * 5.0 + PARAMETERS["c_Dx"] * 25.0
        lift = 4 * PARAMETERS["k_h"] * 25.0
        np.testing.assert_allclose(linear, [push / MASS, 0.0, lift / MASS], rtol=1e-5, atol=1e-9)
        self.assertAlmostEqual(push / MASS, 2.48, 2)

    def test_without_drag_wind_does_nothing(self):
        np.testing.assert_allclose(acceleration(Conditions(drag=False, wind=(5.0, 0.0, 0.0)))[0], 0.0, atol=1e-9)


class Integrated(unittest.TestCase):
    def lag_error(self, step):
        """Of the rotors' speed after one tick of lag from hover to standing still."""
        found = moved(Conditions(), np.zeros(4), 1, step=step)["rotor_speeds"]
        return np.abs(found / HOVER - np.exp(-TICK / PARAMETERS["tau_m"])).max()

    def test_the_motors_lag_as_they_should(self):
        self.assertLess(self.lag_error(STEP), 5e-4)

    def test_the_order_is_the_fifth(self):
        errors = [self.lag_error(TICK / steps) for steps in (8, 16, 32)]
        for coarse, fine in zip(errors, errors[1:]):
            self.assertTrue(4.7 < np.log2(coarse / fine) < 5.5, errors)


class Started(unittest.TestCase):
    def test_attitudes_are_roll_then_yaw(self):
        for roll, yaw in ((0.0, 0.0), (90.0, 0.0), (-179.0, 100.0), (180.0, 0.0)):
            wanted = Rotation.from_euler("ZX", [yaw, roll], degrees=True)
            self.assertLess((Rotation.from_quat(Start(roll=roll, yaw=yaw).quaternion()) * wanted.inv()).magnitude(), 1e-12)

    def test_half_a_turn_is_exact(self):
        np.testing.assert_array_equal(Start(roll=180.0).quaternion(), [1.0, 0.0, 0.0, 0.0])


if __name__ == "__main__":
    unittest.main()
