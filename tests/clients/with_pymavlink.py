"""pymavlink: every message at its rate, every question answered, and a flight by raw messages."""

import math
import os
import sys
import tempfile
import time

os.environ["MAVLINK20"] = "1"
import pyulog  # noqa: E402
from pymavlink import mavutil  # noqa: E402
from pymavlink.dialects.v20 import common as m  # noqa: E402

from vehicle import EMULATED, signing, vehicle  # noqa: E402

SPEED = 4.0

# The messages of the table in firmware/src/link/streams.rs, times a second of the vehicle's; 0: on request only.
RATES = {
    "HEARTBEAT": 1, "ATTITUDE_QUATERNION": 25, "LOCAL_POSITION_NED": 25, "ATTITUDE": 10, "TIMESYNC": 1, "SYS_STATUS": 1,
    "EXTENDED_SYS_STATE": 2, "GLOBAL_POSITION_INT": 5, "ODOMETRY": 2, "ESTIMATOR_STATUS": 1, "BATTERY_STATUS": 0.5,
    "UNKNOWN_436": 1, "HOME_POSITION": 0.5, "SYSTEM_TIME": 0.5, "POSITION_TARGET_LOCAL_NED": 5, "MISSION_CURRENT": 1,
    "GPS_GLOBAL_ORIGIN": 0, "AUTOPILOT_VERSION": 0, "UNKNOWN_300": 0,
}  # fmt: skip
# CURRENT_MODE (436) and PROTOCOL_VERSION (300), which this pymavlink's dialect has not: it counts frames by number.
# Only while something is flown.
FLYING_ONLY = {"POSITION_TARGET_LOCAL_NED"}

METRES = 0.011_119_493  # of a unit of latitude, and of longitude near the equator
POSITION = 0b110111111000
VELOCITY = 0b110111000111
ACCEPTED, DENIED, UNSUPPORTED = m.MAV_RESULT_ACCEPTED, m.MAV_RESULT_DENIED, m.MAV_RESULT_UNSUPPORTED


class Client:
    def __init__(self, port):
        self.line = signing(
            mavutil.mavlink_connection(f"udpin:127.0.0.1:{port}", source_system=255, dialect="common")
        )
        self.now, self.position, self.yaw, self.mode, self.armed = 0.0, None, 0.0, 0, False
        self.landed = None
        self.beaten = self.sent = -10.0
        self.setpoint = None
        self.counts = {}
        self.texts = []

    def step(self):
        """Takes one message, and sends what is due by the vehicle's time."""
        # A board says nothing while it certifies, and an emulated one takes its time.
        message = self.line.recv_match(blocking=True, timeout=40 if EMULATED else 5)
        assert message is not None, "the vehicle is silent"
        kind = message.get_type()
        self.counts[kind] = self.counts.get(kind, 0) + 1
        if kind == "LOCAL_POSITION_NED":
            self.now, self.position = message.time_boot_ms * 1e-3, (message.x, message.y, message.z)
        elif kind == "ATTITUDE":
            self.yaw = message.yaw
        elif kind == "HEARTBEAT":
            self.armed = bool(message.base_mode & m.MAV_MODE_FLAG_SAFETY_ARMED)
            self.mode = (message.custom_mode >> 16 & 255, message.custom_mode >> 24)
        elif kind == "EXTENDED_SYS_STATE":
            self.landed = message.landed_state
        elif kind == "STATUSTEXT":
            self.texts.append(message.text)
            print(f"    {self.now:7.2f} s  {message.text}")
        if self.now - self.beaten >= 0.5:
            self.beaten = self.now
            self.line.mav.heartbeat_send(m.MAV_TYPE_GCS, m.MAV_AUTOPILOT_INVALID, 0, 0, 0)
        if self.setpoint and self.now - self.sent >= 0.1:
            self.sent = self.now
            frame, mask, numbers = self.setpoint
            x, y, z, vx, vy, vz = numbers
            self.line.mav.set_position_target_local_ned_send(
                0, 1, 1, frame, mask, x, y, z, vx, vy, vz, 0, 0, 0, 0, 0
            )
        return message

    def until(self, what, patience, reason):
        """Goes on until what(message) is true, by the vehicle's time; returns that message."""
        end = self.now + patience
        while True:
            message = self.step()
            if what(message):
                return message
            assert self.now < end, f"not within {patience} s: {reason}; at {self.position}, mode {self.mode}"

    def reply(self, kind, patience=2.0, **fields):
        """The next message of a kind with these fields."""
        fits = lambda one: one.get_type() == kind and all(getattr(one, k) == v for k, v in fields.items())
        return self.until(fits, patience, f"{kind} {fields}")

    def command(self, number, *parameters):
        """Sends COMMAND_LONG and returns its result."""
        self.line.mav.command_long_send(1, 1, number, 0, *parameters, *[0.0] * (7 - len(parameters)))
        return self.reply("COMMAND_ACK", command=number).result

    def command_int(self, number, frame, *parameters, x=0, y=0, z=0.0):
        self.line.mav.command_int_send(1, 1, frame, number, 0, 0, *parameters, *[0.0] * (4 - len(parameters)), x, y, z)
        return self.reply("COMMAND_ACK", command=number).result

    def wait_ready(self, patience=20.0):
        """Waits until it may be armed."""
        ready = lambda one: one.get_type() == "SYS_STATUS" and (
            one.onboard_control_sensors_health & m.MAV_SYS_STATUS_PREARM_CHECK
        )
        self.until(ready, patience, "ready to arm")

    def fly_to(self, target, patience=15.0, within=0.15):
        self.setpoint = (m.MAV_FRAME_LOCAL_NED, POSITION, (*target, 0, 0, 0))
        self.until(lambda _: math.dist(self.position, target) < within, patience, f"there: {target}")

    def rest(self, seconds):
        end = self.now + seconds
        while self.now < end:
            self.step()


