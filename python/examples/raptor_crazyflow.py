"""RAPTOR on crazyflow's Crazyflie: bare, behind the shield, and beside the law alone, in a simulator of other people.

    pip install crazyflow
    python python/examples/raptor_crazyflow.py

The flights are those of raptor.py, their starts as well. The vehicle and its rotors are crazyflow's, from first
principles, at 500 Hz: thrusts with a linear term, rotors that rise and fall at different rates, drag, gyroscopic
torques of propellers. The law knows mass, inertia, arm, the range of thrust and one lag of the rotors, and nothing of
the rest. docs/foundation-policy.md has the table.
"""

import argparse

import numpy as np
import raptor
import saturated_hybrid as sh

DRONE = "cf21B_500"
STEPS = 5  # of 2 ms, in a control period
# What it flies: crazyflow has no wind, and its rotors are alike.
CONDITIONS = ("calm", "upside down", "4 m away, up to 4 m/s", "goal at the wall")


class Crazyflies:
    """Rows of them, with the interface of `VehicleRows` that the flights need."""

    def __init__(self, rows):
        from crazyflow.dynamics import load_params
        from crazyflow.sim import Sim

        self.simulation = Sim(n_worlds=rows, drone=DRONE, dynamics="first_principles", control="rotor_vel", freq=500)
        self.simulation.reset()
        given = {name: np.asarray(value, float) for name, value in load_params("first_principles", DRONE).items()}
        self.given = given
        self.curve = given["rpm2thrust"].ravel()[-3:]
        self.mixer = None

    def scenario(self):
        """The scenario, with what the law knows of this vehicle."""
        given, arm = self.given, float(self.given["L"])
        hover = 9.81 * float(given["mass"]) / 4.0
        speed = self.rpm(hover)
        torque = np.polynomial.polynomial.polyval(speed, given["rpm2torque"].ravel()[-3:])
        rise, rises, fall, falls = given["rotor_dyn_coef"].ravel()
        # The mean of the rates at which a rotor's speed rises and falls about hover.
        lag = 2.0 / (rise + fall + 2.0 * speed * (rises + falls))
        places = ((1, -1), (-1, -1), (-1, 1), (1, 1))
        text = f"""
name = "{DRONE}"
[vehicle]
mass = {float(given["mass"])}
inertia = {np.diag(given["J"].reshape(3, 3)).tolist()}
[rotors]
position = {[[arm * x, arm * y, 0.0] for x, y in places]}
spin = ["ccw", "cw", "ccw", "cw"]
thrust_min = {float(given["thrust_min"])}
thrust_max = {float(given["thrust_max"])}
torque_per_thrust = {float(torque / hover)}
lag = {float(lag)}
"""
        rest = {"reference": {"kind": "hover", "position": raptor.MIDDLE.tolist()}, "duration": raptor.DURATION}
        return sh.Scenario.parse(text, DRONE).edited(rest)

    def rpm(self, thrusts):
        """Speeds, in turns a minute, that give thrusts, N."""
        c, b, a = self.curve
        return (-b + np.sqrt(b * b - 4.0 * a * (c - np.maximum(thrusts, 0.0)))) / (2.0 * a)

    def place(self, states):
        """Puts rows at states (rows, 13), their rotors at the speed that hovers."""
        import jax.numpy as jnp

        def rows(columns):
            return jnp.asarray(np.asarray(columns, np.float32)[:, None, :])

        hover = self.rpm(9.81 * float(self.given["mass"]) / 4.0)
        data = self.simulation.data
        self.simulation.data = data.replace(
            states=data.states.replace(
                pos=rows(states[:, :3]),
                vel=rows(states[:, 3:6]),
                quat=rows(states[:, [7, 8, 9, 6]]),
                ang_vel=rows(states[:, 10:13]),
                rotor_vel=jnp.full_like(data.states.rotor_vel, hover),
            )
        )

    @property
    def states(self):
        """(rows, 13)."""
        now = self.simulation.data.states
        columns = [np.asarray(each, float)[:, 0] for each in (now.pos, now.vel, now.quat, now.ang_vel)]
        columns[2] = columns[2][:, [3, 0, 1, 2]]
        # Single precision loses the unit length that our states have.
        columns[2] /= np.linalg.norm(columns[2], axis=1, keepdims=True)
        return np.concatenate(columns, axis=1)

    @property
    def measured(self):
        """As the states."""
        return self.states

    def step(self, wrenches):
        """Holds wrenches for a control period: which were clipped, and which rows' motion is no longer finite."""
        import jax.numpy as jnp

        thrusts, clipped = zip(*(self.mixer.thrusts(wrench) for wrench in np.nan_to_num(wrenches)))
        self.simulation.rotor_vel_control(jnp.asarray(self.rpm(np.array(thrusts))[:, None, :].astype(np.float32)))
        self.simulation.step(STEPS)
        return np.array(clipped), ~np.isfinite(self.states).all(axis=1)


def main(given=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--episodes", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args(given)
    vehicles = Crazyflies(arguments.episodes)
    scenario = vehicles.scenario()
    print(sh.certify(scenario).report.splitlines()[-1])
    vehicles.mixer = sh.Allocation(scenario)
    raptor.row("vehicle", "flight", *raptor.HEAD)
    raptor.row(*["---"] * (2 + len(raptor.HEAD)))
    for condition in raptor.CONDITIONS:
        if condition[0] not in CONDITIONS:
            continue
        states, goals = raptor.drawn(condition, arguments.episodes, arguments.seed)
        options = {"vehicles": vehicles}
        seen = [
            raptor.fly(scenario, pilot, states, goals, arguments.seed, **options) for pilot in raptor.PILOTS.values()
        ]
        raptor.row(DRONE, condition[0], *raptor.cells(*seen))


if __name__ == "__main__":
    main()
