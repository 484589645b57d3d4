"""Delay, noise and velocity filter against what can be worked out by hand."""

import dataclasses
import unittest

import numpy as np
from scipy.spatial.transform import Rotation

from sensors import AlphaBeta, Delay, Noise, Sensors, turned

PERIOD = 0.01
LEVEL = np.array([0.0, 0.0, 0.0, 1.0])


def state(position, quaternion=LEVEL):
    return {"x": np.full(3, float(position)), "v": np.full(3, 10.0 + position), "q": quaternion,
            "w": np.full(3, 20.0 + position)}


class Delays(unittest.TestCase):
    def test_gives_back_what_came_two_calls_ago(self):
        delay = Delay(2)
        self.assertEqual([delay.pass_through(value) for value in range(6)], [0, 0, 0, 1, 2, 3])
        self.assertEqual([Delay(0).pass_through(value) for value in range(3)], [0, 1, 2])

    def test_everything_is_equally_late(self):
        sensors = Sensors(Noise(0.0, 0.0, 0.0, None, delay=0.02), PERIOD)
        quaternions = [Rotation.from_rotvec([0, 0, 0.1 * tick]).as_quat() for tick in range(8)]
        measured = [sensors.measure(state(tick, quaternions[tick])) for tick in range(8)]
        for tick in range(8):
            then = max(tick - 2, 0)
            for name, value in state(then, quaternions[then]).items():
                np.testing.assert_allclose(measured[tick][name], value, rtol=0, atol=1e-15)

    def test_a_delay_between_ticks_is_refused(self):
        with self.assertRaises(AssertionError):
            Sensors(Noise(0.0, 0.0, 0.0, None, delay=0.025), PERIOD)

    def test_without_noise_the_state_passes(self):
        true = state(3.0)
        self.assertIs(Sensors(None, PERIOD).measure(true), true)


class Turning(unittest.TestCase):
    def test_a_quarter_turn_about_body_axes(self):
        # Yaw 90 degrees, then roll 90 degrees about the new body x: body y, the world's -x at first, points up.
        yawed = Rotation.from_euler("z", 90, degrees=True).as_quat()
        rolled = Rotation.from_quat(turned(yawed, np.array([np.pi / 2, 0.0, 0.0])))
        np.testing.assert_allclose(rolled.apply([0.0, 1.0, 0.0]), [0.0, 0.0, 1.0], atol=1e-12)

    def test_is_the_product_with_a_rotation_vector(self):
        random = np.random.default_rng(3)
        for vector in [np.zeros(3), *random.normal(0.0, 1.0, (100, 3))]:
            start = Rotation.random(random_state=random.integers(1 << 30))
            found = Rotation.from_quat(turned(start.as_quat(), vector))
            self.assertLess((found.inv() * start * Rotation.from_rotvec(vector)).magnitude(), 1e-12)


class White(unittest.TestCase):
    def setUp(self):
        self.noise = Noise(gyro=0.01, position=0.002, attitude=0.0035, bandwidth=None, delay=0.0, seed=4)

    def samples(self, count=20000):
        sensors = Sensors(self.noise, PERIOD)
        tilted = Rotation.from_euler("xyz", [30, 40, 50], degrees=True)
        taken = [sensors.measure(state(1.0, tilted.as_quat())) for _ in range(count)]
        attitude = (tilted.inv() * Rotation.from_quat([sample["q"] for sample in taken])).as_rotvec()
        return {"position": np.array([sample["x"] for sample in taken]) - 1.0,
                "gyro": np.array([sample["w"] for sample in taken]) - 21.0, "attitude": attitude}

    def test_each_axis_has_the_stated_deviation_and_no_memory(self):
        for name, found in self.samples().items():
            wanted = getattr(self.noise, name)
            # Five deviations of what 20,000 samples show.
            np.testing.assert_allclose(found.std(axis=0), wanted, rtol=5 / np.sqrt(2 * 20000))
            np.testing.assert_allclose(found.mean(axis=0), 0.0, atol=5 * wanted / np.sqrt(20000))
            for lag in (1, 2):
                correlation = (found[lag:] * found[:-lag]).mean(axis=0) / wanted**2
                np.testing.assert_allclose(correlation, 0.0, atol=5 / np.sqrt(20000))

    def test_the_seed_alone_decides(self):
        first, again = self.samples(100), self.samples(100)
        self.noise = Noise(0.01, 0.002, 0.0035, None, 0.0, seed=5)
        other = self.samples(100)
        for name in first:
            np.testing.assert_array_equal(first[name], again[name])
            self.assertFalse(np.allclose(first[name], other[name]))


