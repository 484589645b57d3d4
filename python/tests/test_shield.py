"""Behind a shield a policy flies what it demands, and the law takes over where the rules of docs/shield.md say so."""

import tomllib

import numpy as np
import pytest
import saturated_hybrid as sh
from conftest import TOP

SCENARIO = sh.Scenario.built_in("hummingbird")
BOX = {"low": [-4, -4, 0.5], "high": [4, 4, 6]}
HOVER = [0.0, 0.0, 0.0, 0.0]
MIDDLE = [0.0, 0.0, 3.0]


def flown(shield, vehicle, policy, ticks):
    """States, reasons and who flew, tick by tick, of one row under `policy` (tick, state) -> demand."""
    states, reasons, by_policy = [], [], []
    for tick in range(ticks):
        state = vehicle.measured
        demand = policy(tick, state[0])
        wrench = shield.step(state, None if demand is None else [demand])
        clipped, _ = vehicle.step(shield.for_rotors(wrench))
        shield.hold_estimates(clipped.tolist())
        assert not clipped.any()
        states.append(vehicle.states[0])
        reasons.append(shield.reasons[0])
        by_policy.append(shield.by_policy[0])
    return np.array(states), reasons, np.array(by_policy)


def started(at=MIDDLE, scenario=SCENARIO, **options):
    vehicle = sh.VehicleRows(scenario, 1)
    vehicle.place([sh.state(at)])
    return sh.ShieldRows(scenario, 1, **BOX, **options), vehicle


def test_the_vehicle_accelerates_and_turns_as_demanded():
    shield, vehicle = started([-2.0, 0.0, 3.0])
    states, _, by_policy = flown(shield, vehicle, lambda *_: [1.0, 0.0, 0.2, 0.5], 150)
    assert by_policy.all()
    gained = (states[-1, 3:6] - states[79, 3:6]) / 0.7
    # What drag does while a demand passes the filters is left over.
    np.testing.assert_allclose(gained, [1.0, 0.0, 0.2], atol=0.1)
    turned = 2 * np.arctan2(states[-1, 9], states[-1, 6]) - 2 * np.arctan2(states[79, 9], states[79, 6])
    assert abs(turned - 0.35) < 0.04


def test_an_attitude_is_flown_with_its_heading():
    shield, vehicle = started()
    half = 0.1
    wanted = [np.cos(half), 0.0, np.sin(half), 0.0, SCENARIO.mass * SCENARIO.gravity / np.cos(2 * half)]
    states, _, by_policy = flown(shield, vehicle, lambda *_: wanted, 60)
    assert by_policy.all()
    np.testing.assert_allclose(states[-1, 6:10], wanted[:4], atol=0.02)
    shield, vehicle = started()
    facing = [np.cos(0.4), 0.0, 0.0, np.sin(0.4), SCENARIO.mass * SCENARIO.gravity]
    states, _, by_policy = flown(shield, vehicle, lambda *_: facing, 400)
    assert by_policy.all()
    np.testing.assert_allclose(states[-1, 6:10], facing[:4], atol=0.02)


@pytest.mark.parametrize(
    "policy, reason",
    [
        (lambda tick, _: HOVER if tick < 50 else None, "silent"),
        (lambda tick, _: HOVER if tick < 50 else [np.nan, 0, 0, 0], "demand"),
        (lambda tick, _: HOVER if tick < 50 else [1, 1, 0, 0, 5.0], "demand"),
        (lambda tick, _: [30.0, 0, 0, 0], "stop"),
        (lambda tick, _: [0, 0, -30.0, 0], "stop"),
    ],
)
def test_the_law_takes_over_and_keeps_the_vehicle_in_the_box(policy, reason):
    shield, vehicle = started(hand_overs=1)
    states, reasons, by_policy = flown(shield, vehicle, policy, 500)
    taken = int(np.argmin(by_policy))
    assert by_policy[:taken].all() and not by_policy[taken:].any()
    assert set(reasons[:taken]) == {""} and set(reasons[taken:]) == {reason}
    assert (states[:, :3] > BOX["low"]).all() and (states[:, :3] < BOX["high"]).all()
    np.testing.assert_allclose(states[-1, :3], shield.references[0, :3], atol=0.01)


@pytest.mark.parametrize(
    "start, reason",
    [
        (sh.state(MIDDLE, euler=[1.2, 0, 0]), "tilt"),
        (sh.state(MIDDLE, angular_velocity=[40, 0, 0]), "rate"),
        (sh.state(MIDDLE, angular_velocity=[0, 0, 20]), "rate"),
        (sh.state(MIDDLE, velocity=[0, 11, 0]), "speed"),
        (sh.state([0, 0, 0.4]), "stop"),
    ],
)
def test_an_upset_start_is_the_laws(start, reason):
    shield = sh.Shield(SCENARIO, **BOX)
    shield.step(start, HOVER)
    assert not shield.by_policy and shield.reason == reason and shield.hand_overs == 1


def test_a_demand_is_flown_on_for_the_time_of_silence():
    shield, vehicle = started(silence=0.2)
    _, reasons, _ = flown(shield, vehicle, lambda tick, _: HOVER if tick == 0 else None, 40)
    assert reasons.index("silent") == 21


