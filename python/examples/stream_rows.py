"""Flies the rows of a CSV on a vehicle over MAVLink: arm, take off, go to the first row, stream the rows, land.

    host-sim reference scenarios/eight.toml --rows rows.csv       # smooth rows, 50 a second
    python stream_rows.py udpin:127.0.0.1:14540 rows.csv          # to `host-sim sitl`; or /dev/ttyUSB0

Columns: t, x, y, z, vx, vy, vz, ax, ay, az, yaw_deg, as `host-sim reference` writes them: s, m, degrees, world z up, x
east, y north. Ctrl-C lands. Keep a hand on the switch that stops the motors all the same.
"""

import csv
import math
import os
import sys
import threading
import time

os.environ["MAVLINK20"] = "1"
from pymavlink import mavutil  # noqa: E402
from pymavlink.dialects.v20 import common as m  # noqa: E402

NAMES = ["t", "x", "y", "z", "vx", "vy", "vz", "ax", "ay", "az", "yaw_deg"]
NEAR, PATIENCE = 0.1, 60.0  # m, s
USED = m.POSITION_TARGET_TYPEMASK_YAW_RATE_IGNORE


class Vehicle:
    def __init__(self, address):
        self.line = mavutil.mavlink_connection(address, source_system=255, dialect="common")
        self.began = time.monotonic()
        self.position, self.armed, self.mode, self.ready = None, False, None, False
        self.answers, self.texts = {}, []
        threading.Thread(target=self._listen, daemon=True).start()
        threading.Thread(target=self._beat, daemon=True).start()

    def _listen(self):
        while True:
            message = self.line.recv_match(blocking=True, timeout=1.0)
            kind = message.get_type() if message else None
            if kind == "LOCAL_POSITION_NED":
                self.position = (message.y, message.x, -message.z)
            elif kind == "HEARTBEAT" and message.autopilot != m.MAV_AUTOPILOT_INVALID:
                self.armed = bool(message.base_mode & m.MAV_MODE_FLAG_SAFETY_ARMED)
                self.mode = (message.custom_mode >> 16 & 255, message.custom_mode >> 24)
            elif kind == "SYS_STATUS":
                self.ready = bool(message.onboard_control_sensors_health & m.MAV_SYS_STATUS_PREARM_CHECK)
            elif kind == "COMMAND_ACK":
                self.answers[message.command] = message.result
            elif kind == "STATUSTEXT":
                self.texts.append(message.text)
                print(f"  vehicle: {message.text}", flush=True)

    def _beat(self):
        while True:
            self.line.mav.heartbeat_send(m.MAV_TYPE_GCS, m.MAV_AUTOPILOT_INVALID, 0, 0, 0)
            time.sleep(0.5)

    def wait(self, what, reason):
        end = time.monotonic() + PATIENCE
        while not what():
            if time.monotonic() > end:
                raise RuntimeError(f"not within {PATIENCE:.0f} s: {reason}")
            time.sleep(0.02)

    def command(self, number, *parameters):
        self.answers.pop(number, None)
        self.line.mav.command_long_send(1, 1, number, 0, *parameters, *[0.0] * (7 - len(parameters)))
        self.wait(lambda: number in self.answers, f"an answer to command {number}")
        if self.answers[number] != m.MAV_RESULT_ACCEPTED:
            raise RuntimeError(f"command {number} is refused: {self.answers[number]}; the vehicle's texts say why")

    def send(self, row, when):
        """A row that is true at a time of this machine: how late it comes varies, and the vehicle makes up for it."""
        x, y, z, vx, vy, vz, ax, ay, az = row[1:10]
        # East, north, up to north, east, down; a yaw from east, counter-clockwise, to one from north, clockwise.
        yaw = math.remainder(math.pi / 2 - math.radians(row[10]), math.tau)
        self.line.mav.set_position_target_local_ned_send(
            round(1e3 * (when - self.began)),
            1,
            1,
            m.MAV_FRAME_LOCAL_NED,
            USED,
            y,
            x,
            -z,
            vy,
            vx,
            -vz,
            ay,
            ax,
            -az,
            yaw,
            0,
        )


def read(path):
    """The rows of a CSV, as lists in the order of NAMES."""
    with open(path, newline="") as file:
        table = csv.DictReader(file)
        lacking = [name for name in NAMES if name not in (table.fieldnames or [])]
        if lacking:
            raise ValueError(f"{path}: column {lacking[0]!r} is missing; `host-sim reference` writes all of {NAMES}")
        rows = [[float(line[name]) for name in NAMES] for line in table]
    if not rows or any(later[0] <= row[0] for row, later in zip(rows, rows[1:])):
        raise ValueError(f"{path}: needs at least one row, and times that increase")
    return rows


def hold(vehicle, row, until, reason):
    """Streams the place of a row, at rest, until something is true."""

    def sent():
        vehicle.send(row, time.monotonic())
        return until()

    vehicle.wait(sent, reason)


def fly(vehicle, rows):
    first = rows[0]
    vehicle.wait(lambda: vehicle.ready and vehicle.position, "ready to arm")
    height = first[3] - vehicle.position[2]
    vehicle.command(m.MAV_CMD_COMPONENT_ARM_DISARM, 1)
    try:
        vehicle.command(m.MAV_CMD_NAV_TAKEOFF, 0, 0, 0, math.nan, 0, 0, max(height, 0.5))
        vehicle.wait(lambda: vehicle.mode == (4, 3), "taken off")
        began = time.monotonic()
        hold(vehicle, first, lambda: time.monotonic() - began > 0.3, "a stream")
        vehicle.command(m.MAV_CMD_DO_SET_MODE, m.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED, 6, 0)
        hold(vehicle, first, lambda: math.dist(vehicle.position, first[1:4]) < NEAR, "at the first row")
        began = time.monotonic()
        hold(vehicle, first, lambda: time.monotonic() - began > 2.0, "a rest")
        began = time.monotonic() - first[0]
        for row in rows:
            time.sleep(max(0.0, began + row[0] - time.monotonic()))
            if vehicle.mode != (6, 0):
                raise RuntimeError("the vehicle no longer flies setpoints; its texts say why")
            vehicle.send(row, began + row[0])
    finally:
        vehicle.command(m.MAV_CMD_NAV_LAND)
        vehicle.wait(lambda: not vehicle.armed, "landed")


def main(arguments):
    if len(arguments) != 2:
        return "usage: stream_rows.py ADDRESS ROWS.csv, the address as pymavlink has it: udpin:127.0.0.1:14540"
    try:
        fly(Vehicle(arguments[0]), read(arguments[1]))
    except (OSError, ValueError, RuntimeError, KeyboardInterrupt) as error:
        return f"error: {error or 'interrupted'}"
    print("landed")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
