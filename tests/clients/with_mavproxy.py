"""MAVProxy at its own prompt: connect, arm, take off, fly in body frames, hold, land, disarm; a mission by `wp`.

Its `mode` is for ArduPilot and PX4: for any other autopilot it sends ArduCopter's numbers, which here are refused. Modes are changed by `long
DO_SET_MODE` with PX4's numbers. `velocity` is sent once when it is typed; `repeat` makes a stream of it, as the vehicle asks for.
"""

import math
import pathlib
import subprocess
import sys
import tempfile
import threading
import time

import pyulog
from vehicle import PASSPHRASE, SIGNED, STRETCH, vehicle

MODULES = "arm,mode,cmdlong,param,link,misc,log,signing,wp"


class MAVProxy:
    def __init__(self, port, directory):
        self.directory = pathlib.Path(directory)
        program = pathlib.Path(sys.executable).parent / "mavproxy.py"
        command = [sys.executable, "-u", program, f"--master=udp:127.0.0.1:{port}", f"--default-modules={MODULES}"]
        command += ["--logfile", self.directory / "mav.tlog", "--state-basedir", directory]
        self.process = subprocess.Popen(
            [str(part) for part in command],
            cwd=directory, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        )  # fmt: skip
        self.text = ""
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self):
        while character := self.process.stdout.read(1):
            self.text += character

    def type(self, line):
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()

    def wait_for(self, text, patience=10.0, after=0):
        """Waits until it shows a text; returns where that ends."""
        end = time.monotonic() + STRETCH * patience
        while (place := self.text.find(text, after)) < 0:
            assert time.monotonic() < end, f"MAVProxy has not shown {text!r} within {STRETCH * patience} s; it showed:\n{self.text}"
            time.sleep(0.05)
        return place + len(text)

    def ask(self, line, answer, patience=5.0):
        before = len(self.text)
        self.type(line)
        self.wait_for(answer, patience, before)

    def close(self):
        self.type("exit")
        try:
            self.process.wait(5)
        except subprocess.TimeoutExpired:
            self.process.kill()


def fly(flown, proxy):
    proxy.wait_for("Detected vehicle 1:1", 20)
    if SIGNED:
        proxy.ask(f"signing key {PASSPHRASE}", "Setup signing key")
    flown.wait_for("ready", 20)
    # It says so once it has all of them.
    proxy.wait_for(" parameters to ", 20)
    proxy.ask("param show TKO_ALT", "TKO_ALT          1.5")
    proxy.type("param set TKO_ALT 2.0")
    flown.rest(1.0)
    proxy.ask("param show TKO_ALT", "TKO_ALT          2.0")
    print("  MAVProxy: connected, parameters read and set", flush=True)
    proxy.ask("arm throttle", "Got COMMAND_ACK: COMPONENT_ARM_DISARM: ACCEPTED")
    flown.wait_for("Armed: idling", 2)
    proxy.ask("takeoff 2", "Got COMMAND_ACK: NAV_TAKEOFF: ACCEPTED")
    flown.wait_for("Take-off over", 30)
    print("  MAVProxy: armed, took off", flush=True)

    # What an ArduPilot user types first is refused, in words, and changes nothing.
    proxy.ask("mode GUIDED", "DENIED")
    proxy.type("repeat add 0.2 velocity 0.5 0 0")
    time.sleep(0.6)
    proxy.ask("long DO_SET_MODE 1 6 0", "Got COMMAND_ACK: DO_SET_MODE: ACCEPTED")
    flown.wait_for("Flying setpoints", 2)
    # Once it is up to speed, however late this busy desk's setpoints came.
    flown.rest(4.0)
    began, start = flown.status()
    flown.rest(2.0)
    ended, end = flown.status()
    # It points east.
    ahead, aside, up = ((now - then) / (ended - began) for now, then in zip(end, start))
    assert abs(ahead - 0.5) < 0.1 and abs(aside) < 0.05 and abs(up) < 0.05, (ahead, aside, up)
    print(f"  MAVProxy: flew {ahead:.2f} m/s ahead by velocity", flush=True)

    # A position of the body's frame counts from where the vehicle is when it comes.
    proxy.type("repeat remove 0")
    start = flown.status()[1]
    proxy.type("position 0 2 0")
    time.sleep(0.3)
    proxy.ask("long DO_SET_MODE 1 6 0", "Got COMMAND_ACK: DO_SET_MODE")
    flown.rest(4.0)
    end = flown.status()[1]
    # To the right is south.
    assert start[1] - end[1] > 0.5, (start, end)
    print(f"  MAVProxy: flew {start[1] - end[1]:.2f} m to the right by position", flush=True)

    proxy.ask("long DO_SET_MODE 1 4 3", "Got COMMAND_ACK: DO_SET_MODE: ACCEPTED")
    flown.rest(3.0)
    held = flown.status()[1]
    flown.rest(2.0)
    assert math.dist(held, flown.status()[1]) < 0.1
    proxy.ask("disarm", "Got COMMAND_ACK: COMPONENT_ARM_DISARM: DENIED")
    proxy.ask("long NAV_LAND", "Got COMMAND_ACK: NAV_LAND: ACCEPTED")
    flown.wait_for("Landed: disarmed", 30)
    proxy.wait_for("DISARMED", 5)
    print("  MAVProxy: held, was refused a disarming in the air, landed and disarmed", flush=True)
    # The recorder goes on for two seconds. On an emulated board it holds four and a half.
    flown.rest(3.0)
    proxy.ask("log list", "Log 0  numLogs 1")
    proxy.ask("log download 0 flight.ulg", "Finished downloading flight.ulg", 60)
    (ticks,) = pyulog.ULog(str(proxy.directory / "flight.ulg")).data_list
    assert len(ticks.data["timestamp"]) > 400 and ticks.data["airborne"].any(), len(ticks.data["timestamp"])
    print(f"  MAVProxy: fetched {len(ticks.data['timestamp'])} ticks of the recorder", flush=True)
    fly_mission(flown, proxy)
    proxy.ask("arm throttle", "Got COMMAND_ACK: COMPONENT_ARM_DISARM: ACCEPTED", 10)
    proxy.ask("disarm", "Got COMMAND_ACK: COMPONENT_ARM_DISARM: ACCEPTED", 10)
    print("  MAVProxy: armed and disarmed on the ground", flush=True)


