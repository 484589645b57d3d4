"""The wheel's law, flights and environments give the bits of the repository's program: every comparison is exact."""

import numpy as np
import pytest
import saturated_hybrid as sh
from saturated_hybrid.environment import VectorEnvironment

STATE = ["px", "py", "pz", "vx", "vy", "vz", "qw", "qx", "qy", "qz", "wx", "wy", "wz"]
WRENCH = ["thrust", "tau_x", "tau_y", "tau_z"]
SHORT = {"duration": 8.0}


def stack(columns, names):
    return np.stack([columns[name] for name in names], axis=1)


def as_logged(singles):
    """Single precision as log.csv has it: the shortest decimals that give the bits back."""
    return np.array([[float(str(value)) for value in row] for row in np.atleast_2d(singles)])


@pytest.mark.parametrize("name", sh.Scenario.names())
def test_a_flight_has_the_columns_of_the_log_number_by_number(name, logged):
    scenario = sh.Scenario.built_in(name).edited(SHORT)
    flown, log = sh.fly(scenario).columns, logged(scenario.text)
    assert list(flown) == list(log)
    for column in log:
        assert np.array_equal(flown[column], log[column]), column


@pytest.mark.parametrize("name", ["paper", "hummingbird", "study"])
def test_the_law_on_the_logs_states_commands_what_the_log_has(name, logged):
    scenario = sh.Scenario.built_in(name).edited(SHORT)
    log = logged(scenario.text)
    law = sh.Law(scenario)
    states, references = stack(log, STATE), scenario.reference(log["t"])
    commanded = []
    for state, reference, clipped in zip(states, references, log["clipped"]):
        commanded.append(law.step(state, reference))
        if clipped:
            law.hold_estimates()
    assert np.array_equal(as_logged(commanded), stack(log, WRENCH))
    law.reset()
    assert np.array_equal(law.step(states[0], references[0]), commanded[0])


@pytest.mark.parametrize("name", ["paper", "hummingbird"])
def test_rows_of_laws_are_laws(name):
    scenario = sh.Scenario.built_in(name)
    random = np.random.default_rng(3)
    first, rows = sh.Law(scenario), sh.LawRows(scenario, 300)
    laws = [first.copy() for _ in range(300)]
    for tick in range(20):
        states = np.concatenate([random.normal(size=(300, 6)), random.normal(size=(300, 4)), random.normal(size=(300, 3))], 1)
        states[:, 6:10] /= np.linalg.norm(states[:, 6:10], axis=1, keepdims=True)
        references = np.repeat(scenario.reference([0.01 * tick]), 300, 0)
        one_by_one = [law.step(state, reference) for law, state, reference in zip(laws, states, references)]
        assert np.array_equal(rows.step(states, references), one_by_one)
    assert np.array_equal(rows.thrust_scale, [law.thrust_scale for law in laws])
    chosen = np.arange(300) % 2 == 0
    rows.reset(chosen.tolist())
    for law in laws[::2]:
        law.reset()
    one_by_one = [law.step(state, reference) for law, state, reference in zip(laws, states, references)]
    assert np.array_equal(rows.step(states, references), one_by_one)


@pytest.mark.parametrize("name", ["paper", "hummingbird", "study"])
def test_an_environment_flown_by_the_law_flies_the_scenarios_flight(name):
    scenario = sh.Scenario.built_in(name).edited({"duration": 5.0})
    flown = sh.fly(scenario).columns
    # More than a stretch, and more than fills its vector registers.
    rows = 19
    environment, law = VectorEnvironment(scenario, rows, start="scenario"), sh.LawRows(scenario, rows)
    observations, _ = environment.reset(seed=1)
    for tick in range(scenario.ticks):
        assert np.array_equal(environment.vehicles.states, np.repeat(stack(flown, STATE)[tick : tick + 1], rows, 0))
        wrenches = law.step(observations[:, :13], observations[:, 13:])
        assert np.array_equal(as_logged(wrenches[:1]), stack(flown, WRENCH)[tick : tick + 1])
        observations, _, terminated, truncated, info = environment.step(law.for_rotors(wrenches))
        assert not terminated.any() and truncated.all() == (tick == scenario.ticks - 1)
        law.hold_estimates(info["clipped"].tolist())


def test_the_governor_arrives_with_derivatives_that_belong_together():
    scenario = sh.Scenario.built_in("hummingbird")
    governor = sh.Governor(scenario)
    governor.start([0, 0, 1])
    governor.accept([3, -2, 2], yaw=1.0)
    path = governor.run(1500)
    assert governor.at_rest
    np.testing.assert_allclose(path[-1, :3], [3, -2, 2], atol=1e-5)
    np.testing.assert_allclose(path[-1, 15:17], [np.cos(1), np.sin(1)], atol=1e-5)
    # Each derivative is the one of the column before it, to what a period's difference shows.
    for first in (0, 3, 6):
        slope = np.diff(path[:, first : first + 3].astype(float), axis=0) / scenario.period
        middle = (path[1:, first + 3 : first + 6] + path[:-1, first + 3 : first + 6]) / 2
        np.testing.assert_allclose(slope, middle, atol=2e-3)
    again = sh.Governor(scenario)
    again.start([0, 0, 1])
    again.accept([3, -2, 2], yaw=1.0)
    assert np.array_equal([again.tick() for _ in range(1500)], path)
