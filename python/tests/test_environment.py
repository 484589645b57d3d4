"""The environments: Gymnasium's rules, the same rows whatever their number, and endings."""

import subprocess
import sys

import gymnasium
import numpy as np
import pytest
import saturated_hybrid as sh
from gymnasium.utils.env_checker import check_env
from saturated_hybrid.environment import Environment, VectorEnvironment

HUMMINGBIRD = sh.Scenario.built_in("hummingbird")


@pytest.mark.filterwarnings("ignore:.*infinity")
@pytest.mark.filterwarnings("ignore:.*spec.*")
@pytest.mark.filterwarnings("ignore:.*normalized.*")
def test_gymnasiums_checker_passes():
    environment = Environment(HUMMINGBIRD)
    assert isinstance(environment, gymnasium.Env)
    check_env(environment)


def test_the_vector_is_gymnasiums_with_its_spaces():
    environment = VectorEnvironment(HUMMINGBIRD, 5)
    assert isinstance(environment, gymnasium.vector.VectorEnv)
    observations, _ = environment.reset(seed=4)
    assert environment.observation_space.contains(observations)
    assert environment.single_observation_space.shape == (32,) and environment.single_action_space.shape == (4,)
    environment.action_space.seed(1)
    stepped = environment.step(environment.action_space.sample())
    assert environment.observation_space.contains(stepped[0])
    assert [part.shape for part in stepped[1:4]] == [(5,)] * 3
    wrapped = gymnasium.wrappers.vector.RecordEpisodeStatistics(VectorEnvironment(HUMMINGBIRD, 2))
    wrapped.reset(seed=1)
    wrapped.step(wrapped.action_space.sample())


def fly(environment, actions, seed):
    seen = [environment.reset(seed=seed)[0]]
    for action in actions:
        seen.append(environment.step(action)[0])
    return np.array(seen)


@pytest.mark.parametrize("name", ["hummingbird", "paper"])
def test_a_row_is_the_same_whatever_the_number_of_rows(name):
    actions = np.random.default_rng(5).uniform([0, -0.1, -0.1, -0.1], [10, 0.1, 0.1, 0.1], (30, 21, 4))
    noisy = sh.Scenario.built_in(name).edited({"sensors": {"position_noise": 0.01}})
    many = fly(VectorEnvironment(noisy, 21), actions, 7)
    few = fly(VectorEnvironment(noisy, 2), actions[:, :2], 7)
    alone = fly(Environment(noisy), actions[:, 1], 8)
    assert np.array_equal(many[:, :2], few) and np.array_equal(many[:, 1], alone)
    assert not np.array_equal(many[:, 0], many[:, 1])
    # From where they were put, at rest.
    assert np.abs(many[1, :, :3] - many[0, :, :3]).max() < 0.1
    assert np.array_equal(fly(VectorEnvironment(noisy, 21), actions, 7), many)


def test_random_starts_are_everywhere():
    environment = VectorEnvironment(HUMMINGBIRD, 2000)
    observations, _ = environment.reset(seed=11)
    away = np.linalg.norm(observations[:, :3] - observations[:, 13:16], axis=1)
    rates = np.linalg.norm(observations[:, 10:13], axis=1)
    assert 9.5 < away.max() <= 10.0 and 14.0 < rates.max() <= 15.0
    up = 1 - 2 * (observations[:, 7] ** 2 + observations[:, 8] ** 2)
    assert abs(up.mean()) < 0.05 and up.min() < -0.99 and up.max() > 0.99


def test_the_law_recovers_every_row_from_a_random_start():
    scenario = HUMMINGBIRD.edited({"duration": 30.0})
    environment, law = VectorEnvironment(scenario, 64), sh.LawRows(scenario, 64)
    observations, _ = environment.reset(seed=21)
    for _ in range(scenario.ticks - 1):
        wrenches = law.for_rotors(law.step(observations[:, :13], observations[:, 13:]))
        observations, rewards, terminated, truncated, info = environment.step(wrenches)
        assert not terminated.any() and not truncated.any()
        law.hold_estimates(info["clipped"].tolist())
    assert rewards.min() > 0.95, rewards.min()
    *_, truncated, _ = environment.step(wrenches)
    assert truncated.all()


def test_an_episode_that_ended_starts_anew_with_the_next_step():
    scenario = HUMMINGBIRD.edited({"duration": 0.05})
    environment = VectorEnvironment(scenario, 2, lost=200.0)
    environment.reset(seed=1, options={"state": [sh.state([0, 0, 1.5]), sh.state([0, 0, 300])]})
    _, rewards, terminated, truncated, _ = environment.step(np.zeros((2, 4)))
    assert terminated.tolist() == [False, True] and not truncated.any()
    observations, rewards, terminated, truncated, _ = environment.step(np.zeros((2, 4)))
    assert not terminated.any() and rewards[1] == 0.0 and rewards[0] > 0.0
    assert np.linalg.norm(observations[1, :3]) < 20.0 and environment.vehicles.ticks.tolist() == [2, 0]


def test_what_cannot_be_is_refused():
    with pytest.raises(ValueError, match='start: must be "random" or "scenario"'):
        VectorEnvironment(HUMMINGBIRD, 2, start="here")
    with pytest.raises(ValueError, match="lost: must be greater than zero"):
        VectorEnvironment(HUMMINGBIRD, 2, lost=float("nan"))
    environment = VectorEnvironment(HUMMINGBIRD, 2)
    with pytest.raises(RuntimeError, match="call reset first"):
        environment.step(np.zeros((2, 4)))
    with pytest.raises(ValueError, match="unknown key 'stat'"):
        environment.reset(options={"stat": 1})
    with pytest.raises(ValueError, match=r"states: must have shape \(2, 13\)"):
        environment.reset(options={"state": sh.state()})
    environment.reset(seed=1)
    with pytest.raises(ValueError, match=r"actions: must have shape \(2, 4\), found \(2, 3\)"):
        environment.step(np.zeros((2, 3)))


WITHOUT = """
import sys
sys.modules["gymnasium"] = None
import numpy as np, saturated_hybrid as sh
from saturated_hybrid.environment import Environment, VectorEnvironment
one, many = Environment(sh.Scenario.built_in("hummingbird")), VectorEnvironment(sh.Scenario.built_in("hummingbird"), 3)
first, _ = one.reset(seed=2)
rows, _ = many.reset(seed=1)
assert np.array_equal(rows[1], first) and one.observation_space.contains(first)
assert many.action_space.contains(np.zeros((3, 4), np.float32)) and not many.action_space.contains(np.full((3, 4), 1e9))
assert many.step(np.zeros((3, 4)))[0].shape == (3, 32)
print("without")
"""


def test_it_works_without_gymnasium():
    done = subprocess.run([sys.executable, "-c", WITHOUT], capture_output=True, text=True, timeout=60)
    assert done.stdout == "without\n", done.stderr
