"""The controllers behind one interface: RotorPy's, and the project's over its pipe."""

import contextlib
import io
import pathlib
import tempfile
import unittest

import numpy as np
from rotorpy.trajectories.hover_traj import HoverTraj

from compare import HUMMINGBIRD, PROGRAM, arguments
from controllers import SE3, Law, SE3TorqueFirst, UnusableAnswer
from flight import Flight, fly
from vehicle import GRAVITY, PARAMETERS, Conditions, Start, Vehicle

PERIOD, STEP = 0.01, 0.005
HOVER = np.sqrt(PARAMETERS["mass"] * GRAVITY / 4 / PARAMETERS["k_eta"])  # rad/s


def asked(controller, start=Start(), reference=HoverTraj()):
    """What a controller asks of the rotors at rest there."""
    return controller.command(0.0, PERIOD, Vehicle(Conditions(), start, STEP).state, reference.update(0.0))


class RotorPys(unittest.TestCase):
    def offset(self, controller, **conditions):
        flown = fly(Flight(HoverTraj(), 10.0, conditions=Conditions(**conditions)), controller, PERIOD, STEP)
        return flown.error[-1]

    def test_its_steady_offset_is_that_of_its_position_gains(self):
        across, vertical = SE3().law.kp_pos[[0, 2]]
        np.testing.assert_allclose(self.offset(SE3(), acceleration=(1.0, 0.0, 0.0)), [1 / across, 0.0, 0.0], atol=2e-4)
        low = -GRAVITY * (1 / 0.8 - 1) / vertical
        np.testing.assert_allclose(self.offset(SE3(), rotor_thrust=(0.8,) * 4), [0.0, 0.0, low], atol=2e-4)

    def test_torque_first_is_the_same_while_nothing_clips(self):
        near = HoverTraj(np.array([0.05, 0.03, 0.02]))
        plain, first = (fly(Flight(near, 2.0), pilot, PERIOD, STEP) for pilot in (SE3(), SE3TorqueFirst()))
        self.assertEqual((plain.clipped, first.clipped), (0, 0))
        np.testing.assert_allclose(first.position, plain.position, rtol=0, atol=1e-9)

    def test_upside_down_its_own_mixer_stops_and_torque_first_turns(self):
        start = Start(roll=179.0)
        stopped, within = asked(SE3(), start)
        self.assertFalse(within)
        np.testing.assert_array_equal(stopped, 0.0)
        turning, within = asked(SE3TorqueFirst(), start)
        self.assertFalse(within)
        self.assertGreater(turning.max(), 100.0)

    def test_eased_gains_keep_the_damping_ratio(self):
        ratio = [pilot.law.kd_att / np.sqrt(pilot.law.kp_att) for pilot in (SE3(), SE3(0.5))]
        self.assertAlmostEqual(*ratio, 12)
        self.assertEqual(SE3(0.5).law.kd_att, 0.5 * PARAMETERS["kd_att"])


class Ours(unittest.TestCase):
    def setUp(self):
        self.law = Law(PROGRAM, HUMMINGBIRD)
        self.addCleanup(self.law.close)

    def test_hovers_where_it_should(self):
        speeds, within = asked(self.law)
        self.assertTrue(within)
        np.testing.assert_allclose(speeds, HOVER, rtol=1e-6)

    def test_a_tilt_is_opposed_and_a_height_error_lowers_the_thrust(self):
        speeds, _ = asked(self.law, Start(roll=5.0))
        # Rolled right side down: the rotors on the right, 2 and 3, push harder.
        self.assertGreater(min(speeds[1], speeds[2]), max(speeds[0], speeds[3]))
        above = Flight(HoverTraj(), 0.5, start=Start(position=(0.0, 0.0, 1.0)))
        self.assertLess(fly(above, self.law, PERIOD, STEP).thrusts[-1].sum(), PARAMETERS["mass"] * GRAVITY)

    def test_a_refused_line_ends_the_flight_with_its_reason(self):
        with self.assertRaisesRegex(UnusableAnswer, "dt: must be from 0.00025"):
            self.law.command(0.0, 0.0, Vehicle(Conditions(), Start(), STEP).state, HoverTraj().update(0.0))

    def test_a_program_that_ends_is_an_error(self):
        self.law.process.kill()
        with self.assertRaisesRegex(UnusableAnswer, "ended early"):
            asked(self.law)


class Lines(unittest.TestCase):
    def test_hold_the_numbers_in_the_order_of_the_interface(self):
        state = {"x": [1.0, 2.0, 3.0], "v": [4.0, 5.0, 6.0], "q": [0.1, 0.2, 0.3, 0.4], "w": [7.0, 8.0, 9.0]}
        names = ("x", "x_dot", "x_ddot", "x_dddot", "x_ddddot")
        reference = {name: 10.0 * order + np.arange(3) for order, name in enumerate(names, 1)}
        reference |= {"yaw": 60.0, "yaw_dot": 61.0, "yaw_ddot": 62.0}
        with tempfile.TemporaryDirectory() as folder:
            recorder, heard = pathlib.Path(folder) / "recorder", pathlib.Path(folder) / "heard"
            recorder.write_text(f'#!/bin/sh\necho "$@" > {heard}\nread line\necho "$line" >> {heard}\necho 8.0 0.1 0.0 0.0\n')
            recorder.chmod(0o755)
            law = Law(recorder, "some.toml", ["--more", "1"])
            speeds, _ = law.command(0.5, 0.01, state, reference)
            law.close()
            called, line = heard.read_text().splitlines()
        self.assertEqual(called, "law some.toml --more 1")
        expected = [0.5, 0.01, *range(1, 7), 0.1, 0.2, 0.3, 0.4, 7, 8, 9, *range(10, 13), *range(20, 23), *range(30, 33),
                    *range(40, 43), *range(50, 53), 60, 61, 62]
        self.assertEqual([float(word) for word in line.split()], expected)
        # Roll to the right by 0.1 N m: the rotors on the left, 1 and 4, push harder than their 2 N by a quarter over the lever.
        more = 0.1 / 4 / PARAMETERS["rotor_pos"]["r1"][1]
        np.testing.assert_allclose(PARAMETERS["k_eta"] * speeds**2, [2 + more, 2 - more, 2 - more, 2 + more], rtol=1e-9)


class Arguments(unittest.TestCase):
    def test_a_law_takes_its_file_and_further_arguments(self):
        given = arguments(["--law", "new", f"{HUMMINGBIRD} --more 1", "--law", "old", str(HUMMINGBIRD)])
        self.assertEqual(given.law, {"new": (str(HUMMINGBIRD), ("--more", "1")), "old": (str(HUMMINGBIRD), ())})

    def test_what_cannot_be_flown_is_refused(self):
        for words, reason in ((["--law", "SE3", str(HUMMINGBIRD)], "label is taken"), (["--law", "new", "x.toml"], "x.toml"),
                              (["--rate", "0"], "above zero"), (["--rows", "nothing"], "no row")):
            said = io.StringIO()
            with self.assertRaises(SystemExit) as stopped, contextlib.redirect_stderr(said):
                arguments(words)
            self.assertEqual(stopped.exception.code, 2)
            self.assertIn(reason, said.getvalue())


if __name__ == "__main__":
    unittest.main()
