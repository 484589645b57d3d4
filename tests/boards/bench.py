"""Walks docs/first-flight.md's bench checks with an emulated board: `host-sim first-flight` over its serial line, and
somebody whose hands do what the walk says, and who answers what the emulated motors really do.

Usage: bench.py BOARD IMAGE VEHICLE.toml HOST_SIM
"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time
import tomllib

from boards import BOARDS, Board
from chip import POWER
from hands import Hands
from schedule import NS_PER_S
from serve import Server
from station import PoseSource
from vehicle import Vehicle

# The walk's clock goes so many times more slowly than ours: an emulated board is some ten times slower than a real one.
_SLOWER = 20
# How long somebody waits with an answer, once the hands are still.
_WAITS_NS = NS_PER_S
# What is told, and what the hands do then.
_DEEDS = {
    "Raise the nose": "nose-up", "Raise the left side": "left-up", "Keep it flat, and turn": "turned-left",
    "Lay it flat": "flat", "5 of 15": "flat", "7 of 15": "flat", "1 m north": "carry 0 1 0", "1 m east": "carry 1 1 0",
    "Lift it 1 m": "carry 1 1 1", "Set it down": "carry 0 0 0",
}
_SIDES = ["on-left", "on-right", "on-nose", "on-tail", "on-back"]
_ANSWERS = {
    "usb": "no", "frames": "skip", "kill": "no", "radio": "no", "bootloader": "no", "battery.meter": "16.05",
    "settings.low": "14.0", "settings.critical": "13.5", "calibration.gyro": "ready", "calibration.sides": "ready",
    "calibration.level": "ready",
}
_QUESTION = re.compile(r"\[([\w.-]+)\] > $")


class Somebody:
    """Hands, eyes and answers."""

    def __init__(self, board: Board, vehicle: Vehicle, rotors: dict[str, list]) -> None:
        self._board, self._rotors = board, rotors
        self._hands = vehicle.hands = Hands()
        self._hands.take("hide")
        self._sides = list(_SIDES)
        # Which motor turned last, from 0.
        self._turned: int | None = None
        self._answer: tuple[int, bytes] | None = None

    def look(self) -> None:
        """Sees which motors turn."""
        turning = [number for number, command in enumerate(self._board.escs.commands()) if command > 0.0]
        if turning:
            self._turned = turning[0] if len(turning) == 1 else None

    def hear(self, line: str) -> None:
        """Does what a line says."""
        for told, deed in _DEEDS.items():
            if told in line:
                self._hands.take(deed)
        if "of 6 sides" in line:
            self._hands.take(self._sides.pop(0) if self._sides else "flat")
        question = _QUESTION.search(line)
        if question:
            if question[1] == "arming":
                self._hands.take("show")
            answer = self._reply(question[1])
            print(answer, flush=True)
            self._answer = self._board.schedule.now + _WAITS_NS, answer.encode() + b"\n"

    def _reply(self, key: str) -> str:
        motor, _, what = key.removeprefix("motors.").partition(".")
        if key.startswith("motors.") and what:
            if self._turned is None:
                return "none"
            if what == "way":
                return self._rotors["spin"][self._turned]
            x, y, _ = self._rotors["position"][self._turned]
            return f"{'front' if x > 0.0 else 'rear'} {'left' if y > 0.0 else 'right'}"
        return _ANSWERS.get(key, "yes")

    def answer(self) -> bytes:
        """What is said now."""
        if self._answer is not None and not self._hands.are_still:
            self._answer = self._board.schedule.now + _WAITS_NS, self._answer[1]
        if self._answer is None or self._board.schedule.now < self._answer[0]:
            return b""
        said, self._answer = self._answer[1], None
        return said


def main() -> int:
    """0 if the walk passed from the first check to the last, and the board did nothing that it must not."""
    name, image, file, program = sys.argv[1:]
    vehicle_file = pathlib.Path(file)
    board = Board(name, image)
    vehicle = Vehicle(board, vehicle_file)
    somebody = Somebody(board, vehicle, tomllib.loads(vehicle_file.read_text())["rotors"])
    PoseSource(board, vehicle)
    server = Server(board, 0)
    started = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        kept = ["--record", f"{folder}/record.toml", "--page", f"{folder}/page.md", "--image", image]
        walk = subprocess.Popen(
            [program, "first-flight", BOARDS[name].feature, file, "--link", f"tcp:127.0.0.1:{server.port}",
             "--slower", str(_SLOWER), *kept], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        assert walk.stdin is not None and walk.stdout is not None
        os.set_blocking(walk.stdout.fileno(), False)
        board.start(POWER)
        heard = ""
        while walk.poll() is None:
            server.step()
            somebody.look()
            said = (walk.stdout.read() or b"").decode()
            print(said, end="", flush=True)
            *lines, heard = (heard + said).split("\n")
            for line in lines:
                somebody.hear(line)
            if _QUESTION.search(heard):
                somebody.hear(heard)
                heard = ""
            answer = somebody.answer()
            if answer:
                walk.stdin.write(answer)
                walk.stdin.flush()
        print((walk.stdout.read() or b"").decode(), end="")
        page = pathlib.Path(f"{folder}/page.md").read_text()
    print(page)
    wrong = board.complaints()
    for complaint in wrong:
        print(f"WRONG: {complaint}")
    now = board.schedule.now / NS_PER_S
    print(f"== {name}: walked in {now:.0f} s of its time, {time.monotonic() - started:.0f} s of ours, "
          f"restarts: {', '.join(board.restarts) or 'none'}")
    return int(walk.returncode != 0 or bool(wrong))


if __name__ == "__main__":
    sys.exit(main())
