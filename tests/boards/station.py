"""A ground station and a source of poses, each on an emulated board's serial line, by pymavlink, in the vehicle's time.
"""

import math
import os
import struct
from collections import Counter
from collections.abc import Callable
from typing import Any

os.environ["MAVLINK20"] = "1"
from pymavlink.dialects.v20 import common as mavlink  # noqa: E402

from boards import Board  # noqa: E402
from schedule import NS_PER_MS, NS_PER_S, NS_PER_US  # noqa: E402
from vehicle import POSE_DELAY_NS, POSE_PERIOD_NS, Vehicle  # noqa: E402

# Position alone counts: ignore velocity, acceleration, yaw and yaw rate.
POSITION_ONLY = 0b110111111000
OFFBOARD_MAIN, OFFBOARD = 6, 6 << 16
HEARTBEAT_NS, SETPOINT_NS, RETRY_NS = NS_PER_S // 2, NS_PER_S // 10, NS_PER_S // 2
# An erase keeps the link for a second and more.
_TRIES = 8
# How long the board runs between two looks at what it sends.
LOOK_NS = 5 * NS_PER_MS


# Messages that pymavlink has no names for: common.xml's 291 and 290.
_ESC_STATUS, _ESC_INFO = "UNKNOWN_291", "UNKNOWN_290"
_RAD_S_PER_RPM = math.pi / 30.0


def _payload(frame: bytes, size: int) -> bytes:
    """Of a frame of MAVLink 2, with the zeros that its end was cut by."""
    return bytes(frame[10:10 + frame[1]]).ljust(size, b"\0")


def _esc_status(frame: bytes) -> tuple[int, list[float]]:
    time_us, *speeds = struct.unpack_from("<Q4i", _payload(frame, 57))
    return time_us, [speed * _RAD_S_PER_RPM for speed in speeds]


def _esc_info(frame: bytes) -> list[int]:
    return list(struct.unpack_from("<8x4I", _payload(frame, 46)))