def numbered(kind):
    """A message's number."""
    return int(kind.removeprefix("UNKNOWN_")) if kind.startswith("UNKNOWN_") else getattr(m, f"MAVLINK_MSG_ID_{kind}")


def rates(client):
    """Every message comes as often as the table says."""
    client.rest(1.0)
    client.counts = {}
    start, seconds = client.now, 10.0
    client.rest(seconds)
    seconds = client.now - start
    for kind, rate in RATES.items():
        expected = 0 if kind in FLYING_ONLY else rate * seconds
        found = client.counts.get(kind, 0)
        assert abs(found - expected) <= 2, f"{kind}: {found} in {seconds:.2f} s, {expected:.1f} expected"


def questions(client):
    """Every request is answered."""
    for kind in RATES:
        if kind not in FLYING_ONLY:
            number = numbered(kind)
            client.counts[kind] = 0
            assert client.command(m.MAV_CMD_REQUEST_MESSAGE, number) == ACCEPTED, kind
            client.until(lambda _: client.counts[kind] > 0, 0.1 if RATES[kind] <= 1 else 2.0, f"{kind} on request")
    assert client.command(m.MAV_CMD_REQUEST_MESSAGE, m.MAVLINK_MSG_ID_RAW_IMU) == UNSUPPORTED
    assert client.command(m.MAV_CMD_SET_MESSAGE_INTERVAL, m.MAVLINK_MSG_ID_ODOMETRY, 20_000) == ACCEPTED
    assert client.command(m.MAV_CMD_GET_MESSAGE_INTERVAL, m.MAVLINK_MSG_ID_ODOMETRY) == ACCEPTED
    client.counts["ODOMETRY"] = 0
    client.rest(2.0)
    assert 96 <= client.counts["ODOMETRY"] <= 104, client.counts["ODOMETRY"]
    assert client.command(m.MAV_CMD_SET_MESSAGE_INTERVAL, m.MAVLINK_MSG_ID_ODOMETRY, 0) == ACCEPTED
    # An integer command, one that the dialect has and the vehicle not, and an unknown one.
    version = m.MAVLINK_MSG_ID_AUTOPILOT_VERSION
    client.counts["AUTOPILOT_VERSION"] = 0
    assert client.command_int(m.MAV_CMD_REQUEST_MESSAGE, m.MAV_FRAME_GLOBAL, version) == ACCEPTED
    client.until(lambda _: client.counts["AUTOPILOT_VERSION"] == 1, 0.5, "AUTOPILOT_VERSION by COMMAND_INT")
    assert client.command(m.MAV_CMD_DO_PARACHUTE) == UNSUPPORTED
    assert client.command(31_999) == UNSUPPORTED
    client.line.mav.mission_count_send(1, 1, 3, m.MAV_MISSION_TYPE_FENCE)
    assert client.reply("MISSION_ACK").type == m.MAV_MISSION_UNSUPPORTED
    client.line.mav.mission_request_list_send(1, 1)
    assert client.reply("MISSION_COUNT").count == 0
    client.line.mav.ping_send(0, 7, 0, 0)
    assert client.reply("PING").seq == 7
    client.line.mav.timesync_send(0, 123_456)
    assert client.reply("TIMESYNC", ts1=123_456).tc1 > 0


