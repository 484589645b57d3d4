"""A simulated vehicle for one client, on ports of its own, and its true end."""

import os
import re
import signal
import socket
import subprocess
import threading
import time


def free_ports(count):
    """UDP ports that nobody has."""
    sockets = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(count)]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


class Vehicle:
    """`host-sim sitl` as a process; what it prints is kept, and shown if the test fails."""

    def __init__(self, *arguments, speed=1.0):
        self.offboard, self.ground, self.local = free_ports(3)
        ports = ["--offboard-port", self.offboard, "--ground-port", self.ground, "--local-port", self.local]
        command = [os.environ["SIMULATOR"], "sitl", "--speed", speed, *ports, *arguments]
        self.process = subprocess.Popen(
            [str(part) for part in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )
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
        """Waits until the vehicle has said it, seconds of this desk's time."""
        end = time.monotonic() + patience
        while not self.said(text):
            assert time.monotonic() < end, f"not said within {patience} s: {text}"
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
        assert status == 130, f"sitl ended with {status}"
        assert "interrupted" in self.lines[-1], self.lines[-1]
        print(f"    {self.lines[-1]}")


def final_position(vehicle):
    """Where the vehicle truly was at its end, m."""
    return tuple(float(part) for part in re.search(r"at (\S+) (\S+) (\S+) m", vehicle.lines[-1]).groups())
