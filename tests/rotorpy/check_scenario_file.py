"""Whose vehicle a scenario file describes, and what a changed copy of it says."""

import pathlib
import tempfile
import tomllib
import unittest

from compare import HUMMINGBIRD
from rows import IDEAL
from scenario_file import changed, check_vehicle


class Vehicles(unittest.TestCase):
    def test_the_projects_hummingbird_is_rotorpys(self):
        check_vehicle(HUMMINGBIRD)

    def test_another_vehicle_is_refused_by_name(self):
        text = HUMMINGBIRD.read_text()
        with tempfile.TemporaryDirectory() as folder:
            for name, old, new in (("vehicle.mass", "mass = 0.500", "mass = 0.501"),
                                   ("rotors.thrust_coefficient", "5.57e-6", "5.58e-6"),
                                   ("rotors.spin", '["cw", "ccw", "cw", "ccw"]', '["ccw", "cw", "ccw", "cw"]'),
                                   ("rotors.lag", "lag = 0.005 ", "delay = 0.005 "),
                                   ("rotors.position", "[0.120208, 0.120208, 0.0]", "[0.121, 0.120208, 0.0]")):
                self.assertIn(old, text)
                other = pathlib.Path(folder) / "other.toml"
                other.write_text(text.replace(old, new))
                with self.assertRaisesRegex(ValueError, name):
                    check_vehicle(other)

    def test_a_file_that_cannot_be_read_is_refused_by_name(self):
        with self.assertRaisesRegex(ValueError, "nowhere.toml"):
            check_vehicle("nowhere.toml")


class Copies(unittest.TestCase):
    def test_differ_in_what_is_changed_and_in_nothing_else(self):
        text = HUMMINGBIRD.read_text()
        wanted = tomllib.loads(text)
        for section, key, value in IDEAL:
            self.assertNotEqual(wanted.get(section, {}).get(key), value)
            wanted.setdefault(section, {})[key] = value
        self.assertEqual(tomllib.loads(changed(text, IDEAL)), wanted)
        self.assertEqual(changed(text, ()), text)

    def test_a_key_elsewhere_is_left_alone_and_one_that_is_missing_is_added(self):
        text = "[a]\nlag = 1.0 # s\n[b]\nlag = 2.0\n"
        self.assertEqual(changed(text, (("b", "lag", 0.0),)), "[a]\nlag = 1.0 # s\n[b]\nlag = 0.0\n")
        self.assertEqual(changed(text, (("a", "delay", 0.0),)), "[a]\ndelay = 0.0\nlag = 1.0 # s\n[b]\nlag = 2.0\n")
        self.assertEqual(tomllib.loads(changed(text, (("c", "delay", 0.0),)))["c"], {"delay": 0.0})


if __name__ == "__main__":
    unittest.main()
