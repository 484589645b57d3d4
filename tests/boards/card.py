"""A slot for a microSD card, SDMMC1 of the STM32H743 with its own DMA (RM0433 chapter 55), and a card with an empty
FAT32 volume (SD Physical Layer Simplified Specification; Microsoft's FAT32 specification).

A card answers at once; a sector takes as long as its bits on four lines at 25 MHz, a write a while more. One that is
not there answers nothing.
"""

import struct
from collections import Counter

from core import Core
from peripheral import Peripheral
from schedule import NS_PER_MS, NS_PER_S

SECTOR_BYTES = 512
# FAT32 begins at 65,525 clusters.
_CLUSTERS, _CLUSTER_SECTORS, _PARTITION, _RESERVED = 66_000, 8, 2048, 32
_FAT_SECTORS = (_CLUSTERS + 2) * 4 // SECTOR_BYTES + 1
_SECTORS = (_PARTITION + _RESERVED + 2 * _FAT_SECTORS + _CLUSTERS * _CLUSTER_SECTORS + 1023) // 1024 * 1024
_BITS_PER_S, _WRITE_NS = 4 * 25_000_000, NS_PER_MS


class Card:
    """A card of some 260 MB."""

    def __init__(self) -> None:
        self.sectors: dict[int, bytes] = {}
        self.writes = 0
        volume = _SECTORS - _PARTITION
        entry = struct.pack("<B3sB3sII", 0, b"\0\0\0", 0x0C, b"\0\0\0", _PARTITION, volume)
        self.sectors[0] = bytes(446) + entry + bytes(48) + b"\x55\xaa"
        head = b"\xeb\x58\x90MSDOS5.0" + struct.pack(
            "<HBHBHHBHHHII", SECTOR_BYTES, _CLUSTER_SECTORS, _RESERVED, 2, 0, 0, 0xF8, 0, 63, 255, _PARTITION, volume)
        head += struct.pack("<IHHIHH12xBBBI11s8s", _FAT_SECTORS, 0, 0, 2, 1, 6, 0x80, 0, 0x29, 1,
                            b"NO NAME    ", b"FAT32   ")
        boot = head + bytes(510 - len(head)) + b"\x55\xaa"
        free = struct.pack("<II", _CLUSTERS - 1, 3)
        information = b"RRaA" + bytes(480) + b"rrAa" + free + bytes(12) + b"\0\0\x55\xaa"
        for copy in (0, 6):
            self.sectors[_PARTITION + copy], self.sectors[_PARTITION + copy + 1] = boot, information
        table = struct.pack("<III", 0x0FFF_FFF8, 0x0FFF_FFFF, 0x0FFF_FFFF) + bytes(SECTOR_BYTES - 12)
        for fat in range(2):
            self.sectors[_PARTITION + _RESERVED + fat * _FAT_SECTORS] = table

    def read(self, sector: int) -> bytes:
        """A sector."""
        return self.sectors.get(sector, bytes(SECTOR_BYTES))

    def write(self, sector: int, data: bytes) -> None:
        """The same."""
        self.sectors[sector] = data
        self.writes += 1


_ARGUMENT, _COMMAND, _RESPONSE, _LENGTH, _CONTROL, _STATUS, _CLEAR, _MASK, _BUFFER = (
    0x08, 0x0C, 0x14, 0x28, 0x2C, 0x34, 0x38, 0x3C, 0x58)
_NO_ANSWER, _DATA_TIMEOUT, _ANSWERED, _COMMAND_SENT, _DATA_END, _DATA_ACTIVE = (
    1 << 2, 1 << 3, 1 << 6, 1 << 7, 1 << 8, 1 << 12)
_READY = 0x900
_ADDRESS = 0x1234


