"""MuJoCo, a simulator that others wrote, flies our vehicles under the law: the flights of `sh.fly`."""

import runpy

import mujoco
import numpy as np
import pytest
import saturated_hybrid as sh
from conftest import TOP

EXAMPLE = runpy.run_path(str(TOP / "python" / "examples" / "mujoco_flight.py"))


FILES = [f"vehicles/published/{name}.toml" for name in ("cf2x-pybullet", "x500", "firefly")] + [
    "vehicles/hummingbird-paper.toml"
]


@pytest.mark.parametrize("file", FILES)
def test_mujocos_flight_from_upside_down_is_ours(file):
    scenario = EXAMPLE["upside_down"](sh.Scenario.load(TOP / file)).edited({"duration": 15.0})
    assert sh.certify(scenario)
    theirs, log = EXAMPLE["fly"](scenario), sh.fly(scenario).columns
    ours = np.stack([log[f"p{axis}"] for axis in "xyz"], axis=1)
    apart = np.linalg.norm(theirs - ours, axis=1)
    lowest = np.abs(ours[:, 2] - ours[0, 2]).max()
    print(f"{scenario.name}: {apart.max():.2g} m apart in a flight that loses {lowest:.2g} m")
    assert apart.max() < 5e-6, apart.max()
    assert lowest > 0.3
    wanted = np.array([log[f"pd{axis}"][-1] for axis in "xyz"])
    assert np.linalg.norm(theirs[-1] - wanted) < 0.05


def test_mujocos_model_has_the_vehicles_numbers():
    scenario = sh.Scenario.load(TOP / "vehicles" / "published" / "x500.toml")
    vehicle = mujoco.MjModel.from_xml_string(EXAMPLE["model"](scenario))
    assert vehicle.body_mass[1] == pytest.approx(scenario.mass, rel=1e-6)
    assert np.allclose(np.sort(vehicle.body_inertia[1]), np.sort(scenario.inertia), rtol=1e-6)
    assert np.allclose(vehicle.site_pos, scenario.rotors["position"], atol=1e-9) and vehicle.nu == 4
    # A wrench through the mixer is that wrench on MuJoCo's body.
    data, wrench = mujoco.MjData(vehicle), np.array([25.0, 0.2, -0.3, 0.05])
    thrusts, clipped = sh.Allocation(scenario).thrusts(wrench)
    data.ctrl[:] = thrusts
    mujoco.mj_forward(vehicle, data)
    assert not clipped and np.allclose(data.qfrc_actuator[[2, 3, 4, 5]], wrench, atol=1e-4)
