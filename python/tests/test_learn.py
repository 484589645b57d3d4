"""The examples that learn and judge: a short form learns measurably, and the shield keeps its promises meanwhile."""

import sys

import numpy as np
import pytest
import saturated_hybrid as sh
from conftest import TOP
from saturated_hybrid.actions import facing, kinds
from saturated_hybrid.tasks import GATE, POINT, GateRows, HoverRows

sys.path.insert(0, str(TOP / "python" / "examples"))
import judge  # noqa: E402
import learn  # noqa: E402
import learn_vehicles  # noqa: E402


@pytest.fixture(scope="module")
def learnt(tmp_path_factory):
    """Sixteen generations with the shield and sixteen without, which then has hardly begun to learn; and a short
    table."""
    out = tmp_path_factory.mktemp("learnt")
    curves, table = learn.main(["hover", "--out", str(out), "--generations", "16", "--episodes", "50"])
    return out, curves, table


def test_it_learns_measurably_behind_the_shield(learnt):
    _, curves, table = learnt
    earned = curves["with the shield"][:, 1]
    assert earned[-1] > earned[0] + 60.0, earned
    flew = {name: row["by_policy"] for name, shield, row in table if shield == "box"}
    assert flew["learnt with the shield"] > flew["as it starts"] + 0.1


def test_behind_the_shield_nothing_is_lost_from_the_first_episode_on(learnt):
    _, curves, table = learnt
    assert curves["with the shield"][-1, 2] == 0 and curves["without"][-1, 2] > 100
    names = {name for name, _, _ in table}
    assert names == {"as it starts", "learnt with the shield", "learnt without", "spring and damper", "malicious"}
    for name, shield, row in table:
        if shield == "box":
            assert (row["crashed"], row["lost"], row["clipped"], row["out"]) == (0, 0, 0.0, 0), (name, row)
            assert row["nearest"] > 0.0, (name, row)
    malicious = {shield: row for name, shield, row in table if name == "malicious"}
    assert malicious["no"]["crashed"] > 5 and malicious["no"]["lost"] > 20 and malicious["no"]["clipped"] > 0.2
    assert malicious["box"]["by_policy"] < 0.9


def test_the_file_of_weights_is_the_network_that_boards_run(learnt):
    out, _, _ = learnt
    theirs, ours = sh.Network.read(out / "hover.toml"), judge.Network.read(out / "hover.toml")
    observations = np.random.default_rng(3).normal(size=(20, 22)).astype(np.float32)
    assert np.allclose(theirs.act(observations), ours.act(observations), atol=1e-5)
    assert np.ptp(theirs.act(observations), axis=0).min() > 0.01
    assert np.allclose(theirs.scale, kinds(sh.Scenario.built_in("hummingbird"))["forward"].high)


def test_curves_pictures_and_replay_are_written(learnt):
    out, _, _ = learnt
    rows = np.loadtxt(out / "hover-with.csv", delimiter=",", skiprows=1)
    assert rows.shape == (16, 3) and (np.diff(rows[:, 0]) > 0).all()
    assert (out / "hover.svg").read_text().count("steps flown, millions") == 1
    assert (out / "hover.gif").read_bytes().startswith(b"GIF89a")


def test_a_network_of_a_batch_is_each_of_its_networks():
    random = np.random.default_rng(1)
    weights, observations = random.normal(size=(3, judge.Network.count)), random.normal(size=(3, 5, 22))
    together = judge.Network(weights).act(observations)
    for one, seen, acted in zip(weights, observations, together):
        assert np.allclose(judge.Network(one).act(seen), acted, atol=1e-6)


def test_on_the_boards_estimator_no_hover_leaves_its_box(learnt):
    out, _, _ = learnt
    network = judge.Network.read(out / "hover.toml")
    for poses in (True, judge.LATE):
        for policy in (network, judge.Malicious(40, 1)):
            seen = judge.Flights("hover", 40, HoverRows.box, estimated=poses).fly(policy.act, list(range(40)))
            assert not seen["lost"].any() and not seen["clipped"].any() and seen["out"].max() < 0.0


def test_behind_the_boxes_of_the_gate_no_policy_flies_into_its_wall(learnt):
    """The wall is not part of one box, and malicious policies fly into it there."""
    lost = {}
    for name, box in (("box", judge.ROOM), ("boxes", GateRows.box)):
        seen = judge.Flights("gate", 100, box).fly(judge.Malicious(100, 1).act, list(range(100)))
        lost[name] = int(seen["lost"].sum())
        assert not seen["clipped"].any()
    assert lost["boxes"] == 0 and lost["box"] > 0, lost


def test_a_policy_that_aligns_itself_first_flies_through_the_opening_in_its_box():
    rows = GateRows(None, 50, action="acceleration", scaled=False, shield=GateRows.box)
    rows.reset(seed=1)
    was_through = np.zeros(50, bool)
    for _ in range(rows.scenario.ticks - 1):
        states = rows.vehicles.states
        position, velocity = states[:, :3], states[:, 3:6]
        aligned = np.abs(position[:, 1:] - GATE[1:]).max(axis=1) < 0.15
        goal = np.where(aligned[:, None] | (position[:, :1] > -0.5), GATE + [2.0, 0.0, 0.0], GATE - [1.2, 0.0, 0.0])
        wanted = np.clip(2.0 * (goal - position), -1.2, 1.2)
        demands = np.column_stack([3.0 * (wanted - velocity), np.zeros(50)])
        _, _, terminated, _, info = rows.step(demands)
        was_through |= rows.through
        assert not terminated.any() and not info["clipped"].any()
    assert was_through.mean() > 0.9, was_through.mean()


def test_every_vehicle_learns_for_a_moment():
    table = learn_vehicles.main(["--generations", "1", "--episodes", "4", "--seeds", "1"])
    assert [row[:2] for row in table] == [("Hummingbird", 1), ("x500", 1), ("Crazyflie", 1)]
    assert all(row[2] == row[6] == row[7] == 0 for row in table), table


def test_the_policy_that_was_learnt_and_ships_hovers_as_boards_would_fly_it():
    """Through the same network, shield and vehicle as anywhere; goals and headings as aboard."""
    network = sh.Network.read(TOP / "vehicles" / "policies" / "learnt-hover.toml")
    tasks = HoverRows(None, 100)
    tasks.reset(seed=10_000)
    scenario, states = tasks.scenario, tasks.vehicles.states
    vehicles, shield = sh.VehicleRows(scenario, 100), sh.ShieldRows(scenario, 100, **HoverRows.box)
    vehicles.place(states)
    headings, outputs, goals, flown = facing(states), np.zeros((100, 4), np.float32), np.tile(POINT, (100, 1)), []
    for _ in range(600):
        outputs = network.act(sh.Network.observe(vehicles.states, goals, headings, outputs))
        wrenches = shield.for_rotors(shield.step(vehicles.states, network.demands(outputs, headings)))
        clipped, _ = vehicles.step(wrenches)
        assert not clipped.any()
        headings = shield.references[:, 15:17]
        flown.append(shield.by_policy.mean())
    away = np.linalg.norm(vehicles.states[:, :3] - POINT, axis=1)
    print(f"policy flew {np.mean(flown):.1%}, median {np.median(away):.2f} m away, at most {away.max():.2f} m")
    assert np.mean(flown) > 0.9 and np.median(away) < 0.3 and away.max() < 3.0