def test_the_policy_gets_the_vehicle_back_later_each_time_and_in_the_end_not_at_all():
    shield, vehicle = started(hand_overs=3, patience=0.2)
    _, _, by_policy = flown(shield, vehicle, lambda tick, _: None if tick % 300 == 0 else HOVER, 40)
    assert not by_policy[0] and by_policy[-1]
    assert 20 <= np.argmax(by_policy) <= 25
    waits = []
    for _ in range(2):
        _, _, by_policy = flown(shield, vehicle, lambda tick, _: [np.nan] * 4 if tick == 0 else HOVER, 300)
        assert not by_policy[0]
        waits.append(np.argmax(by_policy))
    assert 40 <= waits[0] <= 60 and waits[1] == 0 and shield.hand_overs[0] == 3
    shield.ask_again()
    _, _, by_policy = flown(shield, vehicle, lambda *_: HOVER, 100)
    assert by_policy[-1]


def test_rows_of_shields_are_shields():
    random = np.random.default_rng(3)
    rows = sh.ShieldRows(SCENARIO, 300, **BOX)
    shields = [sh.Shield(SCENARIO, **BOX) for _ in range(300)]
    states = random.normal(size=(300, 13))
    states[:, 2] += 3
    states[:, 6:10] = [1, 0, 0, 0] + 0.2 * states[:, 6:10]
    states[:, 6:10] /= np.linalg.norm(states[:, 6:10], axis=1, keepdims=True)
    for tick in range(20):
        states[:, :3] += 0.01 * states[:, 3:6]
        demands = (
            None
            if tick == 15
            else random.normal(size=(300, 4))
            if tick < 10
            else np.c_[states[:, 6:10], np.full(300, 5.0)]
        )
        one_by_one = [
            shield.step(state, None if demands is None else demands[number])
            for number, (shield, state) in enumerate(zip(shields, states))
        ]
        assert np.array_equal(rows.step(states, demands), one_by_one)
        assert rows.reasons == [shield.reason for shield in shields]
        assert rows.by_policy.tolist() == [shield.by_policy for shield in shields]
    assert 0 < rows.by_policy.sum() < 300
    assert np.array_equal(rows.references, [shield.reference for shield in shields])
    assert np.array_equal(rows.thrust_scale, [shield.thrust_scale for shield in shields])
    rows.reset((np.arange(300) % 2 == 0).tolist())
    for shield in shields[::2]:
        shield.reset()
    one_by_one = [shield.step(state, HOVER) for shield, state in zip(shields, states)]
    assert np.array_equal(rows.step(states, [HOVER] * 300), one_by_one)


def test_a_state_that_cannot_be_used_changes_nothing():
    shield = sh.Shield(SCENARIO, **BOX)
    shield.step(sh.state(MIDDLE), HOVER)
    before = shield.copy()
    with pytest.raises(ValueError, match="state.position"):
        shield.step(sh.state([np.nan, 0, 0]), None)
    for _ in range(12):
        assert np.array_equal(shield.step(sh.state(MIDDLE), None), before.step(sh.state(MIDDLE), None))
        assert shield.reason == before.reason
    rows = sh.ShieldRows(SCENARIO, 2, **BOX)
    with pytest.raises(ValueError, match="row 1: state.position"):
        rows.step([sh.state(MIDDLE), sh.state([np.nan, 0, 0])], None)
    assert not rows.by_policy.any() and rows.reasons == ["", ""]


@pytest.mark.parametrize(
    "call, said",
    [
        (
            lambda: sh.Shield(sh.Scenario.built_in("paper"), **BOX),
            'control.law: must be "extended": the paper\'s law carries no policy',
        ),
        (
            lambda: sh.Shield(SCENARIO, low=[0, 0, 0], high=[1, 1, 0.5]),
            "shield.high - shield.low: must be at least 0.6",
        ),
        (
            lambda: sh.Shield(SCENARIO, low=[[0, 0, 0]] * 5, high=[[1, 1, 1]] * 5),
            "low: must be of 1 to 4 boxes, found 5",
        ),
        (lambda: sh.Shield(SCENARIO, low=[[0, 0, 0]] * 2, high=[1, 1, 1]), "high: must be of 2 boxes as low, found 1"),
        (lambda: sh.Shield(SCENARIO, low=[[0, 0]], high=[1, 1, 1]), r"low: must have shape \(3,\) or \(n, 3\)"),
        (lambda: sh.Shield(SCENARIO, **BOX, margin=-0.1), "shield.margin: must be at least 0"),
        (lambda: sh.Shield(SCENARIO, **BOX, margin=3.0), "shield.high - shield.low: must be at least 6.6"),
        (lambda: sh.Shield(SCENARIO, low=[0, 0, np.nan], high=[1, 1, 1]), "shield.low: must be a finite number"),
        (lambda: sh.Shield(SCENARIO, low=[0, 0, 0], high=[1e6, 1, 1]), "shield.high: must be at most 100000"),
        (lambda: sh.Shield(SCENARIO, **BOX, silence=-1), "shield.silence: must be greater than zero"),
        (
            lambda: sh.Shield(SCENARIO, **BOX, hand_overs=0),
            "hand_overs: must be a whole number from 1 to 4294967295, found 0",
        ),
        (
            lambda: sh.Shield(SCENARIO, **BOX).step(sh.state(), [1, 2, 3]),
            r"demand: must have shape \(4,\) or \(5,\), found \(3,\)",
        ),
        (
            lambda: sh.ShieldRows(SCENARIO, 2, **BOX).step([sh.state()] * 2, [HOVER]),
            r"demands: must have shape \(2, 4\) or \(2, 5\), found \(1, 4\)",
        ),
    ],
)
def test_what_makes_no_sense_is_refused_by_name(call, said):
    with pytest.raises(ValueError, match=said):
        call()


