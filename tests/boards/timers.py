"""Timers: general and advanced ones (RM0433 chapters 38 and 39, RM0090 chapters 17 and 18), as far as this firmware
uses them: one that counts microseconds for the scheduler, and those that make the motors' pulses.
"""

from collections.abc import Callable
from dataclasses import dataclass

from core import Core
from dma import Controller, Stream
from peripheral import Peripheral
from schedule import NS_PER_S

CR1, DIER, SR, EGR, CCER, CNT, PSC, ARR, CCR1, BDTR, DCR, DMAR = (
    0x00, 0x0C, 0x10, 0x14, 0x20, 0x24, 0x28, 0x2C, 0x34, 0x44, 0x48, 0x4C)
_KNOWN = frozenset(range(0, 0x70, 4))
_UPDATE_DMA = 1 << 8
# Of CCER: the bits that enable an output; the next one of each inverts it.
_ENABLING_BITS = 0x5555


class TimeBase(Peripheral):
    """A counter of microseconds with four compare channels, up to its reload value; it stands still while it is off."""

    KNOWN = _KNOWN
    RESET = {ARR: 0xFFFF_FFFF}

    def __init__(self, name: str, base: int, core: Core, kernel_hz: int, interrupt: int) -> None:
        super().__init__(name, base)
        self.core, self.kernel_hz, self.interrupt = core, kernel_hz, interrupt
        # Ticks that it had counted, wraps included, when it was last set going or stopped; looked at until then.
        self._origin_ns, self._origin, self._seen, self._generation = 0, 0, 0, 0
        core.system.lines[interrupt] = self._wants_interrupt

    def reset(self) -> None:
        super().reset()
        self._origin, self._seen, self._generation = 0, 0, self._generation + 1

    def _tick_ns(self) -> int:
        return NS_PER_S * (self.values.get(PSC, 0) + 1) // self.kernel_hz

    def _period(self) -> int:
        return self.values[ARR] + 1

    def ticks(self) -> int:
        """Ticks, wraps included."""
        if not self.values.get(CR1, 0) & 1:
            return self._origin
        return self._origin + (self.core.schedule.now - self._origin_ns) // self._tick_ns()

    def _wants_interrupt(self) -> bool:
        return bool(self.values.get(SR, 0) & self.values.get(DIER, 0) & 0x1F)

    def _look(self, generation: int | None = None) -> None:
        """Raises the flags of what it has counted past, and looks again when the next is due."""
        if generation is not None and generation != self._generation:
            return
        self._generation += 1
        count, period, status, enabled = self.ticks(), self._period(), self.values.get(SR, 0), self.values.get(DIER, 0)
        nearest = period - count % period
        if count // period > self._seen // period:
            status |= 1
        for channel in range(4):
            compare = self.values.get(CCR1 + 4 * channel, 0) % period
            first = self._seen + 1 + (compare - self._seen - 1) % period
            if first <= count:
                status |= 2 << channel
            if enabled >> 1 + channel & 1:
                nearest = min(nearest, (compare - count - 1) % period + 1)
        self._seen = count
        self.values[SR] = status
        if self._wants_interrupt():
            self.core.system.raise_interrupt(self.interrupt)
        if self.values.get(CR1, 0) & 1:
            due = self._origin_ns + (count + nearest - self._origin) * self._tick_ns()
            self.core.schedule.at(due, self._look, self._generation)

    def read(self, offset: int) -> int:
        if offset == CNT:
            return self.ticks() % self._period()
        return self.values.get(offset, 0)

    def write(self, offset: int, value: int) -> None:
        if offset == SR:
            self.values[SR] = self.values.get(SR, 0) & value
            return
        if offset == EGR:
            self._set_count(0)
            if not self.values.get(CR1, 0) >> 2 & 1:
                self.values[SR] = self.values.get(SR, 0) | 1
            return
        if offset == CNT:
            self._set_count(value)
            return
        if offset == CR1:
            self._set_count(self.ticks())
        self.values[offset] = value
        self._look()

    def _set_count(self, count: int) -> None:
        self._origin, self._origin_ns, self._seen = count, self.core.schedule.now, count


@dataclass
class Pulses:
    """Pulses that a timer has made, a width each, as parts of its period."""

    timer: str
    begun_ns: int
    period_ns: int
    # By the channel, 1 to 4, and whether it is its complementary output: only those that reach a pin.
    widths: dict[tuple[int, bool], list[float]]
    # Whether the outputs rest high and the pulses are low.
    inverted: bool = False
    # Why they are no whole frame, if so.
    fault: str | None = None


