"""Registers: what every peripheral of a chip has in common, and the bus on which the core finds it.

A register that a model does not know is no error on silicon, but a thing to look at here: it is noted, and fails the
run unless the chip's file accepts it.
"""

from collections import Counter
from collections.abc import Iterable

# A peripheral lies in whole blocks of this size, bytes.
BLOCK_BITS = 10


class Peripheral:
    """A peripheral whose registers keep what is written to them. Models override what does more."""

    # Offsets of the registers that the model knows, bytes.
    KNOWN: frozenset[int] = frozenset()
    # What they hold after a reset, where that is not zero.
    RESET: dict[int, int] = {}

    def __init__(self, name: str, base: int, *, size: int = 1 << BLOCK_BITS) -> None:
        self.name, self.base, self.size = name, base, size
        self.values: dict[int, int] = dict(self.RESET)

    def reset(self) -> None:
        """As after a reset of the chip."""
        self.values = dict(self.RESET)

    def read(self, offset: int) -> int:
        """The word at `offset`."""
        return self.values.get(offset, 0)

    def write(self, offset: int, value: int) -> None:
        """A word written to `offset`."""
        self.values[offset] = value


class Store(Peripheral):
    """A peripheral of which nothing but its memory matters here."""

    def __init__(self, name: str, base: int, known: Iterable[int], reset: dict[int, int] | None = None,
                 always: dict[int, int] | None = None, *, size: int = 1 << BLOCK_BITS) -> None:
        """`always`: bits that read as set, whatever was written."""
        self.KNOWN, self.RESET = frozenset(known), reset or {}
        self.always = always or {}
        super().__init__(name, base, size=size)

    def read(self, offset: int) -> int:
        return self.values.get(offset, 0) | self.always.get(offset, 0)


class Bus:
    """The core's way to the peripherals, in words."""

    def __init__(self) -> None:
        self.blocks: dict[int, Peripheral] = {}
        self.peripherals: list[Peripheral] = []
        # Accesses to registers that no model knows: (peripheral, offset, "read" or "write").
        self.unknown: Counter[tuple[str, str, str]] = Counter()

    def add(self, peripheral: Peripheral) -> None:
        """Puts `peripheral` where its base says."""
        first = peripheral.base >> BLOCK_BITS
        for block in range(first, first + max(1, peripheral.size >> BLOCK_BITS)):
            assert block not in self.blocks, (peripheral.name, self.blocks[block].name)
            self.blocks[block] = peripheral
        self.peripherals.append(peripheral)

    def read(self, address: int, size: int) -> int:
        """`size` bytes at `address`."""
        word = address & ~3
        peripheral = self.blocks.get(address >> BLOCK_BITS)
        if peripheral is None:
            self.unknown["nothing", hex(word), "read"] += 1
            return 0
        offset = word - peripheral.base
        if offset not in peripheral.KNOWN:
            self.unknown[peripheral.name, hex(offset), "read"] += 1
        value = peripheral.read(offset)
        return value if size == 4 else value >> 8 * (address & 3) & (1 << 8 * size) - 1

    def write(self, address: int, size: int, value: int) -> None:
        """`size` bytes written to `address`; the rest of the word as it reads."""
        word = address & ~3
        peripheral = self.blocks.get(address >> BLOCK_BITS)
        if peripheral is None:
            self.unknown["nothing", hex(word), "write"] += 1
            return
        offset = word - peripheral.base
        if offset not in peripheral.KNOWN:
            self.unknown[peripheral.name, hex(offset), "write"] += 1
        if size < 4:
            shift = 8 * (address & 3)
            mask = (1 << 8 * size) - 1 << shift
            value = peripheral.values.get(offset, 0) & ~mask | value << shift & mask
        peripheral.write(offset, value)
