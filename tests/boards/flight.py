"""Flies an unmodified board image from power on to the motors' stop, closed over host-sim's vehicle, and holds the
whole flight to what must be true of it.

Usage: flight.py BOARD IMAGE VEHICLE.toml [both-ways]

Both ways: the motors' controllers answer each frame (`MOT_DSHOT` 1), and what ESC_STATUS says is held to how fast the
rotors truly turn.

Figures that are printed were measured in that run. Times are the vehicle's.
"""

import math
import pathlib
import sys
import time

from boards import Board
from chip import POWER, SOFTWARE
from schedule import NS_PER_MS, NS_PER_S, NS_PER_US
from station import OFFBOARD, OFFBOARD_MAIN, PoseSource, Station, mavlink
from vehicle import START, Vehicle

# As low as a take-off may be: this vehicle climbs with 0.18 m/s^2 at most, and half of a flight is up and down.
HEIGHT = 0.5
STEP = (0.0, 0.25)
# What a hover and the end of a step are held to, m.
HOVER_ERROR_MAX, STEP_ERROR_MAX = 0.03, 0.1
# Parts of a rotor's speed, and of the answers: one that begins before the firmware listens is missed.
SPEED_ERROR_MAX, MISSED_ANSWERS_MAX = 0.02, 0.005
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
        # Frames before its controllers answered.
        self.plain_frames = 0

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

    def speak_both_ways(self) -> None:
        """Has the controllers answer, from a restart by command on."""
        board, station, escs = self.board, self.station, self.board.escs
        station.set_parameter("MOT_DSHOT", 1.0)
        station.wait(0.2)
        assert escs.inverted_frames == 0, escs.inverted_frames
        station.order(mavlink.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1.0)
        plain = escs.frames

        def started() -> None:
            self.plain_frames = escs.frames
            escs.begin_anew()
        board.on_start = started
        station.counts.clear()
        station.until("a heartbeat again", lambda: bool(board.restarts) and station.counts["HEARTBEAT"] > 0, BOOT_MAX)
        assert board.restarts == [SOFTWARE], board.restarts
        board.restarts.clear()
        station.position = None
        self.say(f"restarted to speak both ways, {self.plain_frames - plain} plain frames before it went")

    def compare_speeds(self, what: str) -> None:
        """Holds what ESC_STATUS said since the last look to the truth."""
        clock_us = self.board.chip.time_base.ticks()
        said, errors = self.station.speeds, []
        for time_us, speeds in said:
            when = self.board.schedule.now - (clock_us - time_us) * NS_PER_US
            near = [(abs(then - when), truth) for then, truth in self.vehicle.rotor_speeds]
            distance, truth = min(near)
            if distance <= NS_PER_MS:
                errors += [abs(speed / true - 1.0) if true else abs(speed) for speed, true in zip(speeds, truth)]
        said.clear()
        assert errors, f"no ESC_STATUS of the last half second, {what}"
        self.say(f"{what}: ESC_STATUS's {len(errors)} speeds are the rotors' within {100 * max(errors):.2f} %")
        assert max(errors) < SPEED_ERROR_MAX, max(errors)

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
        station.wait(0.2)

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
        if board.escs.answers:
            self.say(f"{board.escs.answers} answers, {self.station.missed_answers} not understood; "
                     f"{sum(board.chip.sampler.samples.values())} samples of pins")
            missed = sum(self.station.missed_answers) / board.escs.answers
            assert missed < MISSED_ANSWERS_MAX, self.station.missed_answers
        inverted = board.escs.frames - self.plain_frames if board.escs.answers else 0
        asleep = 100 * core.idle_ns / NS_PER_S / seconds
        self.say(f"{sum(core.taken.values())} interrupts; asleep {asleep:.0f} % of the time; "
                 f"{time.process_time() - self._begun_s:.0f} s of this processor")
        wrong = board.flight_complaints()
        wrong += [f"restarted by {cause}" for cause in board.restarts]
        if board.escs.inverted_frames != inverted:
            wrong.append(f"{board.escs.inverted_frames} frames on lines that rest high, not {inverted}")
        assert not wrong, "\n".join(wrong)


def main() -> None:
    """A whole flight."""
    name, image, vehicle, *ways = sys.argv[1:]
    assert ways in ([], ["both-ways"]), ways
    print(f"== {name}: {pathlib.Path(image).name} flies", *ways, flush=True)
    flight = Flight(name, image, pathlib.Path(vehicle))
    flight.boot()
    if ways:
        flight.speak_both_ways()
    flight.make_ready()
    flight.arm()
    if ways:
        flight.station.wait(0.6)
        flight.compare_speeds("idling")
    flight.take_off()
    if ways:
        flight.hover((START[0], START[1], HEIGHT), 1.0)
        flight.compare_speeds("hovering")
    else:
        flight.hover((START[0], START[1], HEIGHT), 1.0)
        there = flight.step()
        flight.hover(there, 0.5)
        flight.land()
    flight.report()
    print(f"== {name}: flown as the flight rules say")


if __name__ == "__main__":
    main()
