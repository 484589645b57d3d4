"""One vehicle under its rotors' thrusts."""

import copy

import numpy as np
import pytest
import saturated_hybrid as sh

HUMMINGBIRD = sh.Scenario.built_in("hummingbird")
GRAVITY, MASS = 9.81, 0.5
ON_THE_GROUND = HUMMINGBIRD.edited({"ground": {}, "initial.position": [1.0, 0.0, 0.0]})


def flown(vehicle, thrusts, steps):
    for _ in range(steps):
        vehicle.step(thrusts)
    return vehicle.state


def test_a_vehicle_without_thrust_falls_and_feels_nothing():
    vehicle = sh.RotorVehicle(HUMMINGBIRD)
    state = flown(vehicle, np.zeros(4), 200)
    assert -2.0 < state[5] < -1.6  # m/s, after 0.2 s: the rotors were at hover and spun down, the air brakes
    assert np.abs(vehicle.specific_force).max() < 0.2
    assert not vehicle.stands


def test_on_the_ground_it_stands_until_its_rotors_lift_it():
    vehicle = sh.RotorVehicle(ON_THE_GROUND)
    flown(vehicle, np.zeros(4), 100)
    assert vehicle.stands
    assert vehicle.specific_force == pytest.approx([0.0, 0.0, GRAVITY])
    state = flown(vehicle, np.full(4, 1.2 * MASS * GRAVITY / 4), 300)
    assert state[2] > 0.03 and not vehicle.stands
    assert vehicle.thrusts.sum() == pytest.approx(1.2 * MASS * GRAVITY, rel=1e-3)


def test_a_rotor_that_pulls_more_rolls_it_away_from_its_side():
    vehicle = sh.RotorVehicle(HUMMINGBIRD)
    more, less = 1.3, 1.1
    state = flown(vehicle, [more, less, less, more], 50)
    # Rotors 1 and 4 are on the left, +y: more of them turns it about +x.
    assert state[10] > 0.1 and abs(state[11]) < 0.02


def test_a_copy_flies_on_to_the_same_bits():
    vehicle = sh.RotorVehicle(ON_THE_GROUND)
    flown(vehicle, [1.5, 1.4, 1.5, 1.4], 50)
    other = copy.deepcopy(vehicle)
    assert (flown(vehicle, [1.5, 1.4, 1.4, 1.4], 50) == flown(other, [1.5, 1.4, 1.4, 1.4], 50)).all()


@pytest.mark.parametrize(
    "thrusts, said", [([1.0] * 3, r"must have shape \(4,\), found \(3,\)"), ([np.nan] * 4, "must be finite")]
)
def test_thrusts_that_cannot_be_used_are_refused(thrusts, said):
    with pytest.raises(ValueError, match=f"thrusts: {said}"):
        sh.RotorVehicle(HUMMINGBIRD).step(thrusts)


def test_a_vehicle_without_rotors_is_refused():
    with pytest.raises(ValueError, match="rotors: must be there"):
        sh.RotorVehicle(sh.Scenario.built_in("paper"))
