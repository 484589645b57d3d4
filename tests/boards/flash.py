"""The parameters' part of the flash, the last two sectors of 128 KB: RM0433 chapter 4 (STM32H743: words of 32 bytes
with an error-correcting code, the second bank's registers), RM0090 chapter 3 (STM32F405: words of 4 bytes).

Programming clears bits, a word at a time, and takes time; so does an erase. Power that fails in the middle of either
tears the word or the sector: which bits are done then is drawn by a seed. On the H743 a torn word has the wrong code,
and reading it is a fault of the bus that the flash also reports (DBECCERR).

On the F405 the core stands still while the flash works: code comes from the same bank.
"""

import random
from collections.abc import Callable

from core import Core
from peripheral import Peripheral
from schedule import NS_PER_MS, NS_PER_US

SECTOR_BYTES = 128 * 1024
SECTORS = 2
_KEYS = (0x4567_0123, 0xCDEF_89AB)


class Flash(Peripheral):
    """What both chips have in common: memory, locks, work that takes time."""

    WORD_BYTES = 4
    PROGRAM_NS, ERASE_NS = 100 * NS_PER_US, 1_000 * NS_PER_MS
    STALLS = False
    _CONTROL, _LOCK = 0, 1

    def __init__(self, base: int, core: Core, first_address: int) -> None:
        super().__init__("FLASH", base)
        self.core, self.first_address = core, first_address
        self.memory = bytearray(b"\xff" * SECTORS * SECTOR_BYTES)
        self.torn: set[int] = set()
        self.busy_until_ns = 0
        self._keys_given = 0
        self._filling: dict[int, bytes] = {}
        # Words programmed and sectors erased since power came, and the one that power fails at, from 0.
        self.works = 0
        self.fails_at: int | None = None
        self.seed = 0
        # What power failed in last: "word" or "erase".
        self.failed_in: str | None = None
        # Called when power fails in the middle of it.
        self.on_power_lost: Callable[[], None] = lambda: None
        # What must not happen.
        self.wrong: list[str] = []
        core.map_memory(first_address, len(self.memory), self._load, self._store)

    def reset(self) -> None:
        super().reset()
        self._keys_given, self._filling, self.busy_until_ns = 0, {}, 0

    # As memory.

    def _load(self, address: int, size: int) -> int:
        offset = address - self.first_address
        if offset // self.WORD_BYTES in self.torn:
            self.read_torn()
        return int.from_bytes(self.memory[offset:offset + size], "little")

    def _store(self, address: int, size: int, value: int) -> None:
        offset = address - self.first_address
        if size != 4 or not self.may_program():
            self.wrong.append(f"a write of {size} bytes to a flash that is not open for it")
            return
        word = offset // self.WORD_BYTES
        self._filling[offset] = value.to_bytes(4, "little")
        if len(self._filling) * 4 == self.WORD_BYTES:
            places = sorted(self._filling)
            if any(place // self.WORD_BYTES != word for place in places):
                self.wrong.append("a word of the flash that was not filled")
            data, self._filling = b"".join(self._filling[place] for place in places), {}
            self._program(word, data)

    def _fails(self) -> bool:
        self.works += 1
        return self.fails_at is not None and self.works > self.fails_at

    def _program(self, word: int, data: bytes) -> None:
        place = word * self.WORD_BYTES
        before = self.memory[place:place + self.WORD_BYTES]
        if self.WORD_BYTES > 4 and before != b"\xff" * self.WORD_BYTES:
            self.wrong.append("a word programmed twice: its code is wrong from then on")
        if self._fails():
            self.failed_in = "word"
            draw = random.Random(self.seed * 1_000_003 + self.works)
            done = bytes(byte | draw.getrandbits(8) for byte in data)
            self.memory[place:place + self.WORD_BYTES] = bytes(a & b for a, b in zip(before, done))
            self.torn.add(word)
            self.on_power_lost()
            return
        self.memory[place:place + self.WORD_BYTES] = bytes(a & b for a, b in zip(before, data))
        self._work(self.PROGRAM_NS)

    def erase(self, sector: int) -> None:
        """Erases one of the two sectors."""
        if not 0 <= sector < SECTORS:
            self.wrong.append(f"an erase of sector {sector} of the two")
            return
        first = sector * SECTOR_BYTES
        if self._fails():
            self.failed_in = "erase"
            # Some words are blank, some as before, and some between: every fourth here.
            draw = random.Random(self.seed * 1_000_003 + self.works)
            for word in range(first // self.WORD_BYTES, (first + SECTOR_BYTES) // self.WORD_BYTES):
                place, kind = word * self.WORD_BYTES, draw.randrange(4)
                if kind == 0:
                    self.memory[place:place + self.WORD_BYTES] = draw.randbytes(self.WORD_BYTES)
                    self.torn.add(word)
                elif kind < 3:
                    self.memory[place:place + self.WORD_BYTES] = b"\xff" * self.WORD_BYTES
                    self.torn.discard(word)
            self.on_power_lost()
            return
        self.memory[first:first + SECTOR_BYTES] = b"\xff" * SECTOR_BYTES
        words = range(first // self.WORD_BYTES, (first + SECTOR_BYTES) // self.WORD_BYTES)
        self.torn.difference_update(words)
        self._work(self.ERASE_NS)

    def _work(self, duration_ns: int) -> None:
        schedule = self.core.schedule
        self.busy_until_ns = schedule.now + duration_ns
        schedule.at(self.busy_until_ns, lambda: None)
        if self.STALLS:
            # Nothing else of the core happens meanwhile; what is outside goes on.
            schedule.now = self.busy_until_ns

    @property
    def is_busy(self) -> bool:
        """Whether it is at work; who waits for it polls this."""
        is_busy = self.core.schedule.now < self.busy_until_ns
        if is_busy:
            self.core.spin()
        return is_busy

    def may_program(self) -> bool:
        """Whether it is open, and for programming."""
        raise NotImplementedError

    def read_torn(self) -> None:
        """What reading a torn word does."""

    def take_key(self, value: int) -> None:
        """A key is written: both of them, one after the other, open the control register."""
        self._keys_given = self._keys_given + 1 if value == _KEYS[self._keys_given] else 0
        if self._keys_given == len(_KEYS):
            self._keys_given = 0
            self.values[self._CONTROL] &= ~self._LOCK

    def is_locked(self) -> bool:
        """Whether the control register is, at a write to it: that must not happen."""
        is_locked = bool(self.values[self._CONTROL] & self._LOCK)
        if is_locked:
            self.wrong.append("the control register written while it is locked")
        return is_locked


class FlashH743(Flash):
    """The second bank: its registers begin at 0x100."""

    KNOWN = frozenset([0x00, 0x04, 0x0C, 0x10, 0x14, 0x18, 0x1C, 0x20, 0x104, 0x10C, 0x110, 0x114, 0x11C])
    WORD_BYTES = 32
    _KEY, _CONTROL, _STATUS, _CLEAR, _DOUBLE_ERROR = 0x104, 0x10C, 0x110, 0x114, 1 << 26
    _FIRST_SECTOR = 6

    def __init__(self, base: int, core: Core, first_address: int, options: int) -> None:
        self.RESET = {0x00: 0x37, 0x0C: 1, 0x10C: 1, 0x1C: options}
        super().__init__(base, core, first_address)

    def may_program(self) -> bool:
        return self.values[self._CONTROL] & 3 == 2

    def read_torn(self) -> None:
        self.values[self._STATUS] = self.values.get(self._STATUS, 0) | self._DOUBLE_ERROR
        if not (self.core.faults_masked and self.core.system.values[0xD14] >> 8 & 1):
            self.wrong.append("a torn word read with faults not masked")

    def read(self, offset: int) -> int:
        if offset == self._STATUS:
            # BSY and QW.
            return self.values.get(offset, 0) | (5 if self.is_busy else 0)
        return self.values.get(offset, 0)

    def write(self, offset: int, value: int) -> None:
        if offset == self._KEY:
            self.take_key(value)
        elif offset == self._CLEAR:
            self.values[self._STATUS] = self.values.get(self._STATUS, 0) & ~value
        elif offset == self._CONTROL:
            if self.is_locked():
                return
            self.values[offset] = value & ~(1 << 7)
            if value >> 7 & 1 and value >> 2 & 1:
                self.erase((value >> 8 & 7) - self._FIRST_SECTOR)
        else:
            self.values[offset] = value


class FlashF405(Flash):
    """One bank."""

    KNOWN = frozenset(range(0, 0x18, 4))
    PROGRAM_NS = 16 * NS_PER_US
    STALLS = True
    _KEY, _STATUS, _CONTROL, _OPTIONS = 0x04, 0x0C, 0x10, 0x14
    _LOCK = 1 << 31
    _FIRST_SECTOR = 10

    def __init__(self, base: int, core: Core, first_address: int, options: int) -> None:
        self.RESET = {0x10: self._LOCK, 0x14: options}
        super().__init__(base, core, first_address)

    def may_program(self) -> bool:
        return self.values[self._CONTROL] & (self._LOCK | 1) == 1

    def read(self, offset: int) -> int:
        if offset == self._STATUS:
            return self.values.get(offset, 0) | (1 << 16 if self.is_busy else 0)
        return self.values.get(offset, 0)

    def write(self, offset: int, value: int) -> None:
        if offset == self._KEY:
            self.take_key(value)
        elif offset == self._STATUS:
            self.values[offset] = self.values.get(offset, 0) & ~value
        elif offset == self._CONTROL:
            if self.is_locked():
                return
            self.values[offset] = value & ~(1 << 16)
            if value >> 16 & 1 and value >> 1 & 1:
                self.erase((value >> 3 & 0xF) - self._FIRST_SECTOR)
        else:
            self.values[offset] = value