class Slot(Peripheral):
    """SDMMC1."""

    KNOWN = frozenset([*range(0, 0x60, 4), 0x80])

    def __init__(self, core: Core, interrupt: int, reachable: tuple[int, int]) -> None:
        super().__init__("SDMMC1", 0x5200_7000)
        self.core, self.interrupt, self.reachable = core, interrupt, reachable
        self.card: Card | None = None
        self._is_application, self._generation = False, 0
        self.commands: Counter[int] = Counter()
        self.unreachable: Counter[str] = Counter()
        core.system.lines[interrupt] = self._wants_interrupt

    def reset(self) -> None:
        super().reset()
        self._generation += 1

    def _wants_interrupt(self) -> bool:
        return bool(self.values.get(_STATUS, 0) & self.values.get(_MASK, 0))

    def _raise(self, flag: int) -> None:
        self.values[_STATUS] = self.values.get(_STATUS, 0) | flag
        if self._wants_interrupt():
            self.core.system.raise_interrupt(self.interrupt)

    def read(self, offset: int) -> int:
        status = self.values.get(offset, 0)
        if offset == _STATUS and status & _DATA_ACTIVE:
            self.core.spin()
        return status

    def write(self, offset: int, value: int) -> None:
        if offset == _CLEAR:
            self.values[_STATUS] = self.values.get(_STATUS, 0) & ~value
            return
        self.values[offset] = value
        if offset == _COMMAND and value >> 12 & 1:
            self._do(value & 0x3F, value >> 8 & 3, bool(value >> 6 & 1))
        elif offset == _MASK and self._wants_interrupt():
            self.core.system.raise_interrupt(self.interrupt)

    def _do(self, command: int, answer_kind: int, has_data: bool) -> None:
        self.commands[command] += 1
        if command == 12:
            self._generation += 1
            self.values[_STATUS] = self.values.get(_STATUS, 0) & ~_DATA_ACTIVE
        if answer_kind == 0:
            self._raise(_COMMAND_SENT)
            return
        if self.card is None:
            self._raise(_NO_ANSWER)
            return
        argument, is_application = self.values.get(_ARGUMENT, 0), self._is_application
        self._is_application = command == 55
        for place, word in enumerate(self._answer(command, argument, is_application)):
            self.values[_RESPONSE + 4 * place] = word
        self._raise(_ANSWERED)
        if has_data:
            self._begin_data(command, argument)

    @staticmethod
    def _answer(command: int, argument: int, is_application: bool) -> list[int]:
        if command == 8:
            return [argument & 0xFFF]
        if command == 41 and is_application:
            # Powered up, high capacity, all voltages.
            return [0xC0FF_8000]
        if command == 2:
            return [0x0353_4453, 0x4330_3247, 0x8000_0000, 0x0101_7A01]
        if command == 9:
            size = _SECTORS // 1024 - 1
            return [0x400E_0032, 0x5B59_0000 | size >> 16, (size & 0xFFFF) << 16 | 0x7F80, 0x0A40_0001]
        if command == 3:
            return [_ADDRESS << 16 | 0x500]
        return [_READY | (0x20 if command == 55 else 0)]

    def _begin_data(self, command: int, argument: int) -> None:
        size = self.values.get(_LENGTH, 0)
        self.values[_STATUS] = self.values.get(_STATUS, 0) | _DATA_ACTIVE
        took = size * 8 * NS_PER_S // _BITS_PER_S + (_WRITE_NS if command == 24 else 0)
        self.core.schedule.after(took, self._data_over, command, argument, size, self._generation)

    def _data_over(self, command: int, argument: int, size: int, generation: int) -> None:
        if generation != self._generation:
            return
        self.values[_STATUS] = self.values.get(_STATUS, 0) & ~_DATA_ACTIVE
        if self.card is None:
            self._raise(_DATA_TIMEOUT)
            return
        place, uc = self.values.get(_BUFFER, 0), self.core.uc
        if not (self.reachable[0] <= place and place + size <= self.reachable[1]):
            self.unreachable[f"{place:#x}+{size}"] += 1
        if command == 24:
            self.card.write(argument, bytes(uc.mem_read(place, size)))
        elif command == 17:
            uc.mem_write(place, self.card.read(argument))
        elif command == 51:
            # SCR: version 2 and later, one and four lines.
            uc.mem_write(place, bytes([0x02, 0x35, 0x80, 0x00, 0, 0, 0, 0]))
        else:
            uc.mem_write(place, bytes(size))
        self._raise(_DATA_END)
