"""Flies an unmodified board image from power on to the motors' stop, closed over host-sim's vehicle, and holds the
whole flight to what must be true of it.

Usage: flight.py BOARD IMAGE VEHICLE.toml

Figures that are printed were measured in that run. Times are the vehicle's.
"""

import math
import pathlib
import sys
import time

from boards import Board
from chip import POWER
from schedule import NS_PER_MS, NS_PER_S
from station import OFFBOARD, OFFBOARD_MAIN, PoseSource, Station, mavlink
from vehicle import START, Vehicle

HEIGHT = 0.5
STEP = (0.0, 0.4)
# What a hover and the end of a step are held to, m.
HOVER_ERROR_MAX, STEP_ERROR_MAX = 0.03, 0.1
# From power on, s: the certificate is worked out again at boot.
BOOT_MAX, READY_MAX = 15.0, 8.0


class Flight:
    """One board, its vehicle and its ground station."""

    def __init__(self, name: str, image: str, vehicle: pathlib.Path) -> None:
        self._begun_s, self.is_quiet = time.process_time(), False
        self.board = Board(name, image)
        self.vehicle = Vehicle(self.board, vehicle)
        self.poses = PoseSource(self.board, self.vehicle)
        self.station = Station(self.board)

    def say(self, words: str) -> None:
        """Prints a measured figure."""
        if not self.is_quiet:
            print(f"    {self.board.schedule.now / NS_PER_S:8.3f} s  {words}", flush=True)

    def boot(self, cause: str = POWER) -> None:
        """From power on to the first heartbeat and the first frame of the motors."""
        board, station = self.board, self.station
        board.start(cause)
        station.until("a heartbeat", lambda: station.counts["HEARTBEAT"] > 0, BOOT_MAX)
        self.say(f"booted, {board.escs.frames} frames to the motors")

    def make_ready(self) -> None:
        """Until the gyroscope is calibrated and poses are flown by: it says that it is ready to arm."""
        station = self.station
        station.set_parameter("POSE_DELAY", 5.0)
        station.until("telemetry", lambda: station.position is not None, READY_MAX)
        station.wait(1.0)
        error = math.dist(station.position, START)
        self.say(f"knows where it is, within {1e3 * error:.1f} mm")
        assert error < 0.01, station.position

    def arm(self) -> None:
        """Arms; motors idle."""
        station = self.station
        station.order(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1.0)
        station.until("armed", lambda: station.armed, 2.0)

    def take_off(self) -> None:
        """To a hover."""
        station = self.station
        station.order(mavlink.MAV_CMD_NAV_TAKEOFF, 0.0, 0.0, 0.0, math.nan, 0.0, 0.0, HEIGHT)
        took = station.until("taken off", lambda: station.said("Take-off over"), 15.0)
        self.say(f"taken off in {took:.2f} s")
        station.wait(0.5)

    def hover(self, place: tuple[float, float, float], seconds: float) -> None:
        """Holds a place."""
        begun = self.board.schedule.now
        self.station.wait(seconds)
        worst = max(math.dist(where, place) for when, where in self.vehicle.track if when >= begun)
        self.say(f"held within {1e3 * worst:.1f} mm for {seconds} s, truly")
        assert worst < HOVER_ERROR_MAX, worst

    def step(self) -> tuple[float, float, float]:
        """Flies to another place by setpoints."""
        station = self.station
        station.target = (START[0] + STEP[0], START[1] + STEP[1], HEIGHT)
        station.wait(0.2)
        station.order(mavlink.MAV_CMD_DO_SET_MODE, mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED, OFFBOARD_MAIN)
        station.until("flying setpoints", lambda: station.mode == OFFBOARD, 2.0)
        took = station.until("there", lambda: math.dist(self.vehicle.position, station.target) < STEP_ERROR_MAX, 4.0)
        self.say(f"{math.hypot(*STEP)} m step within {STEP_ERROR_MAX} m in {took:.2f} s, truly")
        station.wait(1.0)
        return station.target

    def land(self) -> None:
        """Down, and disarmed by itself."""
        station = self.station
        station.target = None
        station.order(mavlink.MAV_CMD_NAV_LAND)
        took = station.until("landed", lambda: station.said("Landed: disarmed"), 15.0)
        station.until("disarmed", lambda: not station.armed, 2.0)
        station.wait(0.1)
        assert self.board.escs.are_still()
        x, y, _ = self.vehicle.position
        away = math.hypot(x - START[0] - STEP[0], y - START[1] - STEP[1])
        self.say(f"landed and disarmed in {took:.2f} s, {1e3 * away:.0f} mm away, motors still")
        assert away < STEP_ERROR_MAX, away

    def report(self) -> None:
        """What was counted, and whether all was as it must be."""
        board = self.board
        core, seconds = board.core, board.schedule.now / NS_PER_S
        transfers = sum(sum(controller.transfers.values()) for controller in board.chip.dma)
        regions = sorted({key[2] for controller in board.chip.dma for key in controller.transfers})
        exchanges = sum(spi.exchanges for spi in board.chip.spis.values())
        self.say(f"{transfers} DMA transfers, to and from {', '.join(regions)} alone; {exchanges} SPI exchanges")
        self.say(f"{board.escs.frames} DShot frames, {board.escs.longest_interval_ns / 1e6:.2f} ms apart at most; "
                 f"{board.chip.watchdog.feeds} feeds of the watchdog, "
                 f"{board.chip.watchdog.longest_wait_ns / NS_PER_MS:.2f} ms apart at most")
        asleep = 100 * core.idle_ns / NS_PER_S / seconds
        self.say(f"{sum(core.taken.values())} interrupts; asleep {asleep:.0f} % of the time; "
                 f"{time.process_time() - self._begun_s:.0f} s of this processor")
        wrong = board.flight_complaints()
        wrong += [f"restarted by {cause}" for cause in board.restarts]
        assert not wrong, "\n".join(wrong)


def main() -> None:
    """A whole flight."""
    name, image, vehicle = sys.argv[1:]
    print(f"== {name}: {pathlib.Path(image).name} flies", flush=True)
    flight = Flight(name, image, pathlib.Path(vehicle))
    flight.boot()
    flight.make_ready()
    flight.arm()
    flight.take_off()
    flight.hover((START[0], START[1], HEIGHT), 2.0)
    there = flight.step()
    flight.hover(there, 1.0)
    flight.land()
    flight.report()
    print(f"== {name}: flown as the flight rules say")


if __name__ == "__main__":
    main()
