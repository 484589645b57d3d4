"""Reads an ELF image for a Cortex-M: its sections, its symbols, and how deep its calls go.

The stack is read off the machine code: what a function pushes and subtracts from the stack pointer anywhere, and whom it
calls. Mapping symbols ($t, $d) tell code from constants. A call through a register is one of the functions whose address
the caller builds itself (compilers keep an address that is called often in a register) or that the budget says it can
reach. What has no static bound is a problem to be reported: other calls through registers, stack pointers moved by a
register, and recursion. Functions may be given a size by assumption, for what lies behind them.
"""

import bisect
import re
import struct

RAM = 0x2000_0000
ALLOCATED, NOBITS, SYMTAB, FUNCTION = 2, 8, 2, 2
LOAD = 1


def path(symbol):
    """The identifiers in a mangled Rust symbol, joined; other symbols as they are."""
    if symbol.startswith("_ZN"):
        parts = identifiers(symbol, 3)
        if parts and re.fullmatch(r"h[0-9a-f]{16}", parts[-1]):
            parts.pop()
        return "::".join(parts)
    return "::".join(identifiers(symbol, 2)) if symbol.startswith("_R") else symbol


def identifiers(symbol, place):
    """The identifiers in a mangled Rust symbol from `place` on, of either mangling: each follows its length."""
    parts = []
    while place < len(symbol):
        if found := re.compile(r"(\d+)_?").match(symbol, place):
            # An underscore parts a length from an identifier that begins with a digit or an underscore.
            start = found.end() if symbol.startswith("_R") else found.end(1)
            place = start + int(found[1])
            if place > start:
                parts.append(symbol[start:place])
        elif symbol.startswith("_R") and (number := re.compile(r"[sBKLG][0-9A-Za-z]*_").match(symbol, place)):
            # What tells crates of one name apart, references back, constants and lifetimes: numbers that are no lengths.
            place = number.end()
        else:
            place += 1
    return parts


class Image:
    """One ELF file."""

    def __init__(self, file):
        self.data = file.read_bytes()
        if self.data[:6] != b"\x7fELF\x01\x01":
            raise SystemExit(f"error: {file}: not a 32-bit little-endian ELF file")
        offset, = struct.unpack_from("<I", self.data, 32)
        size, count = struct.unpack_from("<HH", self.data, 46)
        self.sections = [struct.unpack_from("<10I", self.data, offset + size * i) for i in range(count)]
        self.symbols = list(self._symbols())
        # Code by address, a function's first name standing for all of them.
        functions = {}
        for name, value, length, kind in self.symbols:
            if kind == FUNCTION and length:
                functions.setdefault(value & ~1, (name, length))
        self.functions = functions
        self.starts = sorted(functions)
        marks = [(value, name[:2]) for name, value, _, _ in self.symbols if re.match(r"\$[td](\.|$)", name)]
        self.marks = sorted(marks)

    def _symbols(self):
        for _, kind, _, _, offset, size, link, _, _, entry in self.sections:
            if kind != SYMTAB:
                continue
            strings = self.sections[link][4]
            for place in range(offset, offset + size, entry):
                name, value, length, info, _, _ = struct.unpack_from("<IIIBBH", self.data, place)
                end = self.data.index(b"\0", strings + name)
                yield self.data[strings + name : end].decode(), value, length, info & 15

    def paths(self):
        """The paths of all symbols."""
        return [path(name) for name, _, _, _ in self.symbols]

    def _allocated(self):
        return [section for section in self.sections if section[2] & ALLOCATED]

    def flash(self):
        """Bytes that are loaded."""
        return sum(section[5] for section in self._allocated() if section[1] != NOBITS)

    def ram(self):
        """Bytes of memory that are spoken for, without the stack."""
        return sum(section[5] for section in self._allocated() if section[3] >= RAM)

    def binary(self):
        """Where it is loaded to, and its bytes from there on; what lies between its parts is zero."""
        offset, = struct.unpack_from("<I", self.data, 28)
        size, count = struct.unpack_from("<HH", self.data, 42)
        parts = [struct.unpack_from("<8I", self.data, offset + size * i) for i in range(count)]
        loaded = sorted((part[3], part[1], part[4]) for part in parts if part[0] == LOAD and part[4])
        begin = loaded[0][0]
        image = bytearray(max(address + length for address, _, length in loaded) - begin)
        for address, place, length in loaded:
            image[address - begin : address - begin + length] = self.data[place : place + length]
        return begin, bytes(image)

    def is_code(self, address):
        """Whether `address` lies behind a $t."""
        place = bisect.bisect_right(self.marks, (address, "$~")) - 1
        return place >= 0 and self.marks[place][1] == "$t"

    def owner(self, address):
        """The start of the function that holds `address`, if any."""
        place = bisect.bisect_right(self.starts, address) - 1
        if place < 0 or address >= self.starts[place] + self.functions[self.starts[place]][1]:
            return None
        return self.starts[place]

    def word(self, address):
        """The word at an address."""
        section = next(s for s in self._allocated() if s[3] <= address < s[3] + s[5])
        return struct.unpack_from("<I", self.data, section[4] + address - section[3])[0]

    def halfwords(self, start, length):
        """(address, first halfword, second halfword or none) of each instruction."""
        section = next(s for s in self._allocated() if s[3] <= start < s[3] + s[5])
        address = start
        while address < start + length:
            if not self.is_code(address):
                address += 2
                continue
            first, = struct.unpack_from("<H", self.data, section[4] + address - section[3])
            if first >> 11 in (0b11101, 0b11110, 0b11111):
                second, = struct.unpack_from("<H", self.data, section[4] + address - section[3] + 2)
                yield address, first, second
                address += 4
            else:
                yield address, first, None
                address += 2


