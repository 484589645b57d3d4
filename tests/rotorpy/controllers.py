"""The controllers, each from a state and RotorPy's flat outputs to commanded rotor speeds, rad/s.

`command` also says whether the command was within the rotors' limits.
"""

import subprocess

import numpy as np
from rotorpy.controllers.quadrotor_control import SE3Control

from allocation import Clipping, TorqueFirst
from vehicle import PARAMETERS


def speeds(wanted, given):
    """Rotor speeds for thrusts that are in range, f = k_eta speed^2, and whether they are what was wanted."""
    return np.sqrt(given / PARAMETERS["k_eta"]), bool(np.allclose(given, wanted, rtol=0.0, atol=1e-9))


class SE3:
    """RotorPy's own controller with its own gains. RotorPy's vehicle clips the speed of each rotor on its own.

    `ease` multiplies the damping of the attitude loop, and its square the stiffness: the damping ratio stays.
    """

    def __init__(self, ease=1.0):
        self.law = SE3Control(PARAMETERS)
        self.law.kp_att *= ease**2
        self.law.kd_att *= ease

    def command(self, time, period, state, reference):
        wanted = self.law.update(time, state, reference)["cmd_motor_speeds"]
        given = np.clip(wanted, PARAMETERS["rotor_speed_min"], PARAMETERS["rotor_speed_max"])
        return given, bool((given == wanted).all())

    def close(self):
        pass


class SE3TorqueFirst(SE3):
    """The same law; its wrench goes to the rotors with torque first. Where SE3 clips nothing both are the same."""

    def __init__(self, ease=1.0):
        super().__init__(ease)
        self.allocation = TorqueFirst(PARAMETERS)

    def command(self, time, period, state, reference):
        control = self.law.update(time, state, reference)
        given = self.allocation.thrusts(np.append(control["cmd_thrust"], control["cmd_moment"]))
        return speeds(control["cmd_motor_thrusts"], given)


class UnusableAnswer(Exception):
    """A controller in another process answered with something else than a wrench, or no longer does."""


class Law:
    """The project's law in lock-step: `host-sim law FILE` with further arguments, over pipes.

    The least-squares allocation makes rotor thrusts of its wrench, and each is clipped to its range, as on the boards.
    """

    def __init__(self, program, scenario, arguments=()):
        self.line = [str(program), "law", str(scenario), *arguments]
        self.allocation = Clipping(PARAMETERS)
        self.process = subprocess.Popen(self.line, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def command(self, time, period, state, reference):
        numbers = np.concatenate([
            [time, period], state["x"], state["v"], state["q"], state["w"],
            *(reference[name] for name in ("x", "x_dot", "x_ddot", "x_dddot", "x_ddddot")),
            [reference["yaw"], reference["yaw_dot"], reference["yaw_ddot"]],
        ])
        wrench = self.answer(" ".join(map(repr, numbers.tolist())))
        return speeds(self.allocation.inverse @ wrench, self.allocation.thrusts(wrench))

    def answer(self, line):
        """The wrench for one line of numbers."""
        try:
            self.process.stdin.write(line + "\n")
            self.process.stdin.flush()
        except BrokenPipeError:
            pass
        said = self.process.stdout.readline().strip()
        try:
            wrench = np.array([float(word) for word in said.split()])
        except ValueError:
            wrench = np.empty(0)
        if wrench.shape != (4,):
            raise UnusableAnswer(f"{' '.join(self.line)}: {said or 'ended early'}")
        return wrench

    def close(self):
        try:
            self.process.stdin.close()
        except BrokenPipeError:
            pass
        self.process.stdout.close()
        self.process.wait(10)
