"""The same flight twice: in RotorPy under `host-sim law`, and in `host-sim fly`, which has no line of text, no Python and a
vehicle of its own with RotorPy's drag. Frame, order of the quaternion, order of the rotors, units: what either side has
otherwise than the other drives the two apart."""

import csv
import pathlib
import subprocess
import tempfile
import unittest

import numpy as np
from rotorpy.trajectories.circular_traj import ThreeDCircularTraj

from compare import HUMMINGBIRD, PROGRAM
from controllers import Law
from flight import Flight, fly
from vehicle import Start

PERIOD, STEP, DURATION = 0.01, 0.0025, 4.0
ROLL, YAW = 150.0, 40.0
CENTER, START = (0.0, 0.0, 1.5), (1.0, 0.0, 1.5)


def flown_by_host_sim():
    """Positions at the ticks, m."""
    text = HUMMINGBIRD.read_text()
    for old, new in (("duration = 40.0", f"duration = {DURATION}"), ("[initial]", f"[initial]\neuler_deg = [{ROLL}, 0.0, {YAW}]")):
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "turned.toml"
        file.write_text(text)
        ran = subprocess.run([PROGRAM, "fly", file, "--out", folder], capture_output=True, text=True)
        # 1: a claim about tracking does not hold so soon.
        assert ran.returncode in (0, 1), ran.stderr
        with open(pathlib.Path(folder) / "log.csv") as log:
            rows = list(csv.DictReader(log))
    return np.array([[float(row[name]) for name in ("px", "py", "pz")] for row in rows])


def flown_in_rotorpy():
    circle = ThreeDCircularTraj(np.array(CENTER), np.array([1.0, 1.0, 0.0]), np.array([0.25, 0.25, 0.0]))
    law = Law(PROGRAM, HUMMINGBIRD)
    try:
        return fly(Flight(circle, DURATION, Start(START, roll=ROLL, yaw=YAW)), law, PERIOD, STEP)
    finally:
        law.close()


class Agreement(unittest.TestCase):
    def test_of_a_turn_from_upside_down_onto_the_circle(self):
        ours, theirs = flown_by_host_sim(), flown_in_rotorpy()
        count = round(DURATION / PERIOD)
        apart = np.linalg.norm(theirs.position[:count] - ours[:count], axis=1)
        self.assertEqual(len(apart), count)
        self.assertGreater(theirs.height_lost(), 0.5)
        # Found: 4 um.
        self.assertLess(apart.max(), 5e-5)


class Trajectories(unittest.TestCase):
    def test_each_derivative_is_that_of_the_one_before(self):
        circle = ThreeDCircularTraj(np.array(CENTER), np.array([1.0, 1.0, 0.0]), np.array([0.25, 0.25, 0.0]))
        names = ("x", "x_dot", "x_ddot", "x_dddot", "x_ddddot")
        step = 1e-4
        for time in (0.0, 0.7, 2.9):
            before, now, after = (circle.update(time + shift) for shift in (-step, 0.0, step))
            for name, derivative in zip(names, names[1:]):
                np.testing.assert_allclose((after[name] - before[name]) / (2 * step), now[derivative], atol=1e-6)


if __name__ == "__main__":
    unittest.main()