class PoseSource:
    """A motion-capture system: sends what it sees of the vehicle, late."""

    def __init__(self, board: Board, vehicle: Vehicle) -> None:
        self.board, self.vehicle, self.is_on = board, vehicle, True
        self._sender = mavlink.MAVLink(None, srcSystem=1, srcComponent=197)
        board.schedule.after(0, self._see)

    def _see(self) -> None:
        schedule = self.board.schedule
        schedule.after(POSE_PERIOD_NS, self._see)
        hands = self.vehicle.hands
        if self.is_on and (hands is None or hands.is_seen):
            place, attitude = self.vehicle.pose()
            message = mavlink.MAVLink_att_pos_mocap_message(schedule.now // NS_PER_US, attitude, *place)
            schedule.after(POSE_DELAY_NS, self.board.link.receive, message.pack(self._sender))


class Station:
    """Sends heartbeats and setpoints, and keeps what the board says."""

    def __init__(self, board: Board) -> None:
        self.board = board
        self._parser = mavlink.MAVLink(None)
        self._parser.robust_parsing = True
        self._sender = mavlink.MAVLink(None, srcSystem=255, srcComponent=190)
        self.is_talking = True
        self.target: tuple[float, float, float] | None = None
        self.counts: Counter[str] = Counter()
        self.last: dict[str, Any] = {}
        # (time, text); answers to commands and the values of parameters by their names.
        self.texts: list[tuple[int, str]] = []
        self.answers: dict[int, int] = {}
        self.parameters: dict[str, float] = {}
        self.armed, self.mode = False, 0
        self.position: tuple[float, float, float] | None = None
        # What ESC_STATUS has said: (the board's time, us, speeds, rad/s); ESC_INFO: frames without a valid answer.
        self.speeds: list[tuple[int, list[float]]] = []
        self.missed_answers: list[int] | None = None
        self.is_quiet = False
        schedule = board.schedule
        schedule.after(0, self._heartbeat)
        schedule.after(0, self._setpoint)

    # Sending.

    def send(self, message: Any) -> None:
        """Sends a message as the ground station."""
        self.board.link.receive(message.pack(self._sender))

    def _heartbeat(self) -> None:
        self.board.schedule.after(HEARTBEAT_NS, self._heartbeat)
        if self.is_talking:
            self.send(mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3))

    def _setpoint(self) -> None:
        self.board.schedule.after(SETPOINT_NS, self._setpoint)
        if self.target is not None and self.is_talking:
            east, north, up = self.target
            self.send(mavlink.MAVLink_set_position_target_local_ned_message(
                self.board.schedule.now // NS_PER_MS, 1, 1, mavlink.MAV_FRAME_LOCAL_NED, POSITION_ONLY,
                north, east, -up, 0, 0, 0, 0, 0, 0, 0, 0))

    def command(self, number: int, *parameters: float) -> int:
        """Sends a command and waits for its answer."""
        self.answers.pop(number, None)
        padded = [*parameters, *[0.0] * (7 - len(parameters))]
        self.send(mavlink.MAVLink_command_long_message(1, 1, number, 0, *padded))
        self.until(f"an answer to command {number}", lambda: number in self.answers, 1.0)
        return self.answers[number]

    def order(self, number: int, *parameters: float) -> None:
        """Sends a command that must be accepted."""
        answer = self.command(number, *parameters)
        assert answer == mavlink.MAV_RESULT_ACCEPTED, (number, answer, self.texts[-3:])

    def set_parameter(self, name: str, value: float) -> None:
        """Sets a parameter and waits for its echo."""
        kind = mavlink.MAV_PARAM_TYPE_REAL32
        message = mavlink.MAVLink_param_set_message(1, 1, name.encode(), value, kind)
        # An echo of what was set before may still come.
        self._ask(name, message, lambda found: abs(found - value) < 1e-6)

    def get_parameter(self, name: str) -> float:
        """Reads one."""
        return self._ask(name, mavlink.MAVLink_param_request_read_message(1, 1, name.encode(), -1))

    def _ask(self, name: str, message: Any, fits: Callable[[float], bool] = lambda found: True) -> float:
        """Sends until a value of the parameter that fits comes: a board that has just started may not listen yet."""
        self.parameters.pop(name, None)
        for _ in range(_TRIES):
            self.send(message)
            due = self.board.schedule.now + RETRY_NS
            is_there = lambda: name in self.parameters and fits(self.parameters[name])  # noqa: E731
            answered = lambda: is_there() or self.board.schedule.now >= due  # noqa: B023, E731
            self.until(f"an answer about {name}", answered, 1.0)
            if is_there():
                return self.parameters[name]
        raise AssertionError(f"{name}: {self.parameters.get(name)} after {_TRIES} requests; {self.texts[-3:]}")

    # Listening.

    def look(self) -> None:
        """Takes what the board has sent since the last look."""
        sent = self.board.link.sent
        if not sent:
            return
        data = bytes(sent)
        sent.clear()
        for message in self._parser.parse_buffer(data) or []:
            self._take(message)

    def _take(self, message: Any) -> None:
        kind = message.get_type()
        self.counts[kind] += 1
        self.last[kind] = message
        if kind == "HEARTBEAT":
            self.armed = bool(message.base_mode & mavlink.MAV_MODE_FLAG_SAFETY_ARMED)
            self.mode = message.custom_mode
        elif kind == "LOCAL_POSITION_NED":
            self.position = (message.y, message.x, -message.z)
        elif kind == "STATUSTEXT":
            self.texts.append((self.board.schedule.now, message.text))
            if not self.is_quiet:
                print(f"    {self.board.schedule.now / NS_PER_S:8.3f} s  {message.text}", flush=True)
        elif kind == "COMMAND_ACK":
            self.answers[message.command] = message.result
        elif kind == _ESC_STATUS:
            self.speeds.append(_esc_status(message.data))
        elif kind == _ESC_INFO:
            self.missed_answers = _esc_info(message.data)
        elif kind == "PARAM_VALUE":
            self.parameters[message.param_id] = message.param_value

    def until(self, what: str, condition: Callable[[], bool], limit_s: float) -> float:
        """Runs the board until that is so, for at most `limit_s` of vehicle time; returns how long it took, s."""
        begun = self.board.schedule.now
        while not condition():
            if self.board.schedule.now - begun > limit_s * NS_PER_S:
                raise AssertionError(f"{what}: not within {limit_s} s; {self.texts[-4:]}")
            self.board.run(LOOK_NS)
            self.look()
        return (self.board.schedule.now - begun) / NS_PER_S

    def wait(self, seconds: float) -> None:
        """Runs the board for so long."""
        end = self.board.schedule.now + round(seconds * NS_PER_S)
        self.until("waiting", lambda: self.board.schedule.now >= end, seconds + 1.0)

    def said(self, words: str, since_ns: int = 0) -> bool:
        """Whether a text with these words has come since then."""
        return any(words in text and time >= since_ns for time, text in self.texts)
