"""Vehicles from the files and dictionaries of other programs."""

import numpy as np
import pytest
import saturated_hybrid as sh
from rotorpy.vehicles.crazyflie_params import quad_params as crazyflie
from rotorpy.vehicles.hummingbird_params import quad_params as hummingbird
from rotorpy.vehicles.multirotor import Multirotor
from saturated_hybrid.rotorpy import SaturatedHybridControl, check_vehicle


@pytest.mark.parametrize("quad_params", [crazyflie, hummingbird])
def test_rotorpys_dictionary_becomes_a_vehicle_that_its_own_controller_takes_and_that_is_certified(quad_params):
    vehicle = sh.Vehicle.from_rotorpy(quad_params, "theirs")
    assert vehicle.missing == []
    scenario = vehicle.scenario()
    check_vehicle(quad_params, scenario)
    assert sh.certify(scenario)
    SaturatedHybridControl(quad_params, scenario)
    Multirotor(quad_params)
    flight = sh.fly(scenario.edited({"initial.euler_deg": [-179.0, 0.0, 100.0], "duration": 15.0}))
    log = flight.columns
    assert np.abs(log["pz"][-50:] - log["pdz"][-50:]).max() < 0.1


def test_what_a_dictionary_lacks_is_named_until_it_is_given():
    lacking = {key: value for key, value in crazyflie.items() if key not in ("mass", "tau_m")}
    vehicle = sh.Vehicle.from_rotorpy(lacking)
    assert vehicle.missing == ["vehicle.mass", "rotors.lag"]
    with pytest.raises(ValueError, match='vehicle: rotors.lag: marked "missing", as are vehicle.mass: measure it'):
        vehicle.scenario()
    assert vehicle.scenario({"vehicle.mass": 0.03, "rotors.lag": 0.072}).mass == pytest.approx(0.03)


@pytest.mark.parametrize(
    "changes, said",
    [
        ({"mass": "heavy"}, "mass: must be a number"),
        ({"mass": np.nan}, "mass: must be a finite number, found NaN"),
        ({"rotor_pos": {"r1": [1, 2]}}, "rotor_pos, position 1: must be three numbers"),
        ({"rotor_directions": [1, -1, 1]}, "rotor_directions: must have one element for each of num_rotors = 4, found 3"),
        ({"rotor_directions": [1, -1, 1, 0]}, "rotor_directions: must be a list of 1 (clockwise)"),
    ],
)
def test_a_malformed_dictionary_is_refused_by_its_key(changes, said):
    with pytest.raises(ValueError) as refused:
        sh.Vehicle.from_rotorpy(crazyflie | changes)
    assert said in str(refused.value)


def test_a_file_is_read_by_what_it_looks_like(tmp_path):
    file = tmp_path / "quad.params"
    rotors = "".join(f"1\t1\tCA_ROTOR{k}_PX\t{x}\t9\n1\t1\tCA_ROTOR{k}_PY\t{y}\t9\n" for k, (x, y) in enumerate([(1, 1), (-1, 1)]))
    file.write_text(f"1\t1\tCA_ROTOR_COUNT\t2\t6\n{rotors}")
    vehicle = sh.Vehicle.read(file)
    assert (vehicle.name, vehicle.missing[0]) == ("quad", "vehicle.mass")
    assert "[1.0, -1.0, 0.0]" in vehicle.text
    with pytest.raises(ValueError, match="format: must be one of rotorpy, urdf, sdf, mujoco, px4, found 'x'|found \"x\""):
        sh.Vehicle.read(file, format="x")
