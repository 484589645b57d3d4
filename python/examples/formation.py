"""Four vehicles in formation, by cflib's Swarm: one motion capture for all of them, one script that leads them.

    python formation.py --simulate host-sim        # starts four simulated vehicles, and ends them
    python formation.py --truth-ports 9001 9002 9003 9004 udp://127.0.0.1:19850 udp://127.0.0.1:19851 ...

The second way flies vehicles that run already: for each

    host-sim sitl mine.toml --crtp 127.0.0.1:19850 --poses link --truth-port 9001 \\
        --offboard-port 15001 --ground-port 15101 --local-port 15201

with ports of its own, and a file of its own whose `[initial]` says where it stands. Their truth ports take the place of
a motion capture. For a real one, fill in `capture`: then addresses may be radio:// as well.

The frame is the capture's: x, y, z in metres, z up. Put the vehicles down with their noses along x. Ctrl-C lands them.
"""

import argparse
import contextlib
import json
import math
import pathlib
import random
import select
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time

import cflib.crtp
from cflib.crazyflie.swarm import CachedCfFactory, Swarm

VEHICLE = pathlib.Path(__file__).resolve().parents[2] / "vehicles/published/cf2-forster.toml"
HOMES = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]  # m: where the simulated ones stand
HEIGHT = 1.0  # m
SETTLING = 2.0  # s after each move, in the second half of which the formation is measured
PATIENCE = 30.0  # s
NOISE = 3e-4  # m, of a capture: the simulated truth has none, and what never moves by a bit passes for frozen
POSE_DELAY = 1.0  # ms: how late the capture's poses come

# How far the formation moves from where it stood (m), how far it turns (degrees), how it grows, in how many seconds. A
# move that leaves the vehicles too little time is flown as fast as they may, and not in step.
MOVES = [
    ((0.5, 0.0, 0.2), 0.0, 1.0, 5.0),
    ((0.0, 0.5, 0.0), 45.0, 1.3, 6.0),
    ((0.0, 0.0, 0.0), 0.0, 1.0, 6.0),
]


def capture(ports):
    """Yields (vehicle, position, quaternion with the scalar last) as they come: yours, in place of the truth ports."""
    with contextlib.ExitStack() as stack:
        sockets = {}
        for vehicle, port in enumerate(ports):
            listener = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
            listener.bind(("127.0.0.1", port))
            sockets[listener] = vehicle
        while True:
            for listener in select.select(list(sockets), [], [], 1.0)[0]:
                pose = json.loads(listener.recv(4096))
                w, x, y, z = pose["quaternion"]
                yield sockets[listener], [random.gauss(axis, NOISE) for axis in pose["position"]], (x, y, z, w)


class Bridge:
    """Sends each vehicle its poses, and knows where all of them are."""

    def __init__(self, ports):
        self.poses, self.vehicles, self.ports = [None] * len(ports), [None] * len(ports), ports
        threading.Thread(target=self._run, daemon=True).start()

    def _run(self):
        for number, place, turned in capture(self.ports):
            self.poses[number] = place
            vehicle = self.vehicles[number]
            if vehicle is not None and vehicle.is_connected():
                vehicle.extpos.send_extpose(*place, *turned)


def formation(stood, move):
    """Where each vehicle is to be, m, by where it stood."""
    (x, y, z), turn, grown, _ = move
    middle_x, middle_y = (sum(axis) / len(stood) for axis in list(zip(*stood))[:2])
    sine, cosine = math.sin(math.radians(turn)), math.cos(math.radians(turn))
    for home in stood:
        a, b = grown * (home[0] - middle_x), grown * (home[1] - middle_y)
        yield middle_x + x + cosine * a - sine * b, middle_y + y + sine * a + cosine * b, home[2] + HEIGHT + z


def until(what, reason):
    end = time.monotonic() + PATIENCE
    while not what():
        if time.monotonic() > end:
            raise RuntimeError(f"not within {PATIENCE:.0f} s: {reason}")
        time.sleep(0.02)


class Console:
    """What a vehicle says, line by line; it comes in parts."""

    def __init__(self, number):
        self.number, self.text = number, ""

    def __call__(self, part):
        *lines, self.text = (self.text + part).split("\n")
        for line in lines:
            print(f"  vehicle {self.number}: {line}", flush=True)


def prepare(sync, number, bridge):
    """What a vehicle needs before it flies: poses, and that it is armed."""
    vehicle = sync.cf
    vehicle.console.receivedChar.add_callback(Console(number))
    sync.wait_for_params()
    vehicle.param.set_value("POSE.DELAY", POSE_DELAY)
    bridge.vehicles[number] = vehicle
    until(lambda: vehicle.supervisor.can_be_armed, f"vehicle {number} may be armed")
    vehicle.supervisor.send_arming_request(True)
    until(lambda: vehicle.supervisor.is_armed, f"vehicle {number} is armed")


