"""DMA controllers with streams: RM0433 chapter 16 (STM32H743, with DMAMUX1, chapter 17), RM0090 chapter 10 (STM32F405,
with a channel in each stream). The registers of both are the same but for the channel.

A transfer is a whole here: a peripheral takes all of a stream's data when it begins, and ends it when the data would
have been through. Every address is held to what the controllers reach.
"""

from collections import Counter
from collections.abc import Callable

from core import Core
from peripheral import Peripheral

# Flags of a stream in LISR and HISR, and where they begin for each of four streams.
COMPLETE, HALF, ERROR = 0x20, 0x10, 0x08
_SHIFTS = (0, 6, 16, 22)
# Bits of a stream's control register.
_ENABLE, _ERROR_IE, _HALF_IE, _COMPLETE_IE, _CIRCULAR = 1, 1 << 2, 1 << 3, 1 << 4, 1 << 8


class Stream:
    """One stream of a controller."""

    def __init__(self, controller: "Controller", number: int) -> None:
        self.controller, self.number = controller, number
        self.name = f"{controller.name}_S{number}"
        self._base = 0x10 + 0x18 * number
        # Set by who spoils a run: the next transfers end by a bus error.
        self.fails = False

    def _register(self, offset: int) -> int:
        return self.controller.values.get(self._base + offset, 0)

    @property
    def control(self) -> int:
        """SxCR."""
        return self._register(0)

    @property
    def enabled(self) -> bool:
        """Whether it waits for requests."""
        return bool(self.control & _ENABLE)

    @property
    def count(self) -> int:
        """Items left (SxNDTR)."""
        return self._register(4)

    @property
    def peripheral_address(self) -> int:
        """SxPAR."""
        return self._register(8)

    @property
    def memory_address(self) -> int:
        """SxM0AR."""
        return self._register(12)

    @property
    def item_bytes(self) -> int:
        """Of the peripheral's side, in which it counts."""
        return 1 << (self.control >> 11 & 3)

    def take(self, peripheral: int) -> bytes:
        """All that it has for the register at `peripheral`, from memory."""
        size = self.count * self.item_bytes
        self.controller.check(self, self.memory_address, size, peripheral)
        return bytes(self.controller.core.uc.mem_read(self.memory_address, size))

    def put(self, data: bytes, peripheral: int, place: int = 0) -> None:
        """Bytes from the register at `peripheral`, to memory."""
        address = self.memory_address + place
        self.controller.check(self, address, len(data), peripheral)
        self.controller.core.uc.mem_write(address, data)

    def end(self) -> bool:
        """The transfer is through, or ends by an error where the run is to be spoiled; whether it is through."""
        if self.fails:
            self.flag(ERROR)
            self._disable()
            return False
        self.controller.values[self._base + 4] = 0
        self._disable()
        self.flag(COMPLETE)
        return True

    def circulate(self, left: int) -> None:
        """The ring has `left` items to go."""
        self.controller.values[self._base + 4] = left

    def _disable(self) -> None:
        self.controller.values[self._base] = self.control & ~_ENABLE

    def flag(self, bit: int) -> None:
        """Raises a flag, and the interrupt where that is enabled."""
        self.controller.raise_flag(self.number, bit)
        if self.wants_interrupt():
            self.controller.core.system.raise_interrupt(self.controller.interrupts[self.number])

    def wants_interrupt(self) -> bool:
        """Whether its interrupt's line is high."""
        control, flags = self.control, self.controller.flags(self.number)
        return bool(flags & COMPLETE and control & _COMPLETE_IE or flags & HALF and control & _HALF_IE
                    or flags & ERROR and control & _ERROR_IE)


class Controller(Peripheral):
    """A controller of eight streams."""

    KNOWN = frozenset(range(0, 0xD0, 4))

    def __init__(self, name: str, base: int, core: Core, interrupts: list[int], reachable: list[tuple[int, int]],
                 request_of: Callable[[Stream], str | None]) -> None:
        """`reachable`: (first, end) addresses of memory; `request_of`: the peripheral's request that a stream listens
        to."""
        super().__init__(name, base)
        self.core, self.interrupts, self.reachable, self.request_of = core, interrupts, reachable, request_of
        self.streams = [Stream(self, number) for number in range(8)]
        for stream, interrupt in zip(self.streams, interrupts):
            core.system.lines[interrupt] = stream.wants_interrupt
        # Called when a stream begins to wait for its request, by that.
        self.begun: dict[str, Callable[[Stream], None]] = {}
        # The stream that each request had last: drivers clear a stream's register when they are done with it.
        self.served_by: dict[str, Stream] = {}
        # (stream, request, region) of transfers, and those that no controller could do.
        self.transfers: Counter[tuple[str, str | None, str]] = Counter()
        self.unreachable: Counter[tuple[str, str | None, str]] = Counter()

    def check(self, stream: Stream, address: int, size: int, peripheral: int) -> None:
        """Holds a transfer to memory that the controller reaches and to the register that it is meant for."""
        request = self.request_of(stream)
        self.transfers[stream.name, request, f"{address & 0xFF00_0000:#010x}"] += 1
        reached = any(first <= address and address + size <= end for first, end in self.reachable)
        if not reached or stream.peripheral_address != peripheral:
            block = f"{address & ~0xFFF:#x} and up, for {stream.peripheral_address:#x}"
            self.unreachable[stream.name, request, block] += 1

    def armed(self, request: str) -> Stream | None:
        """The stream that waits for `request`."""
        return next((stream for stream in self.streams if stream.enabled and self.request_of(stream) == request), None)

    def flags(self, number: int) -> int:
        """A stream's flags."""
        return self.values.get(4 * (number // 4), 0) >> _SHIFTS[number % 4] & 0x3D

    def raise_flag(self, number: int, bit: int) -> None:
        """Raises one of them."""
        self.values[4 * (number // 4)] = self.values.get(4 * (number // 4), 0) | bit << _SHIFTS[number % 4]

    def write(self, offset: int, value: int) -> None:
        if offset in (0x08, 0x0C):
            self.values[offset - 8] = self.values.get(offset - 8, 0) & ~value
            return
        before = self.values.get(offset, 0)
        self.values[offset] = value
        if offset >= 0x10 and (offset - 0x10) % 0x18 == 0:
            stream = self.streams[(offset - 0x10) // 0x18]
            if value & _ENABLE and not before & _ENABLE:
                request = self.request_of(stream) or ""
                self.served_by[request] = stream
                begun = self.begun.get(request)
                if begun is not None:
                    begun(stream)
            elif before & _ENABLE and not value & _ENABLE:
                # Switched off in the middle: the controller says that it is done (RM0433, 16.3.14).
                stream.flag(COMPLETE)
