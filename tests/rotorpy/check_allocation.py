"""The two allocations against RotorPy's own matrix, worked examples, and a general solver."""

import unittest

import numpy as np
from rotorpy.controllers.quadrotor_control import SE3Control
from scipy.optimize import linprog, lsq_linear

from allocation import Clipping, TorqueFirst, greatest_thrust, wrench_from_thrusts
from vehicle import GRAVITY, PARAMETERS

B = wrench_from_thrusts(PARAMETERS)
GREATEST = greatest_thrust(PARAMETERS)
WEIGHT = PARAMETERS["mass"] * GRAVITY
LEVER = PARAMETERS["rotor_pos"]["r1"][1]  # m, from a rotor to the roll axis
DRAG = PARAMETERS["k_m"] / PARAMETERS["k_eta"]  # m, drag torque over thrust


def nearest_in_order(wrench):
    """Roll and pitch, then thrust, then yaw, each the nearest that is left: by bounded least squares and linear programs."""
    bounds = [(0.0, GREATEST)] * 4
    roll_pitch = B[1:3] @ lsq_linear(B[1:3], wrench[1:3], bounds=(0.0, GREATEST), method="bvls").x

    def nearest(row, value, kept, kept_values):
        low, high = (linprog(sign * row, A_eq=kept, b_eq=kept_values, bounds=bounds) for sign in (1.0, -1.0))
        assert low.success and high.success
        return np.clip(value, low.fun, -high.fun)

    thrust = nearest(B[0], wrench[0], B[1:3], roll_pitch)
    yaw = nearest(B[3], wrench[3], B[:3], np.append(thrust, roll_pitch))
    return np.array([thrust, *roll_pitch, yaw])


class Allocations(unittest.TestCase):
    def test_the_matrix_is_rotorpys(self):
        np.testing.assert_allclose(B, SE3Control(PARAMETERS).f_to_TM, rtol=0, atol=1e-12)

    def test_a_wrench_within_reach_is_delivered_by_both(self):
        random = np.random.default_rng(1)
        for _ in range(1000):
            thrusts = random.uniform(0.0, GREATEST, 4)
            for allocation in (Clipping(PARAMETERS), TorqueFirst(PARAMETERS)):
                np.testing.assert_allclose(allocation.thrusts(B @ thrusts), thrusts, rtol=0, atol=1e-9)

    def test_roll_upside_down_takes_the_least_thrust_that_rolls(self):
        # The law asks for minus the weight along body z; what rolls is two rotors on one side, the others standing still.
        thrusts = TorqueFirst(PARAMETERS).thrusts([-WEIGHT, 0.1, 0.0, 0.0])
        one = 0.1 / (2 * LEVER)
        np.testing.assert_allclose(thrusts, [one, 0.0, 0.0, one], rtol=0, atol=1e-9)
        # Clipped, nothing is left of the torque.
        np.testing.assert_array_equal(Clipping(PARAMETERS).thrusts([-WEIGHT, 0.1, 0.0, 0.0]), np.zeros(4))

    def test_yaw_takes_what_thrust_leaves(self):
        thrusts = TorqueFirst(PARAMETERS).thrusts([WEIGHT, 0.0, 0.0, 1.0])
        np.testing.assert_allclose(thrusts, [WEIGHT / 2, 0.0, WEIGHT / 2, 0.0], rtol=0, atol=1e-9)
        self.assertAlmostEqual((B @ thrusts)[3], DRAG * WEIGHT, 12)

    def test_out_of_reach_each_gives_way_in_its_turn(self):
        random = np.random.default_rng(2)
        scale = np.array([60.0, 3.0, 3.0, 1.0])
        given_up = np.zeros(3, int)
        for _ in range(200):
            wrench = random.uniform(-1.0, 1.0, 4) * scale * random.choice([0.1, 0.5, 1.0])
            thrusts = TorqueFirst(PARAMETERS).thrusts(wrench)
            self.assertTrue((thrusts >= 0.0).all() and (thrusts <= GREATEST).all())
            delivered = B @ thrusts
            np.testing.assert_allclose(delivered, nearest_in_order(wrench), rtol=0, atol=1e-5)
            off = np.abs(delivered - wrench) > 1e-6
            given_up += [off[1] or off[2], off[0], off[3]]
        # All three are met, yaw most often.
        self.assertTrue(20 < given_up[0] < given_up[1] < given_up[2], given_up)

    def test_other_geometries_are_refused(self):
        def with_rotors(**places):
            return dict(PARAMETERS, rotor_pos=PARAMETERS["rotor_pos"] | places)

        places = PARAMETERS["rotor_pos"]
        not_opposite = with_rotors(r3=0.9 * places["r3"])
        not_square = with_rotors(**{name: place * [1.2, 1.0, 1.0] for name, place in places.items()})
        turning_alike = dict(PARAMETERS, rotor_directions=np.array([1, 1, -1, -1]))
        for parameters in (not_opposite, not_square, turning_alike):
            with self.assertRaises(ValueError):
                TorqueFirst(parameters)


if __name__ == "__main__":
    unittest.main()
