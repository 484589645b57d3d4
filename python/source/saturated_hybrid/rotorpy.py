"""The law as a controller for RotorPy (https://github.com/spencerfolk/rotorpy): `update(t, state, flat_output)`, as its
SE3Control.

RotorPy's frames are ours (world z up, body x forward, y left), its quaternions are scalar last: they are turned around
here.
"""

import numpy as np

from . import _core

GRAVITY = 9.81
# Of RotorPy's vehicle.
READ = (
    "mass", "Ixx", "Iyy", "Izz", "rotor_pos", "rotor_directions", "k_eta", "k_m", "rotor_speed_min", "rotor_speed_max", "tau_m",
)
# How far a time may be from a tick, as a share of the period: RotorPy adds its steps up.
ROUNDING = 1e-6


class SaturatedHybridControl:
    """The law of a scenario, at the scenario's rate, for the vehicle of `quad_params`.

    RotorPy may step as fast as the law or a whole number of times faster: between two ticks the last command is held. A
    time before the last one starts a new flight. Rotor thrusts come from the mixer that boards fly, and are within the
    rotors' range.

    Args:
        quad_params: RotorPy's dictionary of the vehicle, e.g. `rotorpy.vehicles.hummingbird_params.quad_params`.
        scenario: whose law flies; its vehicle and rotors must be those of `quad_params`. Left out: the extended law at
            100 Hz
            with the constants that follow from the vehicle's numbers, which must be certified.

    Raises:
        ValueError: names what of the vehicle differs or is missing, or why it is not certified.
    """

    def __init__(self, quad_params, scenario=None):
        self.scenario = certified_scenario(quad_params) if scenario is None else scenario
        check_vehicle(quad_params, self.scenario)
        self.period = self.scenario.period
        self.law = _core.Law(self.scenario)
        self.allocation = _core.Allocation(self.scenario)
        self.reset()

    def reset(self):
        """Everything forgotten: how a flight begins."""
        self.law.reset()
        self.last = None
        self.command = None

    def update(self, t, state, flat_output):
        """The command for one instant.

        Args:
            t: time, s.
            state: `x` (3,) m, `v` (3,) m/s world; `q` (4,) scalar last, body to world; `w` (3,) rad/s body.
            flat_output: `x`, `x_dot`, `x_ddot`, `x_dddot`, `x_ddddot` (3,) m … m/s^4 world; `yaw` rad, `yaw_dot` rad/s;
                and
                `yaw_ddot` rad/s^2, zero where it is left out.

        Returns:
            A dictionary, as SE3Control's: `cmd_motor_speeds` (n,) rad/s, `cmd_motor_thrusts` (n,) N, `cmd_thrust` N,
            `cmd_moment` (3,) N m body, `cmd_q` (4,) scalar last, `cmd_w` (3,) rad/s, `cmd_v` (3,) m/s world,
            `cmd_acc` (3,) m/s^2 world. The law commands thrust and torque; the last four are what it steers for.

        Raises:
            ValueError: names the input that cannot be used, or the time if it is not a tick's.
        """
        if self.last is not None and t < self.last:
            self.reset()
        if self.last is not None:
            passed = (t - self.last) / self.period
            if passed < 1.0 - ROUNDING:
                return dict(self.command)
            if passed > 1.0 + ROUNDING:
                raise ValueError(
                    f"t: went on by {t - self.last:.6g} s, but the law runs every {self.period:.6g} s: "
                    f"set sim_rate to a multiple of {1 / self.period:.6g} Hz"
                )
        self.command = self._compute(state, flat_output)
        self.last = t
        return dict(self.command)

    def _compute(self, state, flat_output):
        x, y, z, w = state["q"]
        measured = _core.state(state["x"], state["v"], (w, x, y, z), state["w"])
        asked = _core.reference(
            flat_output["x"],
            flat_output["x_dot"],
            flat_output["x_ddot"],
            flat_output["x_dddot"],
            flat_output["x_ddddot"],
            yaw=float(flat_output["yaw"]),
            yaw_rate=float(flat_output["yaw_dot"]),
            yaw_acceleration=float(flat_output.get("yaw_ddot", 0.0)),
        )
        wrench = self.law.for_rotors(self.law.step(measured, asked))
        thrusts, clipped = self.allocation.thrusts(wrench)
        if clipped:
            self.law.hold_estimates()
        steered = self.law.diagnostics
        w, x, y, z = steered["desired_attitude"].astype(float)
        acceleration = steered["acceleration_command"].astype(float)
        return {
            "cmd_motor_speeds": self.allocation.speeds(thrusts).astype(float),
            "cmd_motor_thrusts": thrusts.astype(float),
            "cmd_thrust": float(wrench[0]),
            "cmd_moment": wrench[1:].astype(float),
            "cmd_q": np.array([x, y, z, w]),
            "cmd_w": steered["desired_angular_velocity"].astype(float),
            "cmd_v": np.array(flat_output["x_dot"], float),
            "cmd_acc": acceleration,
        }


