"""Power that fails in the middle of the parameters' flash."""

import struct
import zlib
from collections.abc import Callable
from dataclasses import dataclass

from chip import POWER
from flash import SECTOR_BYTES, SECTORS
from flight import Flight
from outcome import Expected, Outcome
from station import mavlink

_NAME, _OLD, _NEW, _BETWEEN = "POSE_DELAY", 5.0, 7.0, 6.0
_RECORD_BYTES = 512
_CHECKSUM = _RECORD_BYTES - 4


def _cut(flight: Flight, at: int) -> bool:
    """Changes a parameter, and power fails at its work number `at`, from 0, on the flash; whether it came to that."""
    board, station = flight.board, flight.station
    flash = board.chip.flash
    flash.fails_at, flash.works, flash.seed = at, 0, at
    flash.on_power_lost = lambda: board.chip.request_restart(POWER)
    board.restarts.clear()
    station.send(mavlink.MAVLink_param_set_message(1, 1, _NAME.encode(), _NEW, mavlink.MAV_PARAM_TYPE_REAL32))
    begun = board.schedule.now
    while not board.restarts and board.schedule.now < begun + 1_500_000_000:
        board.run(5_000_000)
    flash.fails_at = None
    return bool(board.restarts)


def _keep(flight: Flight, value: float) -> None:
    """Sets the parameter, and waits until the flash has worked and works no more."""
    flash, station = flight.board.chip.flash, flight.station
    if station.get_parameter(_NAME) != value or flash.memory.count(b"\xff") == len(flash.memory):
        flash.works = 0
        station.set_parameter(_NAME, value)
        station.until("kept", lambda: flash.works > 0, 5.0)
    station.wait(0.2)


def _value_after(flight: Flight) -> float:
    """The parameter's value after the start that follows."""
    station = flight.station
    flight.board.link.sent.clear()
    station.counts.clear()
    station.texts.clear()
    station.until("a heartbeat after power came back", lambda: station.counts["HEARTBEAT"] > 0, 15.0)
    return station.get_parameter(_NAME)


@dataclass(frozen=True)
class Tear:
    """One kind of cut."""

    prepare: Callable[[Flight], None]
    # Works on the flash at which power fails, each in a run of its own.
    works: tuple[int, ...]
    # Values that may be there afterwards.
    allowed: tuple[float, ...]
    fails_in: str = "word"
    expected: Expected = Expected(0.0, unsaid=("stored values unusable", "lost"))
    boards: tuple[str, ...] | None = None

    def run(self, flight: Flight) -> Outcome:
        """Cuts at each of the works in turn, each behind what the last one left."""
        _keep(flight, _OLD)
        self.prepare(flight)
        said: list[str] = []
        found: list[float] = []
        for work in self.works:
            assert _cut(flight, work), f"no work number {work}"
            failed_in = flight.board.chip.flash.failed_in
            assert failed_in == self.fails_in, f"work number {work} is of the {failed_in}"
            value = _value_after(flight)
            assert value in self.allowed, f"cut at {work}: {_NAME} is {value}"
            said += [text for _, text in flight.station.texts]
            found.append(value)
            # A second cut before the next whole record would be one more than the journal promises.
            _keep(flight, _BETWEEN)
            _keep(flight, _OLD)
        complaints = flight.board.complaints()
        assert not complaints, complaints
        words = [f"{len(found)} cuts: {found.count(_OLD)} times the old value, {found.count(_NEW)} the new one"]
        return Outcome(motors_off_ms=0.0 if flight.board.escs.are_still() else None, words=[*words, *said])


def _fill_sector(flight: Flight) -> None:
    """Continues the journal with copies of its newest record until its sector is full, and starts the board from it:
    the next change erases."""
    flash = flight.board.chip.flash
    records = [bytes(flash.memory[place:place + _RECORD_BYTES])
               for place in range(0, SECTORS * SECTOR_BYTES, _RECORD_BYTES)]
    used = [number for number, record in enumerate(records) if record != b"\xff" * _RECORD_BYTES]
    newest, per_sector = records[used[-1]], SECTOR_BYTES // _RECORD_BYTES
    (number,), (checksum,) = struct.unpack_from("<I", newest), struct.unpack_from("<I", newest, _CHECKSUM)
    kind = checksum ^ zlib.crc32(newest[:_CHECKSUM])
    for place in range(used[-1] + 1, (used[-1] // per_sector + 1) * per_sector):
        number += 1
        body = struct.pack("<I", number) + newest[4:_CHECKSUM]
        record = body + struct.pack("<I", zlib.crc32(body) ^ kind)
        flash.memory[place * _RECORD_BYTES:(place + 1) * _RECORD_BYTES] = record
    flight.board.chip.request_restart(POWER)
    flight.board.run(5_000_000)
    assert _value_after(flight) == _OLD


_H743 = ("micoair", "matek")
# A change writes two copies of a record of 512 bytes: sixteen words each on the H743, 128 on the F405.
TORN: dict[str, Tear] = {
    "power-fails-at-words": Tear(lambda flight: None, (0, 1, 14, 15, 16, 17, 31), (_OLD, _NEW), boards=_H743),
    "power-fails-at-the-words": Tear(lambda flight: None, (0, 1, 126, 127, 128, 129, 255), (_OLD, _NEW),
                                     boards=("bolt",)),
    "power-fails-in-an-erase": Tear(_fill_sector, (0,), (_OLD,), "erase"),
}
