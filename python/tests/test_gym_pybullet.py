"""The equations that gym-pybullet-drones publishes for its explicit dynamics (`Physics.DYN`, `BaseAviary._dynamics`),
flown by the law.

The package itself is not on PyPI. Its model of the Crazyflie `cf2x`: rotors follow their commands at once, z's weight
is `M g`, and the step is a semi-implicit Euler's: velocities first, then position and attitude with the new ones. Its
own rotors' order: front left, back left, back right, front right.
"""

import numpy as np
import pytest
import saturated_hybrid as sh
from conftest import TOP

# cf2x.urdf: N and N m per (revolution/minute)^2, m.
KF, KM, ARM = 3.16e-10, 7.94e-12, 0.0397
RPM = 60.0 / (2.0 * np.pi)


def cf2x():
    """The published file's vehicle with the rotors where the explicit dynamics have them; a circle, from a roll of 90
    degrees."""
    side = ARM / np.sqrt(2.0)
    return sh.Scenario.load(TOP / "vehicles" / "published" / "cf2x-pybullet.toml").edited(
        {
            "rotors.position": [[side, side, 0.0], [-side, side, 0.0], [-side, -side, 0.0], [side, -side, 0.0]],
            "rotors.spin": ["ccw", "cw", "ccw", "cw"],
            "reference": {
                "kind": "harmonic", "center": [0.0, 0.0, 1.0], "amplitude": [0.5, 0.5, 0.0],
                "frequency": [1.0, 1.0, 0.0], "phase": [0.0, -1.5707963, 0.0],
            },
            "initial": {"position": [0.5, 0.0, 1.0], "euler_deg": [90.0, 0.0, 30.0]},
            "duration": 10.0,
        }
    )  # fmt: skip


def flown(scenario, frequency):
    """Positions (ticks, 3) by the published equations, at so many steps a second."""
    step, inertia = 1.0 / frequency, scenario.inertia
    position, velocity, rates = scenario.initial[:3].copy(), scenario.initial[3:6].copy(), scenario.initial[10:].copy()
    attitude, law, mixer, path = scenario.initial[6:10].copy(), sh.Law(scenario), sh.Allocation(scenario), []
    for reference in scenario.reference(np.arange(scenario.ticks) * scenario.period):
        path.append(position.copy())
        thrusts, clipped = mixer.thrusts(
            law.for_rotors(law.step(sh.state(position, velocity, attitude, rates), reference))
        )
        assert not clipped
        rpm = np.asarray(mixer.speeds(thrusts), float) * RPM
        for _ in range(round(frequency * scenario.period)):
            forces, drags = KF * rpm**2, KM * rpm**2
            side = ARM / np.sqrt(2.0)
            torque = [side * forces @ [1, 1, -1, -1], side * forces @ [-1, 1, 1, -1], drags @ [-1, 1, -1, 1]]
            w, x, y, z = attitude
            up = np.array([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)])
            velocity += step * (up * forces.sum() / scenario.mass - [0.0, 0.0, scenario.gravity])
            rates += step * (torque - np.cross(rates, inertia * rates)) / inertia
            position += step * velocity
            attitude = turned(attitude, rates * step)
    return np.array(path)


def turned(attitude, rotation):
    """The attitude after a turn about an axis of the body, rad."""
    angle = np.linalg.norm(rotation)
    (w, x, y, z), axis = attitude, rotation / max(angle, 1e-12)
    c, (a, b, d) = np.cos(angle / 2), np.sin(angle / 2) * axis
    return np.array(
        [
            w * c - x * a - y * b - z * d,
            w * a + x * c + y * d - z * b,
            w * b - x * d + y * c + z * a,
            w * d + x * b - y * a + z * c,
        ]
    )


def test_the_numbers_are_the_published_vehicles():
    rotors = cf2x().rotors
    assert rotors["thrust_coefficient"] == pytest.approx(KF * RPM**2, rel=1e-6)
    assert rotors["drag_coefficient"] == pytest.approx(KM * RPM**2, rel=1e-6)


def test_the_law_flies_their_equations_nearer_to_ours_the_finer_they_step():
    scenario = cf2x()
    assert sh.certify(scenario)
    log = sh.fly(scenario).columns
    ours, wanted = (np.stack([log[f"{name}{axis}"] for axis in "xyz"], axis=1) for name in ("p", "pd"))
    apart = {}
    for frequency in (500, 2000, 8000):
        path = flown(scenario, frequency)
        apart[frequency] = np.linalg.norm(path - ours, axis=1).max()
        off = np.linalg.norm(path - wanted, axis=1)
        assert off.max() > 0.05 and off[-200:].max() < 0.005, off[-200:].max()
    print({frequency: f"{distance:.2g} m" for frequency, distance in apart.items()})
    assert apart[500] < 0.02 and apart[8000] < 0.0012
    assert apart[2000] / apart[500] == pytest.approx(0.25, abs=0.05) and apart[8000] / apart[2000] == pytest.approx(
        0.25, abs=0.05
    )
