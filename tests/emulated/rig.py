"""The rig: an emulated board, the simulated vehicle on its first serial port, a ground station on its second."""

import bisect
import csv
import math
import os
import pathlib
import re
import socket
import subprocess
import tempfile

from station import Station

TOP = pathlib.Path(__file__).resolve().parents[2]
# The file that the image was built of.
VEHICLE = pathlib.Path(os.environ.get("VEHICLE", TOP / "vehicles/study.toml"))

# The sensors that boards have: an IMU at 1 kHz with a BMI088's noise and biases, poses with 1 mm and 0.3 degrees of noise, 20 ms
# late. Without this section sensors are exact, and come once a tick.
NOISY = """
[estimator]
imu_noise = 1.0
pose_rate = 100.0
pose_delay = 0.02
position_noise = 0.001
attitude_noise_deg = 0.3
seed = 1
"""

# Between two commands, s.
TICK = 1.0 / float(re.search(r"^rate = ([\d.]+) ", VEHICLE.read_text(), re.MULTILINE)[1])

# How far the ticks' spacing may be from that, us: what the emulated clock and the message's way make of it.
JITTER_MAX = 50

# The hardest touchdown that any way down may end with, m/s; and how hard it may touch the ground again: from 0.02 mm.
TOUCHDOWN_MAX = 1.2
GRAZE_MAX = 0.02

# The longest that motors may turn on the ground after it, s: half a second until the reference is 0.25 m below it, a second for
# which it must look like the ground, and the contact's last quivering.
GROUND_FOUND_MAX = 1.75

# What flies: the files that .ci/emulated_flight has just built.
SIMULATOR = pathlib.Path(os.environ["SIMULATOR"])
IMAGE = pathlib.Path(os.environ["IMAGE"])

# 1 ns an instruction, and no waiting while the processor sleeps: see firmware/src/boards/mps2/idle.rs.
TIME = "shift=0,sleep=off"

# Longest wait of any process for another, seconds of this machine's time. Only a hang reaches it.
PATIENCE = 180.0


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Rig:
    """One boot of one machine, from power on to the report of what the vehicle did."""

    def __init__(self, machine, simulator_options=(), sensors=""):
        """`sensors`: what the scenario says of them beyond the vehicle's file."""
        self.machine = machine
        self.sensors = sensors
        self.options = [str(option) for option in simulator_options]

    def __enter__(self):
        self.folder = tempfile.TemporaryDirectory(prefix="emulated-flight-")
        folder = pathlib.Path(self.folder.name)
        self.log = folder / "log.csv"
        scenario = folder / "scenario.toml"
        scenario.write_text(VEHICLE.read_text() + self.sensors)
        self.said = open(folder / "board.txt", "w+")
        self.report = open(folder / "simulator.txt", "w+")
        vehicle, ground = free_port(), free_port()
        serial = lambda port: ["-serial", f"tcp:127.0.0.1:{port},server=on,wait=on,nodelay=on"]
        self.processes = []
        # Without `nodelay`, each tick would wait for the other side's delayed acknowledgement of its first byte, 40 ms.
        # The board waits with its first instruction until both are connected.
        self.start(["qemu-system-arm", "-M", self.machine, "-display", "none", "-monitor", "none", "-icount", TIME,
                    *serial(vehicle), *serial(ground), "-semihosting-config", "enable=on,target=native",
                    "-kernel", IMAGE], subprocess.DEVNULL, self.said)
        self.start([SIMULATOR, "hil", "--connect", f"127.0.0.1:{vehicle}", "--patience", PATIENCE, "--log", self.log,
                    *self.options, scenario], self.report, self.report)
        try:
            self.station = Station(f"tcp:127.0.0.1:{ground}", PATIENCE)
        except BaseException:
            self.stop()
            raise
        return self

    def start(self, command, out, err):
        command = [str(word) for word in command]
        self.processes.append(subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=out, stderr=err))

    def __exit__(self, kind, error, trace):
        if error is not None:
            print(f"    the board said:\n{self.read(self.said)}    the simulator said:\n{self.read(self.report)}")
        self.stop()
        self.folder.cleanup()

    def stop(self):
        for process in self.processes:
            if process.poll() is None:
                process.terminate()
            process.wait(PATIENCE)
        self.said.close()
        self.report.close()

    @staticmethod
    def read(file):
        file.flush()
        file.seek(0)
        return file.read()

    def land(self):
        """Switches the board off and reads what the simulator saw."""
        board, simulator = self.processes
        assert board.poll() is None, f"the emulation ended by itself, status {board.returncode}"
        self.station.close()
        board.terminate()
        board.wait(PATIENCE)
        assert simulator.wait(PATIENCE) == 0, "the simulator failed"
        self.summary = self.read(self.report)
        pace = re.search(r"(\d+) ticks, (\d+) to (\d+) us apart .* (\d+) missed, in ([\d.]+) s", self.summary)
        assert pace, self.summary
        self.ticks, self.shortest, self.longest, self.missed = (int(figure) for figure in pace.groups()[:4])
        self.took = float(pace.group(5))
        touched = re.findall(r"touched the ground at ([\d.]+) s with ([\d.]+) m/s, leaning ([\d.]+) degrees", self.summary)
        self.touchdowns = [tuple(float(figure) for figure in figures) for figures in touched]
        with open(self.log) as file:
            self.rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]

    def truth(self, begin, end):
        """Where the vehicle was from `begin` to `end`, s of the board's time: a row is the state a tick after its command."""
        for row in self.rows:
            time = 1e-6 * row["controller_us"] + TICK
            if begin <= time <= end:
                yield time, (row["px"], row["py"], row["pz"])

    def worst_error(self, track):
        """The greatest distance of what telemetry said, (time, position), from where the vehicle was; every place it has had."""
        truth = list(self.truth(0.0, math.inf))
        times = [time for time, _ in truth]
        worst = 0.0
        for time, position in track:
            # A report is that of a tick, its time cut to milliseconds; the next row's time is a tick's duration later or less.
            place = truth[min(bisect.bisect_left(times, time - TICK / 2), len(truth) - 1)][1]
            worst = max(worst, math.dist(position, place))
        return worst

    def check_landed(self):
        """It came down once, softly and upright, and stands where it came down, its motors off."""
        (time, speed, lean), *again = self.touchdowns
        # Set down with its rotors turning it may part from the ground by a hair, and touch it again.
        assert all(graze < GRAZE_MAX for _, graze, _ in again), self.summary
        off = min(row["t"] for row in self.rows if row["t"] > time and row["armed"] == 0)
        print(f"    touched down at {speed:.3f} m/s, leaning {lean:.1f} degrees; motors off {off - time:.2f} s later")
        assert speed < TOUCHDOWN_MAX and lean < 10.0, self.summary
        assert off - time < GROUND_FOUND_MAX, off - time
        last = self.rows[-1]
        assert last["armed"] == 0 and last["thrust"] < 0.05 and abs(last["pz"]) < 0.01, last
        assert all(row["armed"] == 0 for row in self.rows if row["t"] >= off)

    def check_pace(self):
        """No tick missed, and next to no jitter, in emulated time."""
        assert self.missed == 0, self.summary
        assert self.shortest > 1e6 * TICK - JITTER_MAX and self.longest < 1e6 * TICK + JITTER_MAX, self.summary
        print(f"    {self.ticks} ticks {self.shortest} to {self.longest} us apart, none missed; took {self.took:.0f} s")
