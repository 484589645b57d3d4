"""RAPTOR's checkpoint as a policy file: its numbers, what the network makes of them, and its flights."""

import runpy

import foundation_policy
import numpy as np
import pytest
import saturated_hybrid as sh
from conftest import TOP

RAPTOR = runpy.run_path(str(TOP / "python" / "examples" / "raptor.py"))
NETWORK = sh.Network.read(RAPTOR["POLICY"])
# What rounding in single precision and our tanh, 2e-7 at worst, add up to on the way through 16 units that remember.
ROUNDING = 2e-5


def test_the_policy_file_is_the_package_converted():
    assert RAPTOR["POLICY"].read_text() == RAPTOR["converted"]()
    licence = RAPTOR["POLICY"].with_name("raptor.LICENSE").read_text()
    assert "MIT License" in licence and "Copyright (c) 2025 Jonas Eschmann" in licence


@pytest.mark.parametrize("size", [0.3, 1.0, 3.0])
def test_outputs_are_those_of_the_packages_own_network_over_a_long_sequence(size):
    theirs, random = foundation_policy.Raptor(), np.random.default_rng(int(10 * size))
    rows = 50
    theirs.reset()
    memory = NETWORK.memory(rows)
    assert memory.shape == (rows, 16) and not memory.any()
    worst, seen = 0.0, []
    observations = np.zeros((rows, 22), np.float32)
    for _ in range(2_000):
        # Inputs that wander, as a flight's do, and at times jump.
        observations = 0.95 * observations + size * 0.3 * random.normal(size=(rows, 22)).astype(np.float32)
        observations[random.random(rows) < 0.01] *= -1.0
        outputs, memory = NETWORK.advance(observations, memory)
        wanted = theirs.evaluate_step(observations)
        worst = max(worst, np.abs(outputs - wanted).max())
        seen.append(outputs)
    assert worst < ROUNDING, worst
    assert np.ptp(seen, axis=(0, 1)).min() > 0.5


def test_the_checkpoints_own_example_comes_out():
    import importlib.resources

    import h5py

    path = importlib.resources.files("foundation_policy").joinpath("blob", "checkpoint.h5")
    with h5py.File(path, "r") as checkpoint:
        inputs, wanted = checkpoint["example"]["input"][()], checkpoint["example"]["output"][()]
    memory = NETWORK.memory(inputs.shape[1])
    for observations, outputs in zip(inputs, wanted):
        found, memory = NETWORK.advance(observations, memory)
        np.testing.assert_allclose(found, outputs, atol=ROUNDING)


def test_a_network_that_remembers_says_so_and_refuses_what_does_not_fit():
    hover = sh.Network.read(TOP / "vehicles" / "policies" / "hover.toml")
    assert (NETWORK.demanded, NETWORK.scale, hover.demanded) == ("rotors", None, "acceleration")
    assert hover.memory(3).shape == (3, 0)
    observations = np.ones((2, 22))
    np.testing.assert_array_equal(hover.advance(observations, hover.memory(2))[0], hover.act(observations))
    with pytest.raises(ValueError, match=r"network: has recurrent layers: `advance` takes what they remember"):
        NETWORK.act(observations)
    with pytest.raises(ValueError, match=r"memories: must have shape \(2, 16\), found \(3, 16\)"):
        NETWORK.advance(observations, NETWORK.memory(3))
    speeds = [[0.1, 0.2, 0.3, 7.0]]
    np.testing.assert_array_equal(NETWORK.demands(speeds, [[1, 0]]), np.float32(speeds))


def test_rotor_speeds_are_flown_by_an_x_and_by_nothing_else():
    box = {"low": [-4, -4, 0.5], "high": [4, 4, 5]}
    shields = sh.ShieldRows(sh.Scenario.built_in("hummingbird"), 2, **box)
    states, speeds = [sh.state([0, 0, 2])] * 2, np.array([[-0.4, -0.5, -0.3, -0.4], [-1.3, -1.1, -9.0, -1.0]])
    shields.step(states, rotors=speeds)
    assert shields.by_policy.all()
    np.testing.assert_allclose(shields.rotors, np.clip(speeds, -1.0, 1.0), atol=1e-2)
    with pytest.raises(ValueError, match="rotors: a demand is given already; leave one of them out"):
        shields.step(states, speeds, rotors=speeds)
    with pytest.raises(ValueError, match=r"rotors: must have shape \(2, 4\), found \(1, 4\)"):
        shields.step(states, rotors=speeds[:1])
    plus = sh.Scenario.load(str(TOP / "vehicles" / "published" / "pelican.toml"))
    shield = sh.Shield(plus, **box)
    with pytest.raises(ValueError, match="rotors: this vehicle flies none: it takes an X of four like rotors"):
        shield.step(states[0], rotors=speeds[0])
    np.testing.assert_array_equal(shield.rotors, np.zeros(4))


@pytest.fixture(scope="module")
def table():
    """Twenty flights each of a Hummingbird."""
    flown = {}
    for condition in RAPTOR["CONDITIONS"]:
        if condition[0] in ("calm", "upside down", "goal at the wall"):
            scenario = RAPTOR["scenario_of"]("vehicles/hummingbird.toml", condition[1])
            states, goals = RAPTOR["drawn"](condition, 20, 5)
            for name, pilot in RAPTOR["PILOTS"].items():
                flown[condition[0], name] = RAPTOR["fly"](scenario, pilot, states, goals, 5)
    return flown


def test_raptor_flies_a_hummingbird_to_its_goal_bare_and_behind_the_shield(table):
    for pilot in ("RAPTOR", "RAPTOR, shield"):
        seen = table["calm", pilot]
        assert seen["lost"] == 0 and seen["worst"] < 0.5, seen
    assert table["calm", "RAPTOR, shield"]["by_policy"] > 0.9


def test_behind_the_shield_no_command_is_beyond_a_rotor_and_no_flight_is_lost(table):
    for (condition, pilot), seen in table.items():
        if pilot == "RAPTOR, shield":
            assert seen["beyond"] == 0.0 and seen["lost"] == 0 and seen["out"] < 0.1, (condition, seen)
    assert table["upside down", "RAPTOR, shield"]["by_policy"] < table["calm", "RAPTOR, shield"]["by_policy"]
    assert table["calm", "RAPTOR"]["beyond"] > 0.0