def parameters(client):
    """All are listed; one is changed, read back, and refused where it makes no sense."""
    client.line.mav.param_request_list_send(1, 1)
    names = {}
    count = client.reply("PARAM_VALUE", param_index=0).param_count
    names = {0: "SYS_ID"}
    while len(names) < count:
        value = client.reply("PARAM_VALUE")
        names[value.param_index] = value.param_id
    assert {"SYS_ID", "TKO_ALT", "BAT_LOW", "FENCE_HEIGHT"} <= set(names.values())
    for asked, kept in [(2.5, 2.5), (1e6, 2.5), (math.nan, 2.5), (1.5, 1.5)]:
        client.line.mav.param_set_send(1, 1, b"TKO_ALT", asked, m.MAV_PARAM_TYPE_REAL32)
        assert client.reply("PARAM_VALUE", param_id="TKO_ALT").param_value == kept, asked


def tuning(client):
    """A gain is set to a good value; what cannot be flown is refused in words, with the old value."""

    def asked(name, value):
        client.texts = []
        client.line.mav.param_set_send(1, 1, name.encode(), value, m.MAV_PARAM_TYPE_REAL32)
        kept = client.reply("PARAM_VALUE", patience=20.0, param_id=name).param_value
        # The same words go out once a second at most.
        client.rest(1.1)
        # An emulated board's sensors come by a line that is not read while it certifies.
        return kept, [text for text in client.texts if not text.startswith("Estimator: ")]

    assert asked("GAIN_ATT_P", 80.0) == (80.0, ["GAIN_ATT_P: may be flown, from the next boot on"])
    assert asked("GAIN_ATT_P", 130.0) == (130.0, ["GAIN_ATT_P: may be flown, from the next boot on"])
    kept, texts = asked("ROT_THR_MAX", 2.0)
    assert kept > 3.5 and texts[0] == "ROT_THR_MAX: refused, cannot be flown", (kept, texts)
    assert "R rotors' range: needs " in texts[1], texts
    kept, texts = asked("GAIN_ATT_D", 95.0)
    assert kept == 100.0 and texts == ["GAIN_ATT_D: allowed are 70 to 130 % by 10"], (kept, texts)
    assert asked("GAIN_ATT_P", 100.0)[0] == 100.0
    assert client.command(m.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 3) == UNSUPPORTED
    if EMULATED:
        assert client.command(m.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1) == UNSUPPORTED
        return
    assert asked("GAIN_ATT_P", 90.0)[0] == 90.0
    assert client.command(m.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1) == ACCEPTED
    # Half a second until it restarts; then it flies with what it was given, which is what the rest of this script does.
    client.rest(2.0)
    client.line.mav.param_request_read_send(1, 1, b"GAIN_ATT_P", -1)
    assert client.reply("PARAM_VALUE", param_id="GAIN_ATT_P").param_value == 90.0