def test_a_network_flies_to_its_goal_and_is_what_numpy_makes_of_its_file():
    network = sh.Network.read(TOP / "vehicles" / "policies" / "hover.toml")
    file = tomllib.loads((TOP / "vehicles" / "policies" / "hover.toml").read_text())
    shields, vehicles = sh.ShieldRows(SCENARIO, 3, **BOX), sh.VehicleRows(SCENARIO, 3)
    vehicles.place([sh.state([x, 1.0, 2.0], euler=[0, 0, x]) for x in (-1.0, 0.0, 1.0)])
    goals = np.array([[1.0, -1.0, 3.0], [0.0, 0.0, 2.0], [-2.0, 2.0, 4.0]])
    outputs, headings = np.zeros((3, 4)), np.array([[np.cos(x), np.sin(x)] for x in (-1.0, 0.0, 1.0)])
    for _ in range(800):
        states = vehicles.measured
        observations = network.observe(states, goals, headings, outputs)
        outputs = network.act(observations)
        by_hand = np.tanh(
            observations.astype(float) @ np.array(file["layers"][0]["weights"]).T + file["layers"][0]["biases"]
        )
        np.testing.assert_allclose(outputs, by_hand, atol=1e-6)
        demands = network.demands(outputs, headings)
        np.testing.assert_allclose(
            np.hypot(demands[:, 0], demands[:, 1]), 4 * np.hypot(outputs[:, 0], outputs[:, 1]), rtol=1e-5
        )
        wrenches = shields.step(states, demands)
        clipped, _ = vehicles.step(shields.for_rotors(wrenches))
        assert shields.by_policy.all() and not clipped.any()
        headings = shields.references[:, 15:17]
    np.testing.assert_allclose(vehicles.states[:, :3], goals, atol=0.02)


@pytest.mark.parametrize(
    "call, said",
    [
        (lambda: sh.Network.parse("scale = [1, 1, 1, 1]"), r"policy: layers: missing; write \[\[layers\]\]"),
        (lambda: sh.Network.read("nowhere.toml"), "nowhere.toml: "),
        (
            lambda: sh.Network.observe([sh.state()], [[0, 0, 0]], [[2, 0]], [[0] * 4]),
            "row 0: headings: must be a unit vector",
        ),
    ],
)
def test_a_network_that_makes_no_sense_is_refused_by_name(call, said):
    with pytest.raises(ValueError, match=said):
        call()


def test_a_vehicle_stays_in_one_or_another_of_its_boxes_and_goes_over_where_they_overlap():
    low, high = [[-4, -4, 0.5], [-2, -0.4, 2.6], [0.1, -4, 0.5]], [[-0.1, 4, 6], [2, 0.4, 3.4], [4, 4, 6]]
    vehicle, shield = sh.VehicleRows(SCENARIO, 1), sh.ShieldRows(SCENARIO, 1, low=low, high=high)
    vehicle.place([sh.state([-2.0, 0.0, 3.0])])
    states, reasons, by_policy = flown(shield, vehicle, lambda tick, state: towards(state, [2.0, 0.0, 3.0]), 600)
    assert by_policy.all() and states[-1, 0] > 1.5 and set(reasons) == {""}
    # Beside the opening there is a wall, which the vehicle does not come to.
    shield.reset()
    vehicle.place([sh.state([-2.0, 2.0, 3.0])])
    states, reasons, by_policy = flown(shield, vehicle, lambda tick, state: towards(state, [2.0, 2.0, 3.0]), 600)
    assert states[:, 0].max() < -0.1 and "stop" in reasons and not by_policy.all()


def towards(state, place):
    """The demand of a spring and a damper."""
    return [*(np.clip(1.0 * (np.array(place) - state[:3]), -1.5, 1.5) - 2.0 * state[3:6]), 0.0]


def test_a_margin_keeps_the_vehicle_that_much_farther_inside():
    nearest = {}
    for margin in (0.0, 0.3):
        shield, vehicle = started(margin=margin)
        states, _, _ = flown(shield, vehicle, lambda tick, state: towards(state, [9.0, 0.0, 3.0]), 700)
        nearest[margin] = BOX["high"][0] - states[:, 0].max()
    assert nearest[0.0] > 0.0 and 0.25 < nearest[0.3] - nearest[0.0] < 0.35, nearest
