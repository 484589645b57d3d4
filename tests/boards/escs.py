"""Four speed controllers: they read pulses as DShot300 and turn their motors as such controllers do.

DShot: 16 bits, most significant first, each a pulse of 3/8 of its period for zero, 6/8 for one: eleven of value, one
that requests telemetry, four of checksum. Value 0 stops, 1 to 47 are commands, 48 to 2047 turn.

A controller turns its motor once it has been stopped by frames for `ARMING_NS`; without a frame for `TIMEOUT_NS` it
stops and has to be stopped by frames again. A frame that is cut or whose checksum is wrong does not count.

On a line that rests high the pulses are low and the checksum is inverted; then a controller answers each frame, on the
same line (answers.py). The pin must be an input then: two that drive a line are noted, and so is a frame from a pin
that is not its timer's.
"""

import math
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass

import answers
from gpio import Port
from schedule import NS_PER_MS, Schedule
from timers import Pulses

BIT_NS, FRAME_BITS = 1e9 / 300_000, 16
# How far periods and widths may be from what the rate says, parts.
PERIOD_TOLERANCE, WIDTH_TOLERANCE = 0.02, 0.03
ZERO, ONE = 3 / 8, 6 / 8
FIRST_THROTTLE, THROTTLE_STEPS = 48, 1999
ARMING_NS, TIMEOUT_NS = 300 * NS_PER_MS, 250 * NS_PER_MS
# A frame at least so often, once the firmware has sent the first: a thousand a second are promised.
INTERVAL_MAX_NS = 3 * NS_PER_MS


def decode(widths: list[float], inverted: bool) -> tuple[int, bool] | str:
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
    checksum = (data ^ data >> 4 ^ data >> 8 ^ (0xF if inverted else 0)) & 0xF
    return (data >> 1, bool(data & 1)) if checksum == bits & 0xF else "a wrong checksum"


@dataclass(frozen=True)
class Output:
    """Where a board has a motor's line."""

    timer: str
    # From 1; whether it is the complementary one.
    channel: int
    complementary: bool
    # "A15", and its alternate function there.
    pin: str
    function: int


@dataclass
class Esc:
    """One controller."""

    value: int = 0
    last_frame_ns: int | None = None
    stopped_since_ns: int | None = None
    armed: bool = False
    # Its last answer: when it begins, and its levels.
    answer_ns: float = float("-inf")
    answer: list[int] | None = None

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

    def __init__(self, schedule: Schedule, outputs: tuple[Output, ...], ports: dict[str, Port]) -> None:
        self.schedule = schedule
        self.outputs = outputs
        self.pins = [(ports[output.pin[0]], int(output.pin[1:])) for output in outputs]
        self.escs = [Esc() for _ in outputs]
        # How fast each rotor truly turns, rad/s.
        self.speeds: Callable[[], list[float]] = lambda: [0.0] * len(outputs)
        # Whole frames, and those of them on lines that rest high.
        self.frames, self.inverted_frames = 0, 0
        self.answers = 0
        # What frames said, a value and how often by rotor; what was wrong, with how often; frames that were cut.
        self.values: Counter[tuple[int, int]] = Counter()
        self.wrong: Counter[str] = Counter()
        self.cut = 0
        self.longest_interval_ns = 0
        # The last frame of each since the board was started.
        self._frames_ns: list[int | None] = [None] * len(outputs)
        # Every change of what the motors are told: (time, values).
        self.record: list[tuple[int, tuple[int, ...]]] = []

    def begin_anew(self) -> None:
        """The board was started: frames begin when they will."""
        self.longest_interval_ns, self._frames_ns = 0, [None] * len(self.outputs)

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
        mine = [rotor for rotor, output in enumerate(self.outputs) if output.timer == pulses.timer]
        strangers = set(pulses.widths) - {(self.outputs[rotor].channel, self.outputs[rotor].complementary)
                                          for rotor in mine}
        if strangers:
            self.wrong[f"{pulses.timer}: pulses on {sorted(strangers)}"] += 1
        self.frames += 1
        self.inverted_frames += pulses.inverted
        now, answers_ns = self.schedule.now, pulses.begun_ns + FRAME_BITS * pulses.period_ns + answers.DELAY_NS
        speeds = self.speeds() if pulses.inverted else []
        for rotor in mine:
            output, (port, pin) = self.outputs[rotor], self.pins[rotor]
            if port.function(pin) != output.function:
                self.wrong[f"rotor {rotor + 1}: a frame, and P{output.pin} is not its timer's"] += 1
                continue
            if pulses.inverted and pulses.begun_ns < self.escs[rotor].answer_ns + answers.DURATION_NS:
                self.wrong[f"rotor {rotor + 1}: a frame into its answer"] += 1
                continue
            frame = decode(pulses.widths.get((output.channel, output.complementary), []), pulses.inverted)
            if isinstance(frame, str):
                self.wrong[f"rotor {rotor + 1}: {frame}"] += 1
                continue
            esc = self.escs[rotor]
            before_ns, self._frames_ns[rotor] = self._frames_ns[rotor], now
            if before_ns is not None:
                self.longest_interval_ns = max(self.longest_interval_ns, now - before_ns)
            esc.take(frame[0], now)
            self.values[rotor, frame[0]] += 1
            esc.answer = None
            if pulses.inverted:
                esc.answer_ns = answers_ns
                self.answers += 1
                esc.answer = answers.levels(answers.of_speed(speeds[rotor]))
        if pulses.inverted:
            for time in (answers_ns, answers_ns + round(answers.DURATION_NS)):
                self.schedule.at(time, self._look_who_drives, mine)
        told = tuple(esc.value for esc in self.escs)
        if not self.record or self.record[-1][1] != told:
            self.record.append((now, told))

    def _look_who_drives(self, rotors: list[int]) -> None:
        """An answer begins or ends: the controller alone may drive the line."""
        for rotor in rotors:
            port, pin = self.pins[rotor]
            if self.escs[rotor].answer is not None and not port.is_input(pin):
                self.wrong[f"rotor {rotor + 1}: P{self.outputs[rotor].pin} is no input during an answer"] += 1

    def levels(self, port: Port, first_ns: float, period_ns: float, count: int) -> list[int]:
        """A port's pins at so many times. Pins without a motor read low, as does a line that nobody pulls up."""
        samples = [0] * count
        for esc, (there, pin) in zip(self.escs, self.pins):
            if there is not port:
                continue
            bit = 1 << pin
            if port.is_input(pin) and not port.is_pulled_up(pin):
                self.wrong[f"P{port.letter}{pin} is not pulled up"] += 1
                continue
            # What the timer drives rests high, too.
            samples = [sample | bit for sample in samples]
            if esc.answer is None or not port.is_input(pin):
                continue
            for place, level in enumerate(esc.answer):
                if not level:
                    begins = esc.answer_ns + place * answers.LEVEL_NS - first_ns
                    first = max(0, math.ceil(begins / period_ns))
                    end = min(count, math.ceil((begins + answers.LEVEL_NS) / period_ns))
                    for sample in range(first, end):
                        samples[sample] &= ~bit
        return samples

    def commands(self) -> list[float]:
        """What the motors are driven with, 0 to 1 of full, by rotor."""
        return [esc.command(self.schedule.now) for esc in self.escs]

    def are_still(self) -> bool:
        """Whether no motor is driven."""
        return not any(esc.is_driven(self.schedule.now) for esc in self.escs)