def flight(client):
    """Arm, take off, a square of positions, body velocities, hold, land, disarmed."""
    client.wait_ready(10.0)
    assert client.command(m.MAV_CMD_NAV_TAKEOFF, 0, 0, 0, math.nan, 0, 0, 2.0) == DENIED, "not armed"
    home = client.position
    assert client.command(m.MAV_CMD_COMPONENT_ARM_DISARM, 1) == ACCEPTED
    assert client.command(m.MAV_CMD_NAV_TAKEOFF, 0, 0, 0, math.nan, 0, 0, 2.0) == ACCEPTED
    client.until(lambda _: client.position[2] < home[2] - 1.8, 15.0, "2 m up")
    assert client.armed and client.landed in (m.MAV_LANDED_STATE_TAKEOFF, m.MAV_LANDED_STATE_IN_AIR)
    assert client.command(m.MAV_CMD_COMPONENT_ARM_DISARM, 0) == DENIED, "disarmed in the air"
    client.rest(2.0)
    north, east, down = home
    offboard = (m.MAV_CMD_DO_SET_MODE, m.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED, 6, 0)
    assert client.command(*offboard) == DENIED, "no setpoints"
    client.setpoint = (m.MAV_FRAME_LOCAL_NED, POSITION, (north, east, down - 2.0, 0, 0, 0))
    client.rest(0.5)
    assert client.command(*offboard) == ACCEPTED
    for x, y in [(1, 0)] if EMULATED else [(2, 0), (2, 2), (0, 2), (0, 0)]:
        client.fly_to((north + x, east + y, down - 2.0))
    # Ahead at half a metre a second: by where it points, which is east here. It first has to turn round, from a moment that
    # depends on how busy this desk is; then two seconds are a metre.
    client.setpoint = (m.MAV_FRAME_BODY_NED, VELOCITY, (0, 0, 0, 0.5, 0, 0))
    client.rest(4.0)
    start, yaw, began = client.position, client.yaw, client.now
    client.rest(2.0)
    gone = [(now - then) / (client.now - began) for now, then in zip(client.position, start)]
    ahead = gone[0] * math.cos(yaw) + gone[1] * math.sin(yaw)
    aside = gone[1] * math.cos(yaw) - gone[0] * math.sin(yaw)
    assert abs(ahead - 0.5) < 0.1 and abs(aside) < 0.05 and abs(gone[2]) < 0.05, (ahead, aside, gone)
    client.setpoint = None
    assert client.command(m.MAV_CMD_DO_SET_MODE, m.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED, 4, 3) == ACCEPTED
    client.rest(2.0 if EMULATED else 4.0)
    assert client.mode == (4, 3), client.mode
    held = client.position
    client.counts = {}
    client.rest(5.0)
    target = client.counts["POSITION_TARGET_LOCAL_NED"]
    assert abs(target - 5 * RATES["POSITION_TARGET_LOCAL_NED"]) <= 2, f"POSITION_TARGET_LOCAL_NED: {target} in 5 s"
    assert math.dist(held, client.position) < 0.1, (held, client.position)
    assert client.command(m.MAV_CMD_NAV_LAND) == ACCEPTED
    client.until(lambda _: not client.armed, 20.0, "landed and disarmed")
    client.until(lambda _: client.landed == m.MAV_LANDED_STATE_ON_GROUND, 1.0, "said to be on the ground")
    assert abs(client.position[2] - down) < 0.1, client.position


def mission_items(client, down):
    """A take-off, a square by local places and places on the globe, and a landing at home."""
    here = client.reply("GLOBAL_POSITION_INT")
    north, east, _ = client.position
    globe = lambda x, y: (here.lat + round(x / METRES), here.lon + round(y / METRES))
    local = lambda x, y: (round((north + x) * 1e4), round((east + y) * 1e4))
    ned, relative = m.MAV_FRAME_LOCAL_NED, m.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT
    way = lambda frame, x, y, z, hold=0.0: (frame, m.MAV_CMD_NAV_WAYPOINT, hold, 0.3, 0.0, math.nan, x, y, z)
    return [
        (relative, m.MAV_CMD_NAV_TAKEOFF, 0.0, 0.0, 0.0, math.nan, 0, 0, 2.0),
        way(ned, *local(2, 0), down - 2.0, 1.0),
        way(relative, *globe(2, 2), 2.0),
        way(ned, *local(0, 2), down - 2.0),
        (m.MAV_FRAME_MISSION, m.MAV_CMD_NAV_RETURN_TO_LAUNCH, 0.0, 0.0, 0.0, math.nan, 0, 0, 0.0),
    ]