def signed(value, bits):
    return value - (1 << bits) if value >> (bits - 1) else value


def expanded(first, second):
    """The modified immediate of a data-processing instruction."""
    code = (first >> 10 & 1) << 11 | (second >> 12 & 7) << 8 | second & 255
    if code >> 10:
        value = 0x80 | code & 0x7F
        return (value >> (code >> 7) | value << (32 - (code >> 7))) & 0xFFFF_FFFF
    return (code & 255) * (1, 0x00010001, 0x01000100, 0x01010101)[code >> 8]


def pushed(first, second):
    """Bytes by which one instruction lowers the stack pointer; none if that is not known."""
    if second is None:
        if first & 0xFE00 == 0xB400:
            return 4 * (first & 0x1FF).bit_count()
        return 4 * (first & 0x7F) if first & 0xFF80 == 0xB080 else 0
    if first == 0xE92D:
        return 4 * second.bit_count()
    if first == 0xF84D and second & 0x0F00 == 0x0D00:
        return second & 255
    if first in (0xE96D, 0xE9ED):  # strd with write-back
        return 4 * (second & 255) if first == 0xE96D else 0
    if first & 0xFFBF == 0xED2D and second & 0x0E00 == 0x0A00:
        return 4 * (second & 255)
    if first & 0xFBFF == 0xF1AD and second & 0x8F00 == 0x0D00:
        return expanded(first, second)
    if first & 0xFBFF == 0xF2AD and second & 0x8F00 == 0x0D00:
        return (first >> 10 & 1) << 11 | (second >> 12 & 7) << 8 | second & 255
    return None if first in (0xEBAD, 0xEBA0 | 13) and second & 0x0F00 == 0x0D00 else 0


def target(address, first, second):
    """Where a direct call or jump goes; none for other instructions."""
    pc = address + 4
    if second is None:
        if first & 0xF800 == 0xE000:
            return pc + 2 * signed(first & 0x7FF, 11)
        if first & 0xF000 == 0xD000 and first >> 8 & 15 < 14:
            return pc + 2 * signed(first & 0xFF, 8)
        return None
    if first & 0xF800 != 0xF000 or not second & 0x8000:
        return None
    sign, j1, j2 = first >> 10 & 1, second >> 13 & 1, second >> 11 & 1
    if second & 0x1000:
        i1, i2 = 1 - (j1 ^ sign), 1 - (j2 ^ sign)
        offset = sign << 24 | i1 << 23 | i2 << 22 | (first & 0x3FF) << 12 | (second & 0x7FF) << 1
        return pc + signed(offset, 25)
    if second & 0xD000 == 0x8000 and first >> 6 & 15 < 14:
        offset = sign << 20 | j2 << 19 | j1 << 18 | (first & 0x3F) << 12 | (second & 0x7FF) << 1
        return pc + signed(offset, 21)
    return None