class Velocity(unittest.TestCase):
    def test_a_constant_velocity_is_found_by_a_double_pole(self):
        # The error of the velocity after k steps is v p^k (1 + c k): the second difference by p vanishes.
        tracker, speed, pole = AlphaBeta(20.0, PERIOD), np.array([1.0, -2.0, 0.5]), np.exp(-20.0 * PERIOD)
        error = np.array([tracker.update(tick * PERIOD * speed) - speed for tick in range(400)])
        np.testing.assert_allclose(error[2:] - 2 * pole * error[1:-1] + pole**2 * error[:-2], 0.0, atol=1e-12)
        self.assertGreater(np.abs(error[5]).max(), 0.1)
        np.testing.assert_allclose(error[-1], 0.0, atol=1e-12)

    def test_white_noise_comes_out_with_the_known_variance(self):
        # var v = 2 beta^2 / (T^2 alpha (4 - 2 alpha - beta)) var x: the steady state of the filter's Lyapunov equation.
        tracker = AlphaBeta(20.0, PERIOD)
        alpha, beta = tracker.alpha, tracker.beta
        wanted = 0.002 * np.sqrt(2 * beta**2 / (PERIOD**2 * alpha * (4 - 2 * alpha - beta)))
        random = np.random.default_rng(6)
        found = np.array([tracker.update(random.normal(0.0, 0.002, 3)) for _ in range(40000)])[1000:].std()
        self.assertLess(abs(found / wanted - 1.0), 0.05)
        self.assertLess(abs(wanted - 0.009), 0.001)

    def test_an_observer_knows_an_acceleration_at_once_and_tilted(self):
        # A constant 3 m/s^2 along world x, the vehicle pitched: its accelerometer feels it beside gravity.
        noise = Noise(0.0, 0.0, 0.0, 20.0, 0.0, accelerometer=0.0)
        observer, plain = Sensors(noise, PERIOD), Sensors(dataclasses.replace(noise, accelerometer=None), PERIOD)
        quaternion = Rotation.from_euler("yz", [20, 50], degrees=True).as_quat()
        for tick in range(100):
            time = tick * PERIOD
            true = {"x": np.array([1.5 * time**2, 0.0, 0.0]), "v": np.array([3.0 * time, 0.0, 0.0]), "q": quaternion,
                    "w": np.zeros(3)}
            seen, lagging = observer.measure(true), plain.measure(true)
            np.testing.assert_allclose(seen["v"], true["v"], rtol=0, atol=1e-9)
        self.assertGreater(abs(lagging["v"] - true["v"]).max(), 0.2)

    def test_an_accelerometer_s_noise_has_the_stated_deviation(self):
        sensors = Sensors(Noise(0.0, 0.0, 0.0, 20.0, 0.0, accelerometer=0.05), PERIOD)
        found = np.array([sensors.acceleration(state(0.0), LEVEL) for _ in range(20001)])[1:]
        np.testing.assert_allclose(found.std(axis=0), 0.05, rtol=5 / np.sqrt(2 * 20000))
        np.testing.assert_allclose(found.mean(axis=0), 0.0, atol=5 * 0.05 / np.sqrt(20000))

    def test_a_fast_filter_takes_differences(self):
        tracker = AlphaBeta(1e9, PERIOD)
        positions = np.random.default_rng(7).normal(0.0, 1.0, (20, 3))
        found = np.array([tracker.update(position) for position in positions])
        np.testing.assert_allclose(found[1:], np.diff(positions, axis=0) / PERIOD, rtol=1e-9)


if __name__ == "__main__":
    unittest.main()
