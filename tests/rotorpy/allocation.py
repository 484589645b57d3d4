"""From a wrench (thrust along body z, torque about the body axes) to the thrusts of four rotors, N.

With B the map from thrusts to wrench, f = B^-1 w. Both allocations start there; they differ where a thrust is out of range:

- `Clipping`: each rotor on its own into its range. RotorPy's SE3 controller leaves this to its vehicle, and the project's
  law is flown so as well: for four rotors B^-1 is the least-squares inverse that the flight computers use.
- `TorqueFirst`: roll and pitch torque are kept, thrust gives way to them, and yaw gives way to both.
"""

import numpy as np


def wrench_from_thrusts(parameters):
    """B for a vehicle as RotorPy describes it: rows thrust, torque x, y, z."""
    rotors = np.array(list(parameters["rotor_pos"].values()))
    drag = parameters["k_m"] / parameters["k_eta"] * np.asarray(parameters["rotor_directions"], float)
    return np.vstack([np.ones(len(rotors)), rotors[:, 1], -rotors[:, 0], drag])


def greatest_thrust(parameters):
    """Of one rotor, N. The least is zero: a rotor that stands still."""
    assert parameters["rotor_speed_min"] == 0, parameters["rotor_speed_min"]
    return parameters["k_eta"] * parameters["rotor_speed_max"] ** 2


class Clipping:
    def __init__(self, parameters):
        self.inverse = np.linalg.inv(wrench_from_thrusts(parameters))
        self.greatest = greatest_thrust(parameters)

    def thrusts(self, wrench):
        return np.clip(self.inverse @ wrench, 0.0, self.greatest)


class TorqueFirst:
    """For rotors 1 and 3, 2 and 4 opposite each other, the two pairs turning opposite ways.

    A pair's thrusts are mean + half and mean - half. The two halves alone make roll and pitch torque, along two orthogonal
    axes; the sum of the means makes thrust, their difference yaw. A pair is in range if |half| <= mean <= greatest - |half|.
    So, in this order, each to the nearest value that what comes before it leaves:

        |half_a|, |half_b| <= greatest / 2
        |half_a| + |half_b| <= mean_a + mean_b <= 2 greatest - |half_a| - |half_b|
        mean_a - mean_b, by both pairs' ranges
    """

    def __init__(self, parameters):
        forward = wrench_from_thrusts(parameters)
        self.inverse = np.linalg.inv(forward)
        self.greatest = greatest_thrust(parameters)
        roll_pitch = forward[1:3]
        opposite = np.allclose(roll_pitch[:, :2], -roll_pitch[:, 2:], atol=1e-9)
        square = abs(roll_pitch[:, 0] @ roll_pitch[:, 1]) < 1e-9
        turning = np.sign(forward[3])
        if not (opposite and square and turning[0] == turning[2] == -turning[1] == -turning[3]):
            raise ValueError("torque first: needs a square of four rotors, opposite ones turning the same way")

    def thrusts(self, wrench):
        first, second, third, fourth = self.inverse @ wrench
        half_a, half_b = np.clip([(first - third) / 2, (second - fourth) / 2], -self.greatest / 2, self.greatest / 2)
        size_a, size_b = abs(half_a), abs(half_b)
        total = np.clip((first + second + third + fourth) / 2, size_a + size_b, 2 * self.greatest - size_a - size_b)
        difference = (first + third - second - fourth) / 2
        mean_a = (total + difference) / 2
        mean_a = np.clip(mean_a, size_a, self.greatest - size_a)
        mean_a = np.clip(mean_a, total - (self.greatest - size_b), total - size_b)
        mean_b = total - mean_a
        return np.clip([mean_a + half_a, mean_b + half_b, mean_a - half_a, mean_b - half_b], 0.0, self.greatest)