def literal(address, first, second):
    """Where an instruction that loads a constant beside the code finds it; none for other instructions."""
    pc = (address + 4) & ~3
    if second is None:
        return pc + 4 * (first & 255) if first & 0xF800 == 0x4800 else None
    if first & 0xFF7F != 0xF85F:
        return None
    return pc + (second & 0xFFF) * (1 if first & 0x80 else -1)


def moved(first, second):
    """(register, value, whether it is the upper half) of a movw or movt."""
    if second is None or first & 0xFB70 != 0xF240 or second & 0x8000:
        return None
    value = (first & 15) << 12 | (first >> 10 & 1) << 11 | (second >> 12 & 7) << 8 | second & 255
    return second >> 8 & 15, value, bool(first & 0x80)


def is_indirect(first, second):
    """Calls and jumps through a register or memory, returns and jump tables aside."""
    if second is None:
        if first & 0xFF87 == 0x4780:
            return True
        return (first & 0xFF87 == 0x4700 and first >> 3 & 15 != 14) or first & 0xFF87 == 0x4687
    # ldr pc, from anywhere but the top of the stack
    return first & 0xFF70 == 0xF850 and second >> 12 == 15 and (first, second) != (0xF85D, 0xFB04)


class StackBound:
    """The deepest way through an image's calls."""

    def __init__(self, image, indirect, assumed):
        self.image, self.indirect = image, {re.compile(caller): re.compile(reach) for caller, reach in indirect.items()}
        self.assumed = {re.compile(name): size for name, size in assumed.items()}
        self.problems, self.known = [], {}

    def name(self, start):
        return path(self.image.functions[start][0])

    def matching(self, pattern):
        return [start for start in self.image.starts if re.search(pattern, self.name(start))]

    def deepest(self, root):
        """Bytes from the entry of the deepest function matching `root`, and the (path, own bytes) on the way."""
        roots = self.matching(root)
        if not roots:
            self.problems.append(f"no function matches {root}")
        return max((self._bound(start, ()) for start in roots), default=(0, []), key=lambda bound: bound[0])

    def _bound(self, start, callers):
        for name, size in self.assumed.items():
            if name.search(self.name(start)):
                return size, [(f"{self.name(start)} (assumed)", size)]
        if start in callers:
            self.problems.append(f"{self.name(start)} calls itself: no static bound")
            return 0, []
        if start not in self.known:
            own, callees = self._read(start)
            below = [self._bound(callee, (*callers, start)) for callee in sorted(callees)]
            deepest, way = max(below, default=(0, []), key=lambda bound: bound[0])
            self.known[start] = own + deepest, [(self.name(start), own), *way]
        return self.known[start]

    def frame(self, start):
        """What one function takes for itself, as far as its code says."""
        return sum(pushed(first, second) or 0 for _, first, second in self.image.halfwords(*self._place(start)))

    def _place(self, start):
        return start, self.image.functions[start][1]

    def _read(self, start):
        """What one function takes for itself, and whom it calls or jumps to."""
        own, callees, name = 0, set(), self.name(start)
        lower, built, unknown = {}, set(), []
        for address, first, second in self.image.halfwords(*self._place(start)):
            taken = pushed(first, second)
            if taken is None:
                self.problems.append(f"{name}: moves the stack pointer by a register at {address:#x}")
            own += taken or 0
            where = target(address, first, second)
            if where is not None and (callee := self.image.owner(where)) != start:
                if callee is None:
                    self.problems.append(f"{name}: calls {where:#x}, where no function is known")
                else:
                    callees.add(callee)
            if (place := literal(address, first, second)) is not None:
                built.add(self.image.word(place) & ~1)
            if half := moved(first, second):
                register, value, upper = half
                if upper:
                    built.add((lower.get(register, 0) | value << 16) & ~1)
                else:
                    lower[register] = value
            if is_indirect(first, second):
                reached = [r for caller, reach in self.indirect.items() if caller.search(name) for r in self.matching(reach)]
                callees.update(reached)
                if not reached:
                    unknown.append(address)
        named = built & self.image.functions.keys()
        if unknown and named:
            callees.update(named)
        else:
            self.problems += [f"{name}: calls through a register at {address:#x}" for address in unknown]
        return own, callees
