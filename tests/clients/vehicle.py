"""A simulated vehicle for one client, on ports of its own, and its true end: the firmware on this desk, or on an emulated board."""

import hashlib
import os
import re
import signal
import socket
import subprocess
import tempfile
import threading
import time

os.environ["MAVLINK20"] = "1"
from pymavlink import mavutil  # noqa: E402
from pymavlink.dialects.v20 import common as m  # noqa: E402

# Whether the firmware's image flies on an emulated processor (.ci/clients emulated), not its library on this desk.
EMULATED = "IMAGE" in os.environ

# Whether frames are signed (.ci/clients signed), and with what: MAVProxy makes keys of words in this way.
SIGNED = "SIGNED" in os.environ
PASSPHRASE = "hover"
KEY = hashlib.sha256(PASSPHRASE.encode()).digest()

# The fastest that the emulated board's time passes, by this desk's: an idle machine with two processors keeps it. A busy one is slower,
# and the client does not know.
BOARD_SPEED = 0.5

# How many times as long as for a vehicle in real time anything may take by this desk's clock.
STRETCH = 8.0 if EMULATED else 1.0

# So that a client on this desk's clock receives a heartbeat each second from a board that is ten times as slow.
BOARD_HEARTBEAT = 100_000  # us

# The longest wait for the emulator or for the simulator to come or go, s.
PATIENCE = 60.0

VEHICLE = os.path.join(os.path.dirname(__file__), "../../vehicles/study.toml")


def free_ports(count, kind=socket.SOCK_DGRAM):
    """Free ports."""
    sockets = [socket.socket(socket.AF_INET, kind) for _ in range(count)]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


def key_file(key=KEY):
    """A file with a key, for `sitl --signing-key`; it is there as long as what is returned."""
    file = tempfile.NamedTemporaryFile("w", suffix=".key")
    file.write(key.hex())
    file.flush()
    return file


def signing(line):
    """A pymavlink connection that signs, if frames are signed."""
    if SIGNED:
        line.setup_signing(KEY, sign_outgoing=True)
    return line


def accept_unsigned(flown):
    """Has the vehicle take what is not signed as well: for clients that cannot sign."""
    line = signing(mavutil.mavlink_connection(f"udpin:127.0.0.1:{flown.ground}", source_system=250, dialect="common"))
    line.wait_heartbeat(timeout=PATIENCE)
    line.mav.param_set_send(1, 1, b"SIGN_ONLY", 0.0, m.MAV_PARAM_TYPE_REAL32)
    answer = line.recv_match(type="PARAM_VALUE", blocking=True, timeout=PATIENCE)
    line.close()
    assert answer is not None and (answer.param_id, answer.param_value) == ("SIGN_ONLY", 0.0), answer


class Vehicle:
    """`host-sim` as a process; what it prints is kept, and shown if the test fails."""

    def __init__(self, *arguments):
        self.offboard, self.ground, self.local = free_ports(3)
        ports = ["--offboard-port", self.offboard, "--ground-port", self.ground, "--local-port", self.local]
        self.began = time.monotonic()
        self.process = subprocess.Popen(
            [str(part) for part in [os.environ["SIMULATOR"], *arguments, *ports]],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        )  # fmt: skip
        self.lines = []
        self.reader = threading.Thread(target=self._read, daemon=True)
        self.reader.start()

    def _read(self):
        for line in self.process.stdout:
            self.lines.append(line.rstrip())

    def said(self, text):
        """Whether the vehicle has said this."""
        return any(text in line for line in list(self.lines))

    def wait_for(self, text, patience):
        """Waits until the vehicle has said it: for so many seconds of a vehicle's in real time."""
        end = time.monotonic() + STRETCH * patience
        while not self.said(text):
            assert time.monotonic() < end, f"not said within {STRETCH * patience} s: {text}"
            time.sleep(0.05)

    def status(self):
        """The vehicle's time, s, and where it is: east, north, up, m; by the last line of status, none before the first."""
        found = [re.match(r" *([\d.]+) s  .* at +(\S+) +(\S+) +(\S+) m", line) for line in list(self.lines)]
        found = [tuple(map(float, one.groups())) for one in found if one]
        return (found[-1][0], found[-1][1:]) if found else (0.0, None)

    def rest(self, seconds):
        """Waits for so many seconds of the vehicle's time, and a line of status after them."""
        due = self.status()[0] + seconds
        end = time.monotonic() + STRETCH * (seconds + 10.0)
        while self.status()[0] < due:
            assert time.monotonic() < end, f"{seconds} s of flight have not passed"
            time.sleep(0.05)

    def __enter__(self):
        return self

    def __exit__(self, kind, *_):
        self.process.send_signal(signal.SIGINT)
        try:
            status = self.process.wait(10)
        except subprocess.TimeoutExpired:
            self.process.kill()
            raise
        # The last line may still be on its way.
        self.reader.join(10)
        if kind is not None:
            print("\n".join(f"    | {line}" for line in self.lines[-60:]))
            return
        assert status == 130, f"host-sim ended with {status}"
        assert any("interrupted" in line for line in self.lines[-2:]), self.lines[-2:]
        print(f"    {self.lines[-1]}")


