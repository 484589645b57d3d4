"""Serves an emulated board's serial line on a local TCP port, for clients that people have: `host-sim first-flight`, a
ground station. Its vehicle stands on the ground until the motors lift it, and a motion-capture system sees it.

Usage: serve.py BOARD IMAGE VEHICLE.toml [--port N] [--no-poses]

The board runs as fast as this machine lets it, slower or faster than real time; a client that waits should wait by the
vehicle's time. One client at a time; the board does not stop while there is none.
"""

import argparse
import pathlib
import select
import socket
import sys

from boards import BOARDS, Board
from chip import POWER
from schedule import NS_PER_MS, NS_PER_S
from station import PoseSource
from vehicle import Vehicle

_LOOK_NS = 2 * NS_PER_MS
_SAY_NS = 10 * NS_PER_S


def _exchange(board: Board, client: socket.socket) -> bool:
    """Carries bytes both ways; whether the client is still there."""
    sent = bytes(board.link.sent)
    board.link.sent.clear()
    try:
        client.sendall(sent)
        if not select.select([client], [], [], 0)[0]:
            return True
        data = client.recv(4096)
    except OSError:
        return False
    if data:
        board.link.receive(data)
    return bool(data)


def main() -> None:
    """Serves until it is interrupted."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("board", choices=sorted(BOARDS))
    parser.add_argument("image")
    parser.add_argument("vehicle", type=pathlib.Path)
    parser.add_argument("--port", type=int, default=5760)
    parser.add_argument("--no-poses", action="store_true", help="nothing sees the vehicle")
    arguments = parser.parse_args()
    board = Board(arguments.board, arguments.image)
    vehicle = Vehicle(board, arguments.vehicle)
    if not arguments.no_poses:
        PoseSource(board, vehicle)
    with socket.create_server(("127.0.0.1", arguments.port)) as server:
        server.setblocking(False)
        print(f"{arguments.board} on tcp:127.0.0.1:{server.getsockname()[1]}", flush=True)
        client: socket.socket | None = None
        said = 0
        board.start(POWER)
        while True:
            board.run(_LOOK_NS)
            if client is None:
                board.link.sent.clear()
                try:
                    client, _ = server.accept()
                    client.setblocking(True)
                    client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                except BlockingIOError:
                    pass
            elif not _exchange(board, client):
                client.close()
                client = None
            if board.schedule.now >= said + _SAY_NS:
                said = board.schedule.now
                x, y, z = vehicle.position
                print(f"{said // NS_PER_S} s: at {x:.2f}, {y:.2f}, {z:.2f} m", flush=True)


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        sys.exit(0)