def upload(client, items):
    """Sends items as they are asked for; the last answer's result."""
    client.line.mav.mission_count_send(1, 1, len(items))
    while True:
        message = client.until(
            lambda one: one.get_type() in ("MISSION_REQUEST_INT", "MISSION_ACK"), 3.0, "an answer to an item"
        )
        if message.get_type() == "MISSION_ACK":
            return message.type
        frame, command, *rest = items[message.seq]
        client.line.mav.mission_item_int_send(1, 1, message.seq, frame, command, 0, 1, *rest)


def download(client):
    """The items that the vehicle has."""
    client.line.mav.mission_request_list_send(1, 1)
    items = []
    for number in range(client.reply("MISSION_COUNT").count):
        client.line.mav.mission_request_int_send(1, 1, number)
        one = client.reply("MISSION_ITEM_INT", seq=number)
        items.append((one.frame, one.command, one.param1, one.param2, one.param3, one.param4, one.x, one.y, one.z))
    client.line.mav.mission_ack_send(1, 1, m.MAV_MISSION_ACCEPTED)
    return items


def mission(client):
    """A mission is sent, refused where it makes no sense, read back, flown, paused, followed, and cleared."""
    client.until(lambda one: client.mode == (4, 1) and not client.armed, 5.0, "on the ground")
    client.rest(3.0)
    home = client.position
    items = mission_items(client, home[2])
    assert upload(client, items) == m.MAV_MISSION_ACCEPTED
    bad = [items[0], (items[1][0], m.MAV_CMD_DO_CHANGE_SPEED, *items[1][2:])]
    assert upload(client, bad) == m.MAV_MISSION_UNSUPPORTED
    client.rest(0.5)
    assert "Mission item 1: command 178 is not flown" in client.texts, client.texts
    back = download(client)
    assert [one[:2] + one[6:8] for one in back] == [one[:2] + one[6:8] for one in items], back
    assert all(abs(one[8] - sent[8]) < 1e-5 for one, sent in zip(back, items)), back
    assert abs(back[1][2] - 1.0) < 0.01 and abs(back[1][3] - 0.3) < 0.01, back[1]
    start = (m.MAV_CMD_MISSION_START, 0, 0)
    assert client.command(*start) == DENIED, "not armed"
    assert client.command(m.MAV_CMD_COMPONENT_ARM_DISARM, 1) == ACCEPTED
    assert client.command(*start) == ACCEPTED
    reached = client.reply("MISSION_ITEM_REACHED", patience=20.0)
    assert reached.seq == 0 and client.position[2] < home[2] - 1.5, (reached, client.position)
    client.until(lambda _: client.mode == (4, 4), 2.0, "in the mission's mode")
    assert upload(client, items) == m.MAV_MISSION_DENIED, "changed while it is flown"
    assert client.reply("MISSION_ITEM_REACHED", patience=20.0).seq == 1
    corner = (home[0] + 2.0, home[1], home[2] - 2.0)
    assert math.dist(client.position, corner) < 0.4, (client.position, corner)
    assert client.command(m.MAV_CMD_DO_PAUSE_CONTINUE, 0) == ACCEPTED
    client.until(lambda _: client.mode == (4, 3), 2.0, "paused")
    client.rest(3.0)
    assert client.reply("MISSION_CURRENT").seq == 2
    assert client.command(m.MAV_CMD_DO_SET_MODE, m.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED, 4, 4) == ACCEPTED
    for number, (x, y) in [(2, (2, 2)), (3, (0, 2))]:
        assert client.reply("MISSION_ITEM_REACHED", patience=20.0).seq == number
        corner = (home[0] + x, home[1] + y, home[2] - 2.0)
        assert math.dist(client.position, corner) < 0.6, (client.position, corner)
    client.until(lambda _: not client.armed, 40.0, "landed and disarmed")
    assert "Mission over: landing" in client.texts, client.texts
    assert math.dist(client.position, home) < 0.15, (client.position, home)
    client.line.mav.mission_clear_all_send(1, 1)
    assert client.reply("MISSION_ACK").type == m.MAV_MISSION_ACCEPTED
    assert download(client) == []