def worst(bridge, places):
    """How far from its place the vehicle is that is farthest from it, over half the settling time, m."""
    end, farthest = time.monotonic() + SETTLING / 2, 0.0
    while time.monotonic() < end:
        farthest = max(farthest, *(math.dist(pose, place) for pose, place in zip(bridge.poses, places)))
        time.sleep(0.02)
    return farthest


def fly(swarm, uris, bridge):
    """Take-off and the moves; the worst error of a formation once it stood, m."""
    stood, errors = list(bridge.poses), []
    swarm.parallel_safe(lambda sync: sync.cf.high_level_commander.takeoff(HEIGHT, 4.0))
    until(lambda: all(pose[2] > stood[0][2] + HEIGHT - 0.02 for pose in bridge.poses), "taken off")
    for move in MOVES:
        seconds = move[-1]
        places = list(formation(stood, move))
        goals = {uri: (*place, 0.0, seconds) for uri, place in zip(uris, places)}
        swarm.parallel_safe(lambda sync, *goal: sync.cf.high_level_commander.go_to(*goal), goals)
        time.sleep(seconds + SETTLING / 2)
        errors.append(worst(bridge, places))
        print(f"moved by {move[0]} m, turned by {move[1]:.0f} degrees: within {100 * errors[-1]:.1f} cm", flush=True)
    return max(errors)


def land(swarm):
    def down(sync):
        if sync.cf.supervisor.is_armed:
            sync.cf.high_level_commander.land(0.0, 4.0)
        until(lambda: not sync.cf.supervisor.is_armed, "landed")

    swarm.parallel_safe(down)


@contextlib.contextmanager
def simulated(program):
    """Four vehicles as processes; their addresses and truth ports."""
    sockets = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(5 * len(HOMES))]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = iter([one.getsockname()[1] for one in sockets])
    for one in sockets:
        one.close()
    processes, uris, truths = [], [], []
    with tempfile.TemporaryDirectory() as directory:
        try:
            for number, (x, y) in enumerate(HOMES):
                file = pathlib.Path(directory) / f"{number}.toml"
                file.write_text(f"{VEHICLE.read_text()}\n[initial]\nposition = [{x}, {y}, 0.0]\n")
                crtp, truth, offboard, ground, local = (next(ports) for _ in range(5))
                command = [program, "sitl", file, "--crtp", f"127.0.0.1:{crtp}", "--poses", "link"]
                command += ["--truth-port", truth, "--local-port", local]
                command += ["--offboard-port", offboard, "--ground-port", ground]
                processes.append(subprocess.Popen([str(word) for word in command], stdout=subprocess.DEVNULL))
                uris.append(f"udp://127.0.0.1:{crtp}")
                truths.append(truth)
            yield uris, truths
        finally:
            for process in processes:
                process.send_signal(signal.SIGINT)
            for process in processes:
                process.wait(PATIENCE)


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--simulate", metavar="HOST_SIM", help="start four simulated vehicles with this program")
    parser.add_argument("--truth-ports", metavar="PORT", type=int, nargs=len(HOMES), help="where their truth comes")
    parser.add_argument("uris", metavar="URI", nargs="*", help="the vehicles, in the order of their truth ports")
    options = parser.parse_args(arguments)
    if options.simulate is None and (options.truth_ports is None or len(options.uris) != len(HOMES)):
        parser.error(f"needs --simulate, or {len(HOMES)} truth ports and as many addresses")
    cflib.crtp.init_drivers()
    with contextlib.ExitStack() as stack:
        uris, ports = options.uris, options.truth_ports
        if options.simulate:
            uris, ports = stack.enter_context(simulated(options.simulate))
        bridge = Bridge(ports)
        # A simulated vehicle is judged first.
        until(lambda: all(bridge.poses), "a pose of each vehicle")
        cache = stack.enter_context(tempfile.TemporaryDirectory())
        swarm = stack.enter_context(Swarm(uris, factory=CachedCfFactory(rw_cache=cache)))
        try:
            swarm.parallel_safe(prepare, {uri: (number, bridge) for number, uri in enumerate(uris)})
            error = fly(swarm, uris, bridge)
        finally:
            land(swarm)
    print(f"landed; worst formation error {100 * error:.1f} cm")


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except (RuntimeError, OSError, KeyboardInterrupt) as error:
        sys.exit(f"error: {error or 'interrupted'}")
