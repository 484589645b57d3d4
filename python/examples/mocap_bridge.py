"""Poses from a motion capture to the vehicle: ATT_POS_MOCAP, with TIMESYNC answered by the clock that stamps them.

    your_capture | python mocap_bridge.py udpout:127.0.0.1:14580
    python mocap_bridge.py udpout:127.0.0.1:14580 9000

Fill in `poses`, or pipe lines of JSON, or send each to a UDP port of this machine: {"t": 1760000012.34, "position":
[x, y, z], "quaternion": [w, x, y, z]}, metres, body to world, z up in both: x east, y north; x ahead, y left. `t` is
when the pose was true, s, by this machine's time.time(); without it the moment of reading counts.
"""

import json
import math
import os
import socket
import sys
import threading
import time

os.environ["MAVLINK20"] = "1"
from pymavlink import mavutil  # noqa: E402

SYSTEM = 143  # not the vehicle's


def datagrams(port):
    """Yields what comes to a UDP port of this machine."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as listener:
        listener.bind(("127.0.0.1", port))
        while True:
            yield listener.recv(4096)


def poses(lines):
    """Yields (time, position, quaternion): yours, in place of lines of JSON."""
    for line in lines:
        pose = json.loads(line)
        yield pose.get("t", time.time()), pose["position"], pose["quaternion"]


def answer_timesync(line, lock):
    """Says what this machine's clock shows whenever the vehicle asks."""
    while True:
        question = line.recv_match(type="TIMESYNC", blocking=True, timeout=1.0)
        if question is not None and question.tc1 == 0:
            with lock:
                line.mav.timesync_send(time.time_ns(), question.ts1)


def main(address, lines):
    line, lock = mavutil.mavlink_connection(address, source_system=SYSTEM, dialect="common"), threading.Lock()
    threading.Thread(target=answer_timesync, args=(line, lock), daemon=True).start()
    half = math.sqrt(0.5)
    for when, (x, y, z), (qw, qx, qy, qz) in poses(lines):
        # East, north, up to north, east, down; forward, left, up to forward, right, down.
        attitude = [half * (qw + qz), half * (qx + qy), half * (qx - qy), half * (qw - qz)]
        with lock:
            line.mav.att_pos_mocap_send(int(when * 1e6), attitude, y, x, -z)


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit("usage: mocap_bridge.py ADDRESS [UDP_PORT], ADDRESS as pymavlink has it: udpout:127.0.0.1:14580")
    main(sys.argv[1], datagrams(int(sys.argv[2])) if len(sys.argv) == 3 else sys.stdin)
