"""Steps of simulated vehicles a second, with and without the shield; and crazyflow's, where it is installed.

    python python/examples/steps_per_second.py

A step is one control period of 10 ms of one vehicle: its simulation, and everything that turns an action into rotor
commands.
"""

import time

import numpy as np
import saturated_hybrid as sh
from saturated_hybrid.environment import VectorEnvironment

ROWS = 1024
SECONDS = 5.0
BOX = {"low": [-100.0] * 3, "high": [100.0] * 3}


def rate(step, rows):
    """Steps a second of `step`, which moves so many rows by one."""
    step()
    began, count = time.perf_counter(), 0
    while (passed := time.perf_counter() - began) < SECONDS:
        step()
        count += rows
    return count / passed


def ours():
    """What is measured, by its name."""
    hummingbird, paper = sh.Scenario.built_in("hummingbird"), sh.Scenario.built_in("paper")
    coarse = hummingbird.edited({"plant.step": 0.005})
    weight = hummingbird.mass * hummingbird.gravity
    for name, scenario, options, action in [
        ("paper's vehicle, wrenches", paper, {}, [paper.mass * paper.gravity, 0.0, 0.0, 0.0]),
        ("Hummingbird, rotors and drag, wrenches", hummingbird, {}, [weight, 0.0, 0.0, 0.0]),
        ("the same, five times the plant's step", coarse, {}, [weight, 0.0, 0.0, 0.0]),
        ("the Hummingbird, accelerations, textbook controller", hummingbird, {"action": "acceleration"}, [0.0] * 4),
        ("the same, accelerations, shield", hummingbird, {"action": "acceleration", "shield": BOX}, [0.0] * 4),
    ]:
        environment = VectorEnvironment(scenario, ROWS, start="scenario", **options)
        environment.reset(seed=1)
        actions = np.tile(action, (ROWS, 1))
        yield name, rate(lambda: environment.step(actions), ROWS)


def crazyflow():
    """Its Crazyflie, at 500 Hz, under an attitude command held for 10 ms."""
    from crazyflow.sim import Sim

    simulation = Sim(n_worlds=ROWS, control="attitude", freq=500, attitude_freq=500)
    simulation.reset()
    command = np.zeros((ROWS, 1, 4), np.float32)
    command[..., 3] = 0.3

    def step():
        simulation.attitude_control(command)
        simulation.step(5)
        simulation.data.states.pos.block_until_ready()

    return rate(step, ROWS)


def main():
    print(f"{ROWS} rows")
    for name, steps in ours():
        print(f"{steps / 1e3:9.0f} thousand steps/s  {name}")
    try:
        print(f"{crazyflow() / 1e3:9.0f} thousand steps/s  crazyflow, attitude commands")
    except ImportError:
        print("crazyflow is not installed")


if __name__ == "__main__":
    main()
