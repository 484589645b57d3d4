"""The lines of `host-sim hil --help`, run as printed: board and vehicle find each other and fly their ticks."""

import pathlib
import re
import shlex
import subprocess

from rig import IMAGE, PATIENCE, SIMULATOR, TOP

# Vehicle time for which it is run, s: from the first command on, without a ground station.
DURATION = 3


def lines():
    """The commands of the help, continued lines joined."""
    said = subprocess.run([SIMULATOR, "hil", "--help"], check=True, capture_output=True, text=True).stdout
    joined = said.replace("\\\n", " ")
    return [line.strip() for line in joined.splitlines() if re.match(r"  (cargo|qemu-system-arm|host-sim) ", line)]


def as_printed(_machine):
    build, board, vehicle = (shlex.split(line) for line in lines())
    # The build is the one that made the image which flies here, and puts it where the next line looks for it.
    profile, feature, binary = (build[build.index(option) + 1] for option in ("--profile", "--features", "--bin"))
    kernel = pathlib.Path(board[board.index("-kernel") + 1])
    target = build[build.index("--target") + 1]
    assert (profile, feature, binary) == ("board", "mps2", "mps2"), build
    assert kernel == pathlib.Path("target", target, profile, binary), kernel
    assert IMAGE.parts[-3:] == kernel.parts[-3:], f"{IMAGE} is not what the help has built"
    vehicle = [SIMULATOR, *vehicle[1:], "--duration", str(DURATION), "--patience", str(PATIENCE)]
    process = subprocess.Popen([IMAGE if word == str(kernel) else word for word in board], cwd=TOP, stdout=subprocess.DEVNULL)
    try:
        report = subprocess.run(vehicle, cwd=TOP, check=True, capture_output=True, text=True, timeout=PATIENCE).stdout
    finally:
        process.terminate()
        process.wait(PATIENCE)
    ticks, missed = re.search(r"(\d+) ticks, .* (\d+) missed", report).groups()
    print(f"    {ticks} ticks, {missed} missed, no ground station")
    assert int(ticks) >= DURATION * 100 and int(missed) == 0, report
