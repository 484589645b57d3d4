"""QGroundControl's start, replayed by pymavlink: what it asks of a vehicle of autopilot GENERIC, in its order, with its patience.

QGroundControl itself is not run. The states and their times are those of its master as of 2026, read in its source:
InitialConnectStateMachine, RequestMessageCoordinator (4c246ee4dc), MavCommandQueue (1e06c9b93f), StandardModes (117ed905b4),
RequestMetaDataTypeStateMachine (0ae35b5c0e), InitialParameterDownloader, PlanManager (00d5b5e018), FTPManager, GimbalController and
QGCCameraManager. Every request must be answered at the first asking; a refusal is an answer, silence is not.

The fence, rally points and files are asked only of vehicles that say they have them. They are asked here all the same, since
versions differ; and so is what its buttons ask.
"""

import os
import sys
import time

os.environ["MAVLINK20"] = "1"
from pymavlink import mavutil  # noqa: E402
from pymavlink.dialects.v20 import all as m  # noqa: E402

from vehicle import signing, vehicle  # noqa: E402

# s; tries are all of them, the first included.
HEARTBEAT = 1.0
COMMAND_ACK, COMMAND_TRIES = 1.2, 3
MESSAGE_AFTER_ACK = 1.0
LIST_BEGINS, LIST_TRIES = 5.0, 5
LIST_SILENCE, LIST_BATCH = 3.0, 10
PLAN_ACK, PLAN_TRIES = 1.5, 6
FILE_ACK, FILE_TRIES = 1.0, 4

# Values that are taken for lost on their way, to be read again by their places.
LOST = {3, 4, 17}

STATION, COMPONENT = 255, 190
VEHICLE, AUTOPILOT = 1, 1
RESULTS = {0: "accepted", 2: "denied", 3: "unsupported"}

# Messages and commands by their numbers: not every pymavlink has all of them.
AUTOPILOT_VERSION, COMPONENT_METADATA, COMPONENT_INFORMATION = 148, 397, 395
AVAILABLE_MODES, GIMBAL_MANAGER_INFORMATION, CAMERA_INFORMATION = 435, 280, 259
MISSION, FENCE, RALLY = 0, 1, 2
RESET_SESSIONS, LIST_DIRECTORY, OPEN_FOR_READING, REFUSED = 2, 3, 4, 129


class Station:
    """A ground station by this desk's clock."""

    def __init__(self, port):
        self.line = signing(
            mavutil.mavlink_connection(
                f"udpin:127.0.0.1:{port}", source_system=STATION, source_component=COMPONENT, dialect="all"
            )
        )
        self.beaten = 0.0
        self.unanswered = []

    def take(self, patience):
        """The vehicle's next message; None if it does not come in time."""
        now = time.monotonic()
        if now - self.beaten >= HEARTBEAT:
            self.beaten = now
            self.line.mav.heartbeat_send(m.MAV_TYPE_GCS, m.MAV_AUTOPILOT_INVALID, 0, 0, 0)
        message = self.line.recv_match(blocking=True, timeout=max(min(patience, 0.2), 0.001))
        if message is None or (message.get_srcSystem(), message.get_srcComponent()) != (VEHICLE, AUTOPILOT):
            return None
        return message

    def wait(self, fits, patience):
        """The first message that fits, or none."""
        end = time.monotonic() + patience
        while (left := end - time.monotonic()) > 0:
            message = self.take(left)
            if message is not None and fits(message):
                return message
        return None

    def show(self, what, tries, began, said):
        """Prints what was answered, and remembers what was not, or not at once."""
        took = 1e3 * (time.monotonic() - began)
        again = "" if tries == 1 else f", asked {tries} times"
        print(f"    {what:<44} {took:7.1f} ms  {said or 'SILENCE'}{again}", flush=True)
        if said is None or tries > 1:
            self.unanswered.append(what)

    def ask(self, what, send, fits, patience, tries, say):
        """Sends until there is an answer, `tries` times at most; the answer."""
        began = time.monotonic()
        for tried in range(1, tries + 1):
            send()
            if (message := self.wait(fits, patience)) is not None:
                self.show(what, tried, began, say(message))
                return message
        self.show(what, tries, began, None)
        return None

    def command(self, what, number, *parameters, received=lambda message: None):
        """A command by COMMAND_LONG; its result. `received` sees whatever comes before that."""
        parameters = [*parameters, *[0.0] * (7 - len(parameters))]

        def acknowledged(message):
            received(message)
            return message.get_type() == "COMMAND_ACK" and message.command == number

        send = lambda: self.line.mav.command_long_send(VEHICLE, AUTOPILOT, number, 0, *parameters)
        say = lambda answer: RESULTS.get(answer.result, f"result {answer.result}")
        answer = self.ask(what, send, acknowledged, COMMAND_ACK, COMMAND_TRIES, say)
        return None if answer is None else answer.result

    def message(self, what, number):
        """A message by REQUEST_MESSAGE, which may come before or after the acknowledgement; none if refused."""
        received = []
        note = lambda message: received.append(message) if message.get_msgId() == number else None
        if self.command(what, m.MAV_CMD_REQUEST_MESSAGE, number, received=note) != m.MAV_RESULT_ACCEPTED:
            return None
        began = time.monotonic()
        message = received[0] if received else self.wait(lambda one: one.get_msgId() == number, MESSAGE_AFTER_ACK)
        self.show("  the message itself", 1, began, message and message.get_type())
        return message


