"""Serial lines: version 3 (STM32H743, RM0433 chapter 48) and version 1 (STM32F405, RM0090 chapter 30), sending and
receiving by DMA, eight bits, one stop bit.

Bytes arrive at the line's rate, a message at a time: in memory once the last of them is in, which also is when the line
falls idle.
"""

from core import Core
from dma import COMPLETE, HALF, Controller, Stream
from peripheral import Peripheral
from schedule import NS_PER_S

_BITS_PER_BYTE = 10
# Bits of the status register, the same in both versions.
OVERRUN, IDLE, SENT, ROOM = 1 << 3, 1 << 4, 1 << 6, 1 << 7


class Uart(Peripheral):
    """What both versions have in common: where their registers are differs."""

    STATUS, BAUD, CONTROL_1, CONTROL_3, RECEIVED, SENDING = 0, 0, 0, 0, 0, 0

    def __init__(self, name: str, base: int, core: Core, dma: Controller, kernel_hz: int, interrupt: int) -> None:
        super().__init__(name, base)
        self.core, self.dma, self.kernel_hz, self.interrupt = core, dma, kernel_hz, interrupt
        # All that it has sent and nobody has taken yet.
        self.sent = bytearray()
        self.lost_bytes = 0
        self._line_free_ns = 0
        self._place = 0
        dma.begun[f"{name}_TX"] = self._send
        dma.begun[f"{name}_RX"] = self._listen
        core.system.lines[interrupt] = self._wants_interrupt

    def reset(self) -> None:
        super().reset()
        self._place = 0

    @property
    def baud(self) -> float:
        """The rate that its registers make."""
        return self.kernel_hz / max(1, self.values.get(self.BAUD, 0))

    def _byte_ns(self) -> int:
        return int(_BITS_PER_BYTE * NS_PER_S / self.baud)

    def _send(self, stream: Stream) -> None:
        data = stream.take(self.base + self.SENDING)
        self.core.schedule.after(len(data) * self._byte_ns(), self._sent, stream, data)

    def _sent(self, stream: Stream, data: bytes) -> None:
        if stream.enabled and stream.end():
            self.sent += data

    def _listen(self, _stream: Stream) -> None:
        self._place = 0

    def receive(self, data: bytes) -> None:
        """Has these bytes arrive, after those that are on their way."""
        schedule = self.core.schedule
        begins = max(schedule.now, self._line_free_ns)
        self._line_free_ns = begins + len(data) * self._byte_ns()
        schedule.at(self._line_free_ns, self._arrived, data)

    def _arrived(self, data: bytes) -> None:
        stream = self.dma.armed(f"{self.name}_RX")
        if stream is None or not self.values.get(self.CONTROL_3, 0) >> 6 & 1:
            self.lost_bytes += len(data)
            self._raise(OVERRUN)
            return
        if stream.fails:
            stream.end()
            self.lost_bytes += len(data)
            return
        size = self._place + stream.count
        while data:
            part = data[:size - self._place]
            stream.put(part, self.base + self.RECEIVED, self._place)
            half = self._place < size // 2 <= self._place + len(part)
            self._place += len(part)
            if half:
                stream.flag(HALF)
            if self._place == size:
                self._place = 0
                stream.flag(COMPLETE)
            stream.circulate(size - self._place)
            data = data[len(part):]
        self._raise(IDLE)

    def _raise(self, flag: int) -> None:
        self.values[self.STATUS] = self.values.get(self.STATUS, 0) | flag
        if self._wants_interrupt():
            self.core.system.raise_interrupt(self.interrupt)

    def _wants_interrupt(self) -> bool:
        status, control = self.values.get(self.STATUS, 0), self.values.get(self.CONTROL_1, 0)
        errors = self.values.get(self.CONTROL_3, 0) & 1
        return bool(status & IDLE and control >> 4 & 1 or status & OVERRUN and (errors or control >> 5 & 1))

    def read(self, offset: int) -> int:
        if offset == self.STATUS:
            # It can always send, and has been enabled both ways (TEACK, REACK).
            return self.values.get(offset, 0) | SENT | ROOM | 0x60_0000
        return self.values.get(offset, 0)


class UartV3(Uart):
    """STM32H743: flags are cleared in a register of their own."""

    KNOWN = frozenset(range(0, 0x30, 4))
    CONTROL_1, CONTROL_3, BAUD, STATUS, RECEIVED, SENDING = 0x00, 0x08, 0x0C, 0x1C, 0x24, 0x28

    def write(self, offset: int, value: int) -> None:
        if offset == 0x20:
            self.values[self.STATUS] = self.values.get(self.STATUS, 0) & ~value
        else:
            self.values[offset] = value
            if offset in (self.CONTROL_1, self.CONTROL_3) and self._wants_interrupt():
                self.core.system.raise_interrupt(self.interrupt)


class UartV1(Uart):
    """STM32F405: reading the data register after the status register clears the flags."""

    KNOWN = frozenset(range(0, 0x1C, 4))
    STATUS, RECEIVED, SENDING, BAUD, CONTROL_1, CONTROL_3 = 0x00, 0x04, 0x04, 0x08, 0x0C, 0x14

    def read(self, offset: int) -> int:
        if offset == self.RECEIVED:
            self.values[self.STATUS] = self.values.get(self.STATUS, 0) & ~(IDLE | OVERRUN)
        return super().read(offset) if offset != self.STATUS else self.values.get(offset, 0) | SENT | ROOM

    def write(self, offset: int, value: int) -> None:
        if offset not in (self.STATUS, self.SENDING):
            self.values[offset] = value
            if offset in (self.CONTROL_1, self.CONTROL_3) and self._wants_interrupt():
                self.core.system.raise_interrupt(self.interrupt)
