"""`host-sim hil` is a simulator in lock-step over MAVLink; the wheel's law, with pymavlink, is the flight
controller."""

import os
import pathlib
import runpy
import socket
import subprocess

import numpy as np
import saturated_hybrid as sh
from conftest import TOP

EXAMPLE = runpy.run_path(str(TOP / "python" / "examples" / "hil_controller.py"))
PROGRAM = pathlib.Path(os.environ.get("HOST_SIM", TOP / "target" / "debug" / "host-sim"))


def test_the_law_takes_off_and_flies_a_circle_over_mavlink():
    file = TOP / "vehicles" / "study.toml"
    scenario = sh.Scenario.load(file)
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    command = [PROGRAM, "hil", "--listen", f"127.0.0.1:{port}", "--duration", "9", file]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as simulator:
        try:
            positions, references = EXAMPLE["fly"](f"127.0.0.1:{port}", scenario, 880)
        finally:
            simulator.terminate()
            said = simulator.communicate(timeout=30)[0]
    assert len(positions) == 880, said
    off = np.linalg.norm(positions - references, axis=1)
    # From the ground, below the circle.
    assert positions[0, 2] < 0.1 and references[0, 2] > 1.0 and np.ptp(references[:, 0]) > 1.5
    print(f"the last two seconds within {1e3 * off[-200:].max():.1f} mm")
    assert off[-200:].max() < 0.05, off[-200:].max()