def request_autopilot_version(station):
    version = station.message("REQUEST_MESSAGE AUTOPILOT_VERSION", AUTOPILOT_VERSION)
    assert version is not None, "no AUTOPILOT_VERSION: QGroundControl would assume what it can"
    offered = version.capabilities
    assert offered & m.MAV_PROTOCOL_CAPABILITY_MISSION_INT
    for name in ("MISSION_FENCE", "MISSION_RALLY", "FTP"):
        assert not offered & getattr(m, f"MAV_PROTOCOL_CAPABILITY_{name}"), f"{name} is offered and not there"


def request_standard_modes(station):
    """All at once; the last one says that it is."""
    modes = {}

    def note(message):
        if message.get_msgId() == AVAILABLE_MODES:
            modes[message.mode_index] = message

    done = lambda: modes and len(modes) == next(iter(modes.values())).number_modes
    began = time.monotonic()
    result = station.command(
        "REQUEST_MESSAGE AVAILABLE_MODES, all", m.MAV_CMD_REQUEST_MESSAGE, AVAILABLE_MODES, received=note
    )
    assert result == m.MAV_RESULT_ACCEPTED, result
    station.wait(lambda message: note(message) or done(), MESSAGE_AFTER_ACK) if not done() else None
    names = [modes[index].mode_name for index in sorted(modes)]
    station.show("  the modes", 1, began, ", ".join(names) if done() else None)
    assert len(set(names)) == len(names), names


def request_component_information(station):
    """Metadata by the new message, then by the old one; where both are refused there is nothing to download."""
    for name, number in [("METADATA", COMPONENT_METADATA), ("INFORMATION", COMPONENT_INFORMATION)]:
        assert station.message(f"REQUEST_MESSAGE COMPONENT_{name}", number) is None


def request_parameters(station):
    """The list; what was lost of it, by its places; then the time, twice, which is not answered."""
    found, lost, count = {}, set(LOST), None
    value = lambda message: message.get_type() == "PARAM_VALUE"
    send = lambda: station.line.mav.param_request_list_send(VEHICLE, 0)
    first = station.ask("PARAM_REQUEST_LIST", send, value, LIST_BEGINS, LIST_TRIES, lambda one: f"the first of {one.param_count}")
    began, message = time.monotonic(), first
    while message is not None:
        count = message.param_count
        if message.param_index in lost:
            lost.discard(message.param_index)
        else:
            found[message.param_index] = message.param_id
        message = station.wait(value, LIST_SILENCE) if len(found) + len(LOST) < count else None
    taken = count and f"{len(found)} of {count} taken, {len(LOST)} lost on purpose"
    station.show("  the rest of the list", 1, began, taken)
    # Its patience, before it reads what it misses.
    assert station.wait(lambda one: value(one) and one.param_index not in found, LIST_SILENCE) is None
    for index in sorted(set(range(count)) - set(found))[:LIST_BATCH]:
        send = lambda: station.line.mav.param_request_read_send(VEHICLE, AUTOPILOT, b"", index)
        fits = lambda message: value(message) and message.param_index == index
        answer = station.ask(f"PARAM_REQUEST_READ {index}", send, fits, LIST_SILENCE, 1, lambda one: one.param_id)
        found[index] = answer and answer.param_id
    assert sorted(found) == list(range(count)) and len(set(found.values())) == count, found
    for _ in range(2):
        station.line.mav.system_time_send(int(time.time() * 1e6), 0)


def request_plan(station, name, kind):
    """A list of mission items; an answer about another list than the one asked about is dropped."""
    send = lambda: station.line.mav.mission_request_list_send(VEHICLE, AUTOPILOT, kind)
    fits = lambda message: message.get_type() == "MISSION_COUNT" and message.mission_type == kind
    say = lambda answer: f"{answer.count} items"
    answer = station.ask(f"MISSION_REQUEST_LIST {name}", send, fits, PLAN_ACK, PLAN_TRIES, say)
    assert answer is None or (answer.count, answer.target_system) == (0, STATION), answer
    station.line.mav.mission_ack_send(VEHICLE, AUTOPILOT, m.MAV_MISSION_ACCEPTED, kind)


