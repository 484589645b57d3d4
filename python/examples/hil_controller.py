"""The law as a flight controller over MAVLink, for a simulator in lock-step: HIL_ACTUATOR_CONTROLS out, ODOMETRY and
HIL_SENSOR in.

    pip install ./python pymavlink
    host-sim hil --listen 127.0.0.1:5760 --duration 20 vehicles/study.toml &
    python python/examples/hil_controller.py 127.0.0.1:5760 vehicles/study.toml

The simulator moves on by one control period when a command has come, and answers with where the vehicle is then. That
is how PX4's simulators talk; ODOMETRY, with velocity, stands in for their GPS. Firmware on a board or in an emulator
does the same on its serial port (docs/firmware.md). World and body are MAVLink's NED and FRD on the line.
"""

import argparse
import os
import sys

os.environ["MAVLINK20"] = "1"
import numpy as np  # noqa: E402
import saturated_hybrid as sh  # noqa: E402
from pymavlink import mavutil  # noqa: E402
from pymavlink.dialects.v20 import common as m  # noqa: E402
from saturated_hybrid.textbook import rotations  # noqa: E402

# North, east, down to x, y, z up; forward, right, down to forward, left, up.
TURN = np.array([1.0, -1.0, -1.0])


def state_of(odometry):
    """The state (13,) in an ODOMETRY: velocity there is the body's."""
    w, x, y, z = odometry.q
    attitude = np.array([w, *(TURN * [x, y, z])])
    velocity = rotations(attitude) @ (TURN * [odometry.vx, odometry.vy, odometry.vz])
    rates = TURN * [odometry.rollspeed, odometry.pitchspeed, odometry.yawspeed]
    return sh.state(TURN * [odometry.x, odometry.y, odometry.z], velocity, attitude / np.linalg.norm(attitude), rates)


class Link:
    """The line to the simulator."""

    def __init__(self, address, period):
        self.line = mavutil.mavlink_connection(f"tcp:{address}", source_system=1, dialect="common")
        self.now, self.period = 1_000_000, round(1e6 * period)

    def exchange(self, commands):
        """Sends commands from 0 to 1, and waits for the period's end: the state then, or None when the simulator has
        gone."""
        armed = m.MAV_MODE_FLAG_SAFETY_ARMED if max(commands) > 0.0 else 0
        self.line.mav.hil_actuator_controls_send(self.now, [*commands, *[0.0] * (16 - len(commands))], armed, 0)
        state, self.now = None, self.now + self.period
        while True:
            message = self.line.recv_match(type=["ODOMETRY", "HIL_SENSOR"], blocking=True, timeout=5.0)
            if message is None:
                return None
            if message.get_type() == "ODOMETRY":
                state = state_of(message)
            elif message.time_usec >= self.now:
                return state


def fly(address, scenario, ticks):
    """Positions and references of so many ticks, (ticks, 3) each; fewer if the simulator ends first."""
    link, law, mixer = Link(address, scenario.period), sh.Law(scenario), sh.Allocation(scenario)
    rotors = scenario.rotors
    greatest = rotors["thrust_coefficient"] * rotors["speed"][:, 1] ** 2
    state, flown = link.exchange([0.0] * len(greatest)), []
    for reference in scenario.reference(np.arange(ticks) * scenario.period):
        if state is None:
            break
        flown.append((state[:3], reference[:3]))
        thrusts, clipped = mixer.thrusts(law.for_rotors(law.step(state, reference)))
        # On the ground, and while a rotor saturates, the motion teaches nothing.
        if clipped or state[2] < 0.05:
            law.hold_estimates()
        state = link.exchange(np.sqrt(np.clip(thrusts / greatest, 0.0, 1.0)).tolist())
    positions, references = zip(*flown)
    return np.array(positions), np.array(references)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("address", help="HOST:PORT at which the simulator listens")
    parser.add_argument("file", help="scenario file, as the simulator's")
    parser.add_argument("--seconds", type=float, default=20.0)
    arguments = parser.parse_args()
    scenario = sh.Scenario.load(arguments.file)
    positions, references = fly(arguments.address, scenario, round(arguments.seconds / scenario.period))
    off = np.linalg.norm(positions - references, axis=1)
    print(f"{scenario.name}: {len(off)} ticks, at the end {off[-1]:.2g} m from the reference")
    return 0


if __name__ == "__main__":
    sys.exit(main())