def forced(client):
    """The force number stops the motors in the air."""
    client.until(lambda one: client.mode == (4, 1) and not client.armed, 5.0, "on the ground")
    client.rest(3.0)
    assert client.command(m.MAV_CMD_COMPONENT_ARM_DISARM, 1) == ACCEPTED
    assert client.command(m.MAV_CMD_NAV_TAKEOFF, 0, 0, 0, math.nan, 0, 0, 1.0) == ACCEPTED
    up = client.position[2] - 0.5
    client.until(lambda _: client.position[2] < up, 10.0, "in the air")
    assert client.command(m.MAV_CMD_COMPONENT_ARM_DISARM, 0, 21196) == ACCEPTED
    client.until(lambda _: not client.armed, 2.0, "disarmed by force")


def recording(client):
    """The flight that was just ended by force is listed, fetched over the link, and read by PX4's own reader of
    logs."""
    client.rest(3.0)
    client.line.mav.log_request_list_send(1, 1, 0, 0xFFFF)
    entry = client.reply("LOG_ENTRY")
    assert (entry.num_logs, entry.id) == (1, 0), entry
    client.line.mav.log_request_data_send(1, 1, 0, 0, 0xFFFFFFFF)
    parts = {}
    while True:
        part = client.reply("LOG_DATA")
        parts[part.ofs] = bytes(part.data[: part.count])
        if part.count < 90:
            break
    # Lost parts are requested again.
    for offset in range(0, entry.size, 90):
        while offset not in parts:
            client.line.mav.log_request_data_send(1, 1, 0, offset, min(90, entry.size - offset))
            part = client.reply("LOG_DATA", ofs=offset)
            parts[offset] = bytes(part.data[: part.count])
    file = b"".join(parts[offset] for offset in sorted(parts))
    assert len(file) == entry.size, (len(file), entry.size)
    with tempfile.NamedTemporaryFile(suffix=".ulg") as log:
        log.write(file)
        log.flush()
        ulog = pyulog.ULog(log.name)
    assert not ulog.file_corruption and ulog.msg_info_dict["sys_name"] == "saturated hybrid feedback"
    (tick,) = ulog.data_list
    columns = tick.data
    steps = {int(step) for step in columns["timestamp"][1:] - columns["timestamp"][:-1]}
    assert tick.name == "tick" and steps == {10_000}, (tick.name, steps)
    modes = [int(mode) for mode in columns["mode"]]
    changes = [mode for at, mode in enumerate(modes) if at == 0 or modes[at - 1] != mode]
    # Idling, taking off; then stopped motors: in words, as the file itself says.
    names = dict(entry.split(" ", 1) for entry in ulog.msg_info_dict["modes"].split(", "))
    assert [names[str(mode)] for mode in changes[:2]] == ["idling", "taking off"], changes
    flying = columns["airborne"] == 1
    assert flying.any() and (columns["motors[0]"][flying & (columns["mode"] == 5)] > 0.1).all()
    assert modes[-1] not in (4, 5, 6, 7, 8, 9) and columns["motors[0]"][-1] == 0.0
    height = columns["position[2]"]
    assert 0.4 < height.max() - height[0] < 1.2, height
    print(f"    {len(modes)} ticks of the recorder, {entry.size} bytes, read by pyulog")


def main():
    with vehicle(speed=SPEED) as flown:
        client = Client(flown.offboard)
        client.line.wait_heartbeat(timeout=10)
        while client.position is None:
            client.step()
        # Seconds of an emulated board are long, and its heartbeats were requested more often.
        common = (parameters, tuning, flight)
        parts = common if EMULATED else (rates, questions, *common, mission, forced, recording)
        assert client.line.target_system == 1, client.line.target_system
        for part in parts:
            started = time.monotonic()
            part(client)
            print(f"  pymavlink {part.__name__}: passed in {time.monotonic() - started:.1f} s", flush=True)


if __name__ == "__main__":
    sys.exit(main())
