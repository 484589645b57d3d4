"""The wheel flies every vehicle of vehicles/published: certificate, law, environment and textbook controller."""

import numpy as np
import pytest
import saturated_hybrid as sh
from conftest import TOP
from saturated_hybrid.environment import VectorEnvironment
from saturated_hybrid.tasks import POINT, HoverRows, scenario_of

FILES = sorted((TOP / "vehicles" / "published").glob("*.toml"))


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_every_published_vehicle_flies_in_rows(file):
    published = sh.Scenario.load(file)
    assert sh.certify(published)
    scenario = scenario_of(published, POINT).edited({"duration": 8.0})
    law, environment = sh.LawRows(scenario, 4), VectorEnvironment(scenario, 4)
    starts = [sh.state(POINT + [0.5 * k, -0.5, 0.5], [0.5, 0.0, 0.0], euler=[0.5, -0.3 * k, 2.0 * k]) for k in range(4)]
    observations, _ = environment.reset(seed=1, options={"state": np.array(starts)})
    for _ in range(scenario.ticks - 1):
        wrenches = law.for_rotors(law.step(observations[:, :13], observations[:, 13:]))
        observations, *_, info = environment.step(wrenches)
        law.hold_estimates(info["clipped"].tolist())
    assert np.linalg.norm(observations[:, :3] - POINT, axis=1).max() < 0.02
    # An agent's zero, through the textbook controller: it comes to no harm in half a second.
    agent = HoverRows(published, 4)
    agent.reset(seed=1, options={"state": np.array(starts)})
    for _ in range(50):
        *_, terminated, _, _ = agent.step(np.zeros((4, 4)))
        assert not terminated.any()


def test_there_are_files():
    assert len(FILES) >= 13
