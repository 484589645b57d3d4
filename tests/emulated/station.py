"""A ground station that lives in the vehicle's time: it does everything by the telemetry's time stamps."""

import os
import time

os.environ["MAVLINK20"] = "1"
from pymavlink import mavutil  # noqa: E402
from pymavlink.dialects.v20 import common as mavlink  # noqa: E402

# Position alone counts: ignore velocity, acceleration, yaw and yaw rate.
POSITION_ONLY = 0b110111111000

ARM_DISARM = mavlink.MAV_CMD_COMPONENT_ARM_DISARM


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

    def command_arm(self, armed):
        self.acknowledged.pop(ARM_DISARM, None)
        self.line.mav.command_long_send(1, 1, ARM_DISARM, 0, 1.0 if armed else 0.0, 0, 0, 0, 0, 0, 0)
        self.until("acknowledgement", lambda: ARM_DISARM in self.acknowledged, 2.0)
        assert self.acknowledged[ARM_DISARM] == mavlink.MAV_RESULT_ACCEPTED, self.acknowledged
        self.until("armed" if armed else "disarmed", lambda: self.armed == armed, 2.0)

    def distance(self, point):
        return sum((a - b) ** 2 for a, b in zip(self.position, point)) ** 0.5

    def go(self, point, within, limit):
        """Sends the vehicle to a point; returns the time until it was near."""
        self.target = point
        self.send_setpoint()
        return self.until(f"near {point}", lambda: self.distance(point) <= within, limit)

    def worst_distance(self, point, seconds):
        """The greatest distance from a point over some time."""
        end, worst = self.now + seconds, [0.0]

        def passed():
            worst[0] = max(worst[0], self.distance(point))
            return self.now >= end

        self.until("holding", passed, seconds + 1.0)
        return worst[0]

    def heard(self, words):
        return next((time for time, text in self.texts if text.startswith(words)), None)
