"""Rows of vehicles on the boards' estimator: what a law or a shield gets is estimated, and it is what `fly` flies."""

import numpy as np
import pytest
import saturated_hybrid as sh
from saturated_hybrid.environment import VectorEnvironment
from saturated_hybrid.tasks import Hover, HoverRows, scenario_of

HUMMINGBIRD = sh.Scenario.built_in("hummingbird").edited({"duration": 3.0, "estimator": {"seed": 7}})
BOX = {"low": [-4, -4, 0.3], "high": [4, 4, 4]}
STATE = ["px", "py", "pz", "vx", "vy", "vz", "qw", "qx", "qy", "qz", "wx", "wy", "wz"]


def test_rows_on_the_estimator_fly_what_a_flight_of_the_scenario_flies():
    columns = sh.fly(HUMMINGBIRD).columns
    vehicles, laws = sh.VehicleRows(HUMMINGBIRD, 2), sh.LawRows(HUMMINGBIRD, 2)
    assert np.isnan(vehicles.accelerations).all() and not vehicles.jumped.any()
    for tick in range(HUMMINGBIRD.ticks):
        flown = [columns[name][tick] for name in STATE]
        np.testing.assert_array_equal(vehicles.states, [flown, flown])
        laws.hold_estimates(vehicles.jumped.tolist())
        wrenches = laws.step(vehicles.measured, vehicles.references, vehicles.accelerations)
        clipped, lost = vehicles.step(laws.for_rotors(wrenches))
        laws.hold_estimates(clipped.tolist())
        assert not lost.any()
    assert np.isfinite(vehicles.accelerations).all()
    away = np.abs(vehicles.measured[:, :3] - vehicles.states[:, :3]).max()
    assert 1e-5 < away < 0.05, away


def test_a_seed_decides_what_is_estimated_and_nothing_else():
    vehicles = sh.VehicleRows(HUMMINGBIRD, 40)
    start = sh.state([0.0, 0.0, 2.0], [0.3, 0.0, 0.0])
    vehicles.place([start] * 40, None, [7, 8, 7, 9] * 10)
    np.testing.assert_array_equal(vehicles.states, [start] * 40)
    assert np.array_equal(vehicles.measured[0], vehicles.measured[2])
    assert not np.array_equal(vehicles.measured[0], vehicles.measured[1])
    assert np.abs(vehicles.measured[:, :3] - start[:3]).max() < 0.05
    copied = sh.VehicleRows(HUMMINGBIRD, 40)
    copied.place([start] * 40, ([True] + 3 * [False]) * 10, [7] * 40)
    assert np.array_equal(copied.measured[36], vehicles.measured[36])


def test_a_row_that_has_no_estimate_to_begin_with_is_refused_and_nothing_has_changed():
    with pytest.raises(ValueError, match="estimator: no state to fly on. Estimator: not started"):
        sh.VehicleRows(HUMMINGBIRD.edited({"estimator.dropout": 0.99}), 1)
    # So many poses are lost that some seeds have none in time.
    vehicles = sh.VehicleRows(HUMMINGBIRD.edited({"estimator.dropout": 0.97}), 40)
    before = vehicles.measured
    with pytest.raises(ValueError, match="row [0-9]+: estimator: no state to fly on"):
        vehicles.place([sh.state([0.0, 0.0, 2.0])] * 40)
    np.testing.assert_array_equal(vehicles.measured, before)


def test_a_task_is_flown_on_estimates_and_judged_by_the_truth():
    rows = HoverRows(None, 3, estimated={"position_noise": 0.05}, shield=BOX)
    assert rows.scenario.text == scenario_of(None, rows.point, {"position_noise": 0.05}).text
    observations, _ = rows.reset(seed=4)
    seen = []
    for _ in range(100):
        observations, rewards, terminated, _, info = rows.step(np.zeros((3, 4)))
        seen.append(np.linalg.norm(observations[:, :3], axis=1))
        true = np.linalg.norm(rows.point - rows.vehicles.states[:, :3], axis=1)
        speed = np.linalg.norm(rows.vehicles.states[:, 3:6], axis=1)
        rates = np.linalg.norm(rows.vehicles.states[:, 10:13], axis=1)
        np.testing.assert_allclose(rewards, np.exp(-true) - 0.03 * speed - 0.02 * rates, atol=1e-5)
        assert not terminated.any() and not info["clipped"].any()
        seen[-1] -= true
    assert 1e-4 < np.abs(seen).max() < 0.2
    one = Hover(None, estimated={"position_noise": 0.05}, shield=BOX)
    first, _ = one.reset(seed=5)
    again, _ = rows.reset(seed=4)
    assert np.array_equal(again[1], first)


def test_the_shield_keeps_estimated_vehicles_in_their_box_whatever_is_demanded():
    scenario = HUMMINGBIRD.edited({"estimator": {"pose_delay": 0.05, "position_noise": 0.003}})
    vehicles, shields = sh.VehicleRows(scenario, 30), sh.ShieldRows(scenario, 30, **BOX, patience=0.3)
    random = np.random.default_rng(2)
    vehicles.place([sh.state([0.0, 0.0, 2.0], euler=[0.0, 0.0, each]) for each in range(30)])
    for tick in range(300):
        if tick % 30 == 0:
            demands = random.choice([-1.0, 1.0], (30, 4)) * [15.0, 15.0, 8.0, 2.0]
        shields.hold_estimates(vehicles.jumped.tolist())
        wrenches = shields.step(vehicles.measured, demands, vehicles.accelerations)
        clipped, lost = vehicles.step(shields.for_rotors(wrenches))
        assert not clipped.any() and not lost.any()
        assert (vehicles.states[:, :3] > BOX["low"]).all() and (vehicles.states[:, :3] < BOX["high"]).all()
    assert 0 < shields.by_policy.sum() or shields.hand_overs.min() > 0


def test_accelerations_of_another_shape_are_refused_by_name():
    laws, shields = sh.LawRows(HUMMINGBIRD, 2), sh.ShieldRows(HUMMINGBIRD, 2, **BOX)
    states = [sh.state([0.0, 0.0, 2.0])] * 2
    for call in (
        lambda: laws.step(states, [sh.reference([0.0, 0.0, 2.0])] * 2, [[0.0, 0.0, 0.0]]),
        lambda: shields.step(states, None, [[0.0, 0.0, 0.0]]),
    ):
        with pytest.raises(ValueError, match=r"accelerations: must have shape \(2, 3\), found \(1, 3\)"):
            call()
    with pytest.raises(ValueError, match=r"acceleration: must have shape \(3,\)"):
        sh.Law(HUMMINGBIRD).step(states[0], sh.reference(), [0.0])


def test_an_environment_of_an_estimator_flies():
    environment, laws = VectorEnvironment(HUMMINGBIRD, 2, start="scenario"), sh.LawRows(HUMMINGBIRD, 2)
    observations, _ = environment.reset(seed=1)
    assert observations.shape == (2, 32) and not np.array_equal(observations[0], observations[1])
    for _ in range(100):
        wrenches = laws.step(observations[:, :13], observations[:, 13:], environment.vehicles.accelerations)
        observations, rewards, terminated, _, info = environment.step(laws.for_rotors(wrenches))
        assert not terminated.any() and not info["clipped"].any()
