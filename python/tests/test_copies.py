"""Copies and pickles: each flies on, to the same bits, from where its original was."""

import copy
import pickle

import numpy as np
import pytest
import saturated_hybrid as sh
from saturated_hybrid.environment import Environment, VectorEnvironment

HUMMINGBIRD = sh.Scenario.built_in("hummingbird")
PAPER = sh.Scenario.built_in("paper")
BOX = {"low": [-4, -4, 0.5], "high": [4, 4, 5]}
TURBULENCE = {"wind_at_20_feet": 5.0, "altitude": 10.0, "airspeed": 1.0, "seed": 1}
NOISY = HUMMINGBIRD.edited({"sensors": {"position_noise": 0.01}, "wind": {"turbulence": TURBULENCE}})
STATE, ASKED = sh.state([0.1, 0, 1], euler=[0.2, -0.1, 0.3]), sh.reference([0, 0, 1.5])
COPIES = [copy.copy, copy.deepcopy]


def pickled(thing):
    return pickle.loads(pickle.dumps(thing))


def stepped(law):
    return np.array([law.step(STATE, ASKED) for _ in range(20)])


def rows_stepped(laws):
    return np.array([laws.step(np.tile(STATE, (3, 1)), np.tile(ASKED, (3, 1))) for _ in range(20)])


def ticked(governor):
    governor.accept([2.0, 0.0, 1.5], yaw=1.0)
    return governor.run(100)


def shielded(shield):
    return np.array([shield.step(STATE, [0.5, 0.0, 0.0, 0.2]) for _ in range(20)])


def moved(vehicles):
    seen = []
    for _ in range(20):
        vehicles.step(np.tile([5.0, 0.001, -0.002, 0.001], (len(vehicles), 1)))
        seen.append(vehicles.measured)
    return np.array(seen)


@pytest.mark.parametrize(
    "made, fly",
    [
        (lambda: sh.Law(HUMMINGBIRD), stepped),
        (lambda: sh.Law(PAPER), stepped),
        (lambda: sh.LawRows(HUMMINGBIRD, 3), rows_stepped),
        (lambda: sh.Governor(HUMMINGBIRD, horizontal_speed=2.0), ticked),
        (lambda: sh.Shield(HUMMINGBIRD, **BOX, speed=3.0), shielded),
        (lambda: sh.VehicleRows(PAPER, 20), moved),
        (lambda: sh.VehicleRows(NOISY, 20), moved),
    ],
    ids=["extended law", "paper's law", "laws", "governor", "shield", "bare vehicles", "vehicles"],
)
def test_a_copy_flies_on_and_what_has_not_flown_is_pickled(made, fly):
    one = made()
    fly(one)
    others = [copied(one) for copied in COPIES]
    expected = fly(one)
    for other in others:
        assert np.array_equal(fly(other), expected)
    with pytest.raises(ValueError, match="is in flight: pickle it as after a reset"):
        pickle.dumps(one)
    fresh = made()
    other = pickled(fresh)
    assert type(other) is type(fresh) and np.array_equal(fly(other), fly(fresh))


def test_vehicles_are_pickled_where_they_were_put():
    vehicles = sh.VehicleRows(NOISY, 3)
    vehicles.place([sh.state([k, 0, 1], euler=[0, 0.1 * k, 0]) for k in range(3)], [True, False, True], [5, 6, 7])
    other = pickled(vehicles)
    assert np.array_equal(other.measured, vehicles.measured) and np.array_equal(moved(other), moved(vehicles))


def test_what_never_changes_is_its_own_copy_and_can_be_pickled():
    vehicle = sh.Vehicle.from_rotorpy(
        {"mass": 0.5, "Ixx": 3.65e-3, "Iyy": 3.68e-3, "Izz": 7.03e-3, "num_rotors": 4, "rotor_directions": [1, -1, 1, -1],
         "rotor_pos": {"r1": [0.12, 0.12, 0], "r2": [0.12, -0.12, 0], "r3": [-0.12, -0.12, 0], "r4": [-0.12, 0.12, 0]},
         "k_eta": 5.57e-6, "k_m": 1.36e-7, "rotor_speed_min": 0, "rotor_speed_max": 1500}, name="theirs")
    for thing in (vehicle, HUMMINGBIRD):
        assert copy.copy(thing) is thing and copy.deepcopy(thing) is thing
    other = pickled(vehicle)
    assert (other.name, other.text, other.missing) == (vehicle.name, vehicle.text, vehicle.missing) and other.missing


KINDS = [
    {"action": "wrench"},
    {"action": "acceleration", "scaled": True, "render_mode": "rgb_array"},
    {"action": "forward", "scaled": True, "shield": BOX, "start": "scenario"},
    {"action": "attitude", "scaled": True},
]


def flown(environment, steps):
    shape = environment.action_space.shape
    return [environment.step(np.full(shape, 0.1)) for _ in range(steps)]


def same(ones, others):
    return all(np.array_equal(one, other) for one, other in zip([step[0] for step in ones], [step[0] for step in others]))


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind["action"])
@pytest.mark.parametrize("make", [Environment, lambda scenario, **kind: VectorEnvironment(scenario, 3, **kind)], ids=["one", "rows"])
def test_an_environment_is_copied_in_an_episode_and_pickled_at_its_start(make, kind):
    environment = make(NOISY, **kind)
    environment.reset(seed=3)
    flown(environment, 10)
    others = [copied(environment) for copied in COPIES]
    expected = flown(environment, 10)
    for other in others:
        assert same(flown(other, 10), expected)
        assert np.array_equal(other.reset()[0], copy.copy(environment).reset()[0]), "its random numbers go on as well"
    with pytest.raises(ValueError, match="is in flight: pickle it as after a reset"):
        pickle.dumps(environment)
    assert np.array_equal(pickled(make(NOISY, **kind)).reset(seed=4)[0], environment.reset(seed=4)[0])
    assert same(flown(pickled(environment), 10), flown(environment, 10))


def test_a_step_after_the_end_says_reset():
    environment = Environment(HUMMINGBIRD.edited({"duration": 0.05}))
    with pytest.raises(RuntimeError, match="call reset first"):
        environment.step(np.zeros(4))
    environment.reset(seed=1, options={"state": sh.state([0, 0, 1.5])})
    ends = [step[3] for step in flown(environment, 5)]
    assert ends == [False] * 4 + [True]
    with pytest.raises(RuntimeError, match="the episode is over: call reset first"):
        environment.step(np.zeros(4))
    environment.reset(seed=1)
    environment.step(np.zeros(4))