def certified_scenario(quad_params):
    """The scenario of RotorPy's vehicle under the extended law with its default constants, if that is certified."""
    lacking = [name for name in READ if name not in quad_params]
    if lacking:
        raise ValueError(f"quad_params: {lacking[0]!r} is missing")
    scenario = _core.Vehicle.from_rotorpy(quad_params, "rotorpy").scenario()
    certificate = _core.certify(scenario)
    if not certificate:
        reasons = "; ".join(certificate.reasons)
        raise ValueError(
            f"quad_params: not certified with the constants that follow from it: {reasons}; "
            "give a scenario: Vehicle.from_rotorpy(quad_params).scenario({...}), with other constants or another control.rate"
        )
    return scenario


def check_vehicle(quad_params, scenario):
    """Refuses a vehicle that the scenario's law was not made for: its proof would be about another one."""
    rotors = scenario.rotors
    if rotors is None:
        raise ValueError(f"{scenario.name}: rotors: the scenario has no such section; add one")
    lacking = [name for name in READ if name not in quad_params]
    if lacking:
        raise ValueError(f"quad_params: {lacking[0]!r} is missing")
    # The law's rotors idle: they may turn no slower than RotorPy's can, and as fast.
    slowest, fastest = np.moveaxis(np.asarray(rotors["speed"], float), -1, 0)
    theirs = {
        "vehicle.mass": (scenario.mass, quad_params["mass"]),
        "vehicle.inertia": (scenario.inertia, [quad_params[name] for name in ("Ixx", "Iyy", "Izz")]),
        "vehicle.gravity": (scenario.gravity, GRAVITY),
        "rotors.position": (rotors["position"], list(quad_params["rotor_pos"].values())),
        "rotors.spin": (rotors["spin"], quad_params["rotor_directions"]),
        "rotors.thrust_coefficient": (rotors["thrust_coefficient"], quad_params["k_eta"]),
        "rotors.drag_coefficient": (rotors["drag_coefficient"], quad_params["k_m"]),
        "rotors.speed, greatest": (fastest, quad_params["rotor_speed_max"]),
        "rotors.speed, least": (slowest, np.maximum(slowest, quad_params["rotor_speed_min"])),
        "rotors.lag": (rotors["lag"], quad_params["tau_m"]),
    }
    for field, (ours, wanted) in theirs.items():
        try:
            alike = np.allclose(ours, np.asarray(wanted, float), rtol=1e-5, atol=1e-9)
        except ValueError:
            alike = False
        if not alike:
            raise ValueError(
                f"{scenario.name}: {field}: {np.asarray(ours).tolist()}, but RotorPy's vehicle has "
                f"{np.asarray(wanted).tolist()}; fly a scenario of that vehicle"
            )
