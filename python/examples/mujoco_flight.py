"""A vehicle of a scenario in MuJoCo, under the law, beside the same flight in our own simulator.

    pip install ./python mujoco
    python python/examples/mujoco_flight.py vehicles/published/x500.toml

The model is written from the scenario's numbers: one free body, a motor at the site of each rotor. MuJoCo moves the
body; the law sees its state once a control period, and the mixer that boards fly makes rotor thrusts of its wrench.
Rotor speeds lag here as they do in `sh.fly`. There is no air. What is left between the two flights is how they
integrate.
"""

import argparse
import sys

import mujoco
import numpy as np
import saturated_hybrid as sh


def model(scenario):
    """MuJoCo's XML of the scenario's vehicle."""
    rotors, spaced = scenario.rotors, lambda numbers: " ".join(f"{number:.9g}" for number in np.ravel(numbers))
    sites, motors = [], []
    each = zip(rotors["position"], rotors["spin"], rotors["thrust_coefficient"], rotors["drag_coefficient"])
    for number, (position, spin, thrust, drag) in enumerate(each, start=1):
        sites.append(f'<site name="rotor{number}" pos="{spaced(position)}"/>')
        motors.append(f'<motor name="rotor{number}" site="rotor{number}" gear="0 0 1 0 0 {spin * drag / thrust:.9g}"/>')
    step = scenario.period / steps(scenario)
    return f"""<mujoco model="{scenario.name}">
  <option timestep="{step:.9g}" gravity="0 0 {-scenario.gravity:.9g}" integrator="RK4"/>
  <worldbody>
    <body name="vehicle">
      <freejoint/>
      <inertial pos="0 0 0" mass="{scenario.mass:.9g}" diaginertia="{spaced(scenario.inertia)}"/>
      {"".join(sites)}
    </body>
  </worldbody>
  <actuator>{"".join(motors)}</actuator>
</mujoco>"""


def upside_down(scenario):
    """The same vehicle and reference without air, from upside down, turned by 100 degrees."""
    return scenario.edited({"drag": None, "wind": None, "initial.euler_deg": [-179.0, 0.0, 100.0]})


def steps(scenario):
    """MuJoCo's steps in a control period: of a millisecond at most."""
    return int(np.ceil(scenario.period / 0.001 - 1e-6))


def fly(scenario):
    """Positions (ticks, 3), m, in MuJoCo, one for each control period."""
    rotors, count = scenario.rotors, steps(scenario)
    vehicle = mujoco.MjModel.from_xml_string(model(scenario))
    data = mujoco.MjData(vehicle)
    start = scenario.initial
    data.qpos[:], data.qvel[:3], data.qvel[3:] = start[[0, 1, 2, 6, 7, 8, 9]], start[3:6], start[10:13]
    law, mixer = sh.Law(scenario), sh.Allocation(scenario)
    coefficient, lag = rotors["thrust_coefficient"], rotors["lag"]
    half = np.exp(-0.5 * vehicle.opt.timestep / lag) if lag > 0.0 else 0.0
    hover, _ = mixer.thrusts([scenario.mass * scenario.gravity, 0.0, 0.0, 0.0])
    speeds = np.asarray(mixer.speeds(hover), float)
    flown = []
    for reference in scenario.reference(np.arange(scenario.ticks) * scenario.period):
        # Of a free joint, MuJoCo's velocity is the world's and its rates are the body's: our conventions.
        position, velocity, attitude, rates = data.qpos[:3], data.qvel[:3], data.qpos[3:7], data.qvel[3:6]
        flown.append(position.copy())
        wrench = law.for_rotors(law.step(sh.state(position, velocity, attitude, rates), reference))
        thrusts, clipped = mixer.thrusts(wrench)
        if clipped:
            law.hold_estimates()
        wanted = np.asarray(mixer.speeds(thrusts), float)
        for _ in range(count):
            # The thrusts of the step's middle.
            speeds = wanted + half * (speeds - wanted)
            data.ctrl[:] = coefficient * speeds**2
            mujoco.mj_step(vehicle, data)
            speeds = wanted + half * (speeds - wanted)
    return np.array(flown)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file", help="scenario file, with rotors")
    arguments = parser.parse_args()
    scenario = upside_down(sh.Scenario.load(arguments.file))
    theirs, log = fly(scenario), sh.fly(scenario).columns
    ours, wanted = (np.stack([log[f"{name}{axis}"] for axis in "xyz"], axis=1) for name in ("p", "pd"))
    apart = np.linalg.norm(theirs - ours, axis=1).max()
    print(f"{scenario.name}: {scenario.duration:g} s, MuJoCo {mujoco.__version__}")
    print(f"MuJoCo's and our flight are at most {apart:.2g} m apart")
    for name, flown in (("MuJoCo", theirs), ("sh.fly", ours)):
        off = np.linalg.norm(flown - wanted, axis=1)
        print(f"{name}: from the reference at most {off.max():.2g} m, at the end {off[-1]:.2g} m")
    return 0


if __name__ == "__main__":
    sys.exit(main())