class Desk(Vehicle):
    """The firmware's library in `host-sim sitl`; with `crtp` clients of the Crazyflie find it at `uri`."""

    def __init__(self, speed, *arguments, crtp=False):
        self.key = key_file() if SIGNED else None
        signed = ["--signing-key", self.key.name] if SIGNED else []
        address = f"127.0.0.1:{free_ports(1)[0]}"
        self.uri = f"udp://{address}" if crtp else None
        packets = ["--crtp", address] if crtp else []
        super().__init__("sitl", "--speed", speed, *signed, *packets, *arguments)


class Board(Vehicle):
    """The firmware's image in QEMU; `host-sim hil` is its vehicle, keeps its time and hands its line to clients.

    Its sensors are exact: a hundred samples a second of the IMU go over an emulated serial port, and a thousand would take five times
    as long.
    """

    def __init__(self):
        sensors, clients = free_ports(2, socket.SOCK_STREAM)
        serial = lambda port: ["-serial", f"tcp:127.0.0.1:{port},server=on,wait=on,nodelay=on"]
        self.said_by_board = tempfile.TemporaryFile("w+")
        command = ["qemu-system-arm", "-M", os.environ.get("MACHINE", "mps2-an386"), "-display", "none", "-monitor", "none"]
        command += ["-icount", "shift=0,sleep=off", *serial(sensors), *serial(clients)]
        command += ["-semihosting-config", "enable=on,target=native", "-kernel", os.environ["IMAGE"]]
        self.board = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=self.said_by_board
        )
        lines = ["--connect", f"127.0.0.1:{sensors}", "--ground", f"127.0.0.1:{clients}"]
        super().__init__("hil", *lines, "--speed", BOARD_SPEED, "--patience", PATIENCE, VEHICLE)

    def __enter__(self):
        try:
            self._hasten_heartbeats()
        except BaseException:
            self.__exit__(AssertionError)
            raise
        return self

    def _hasten_heartbeats(self):
        """What any client may ask of the vehicle; before the test's own client is there."""
        line = mavutil.mavlink_connection(f"udpin:127.0.0.1:{self.ground}", source_system=250, dialect="common")
        end = time.monotonic() + PATIENCE
        while line.recv_match(type="HEARTBEAT", blocking=True, timeout=1.0) is None:
            assert time.monotonic() < end, "the board says nothing"
        parameters = [m.MAVLINK_MSG_ID_HEARTBEAT, BOARD_HEARTBEAT, 0, 0, 0, 0, 0]
        line.mav.command_long_send(1, 1, m.MAV_CMD_SET_MESSAGE_INTERVAL, 0, *parameters)
        answer = line.recv_match(type="COMMAND_ACK", blocking=True, timeout=PATIENCE)
        line.close()
        assert answer is not None and answer.result == m.MAV_RESULT_ACCEPTED, answer

    def __exit__(self, kind, *rest):
        took, flown = time.monotonic() - self.began, self.status()[0]
        ended = self.board.poll()
        try:
            super().__exit__(kind, *rest)
        finally:
            self.board.terminate()
            self.board.wait(PATIENCE)
            self.said_by_board.seek(0)
            if kind is not None:
                print("    the board said:", self.said_by_board.read(), sep="\n")
            self.said_by_board.close()
        if kind is None:
            assert ended is None, f"the emulation ended by itself, status {ended}"
            assert any(" 0 missed" in line for line in self.lines), self.lines[-4:]
            print(f"    {flown:.0f} s of flight in {took:.0f} s, {flown / took:.2f} times as fast as this desk's time")


def vehicle(speed=1.0):
    """Whatever flies: on this desk at a speed, or emulated at its own."""
    return Board() if EMULATED else Desk(speed)