def upload_plan(station, name, kind):
    """What its plan view sends, and how it clears."""
    fits = lambda message: message.get_type() == "MISSION_ACK" and message.mission_type == kind
    # Only the mission is a list here: an empty one is taken.
    count, result = (0, 0) if kind == MISSION else (3, 3)
    for what, send, expected in [
        (f"MISSION_COUNT {name}", lambda: station.line.mav.mission_count_send(VEHICLE, AUTOPILOT, count, kind), result),
        (f"MISSION_CLEAR_ALL {name}", lambda: station.line.mav.mission_clear_all_send(VEHICLE, AUTOPILOT, kind), 0),
    ]:
        answer = station.ask(what, send, fits, PLAN_ACK, PLAN_TRIES, lambda one: f"MISSION_ACK {one.type}")
        assert answer is None or answer.type == expected, answer


def request_file(station, name, operation, path):
    """One step of a download."""
    sequence = 2 * operation + 1
    header = [sequence & 255, sequence >> 8, 0, operation, len(path), 0, 0, 0, 0, 0, 0, 0]
    payload = bytes(header) + path
    send = lambda: station.line.mav.file_transfer_protocol_send(
        0, VEHICLE, AUTOPILOT, payload + bytes(251 - len(payload))
    )

    def fits(message):
        if message.get_type() != "FILE_TRANSFER_PROTOCOL" or message.target_system != STATION:
            return False
        return message.payload[0] | message.payload[1] << 8 == sequence + 1 and message.payload[5] == operation

    say = lambda answer: f"refused, error {answer.payload[12]}" if answer.payload[3] == REFUSED else "answered"
    station.ask(f"FILE_TRANSFER_PROTOCOL {name}", send, fits, FILE_ACK, FILE_TRIES, say)


def other_components(station):
    """With the parameters there, it asks every component that has a heartbeat whether it is a camera or has a gimbal."""
    station.message("REQUEST_MESSAGE GIMBAL_MANAGER_INFORMATION", GIMBAL_MANAGER_INFORMATION)
    station.message("REQUEST_MESSAGE CAMERA_INFORMATION", CAMERA_INFORMATION)
    station.command("REQUEST_CAMERA_INFORMATION", m.MAV_CMD_REQUEST_CAMERA_INFORMATION, 1)


def what_else_it_can_ask(station):
    request_file(station, "reset sessions", RESET_SESSIONS, b"")
    request_file(station, "list of /", LIST_DIRECTORY, b"/")
    request_file(station, "open @PARAM/param.pck", OPEN_FOR_READING, b"@PARAM/param.pck")
    for name, kind in [("mission", MISSION), ("fence", FENCE), ("rally points", RALLY)]:
        upload_plan(station, name, kind)
    assert station.message("REQUEST_MESSAGE HOME_POSITION", m.MAVLINK_MSG_ID_HOME_POSITION) is not None
    station.command("GET_HOME_POSITION", m.MAV_CMD_GET_HOME_POSITION)
    attitude = m.MAVLINK_MSG_ID_ATTITUDE_QUATERNION
    station.command("SET_MESSAGE_INTERVAL ATTITUDE_QUATERNION 20 Hz", m.MAV_CMD_SET_MESSAGE_INTERVAL, attitude, 50_000)
    station.command("SET_MESSAGE_INTERVAL ATTITUDE_QUATERNION usual", m.MAV_CMD_SET_MESSAGE_INTERVAL, attitude, 0)
    station.command("SET_MESSAGE_INTERVAL CAMERA_INFORMATION", m.MAV_CMD_SET_MESSAGE_INTERVAL, CAMERA_INFORMATION, 0)
    station.command("RUN_PREARM_CHECKS", m.MAV_CMD_RUN_PREARM_CHECKS)
    station.line.mav.timesync_send(0, 123_456)
    began = time.monotonic()
    answer = station.wait(lambda one: one.get_type() == "TIMESYNC" and one.ts1 == 123_456, 1.0)
    station.show("TIMESYNC", 1, began, answer and "answered")


STATES = [
    ("RequestAutopilotVersion", request_autopilot_version),
    ("RequestStandardModes", request_standard_modes),
    ("RequestCompInfo", request_component_information),
    ("RequestParameters", request_parameters),
    ("RequestMission", lambda station: request_plan(station, "mission", MISSION)),
    ("RequestGeoFence", lambda station: request_plan(station, "fence", FENCE)),
    ("RequestRallyPoints", lambda station: request_plan(station, "rally points", RALLY)),
    ("cameras and gimbals", other_components),
    ("besides", what_else_it_can_ask),
]


def main():
    with vehicle() as flown:
        station = Station(flown.ground)
        heartbeat = station.wait(lambda message: message.get_type() == "HEARTBEAT", 10.0)
        assert heartbeat is not None and heartbeat.autopilot == m.MAV_AUTOPILOT_GENERIC, heartbeat
        for name, state in STATES:
            print(f"  QGroundControl's start, {name}", flush=True)
            state(station)
        assert not station.unanswered, f"not answered at the first asking: {', '.join(station.unanswered)}"
        print("  QGroundControl's start: everything answered at the first asking", flush=True)


if __name__ == "__main__":
    sys.exit(main())