class PulseTimer(Peripheral):
    """A timer that makes pulses, by a burst of its DMA request at each update, or by code that waits for each."""

    KNOWN = _KNOWN
    _BURST = 3 << 8 | 0x34 // 4

    def __init__(self, name: str, base: int, core: Core, dma: Controller, kernel_hz: int, is_advanced: bool,
                 made: Callable[[Pulses], None]) -> None:
        """`is_advanced`: its outputs have a main switch (MOE). `made` gets what it has made."""
        super().__init__(name, base)
        self.core, self.dma, self.kernel_hz, self.is_advanced, self.made = core, dma, kernel_hz, is_advanced, made
        self._generation = 0
        self._begun_ns = 0
        self._stream: Stream | None = None
        # What polling code has set: rows of widths that took effect, one a period; whether silence came after them.
        self._rows: list[list[int]] = []
        self._is_over = False
        self._shadow = [0] * 4

    def reset(self) -> None:
        super().reset()
        self._generation += 1
        self._rows, self._shadow, self._stream = [], [0] * 4, None

    def _period_ns(self) -> int:
        ticks = (self.values.get(ARR, 0) + 1) * (self.values.get(PSC, 0) + 1)
        return ticks * NS_PER_S // self.kernel_hz

    def _preload(self) -> list[int]:
        return [self.values.get(CCR1 + 4 * channel, 0) for channel in range(4)]

    def _pulses(self, rows: list[list[int]], fault: str | None = None, begun_ns: int | None = None) -> Pulses:
        outputs = self.values.get(CCER, 0)
        driven = outputs & _ENABLING_BITS
        inverted = outputs & driven << 1
        if inverted not in (0, driven << 1):
            fault = fault or "outputs that rest high and outputs that rest low"
        if self.is_advanced and not self.values.get(BDTR, 0) >> 15 & 1:
            outputs = 0
        reload = self.values.get(ARR, 0) + 1
        widths = {(channel + 1, complementary): [row[channel] / reload for row in rows]
                  for channel in range(4) for bit, complementary in ((0, False), (2, True))
                  if outputs >> 4 * channel + bit & 1}
        begun_ns = self._begun_ns if begun_ns is None else begun_ns
        return Pulses(self.name, begun_ns, self._period_ns(), widths, inverted != 0, fault)

    def _update(self) -> None:
        """An update event: widths take effect."""
        self._shadow = self._preload()
        self.values[SR] = self.values.get(SR, 0) | 1

    def _start(self) -> None:
        self._generation += 1
        self._begun_ns = self.core.schedule.now
        if not self.values.get(DIER, 0) & _UPDATE_DMA:
            self._rows, self._is_over = [self._shadow], False
            return
        self._rows = []
        self._stream = self.dma.armed(f"{self.name}_UP")
        if self._stream is None:
            self.made(self._pulses([], "no stream waits for its requests"))
            return
        bursts = self._stream.count // 4
        self.core.schedule.after(bursts * self._period_ns(), self._burst_over, self._generation)

    def _burst_over(self, generation: int) -> None:
        stream = self._stream
        if generation != self._generation or stream is None or not stream.enabled:
            return
        wrong = self.values.get(DCR, 0) & 0x1F1F != self._BURST or stream.count % 4 != 0
        data = stream.take(self.base + DMAR)
        size = stream.item_bytes
        words = [int.from_bytes(data[place:place + size], "little") for place in range(0, len(data), size)]
        rows = [words[place:place + 4] for place in range(0, len(words), 4)]
        if stream.end():
            self.made(self._pulses(rows, "a burst to other registers" if wrong else None))
        else:
            self.made(self._pulses([], "the transfer failed"))

    def _polled(self, rows: list[list[int]]) -> None:
        """What polling code has made: the first period has what was there before."""
        self.made(self._pulses(rows[1:], begun_ns=self._begun_ns + self._period_ns()))

    def _stop(self) -> None:
        """The counter stands; what polling code has made is a frame if it is whole."""
        self._generation += 1
        rows, self._rows = self._rows, []
        if len(rows) > 1:
            if not self._is_over:
                self._polled(rows)
        elif self._stream is not None and self._stream.enabled:
            self.made(self._pulses([], "cut"))
        self._stream = None

    def read(self, offset: int) -> int:
        if offset == SR and self._rows and self.values.get(CR1, 0) & 1:
            while self.core.schedule.now >= self._begun_ns + len(self._rows) * self._period_ns():
                self._update()
                self._rows.append(self._shadow)
                if not self._is_over and len(self._rows) > 2 and not any(self._shadow):
                    self._is_over = True
                    self._polled(self._rows)
        return self.values.get(offset, 0)

    def write(self, offset: int, value: int) -> None:
        running = self.values.get(CR1, 0) & 1
        if offset == SR:
            self.values[SR] = self.values.get(SR, 0) & value
        elif offset == EGR:
            self._update()
        else:
            self.values[offset] = value
            if offset == CR1 and value & 1 and not running:
                self._start()
            elif offset == CR1 and running and not value & 1:
                self._stop()
