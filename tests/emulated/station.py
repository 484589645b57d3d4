"""A ground station that lives in the vehicle's time: it does everything by the telemetry's time stamps."""

import os
import time

os.environ["MAVLINK20"] = "1"
from pymavlink import mavutil  # noqa: E402
from pymavlink.dialects.v20 import common as mavlink  # noqa: E402

# Position alone counts: ignore velocity, acceleration, yaw and yaw rate.
POSITION_ONLY = 0b110111111000

ARM_DISARM = mavlink.MAV_CMD_COMPONENT_ARM_DISARM
SET_MODE = mavlink.MAV_CMD_DO_SET_MODE
TAKE_OFF = mavlink.MAV_CMD_NAV_TAKEOFF
LAND = mavlink.MAV_CMD_NAV_LAND

# PX4's custom modes, as heartbeats carry them.
HOLDING = 4 << 16 | 3 << 24
OFFBOARD = 6 << 16
OFFBOARD_MAIN = 6


class Station:
    HEARTBEAT = 0.5  # s
    SETPOINT = 0.2  # s

    def __init__(self, address, patience):
        self.patience = patience
        self.line = mavutil.mavlink_connection(address, source_system=255, dialect="common", retries=int(patience))
        self.now = None  # vehicle time, s
        self.position = None  # x east, y north, z up, m
        self.track = []  # (vehicle time, position): all that it ever said
        self.armed = False
        self.mode = 0
        self.heartbeats = 0  # the vehicle's: one a second, whatever else it has to say
        self.texts = []  # (vehicle time, text)
        self.acknowledged = {}
        self.target = None
        self.alive = True  # sends, not only listens
        self.last_heartbeat = None
        self.due = {"heartbeat": 0.0, "setpoint": 0.0}

    def close(self):
        self.line.close()

    def step(self):
        """Takes one message, and sends what is due."""
        message = self.line.recv_match(blocking=True, timeout=self.patience)
        assert message is not None, f"the vehicle is silent for {self.patience} s"
        kind = message.get_type()
        if kind == "HEARTBEAT":
            self.armed = bool(message.base_mode & mavlink.MAV_MODE_FLAG_SAFETY_ARMED)
            self.mode = message.custom_mode
            self.heartbeats += 1
        elif kind == "LOCAL_POSITION_NED":
            self.now = message.time_boot_ms * 1e-3
            self.position = (message.y, message.x, -message.z)
            self.track.append((self.now, self.position))
        elif kind == "STATUSTEXT":
            self.texts.append((self.now, message.text))
            print(f"    {self.now or 0.0:7.2f} s  {message.text}")
        elif kind == "COMMAND_ACK":
            self.acknowledged[message.command] = message.result
        if not self.alive:
            return
        now = self.now or 0.0
        # Before there is telemetry there is no vehicle time; the vehicle's own heartbeats set the pace then.
        if now >= self.due["heartbeat"] or (self.now is None and kind == "HEARTBEAT"):
            self.due["heartbeat"], self.last_heartbeat = now + self.HEARTBEAT, now
            self.line.mav.heartbeat_send(mavlink.MAV_TYPE_GCS, mavlink.MAV_AUTOPILOT_INVALID, 0, 0, 0)
        if self.target is not None and now >= self.due["setpoint"]:
            self.due["setpoint"] = now + self.SETPOINT
            self.send_setpoint()

    def send_setpoint(self):
        east, north, up = self.target
        self.line.mav.set_position_target_local_ned_send(
            int((self.now or 0.0) * 1e3), 1, 1, mavlink.MAV_FRAME_LOCAL_NED, POSITION_ONLY,
            north, east, -up, 0, 0, 0, 0, 0, 0, 0, 0)

    def until(self, what, condition, limit):
        """Waits for at most `limit` s of vehicle time; returns how long it took."""
        start, wall = self.now, time.monotonic()
        while not condition():
            self.step()
            if start is None:
                start = self.now
            elif self.now - start > limit:
                raise AssertionError(f"{what}: not within {limit} s of flight; at {self.position}")
            assert time.monotonic() - wall < self.patience, f"{what}: not within {self.patience} s on this machine"
        return 0.0 if start is None else self.now - start

    def wait(self, seconds):
        end = self.now + seconds
        self.until("waiting", lambda: self.now >= end, seconds + 1.0)

    def wait_for_heartbeats(self, count):
        """Waits by the vehicle's heartbeats: for when there is no pose, and so no telemetry with times."""
        end = self.heartbeats + count
        self.until("the vehicle's heartbeats", lambda: self.heartbeats >= end, count + 1.0)

    def command(self, command, *parameters):
        """Sends a command and waits for its answer."""
        self.acknowledged.pop(command, None)
        self.line.mav.command_long_send(1, 1, command, 0, *parameters, *[0.0] * (7 - len(parameters)))
        self.until("acknowledgement", lambda: command in self.acknowledged, 2.0)
        return self.acknowledged[command]

    def order(self, command, *parameters):
        """Sends a command that must be accepted."""
        result = self.command(command, *parameters)
        assert result == mavlink.MAV_RESULT_ACCEPTED, (command, result)

    def arm(self):
        self.order(ARM_DISARM, 1.0)
        self.until("armed", lambda: self.armed, 2.0)

    def take_off(self, height, limit):
        """Takes off by a command; returns how long it took."""
        self.order(TAKE_OFF, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, height)
        return self.until("take-off", lambda: self.received("Take-off over"), limit)

    def fly_setpoints(self):
        """Has the setpoints flown that are sent meanwhile."""
        self.order(SET_MODE, mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED, OFFBOARD_MAIN)
        self.until("flying setpoints", lambda: self.mode == OFFBOARD, 2.0)

    def disarm_in_the_air(self):
        """Asks to disarm, without force, what flies: that must be refused."""
        result = self.command(ARM_DISARM, 0.0)
        assert result == mavlink.MAV_RESULT_DENIED, result

    def land(self, limit):
        """Lands by a command; returns how long it took."""
        self.target = None
        self.order(LAND)
        return self.landed(limit)

    def landed(self, limit):
        """Waits until the vehicle has found the ground and disarmed; returns how long it took."""
        took = self.until("landed", lambda: self.received("Landed: disarmed"), limit)
        self.until("disarmed", lambda: not self.armed, 2.0)
        return took

    def distance(self, point):
        return sum((a - b) ** 2 for a, b in zip(self.position, point)) ** 0.5

    def go(self, point, within, limit):
        """Sends the vehicle to a point; returns the time until it was near."""
        self.target = point
        self.send_setpoint()
        if self.mode != OFFBOARD:
            self.fly_setpoints()
        return self.until(f"near {point}", lambda: self.distance(point) <= within, limit)

    def worst_distance(self, point, seconds):
        """The greatest distance from a point over some time."""
        end, worst = self.now + seconds, [0.0]

        def passed():
            worst[0] = max(worst[0], self.distance(point))
            return self.now >= end

        self.until("holding", passed, seconds + 1.0)
        return worst[0]

    def received(self, words, since=0.0):
        """When a text that begins so was first received, from a time on."""
        return next((time for time, text in self.texts if text.startswith(words) and (time or 0.0) >= since), None)
