"""Trajectories from files through the firmware's tasks: streamed by python/examples/stream_rows.py, and eighteen points
as a mission.

`host-sim reference` makes the rows; `--truth-port` says where the vehicle really was.
"""

import json
import math
import os
import pathlib
import socket
import subprocess
import sys
import tempfile
import threading

os.environ["MAVLINK20"] = "1"
from pymavlink.dialects.v20 import common as m  # noqa: E402

import with_pymavlink  # noqa: E402
from vehicle import Desk, free_ports  # noqa: E402

ROOT = pathlib.Path(__file__).parent / "../.."
sys.path.append(str(ROOT / "python/examples"))
import stream_rows  # noqa: E402

WITHIN = 0.05  # m, of each row
TRIES = 3
QUICKEST_SLOWER = 1.6
MISSION_WITHIN = 0.45  # m, of each point: its acceptance radius, and what the vehicle is off the reference


def eighteen():
    """Points on two circles at three heights."""
    for i in range(18):
        angle, radius = 0.7 * i, 3.0 if i % 2 == 0 else 2.0
        yield radius * math.cos(angle), radius * math.sin(angle), 1.5 + 0.5 * (i % 3)


def gates_files(directory):
    """Scenarios of the gates and of the eighteen points, inside the bounds of streams."""
    text = (ROOT / "scenarios/gates.toml").read_text()
    rows = "".join(f"{x:.3f},{y:.3f},{z}\n" for x, y, z in eighteen())
    (directory / "eighteen.csv").write_text(f"x,y,z\n{rows}")
    head = text.split("points = [")[0]
    mine = f'{head}file = "eighteen.csv"\n'.replace('"gates"', '"eighteen"')
    return [for_streams(directory / "gates.toml", text), for_streams(directory / "eighteen.toml", mine)]


def for_streams(path, text):
    """The scenario with the bounds that `certify --show` prints."""
    path.write_text(text)
    command = [os.environ["SIMULATOR"], "certify", str(path), "--show"]
    shown = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    path.write_text(f"{text}\n{shown[shown.index('[reference_bounds]'):]}")
    return path


class Truth:
    """Where the vehicle really has been."""

    def __init__(self, port):
        self.places = []
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", port))
        threading.Thread(target=self._see, daemon=True).start()

    def _see(self):
        while True:
            self.places.append(json.loads(self.socket.recv(4096))["position"])

    def nearest(self, places):
        """The farthest that any of the places was passed at, m."""
        path = list(self.places)
        return max(min(math.dist(there, place) for there in path) for place in places)


def simulator(*arguments):
    subprocess.run([os.environ["SIMULATOR"], *map(str, arguments)], check=True, stdout=subprocess.DEVNULL)


def stream(file, directory, slower):
    """On a busy machine a setpoint may come too late to be followed: the vehicle then says so, and it is tried
    again."""
    rows = directory / "rows.csv"
    simulator("reference", file, "--rows", rows, "--slower", slower)
    for _ in range(TRIES):
        worst, texts = stream_once(file, rows)
        if worst < WITHIN:
            print(f"  {file.stem}, streamed: every row passed within {100 * worst:.1f} cm", flush=True)
            return
        assert any(text.startswith("Setpoints") for text in texts), (worst, texts)
        print(f"  {file.stem}, streamed: {worst:.2f} m off, and said so: {texts}", flush=True)
    raise AssertionError(f"{file}: not within {WITHIN} m in {TRIES} flights")


def stream_once(file, rows):
    """How far from a row the vehicle was at worst, m, and what it said."""
    (port,) = free_ports(1)
    with Desk(1.0, file, "--truth-port", port) as flown:
        truth = Truth(port)
        vehicle = stream_rows.Vehicle(f"udpin:127.0.0.1:{flown.offboard}")
        stream_rows.fly(vehicle, stream_rows.read(rows))
        return truth.nearest([row[1:4] for row in stream_rows.read(rows)]), vehicle.texts


def fly_mission(file):
    """The points as NAV_WAYPOINTs, from the ground to the ground."""
    points = list(eighteen())
    local = lambda x, y, z: (round(y * 1e4), round(x * 1e4), -z)
    items = [(m.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT, m.MAV_CMD_NAV_TAKEOFF, 0, 0, 0, math.nan, 0, 0, 1.5)]
    items += [(m.MAV_FRAME_LOCAL_NED, m.MAV_CMD_NAV_WAYPOINT, 0, 0.3, 0, math.nan, *local(*point)) for point in points]
    items.append((m.MAV_FRAME_MISSION, m.MAV_CMD_NAV_RETURN_TO_LAUNCH, 0, 0, 0, math.nan, 0, 0, 0))
    (port,) = free_ports(1)
    with Desk(4.0, file, "--truth-port", port) as flown:
        truth = Truth(port)
        client = with_pymavlink.Client(flown.offboard)
        client.line.wait_heartbeat(timeout=10)
        client.wait_ready()
        assert with_pymavlink.upload(client, items) == m.MAV_MISSION_ACCEPTED, client.texts
        assert client.command(m.MAV_CMD_COMPONENT_ARM_DISARM, 1) == m.MAV_RESULT_ACCEPTED
        assert client.command(m.MAV_CMD_MISSION_START) == m.MAV_RESULT_ACCEPTED
        client.until(lambda _: "Mission over: landing" in client.texts, 180.0, "over")
        client.until(lambda _: not client.armed, 60.0, "landed and disarmed")
        worst = truth.nearest(points)
    assert worst < MISSION_WITHIN, worst
    print(f"  eighteen points as a mission: every one passed within {100 * worst:.0f} cm", flush=True)


def main():
    with tempfile.TemporaryDirectory() as name:
        directory = pathlib.Path(name)
        gates, mine = gates_files(directory)
        eight, pieces = ((ROOT / f"scenarios/{name}.toml").resolve() for name in ("eight", "pieces"))
        # The quickest paths through points change their snap faster than the governor follows a stream.
        for file, slower in [(eight, 1.1), (pieces, 1.1), (gates, QUICKEST_SLOWER), (mine, QUICKEST_SLOWER)]:
            simulator("certify", file)
            stream(file, directory, slower)
        fly_mission(mine)


if __name__ == "__main__":
    sys.exit(main())
