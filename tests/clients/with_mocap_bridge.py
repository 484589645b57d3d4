"""The motion capture bridge: flights on its poses alone, on time and late; python/examples/mocap_bridge.py.

`sitl --poses link` has no camera, and `--truth-port` is the motion capture: each line is held back, and handed to the
bridge. One vehicle each for three delays, all at once, since they fly in real time; each flies three times in a row.
"""

import json
import math
import os
import queue
import socket
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor

os.environ["MAVLINK20"] = "1"
from pymavlink.dialects.v20 import common as m  # noqa: E402

import with_pymavlink  # noqa: E402
from vehicle import SIGNED, Desk, accept_unsigned, free_ports  # noqa: E402

BRIDGE = os.path.join(os.path.dirname(__file__), "../../python/examples/mocap_bridge.py")
ACCEPTED = m.MAV_RESULT_ACCEPTED
LATENESS = (0.0, 0.02, 0.1)  # s
FLIGHTS = 3
WITHIN = 0.15  # m, of each corner, and of where it took off

# What no flight on true poses may hear.
NEVER = ("frozen", "delay unknown", "no believable pose", "given up")


class Capture:
    """Where the vehicle really is, held back for a while before the bridge has it: piped, and sent to a port if it is
    not held back."""

    def __init__(self, flown, port, late):
        self.truth, self.late, self.waiting = None, late, queue.Queue()
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", port))
        command = [sys.executable, BRIDGE, f"udpout:127.0.0.1:{flown.local}"]
        (self.port,) = free_ports(1)
        command += [] if late else [str(self.port)]
        self.bridge = subprocess.Popen(command, stdin=subprocess.PIPE)
        for task in (self._see, self._send):
            threading.Thread(target=task, daemon=True).start()

    def _see(self):
        while True:
            line = self.socket.recv(4096)
            pose = json.loads(line)
            self.truth = pose["position"]
            self.waiting.put((pose["t"] + self.late, line))

    def _send(self):
        while True:
            due, line = self.waiting.get()
            time.sleep(max(0.0, due - time.time()) if self.late else 0.0)
            try:
                if self.late:
                    self.bridge.stdin.write(line + b"\n")
                    self.bridge.stdin.flush()
                else:
                    self.socket.sendto(line, ("127.0.0.1", self.port))
            except BrokenPipeError:
                return

    def close(self):
        self.bridge.kill()
        self.bridge.wait()


def fly(client, capture):
    """Take-off, a square, landing; how far the vehicle really was from the farthest corner, m."""
    client.wait_ready()
    east, north, up = capture.truth
    assert client.command(m.MAV_CMD_COMPONENT_ARM_DISARM, 1) == ACCEPTED
    assert client.command(m.MAV_CMD_NAV_TAKEOFF, 0, 0, 0, math.nan, 0, 0, 1.5) == ACCEPTED
    client.until(lambda _: client.mode == (4, 3), 20.0, "taken off")
    misses = []
    for x, y in [(1, 0), (1, 1), (0, 1), (0, 0)]:
        client.setpoint = (m.MAV_FRAME_LOCAL_NED, with_pymavlink.POSITION, (north + x, east + y, -up - 1.5, 0, 0, 0))
        client.rest(0.3)
        if client.mode != (6, 0):
            offboard = (m.MAV_CMD_DO_SET_MODE, m.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED, 6, 0)
            assert client.command(*offboard) == ACCEPTED
            client.until(lambda _: client.mode == (6, 0), 3.0, "flying setpoints")
        client.rest(4.5)
        misses.append(math.dist(capture.truth, (east + y, north + x, up + 1.5)))
    client.setpoint = None
    assert client.command(m.MAV_CMD_NAV_LAND) == ACCEPTED
    client.until(lambda _: not client.armed, 20.0, "landed and disarmed")
    client.rest(1.0)
    misses.append(math.dist(capture.truth, (east, north, up)))
    assert max(misses) < WITHIN, misses
    assert not any(never in text for text in client.texts for never in NEVER), client.texts
    return max(misses)


def fly_again_and_again(late):
    """As many flights as there are to be on poses that come late, s; the farthest from any corner, m."""
    (port,) = free_ports(1)
    with Desk(1.0, "--poses", "link", "--truth-port", port) as flown:
        if SIGNED:
            accept_unsigned(flown)
        capture = Capture(flown, port, late)
        try:
            client = with_pymavlink.Client(flown.offboard)
            client.line.wait_heartbeat(timeout=10)
            return max(fly(client, capture) for _ in range(FLIGHTS))
        finally:
            capture.close()


def main():
    with ThreadPoolExecutor(len(LATENESS)) as vehicles:
        for late, farthest in zip(LATENESS, vehicles.map(fly_again_and_again, LATENESS)):
            flown = f"{FLIGHTS} squares within {100 * farthest:.1f} cm, landed"
            print(f"  mocap bridge, {1e3 * late:.0f} ms late: {flown}", flush=True)


if __name__ == "__main__":
    sys.exit(main())
