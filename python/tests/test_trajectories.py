"""The kinds of trajectories of docs/trajectories.md: certified, flown, and flown once more by the law in a loop of
one's own."""

import numpy as np
import pytest
import saturated_hybrid as sh
from conftest import TOP

SCENARIOS = TOP / "scenarios"


def eighteen(folder):
    """Points without times, from a file: two circles at three heights."""
    rows = []
    for i in range(18):
        angle, radius = 0.7 * i, 3.0 if i % 2 == 0 else 2.0
        rows.append(f"{radius * np.cos(angle):.3f},{radius * np.sin(angle):.3f},{1.5 + 0.5 * (i % 3)}\n")
    (folder / "eighteen.csv").write_text("x,y,z\n" + "".join(rows))
    text = (SCENARIOS / "gates.toml").read_text()
    head, _ = text.split("points = [")
    (folder / "eighteen.toml").write_text(
        head.replace('name = "gates"', 'name = "eighteen"') + 'file = "eighteen.csv"\n'
    )
    return folder / "eighteen.toml"


# The distance between vehicle and reference that the page states, or the rounded-up one where it states none, m.
@pytest.mark.parametrize("name, most", [("gates", 0.15), ("eight", 0.0056), ("pieces", 0.01), ("eighteen", 0.15)])
def test_a_trajectory_is_certified_and_flown_within_the_stated_distance(name, most, tmp_path):
    scenario = sh.Scenario.load(eighteen(tmp_path) if name == "eighteen" else SCENARIOS / f"{name}.toml")
    certificate = sh.certify(scenario)
    assert certificate, certificate.reasons
    flight = sh.fly(scenario)
    assert flight.every_claim_holds, flight.table
    log = flight.columns
    off = np.linalg.norm([log[f"p{axis}"] - log[f"pd{axis}"] for axis in "xyz"], axis=0)
    assert off.max() <= most, off.max()
    # A loop of one's own: the same law, vehicle and references.
    law, vehicle = sh.Law(scenario), sh.VehicleRows(scenario, 1)
    vehicle.place([scenario.initial])
    references = scenario.reference(np.arange(scenario.ticks) * scenario.period)
    for tick, reference in enumerate(references):
        state = vehicle.states[0]
        assert np.allclose(state[:3], [log[f"p{axis}"][tick] for axis in "xyz"], atol=1e-6), tick
        (clipped,), _ = vehicle.step(law.for_rotors(law.step(state, reference))[None])
        assert not clipped
    extent = np.ptp(references[:, :3], axis=0).max()
    assert extent > 1.0 and len(references) > 500
