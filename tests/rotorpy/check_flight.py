"""How a flight ends, the figures read off a made-up record, and the cells they become."""

import math
import unittest

import numpy as np
from rotorpy.trajectories.hover_traj import HoverTraj

from controllers import speeds
from flight import Flight, Record, fly
from table import cell, markdown
from vehicle import GRAVITY, PARAMETERS, Conditions

PERIOD = 0.01
HOVER = np.full(4, PARAMETERS["mass"] * GRAVITY / 4)  # N


def record(error, thrusts=None):
    """A record whose reference is the origin."""
    error = np.asarray(error, float)
    return Record(PERIOD, error, error, np.zeros((len(error), 4)) if thrusts is None else thrusts, 0, False)


def along_x(distance):
    return np.outer(distance, [1.0, 0.0, 0.0])


class Constant:
    """Always the same thrusts, N; keeps what it was shown."""

    def __init__(self, thrusts):
        self.thrusts, self.shown = np.asarray(thrusts, float), []

    def command(self, time, period, state, reference):
        self.shown.append((time, period, state["x"].copy(), reference["x"]))
        return speeds(self.thrusts, self.thrusts)


class Figures(unittest.TestCase):
    def setUp(self):
        self.time = np.arange(0.0, 20.0, PERIOD)

    def test_heights(self):
        height = np.concatenate([np.linspace(1.0, -2.0, 100), np.linspace(-2.0, 1.5, 100)])
        found = record(np.outer(height, [0.0, 0.0, 1.0]))
        self.assertAlmostEqual(found.height_lost(), 3.0, 12)
        self.assertAlmostEqual(found.rise(), 0.5, 12)

    def test_arrival_is_for_good(self):
        # e^-t is below 0.1 from ln 10 on; a later visit outside moves the arrival behind it.
        distance = np.exp(-self.time)
        self.assertAlmostEqual(record(along_x(distance)).arrival(), math.ceil(100 * math.log(10)) / 100, 9)
        distance[1000] = 0.11
        self.assertAlmostEqual(record(along_x(distance)).arrival(), 10.01, 9)
        distance[-100] = 0.11
        self.assertIsNone(record(along_x(distance)).arrival())
        self.assertEqual(record(along_x(0.0 * self.time)).arrival(), 0.0)

    def test_offset_and_drift(self):
        offset, drift = record(np.tile([3.0, 4.0, 12.0], (2000, 1))).offset()
        self.assertAlmostEqual(offset, 13.0, 12)
        self.assertAlmostEqual(drift, 0.0, 12)
        self.assertAlmostEqual(record(along_x(0.7 * self.time)).offset()[1], 0.7, 9)
        # Over two periods of a motion about 0.3 m only the middle remains.
        circling = along_x(0.3 + np.sin(np.pi / 2 * self.time))
        np.testing.assert_allclose(record(circling).offset(8.0), (0.3, 0.0), atol=1e-9)

    def test_root_mean_square_of_the_last_seconds(self):
        distance = np.where(self.time < 10.0, 100.0, 2.0 * np.sin(2 * np.pi * self.time))
        self.assertAlmostEqual(record(along_x(distance)).rms(10.0), math.sqrt(2.0), 9)
        self.assertAlmostEqual(record(along_x(distance)).deepest(), 100.0, 9)

    def test_rotor_activity(self):
        # One rotor alternates by 0.4 N, one climbs by 0.1 N a tick, two rest.
        ticks = np.arange(2000)
        thrusts = np.stack([0.4 * (ticks % 2), 0.1 * ticks, 0.0 * ticks, 0.0 * ticks], axis=1)
        found = record(along_x(0.0 * ticks), thrusts).rotor_activity(5.0)
        np.testing.assert_allclose(found, (0.5 / 4, math.sqrt((0.4**2 + 0.1**2) / 4)), rtol=1e-9)


class Ends(unittest.TestCase):
    def flown(self, thrusts, reference=HoverTraj(), **flight):
        pilot = Constant(thrusts)
        return fly(Flight(reference, **flight), pilot, PERIOD, 0.005), pilot

    def test_at_its_limit(self):
        found, pilot = self.flown(HOVER, duration=1.0)
        self.assertEqual(len(found.error), 100)
        self.assertFalse(found.lost)
        np.testing.assert_allclose(found.thrusts, np.tile(HOVER, (100, 1)), rtol=1e-12)
        np.testing.assert_allclose([time for time, *_ in pilot.shown], np.arange(100) * PERIOD, atol=1e-12)

    def test_lost_two_hundred_metres_away(self):
        # Free fall, no drag: 200 m after 6.385 s.
        found, _ = self.flown(np.zeros(4), duration=20.0, conditions=Conditions(drag=False, lag=False))
        self.assertTrue(found.lost)
        self.assertEqual(len(found.error), math.ceil(100 * math.sqrt(400 / GRAVITY)))

    def test_nothing_else_ends_it(self):
        near, _ = self.flown(HOVER, duration=12.0)
        self.assertEqual((len(near.error), near.arrival()), (1200, 0.0))
        far, _ = self.flown(HOVER, HoverTraj(np.array([1.0, 0.0, 0.0])), duration=8.0)
        self.assertEqual((len(far.error), far.arrival()), (800, None))


class Cells(unittest.TestCase):
    def test_say_what_happened(self):
        fine = {"lost": False}
        for figures, text in (
            (None, "-"),
            ({"lost": True}, "lost"),
            (fine | {"height_lost": 2.1936, "risen": 0.0, "arrival": 2.54}, "2.19, 0, 2.54"),
            (fine | {"height_lost": 125.4, "risen": 1e-9, "arrival": None}, "125, <1e-6, not in 60 s"),
            (fine | {"arrival": 1.22}, "1.22"),
            (fine | {"offset": 0.15385, "drift": 1e-6}, "0.154"),
            (fine | {"offset": 7.688, "drift": 0.0012}, "7.69"),
            (fine | {"offset": 0.0001, "drift": 0.00011}, "drifts, 0.00011 m/s"),
            (fine | {"offset": 50.0, "drift": 0.5}, "drifts, 0.5 m/s"),
            (fine | {"deepest": 12.0, "drift": 0.5}, "drifts, 0.5 m/s"),
            (fine | {"deepest": 0.386, "drift": 0.0}, "0.386"),
            (fine | {"rms": 0.0139, "rotor_change": 0.39}, "0.0139, 0.39"),
            (fine | {"rms": 0.0462, "drift": 0.0}, "0.0462"),
            (fine | {"rms": 59.4, "drift": 2.0}, "drifts, 2 m/s"),
        ):
            self.assertEqual(cell(figures, 60.0), text)

    def test_columns_are_as_wide_as_their_widest(self):
        self.assertEqual(markdown(["a", "long"], [["wide", "b"]]),
                         "| a    | long |\n| ---- | ---- |\n| wide | b    |")


if __name__ == "__main__":
    unittest.main()
