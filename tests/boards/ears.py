"""A timer whose events have DMA copy a port's pins to memory: what the firmware hears of the motors' controllers by.

The update event has one stream copy, and the second compare event another, half a period later.
"""

from collections import Counter
from collections.abc import Callable

from core import Core
from dma import Controller, Stream
from gpio import IDR, Port
from peripheral import Peripheral
from schedule import NS_PER_S
from timers import ARR, CCR1, CR1, DIER, PSC

# What asks for a transfer, and its enabling bit in DIER.
_EVENTS = {"UP": 1 << 8, "CH2": 1 << 10}
_CCR2 = CCR1 + 4


class SamplingTimer(Peripheral):
    """The timer. It is on for as long as the streams have something to copy."""

    KNOWN = frozenset(range(0, 0x70, 4))

    def __init__(self, name: str, base: int, core: Core, dma: Controller, kernel_hz: int, ports: dict[str, Port],
                 levels: Callable[[Port, float, float, int], list[int]]) -> None:
        """`levels`: of a port's pins at so many times, from a first one at a distance, ns."""
        super().__init__(name, base)
        self.core, self.dma, self.kernel_hz, self.ports, self.levels = core, dma, kernel_hz, ports, levels
        self._generation = 0
        # Samples by the port; what was wrong, with how often.
        self.samples: Counter[str] = Counter()
        self.wrong: Counter[str] = Counter()

    def reset(self) -> None:
        super().reset()
        self._generation += 1

    def write(self, offset: int, value: int) -> None:
        running = self.values.get(CR1, 0) & 1
        self.values[offset] = value
        if offset == CR1 and value & 1 != running:
            self._generation += 1
            if value & 1:
                self._start()

    def _start(self) -> None:
        tick_ns = (self.values.get(PSC, 0) + 1) * NS_PER_S / self.kernel_hz
        period_ns = (self.values.get(ARR, 0) + 1) * tick_ns
        # The firmware enables both requests also where all pins are on one port: the second finds no stream.
        for event, bit in _EVENTS.items():
            stream = self.dma.armed(f"{self.name}_{event}") if self.values.get(DIER, 0) & bit else None
            if stream is None:
                if event == "UP":
                    self.wrong["no stream waits for its updates"] += 1
                continue
            first_ns = self.core.schedule.now + (period_ns if event == "UP" else self.values.get(_CCR2, 0) * tick_ns)
            last_ns = first_ns + (stream.count - 1) * period_ns
            self.core.schedule.at(round(last_ns), self._sampled, stream, first_ns, period_ns, self._generation)

    def _sampled(self, stream: Stream, first_ns: float, period_ns: float, generation: int) -> None:
        if generation != self._generation or not stream.enabled:
            return
        place = stream.peripheral_address
        port = next((port for port in self.ports.values() if port.base + IDR == place), None)
        if port is None:
            self.wrong[f"samples of {place:#x}, where no pins are"] += 1
            return
        levels = self.levels(port, first_ns, period_ns, stream.count)
        size = stream.item_bytes
        data = b"".join([level.to_bytes(size, "little") for level in levels])
        stream.put(data, port.base + IDR)
        self.samples[port.name] += len(levels)
        stream.end()
