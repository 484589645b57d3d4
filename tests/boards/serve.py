"""Serves an emulated board's serial line on a local TCP port, for clients that people have: `host-sim first-flight`, a
ground station. Its vehicle stands on the ground until the motors lift it, and a motion-capture system sees it.

Usage: serve.py BOARD IMAGE VEHICLE.toml [--port N] [--no-poses] [--hands]

The board runs as fast as this machine lets it, slower or faster than real time; a client that waits should wait by the
vehicle's time. One client at a time; the board does not stop while there is none.
"""

import argparse
import os
import pathlib
import select
import socket
import sys

from boards import BOARDS, Board
from chip import POWER
from hands import Hands
from schedule import NS_PER_MS, NS_PER_S
from station import PoseSource
from vehicle import Vehicle

_LOOK_NS = 2 * NS_PER_MS
_SAY_NS = 10 * NS_PER_S


class Server:
    """A board's serial line on a local TCP port."""

    def __init__(self, board: Board, port: int) -> None:
        self.board = board
        self._client: socket.socket | None = None
        self._server = socket.create_server(("127.0.0.1", port))
        self._server.setblocking(False)
        self.port: int = self._server.getsockname()[1]

    def step(self) -> None:
        """Runs the board for a moment, and carries bytes both ways."""
        self.board.run(_LOOK_NS)
        sent = bytes(self.board.link.sent)
        self.board.link.sent.clear()
        if self._client is None:
            self._accept()
        elif not self._exchange(self._client, sent):
            self._client.close()
            self._client = None

    def _accept(self) -> None:
        try:
            self._client, _ = self._server.accept()
        except BlockingIOError:
            return
        self._client.setblocking(True)
        self._client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def _exchange(self, client: socket.socket, sent: bytes) -> bool:
        """Whether the client is still there."""
        try:
            client.sendall(sent)
            if not select.select([client], [], [], 0)[0]:
                return True
            data = client.recv(4096)
        except OSError:
            return False
        if data:
            self.board.link.receive(data)
        return bool(data)


def _hands_do(vehicle: Vehicle, unread: bytes) -> bytes:
    """Does what standard input says; what is left of a line."""
    if vehicle.hands is None or not select.select([sys.stdin], [], [], 0)[0]:
        return unread
    *lines, unread = (unread + os.read(sys.stdin.fileno(), 4096)).split(b"\n")
    for line in lines:
        try:
            vehicle.hands.take(line.decode(errors="replace"))
        except ValueError as error:
            print(error, flush=True)
    return unread


def main() -> None:
    """Serves until it is interrupted."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("board", choices=sorted(BOARDS))
    parser.add_argument("image")
    parser.add_argument("vehicle", type=pathlib.Path)
    parser.add_argument("--port", type=int, default=5760)
    parser.add_argument("--no-poses", action="store_true", help="nothing sees the vehicle")
    parser.add_argument("--hands", action="store_true",
                        help="take words for a person's hands from standard input, as host-sim sitl --hands does")
    arguments = parser.parse_args()
    board = Board(arguments.board, arguments.image)
    vehicle = Vehicle(board, arguments.vehicle)
    if arguments.hands:
        vehicle.hands = Hands()
    if not arguments.no_poses:
        PoseSource(board, vehicle)
    server = Server(board, arguments.port)
    print(f"{arguments.board} on tcp:127.0.0.1:{server.port}", flush=True)
    said, unread = 0, b""
    board.start(POWER)
    while True:
        server.step()
        unread = _hands_do(vehicle, unread)
        if board.schedule.now >= said + _SAY_NS:
            said = board.schedule.now
            x, y, z = vehicle.position
            print(f"{said // NS_PER_S} s: at {x:.2f}, {y:.2f}, {z:.2f} m", flush=True)


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        sys.exit(0)