METRES = 111_194.93  # of a degree

# A mission as MAVProxy keeps it, in a file: number, current, frame, command, four parameters, place, autocontinue.
WAYPOINTS = """QGC WPL 110
0\t0\t3\t22\t0\t0\t0\t0\t0\t0\t2\t1
1\t0\t3\t16\t0\t0.3\t0\t0\t{:.8f}\t{:.8f}\t2\t1
2\t0\t0\t20\t0\t0\t0\t0\t0\t0\t0\t1
"""


def fly_mission(flown, proxy):
    """`wp`: a file is sent, saved again, and flown."""
    east, north, _ = flown.status()[1]
    (proxy.directory / "square.txt").write_text(WAYPOINTS.format((north + 2.0) / METRES, east / METRES))
    proxy.ask("wp load square.txt", "Loaded 3 waypoints", 10)
    flown.wait_for("Mission: 3 items", 10)
    proxy.ask("wp list", "Saved waypoints to", 10)
    back = [line.split("\t") for line in (proxy.directory / "way.txt").read_text().splitlines()[1:]]
    assert [(int(line[2]), int(line[3])) for line in back] == [(3, 22), (3, 16), (2, 20)], back
    assert abs(float(back[1][8]) * METRES - north - 2.0) < 0.02, back
    proxy.ask("arm throttle", "Got COMMAND_ACK: COMPONENT_ARM_DISARM: ACCEPTED", 10)
    # It has landed before.
    before = len(proxy.text)
    proxy.ask("long MISSION_START", "Got COMMAND_ACK: MISSION_START: ACCEPTED")
    flown.wait_for("Mission over: landing", 60)
    proxy.wait_for("Landed: disarmed", 90, before)
    proxy.ask("wp clear", "", 5)
    print("  MAVProxy: sent a mission by `wp load`, listed it, flew it", flush=True)
    flown.rest(3.0)


def main():
    with vehicle() as flown, tempfile.TemporaryDirectory() as directory:
        proxy = MAVProxy(flown.ground, directory)
        try:
            fly(flown, proxy)
        finally:
            proxy.close()


if __name__ == "__main__":
    sys.exit(main())
