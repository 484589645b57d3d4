"""Four speed controllers: they read pulses as DShot300 and turn their motors as such controllers do.

DShot: 16 bits, most significant first, each a pulse of 3/8 of its period for zero, 6/8 for one: eleven of value, one
that requests telemetry, four of checksum. Value 0 stops, 1 to 47 are commands, 48 to 2047 turn.

A controller turns its motor once it has been stopped by frames for `ARMING_NS`; without a frame for `TIMEOUT_NS` it
stops and has to be stopped by frames again. A frame that is cut or whose checksum is wrong does not count.
"""

from collections import Counter
from dataclasses import dataclass

from schedule import NS_PER_MS, Schedule
from timers import Pulses

BIT_NS = 1e9 / 300_000
# How far periods and widths may be from what the rate says, parts.
PERIOD_TOLERANCE, WIDTH_TOLERANCE = 0.02, 0.03
ZERO, ONE = 3 / 8, 6 / 8
FIRST_THROTTLE, THROTTLE_STEPS = 48, 1999
ARMING_NS, TIMEOUT_NS = 300 * NS_PER_MS, 250 * NS_PER_MS
# A frame at least so often, once the firmware has sent the first: a thousand a second are promised.
INTERVAL_MAX_NS = 3 * NS_PER_MS


def decode(widths: list[float]) -> tuple[int, bool] | str:
    """A frame's value and whether it requests telemetry, or what is wrong with it."""
    if len(widths) < 16:
        return "too few pulses"
    bits = 0
    for width in widths[:16]:
        if abs(width - ZERO) <= WIDTH_TOLERANCE:
            bits <<= 1
        elif abs(width - ONE) <= WIDTH_TOLERANCE:
            bits = bits << 1 | 1
        else:
            return f"a width of {width:.3f}"
    if any(widths[16:]):
        return "high after the frame"
    data = bits >> 4
    return (data >> 1, bool(data & 1)) if (data ^ data >> 4 ^ data >> 8) & 0xF == bits & 0xF else "a wrong checksum"


@dataclass
class Esc:
    """One controller."""

    value: int = 0
    last_frame_ns: int | None = None
    stopped_since_ns: int | None = None
    armed: bool = False

    def take(self, value: int, now_ns: int) -> None:
        """A good frame."""
        if self.last_frame_ns is None or now_ns - self.last_frame_ns > TIMEOUT_NS:
            self.armed, self.stopped_since_ns = False, None
        self.last_frame_ns, self.value = now_ns, value
        if value == 0:
            if self.stopped_since_ns is None:
                self.stopped_since_ns = now_ns
            self.armed |= now_ns - self.stopped_since_ns >= ARMING_NS
        else:
            self.stopped_since_ns = None

    def is_driven(self, now_ns: int) -> bool:
        """Whether its motor is driven."""
        young = self.last_frame_ns is not None and now_ns - self.last_frame_ns <= TIMEOUT_NS
        return self.armed and young and self.value >= FIRST_THROTTLE

    def command(self, now_ns: int) -> float:
        """What its motor is driven with, 0 to 1 of full."""
        return (self.value - FIRST_THROTTLE) / THROTTLE_STEPS if self.is_driven(now_ns) else 0.0


class Escs:
    """The controllers on a board's outputs, by the rotors of the table in docs/boards.md."""

    def __init__(self, schedule: Schedule, outputs: list[tuple[str, int, bool]]) -> None:
        """`outputs`: the timer, its channel from 1, whether it is the complementary one, by rotor."""
        self.schedule = schedule
        self.outputs = outputs
        self.escs = [Esc() for _ in outputs]
        self.frames = 0
        # What frames said, a value and how often by rotor; what was wrong, with how often; frames that were cut.
        self.values: Counter[tuple[int, int]] = Counter()
        self.wrong: Counter[str] = Counter()
        self.cut = 0
        self.longest_interval_ns = 0
        # Every change of what the motors are told: (time, values).
        self.record: list[tuple[int, tuple[int, ...]]] = []

    def power(self) -> None:
        """The board was started anew: frames begin again when they will."""
        for esc in self.escs:
            esc.last_frame_ns = None

    def take(self, pulses: Pulses) -> None:
        """What a timer has made."""
        if pulses.fault == "cut":
            self.cut += 1
            return
        if pulses.fault is not None:
            self.wrong[f"{pulses.timer}: {pulses.fault}"] += 1
            return
        if abs(pulses.period_ns / BIT_NS - 1) > PERIOD_TOLERANCE:
            self.wrong[f"{pulses.timer}: a period of {pulses.period_ns} ns"] += 1
        strangers = set(pulses.widths) - {output[1:] for output in self.outputs if output[0] == pulses.timer}
        if strangers:
            self.wrong[f"{pulses.timer}: pulses on {sorted(strangers)}"] += 1
        self.frames += 1
        now = self.schedule.now
        for rotor, (timer, channel, complementary) in enumerate(self.outputs):
            if timer != pulses.timer:
                continue
            frame = decode(pulses.widths.get((channel, complementary), []))
            if isinstance(frame, str):
                self.wrong[f"rotor {rotor + 1}: {frame}"] += 1
                continue
            esc = self.escs[rotor]
            if esc.last_frame_ns is not None:
                self.longest_interval_ns = max(self.longest_interval_ns, now - esc.last_frame_ns)
            esc.take(frame[0], now)
            self.values[rotor, frame[0]] += 1
        told = tuple(esc.value for esc in self.escs)
        if not self.record or self.record[-1][1] != told:
            self.record.append((now, told))

    def commands(self) -> list[float]:
        """What the motors are driven with, 0 to 1 of full, by rotor."""
        return [esc.command(self.schedule.now) for esc in self.escs]

    def are_still(self) -> bool:
        """Whether no motor is driven."""
        return not any(esc.is_driven(self.schedule.now) for esc in self.escs)
