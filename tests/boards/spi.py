"""SPI masters with DMA both ways: version 4 (STM32H743, RM0433 chapter 50) and version 1 (STM32F405, RM0090 chapter
28).

An exchange begins when the peripheral is enabled and told to, with both streams waiting, and is over when its bits have
been clocked. Exactly one device must be selected.
"""

from collections import Counter
from collections.abc import Callable

from core import Core
from dma import Controller, Stream
from peripheral import Peripheral
from schedule import NS_PER_S

# From the start to the first clock edge, and from the last to the flags.
_LEAD_NS = 500


class Device:
    """What hangs on a bus: chosen by a low level on its pin."""

    def __init__(self, select: str) -> None:
        self.select, self.is_selected = select, False

    def chosen(self, level: int) -> None:
        """Its select pin has an edge."""
        self.is_selected = level == 0

    def exchange(self, sent: bytes) -> bytes:
        """As many bytes as it was sent."""
        raise NotImplementedError


class Master(Peripheral):
    """What both versions have in common."""

    TX, RX = 0, 0

    def __init__(self, name: str, base: int, core: Core, dma: Controller, kernel_hz: int) -> None:
        super().__init__(name, base)
        self.core, self.dma, self.kernel_hz = core, dma, kernel_hz
        self.devices: list[Device] = []
        self.exchanges = 0
        # What must not happen, with how often: no device selected, or two.
        self.wrong: Counter[str] = Counter()
        # Set by who spoils a run: exchanges begin and never end.
        self.is_stuck = False
        # Replaces what a device answers, where a run is to be spoiled.
        self.spoil: Callable[[bytes], bytes] = lambda answer: answer

    def clock_hz(self) -> int:
        """Of the bus."""
        raise NotImplementedError

    def clock_mode(self) -> int:
        """CPOL and CPHA as two bits."""
        raise NotImplementedError

    def begin(self) -> None:
        """Begins an exchange where both streams wait for it."""
        sender, receiver = self.dma.armed(f"{self.name}_TX"), self.dma.armed(f"{self.name}_RX")
        if sender is None or receiver is None:
            self.wrong["an exchange without both streams"] += 1
            return
        if self.clock_mode() not in (0, 3):
            self.wrong["a mode that the sensors do not have"] += 1
        sent = sender.take(self.base + self.TX)
        chosen = [device for device in self.devices if device.is_selected]
        if len(chosen) != 1:
            self.wrong[f"{len(chosen)} devices selected"] += 1
        answer = self.spoil(chosen[0].exchange(sent) if len(chosen) == 1 else b"\xff" * len(sent))
        self.exchanges += 1
        if not self.is_stuck:
            took_ns = len(sent) * 8 * NS_PER_S // self.clock_hz() + _LEAD_NS
            self.core.schedule.after(took_ns, self._end, sender, receiver, answer)

    def _end(self, sender: Stream, receiver: Stream, answer: bytes) -> None:
        # Both are off where the firmware has given the exchange up.
        if sender.enabled:
            sender.end()
        if receiver.enabled and receiver.count == len(answer):
            receiver.put(answer, self.base + self.RX)
            receiver.end()
        self.ended()

    def ended(self) -> None:
        """The peripheral's own flags."""


class MasterV4(Master):
    """STM32H743."""

    KNOWN = frozenset([0x00, 0x04, 0x08, 0x0C, 0x10, 0x14, 0x18, 0x20, 0x30, 0x40, 0x44, 0x48, 0x4C, 0x50])
    TX, RX = 0x20, 0x30

    def clock_hz(self) -> int:
        return self.kernel_hz // (2 << (self.values.get(0x08, 0) >> 28 & 7))

    def clock_mode(self) -> int:
        # CFG2: CPHA bit 24, CPOL bit 25.
        return self.values.get(0x0C, 0) >> 24 & 3

    def read(self, offset: int) -> int:
        # Room to send, and whether the transfer is complete: at once, as the streams end with it.
        return self.values.get(offset, 0) | (1 << 1 | 1 << 12 if offset == 0x14 else 0)

    def write(self, offset: int, value: int) -> None:
        if offset == 0x00 and value >> 9 & 1:
            # CSTART, which falls by itself.
            self.values[offset] = value & ~(1 << 9)
            self.begin()
        else:
            self.values[offset] = value


class MasterV1(Master):
    """STM32F405: there is no order to start, the exchange begins with the second of both: enabled, and requests on."""

    KNOWN = frozenset(range(0, 0x24, 4))
    TX = RX = 0x0C
    _BUSY, _NOT_EMPTY, _EMPTY = 1 << 7, 1, 1 << 1

    def __init__(self, name: str, base: int, core: Core, dma: Controller, kernel_hz: int) -> None:
        super().__init__(name, base, core, dma, kernel_hz)
        self._under_way = False

    def reset(self) -> None:
        super().reset()
        self._under_way = False

    def clock_hz(self) -> int:
        return self.kernel_hz // (2 << (self.values.get(0x00, 0) >> 3 & 7))

    def clock_mode(self) -> int:
        bits = self.values.get(0x00, 0)
        return bits & 3

    def read(self, offset: int) -> int:
        if offset == 0x08:
            return self._EMPTY | (self._BUSY if self._under_way else 0)
        return self.values.get(offset, 0)

    def write(self, offset: int, value: int) -> None:
        self.values[offset] = value
        enabled, requests = self.values.get(0x00, 0) >> 6 & 1, self.values.get(0x04, 0) & 3
        if offset in (0x00, 0x04):
            if not enabled:
                self._under_way = False
            elif requests == 3 and not self._under_way:
                self._under_way = True
                self.begin()

    def ended(self) -> None:
        self._under_way = False
