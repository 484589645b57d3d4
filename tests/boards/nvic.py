"""The core's own peripherals: interrupt controller, system control block, SysTick (ARMv7-M Architecture Reference
Manual, B3.2 to B3.4), and what a reset leaves in them.

Memory protection is only remembered: Unicorn does not enforce it.
"""

from collections.abc import Callable

from peripheral import Peripheral

# Exceptions by their number; interrupt n is exception 16 + n.
HARD_FAULT = 3
PENDSV, SYSTICK = 14, 15
FIRST_INTERRUPT = 16

# The priority of a core that handles nothing: below all.
THREAD_PRIORITY = 256
HARD_FAULT_PRIORITY = -1

_ISER, _ICER, _ISPR, _ICPR, _ICPR_END, _IPR, _IPR_END = 0x100, 0x180, 0x200, 0x280, 0x2C0, 0x400, 0x5F0
_ICSR, _VTOR, _AIRCR, _CCR, _SHCSR, _CFSR, _HFSR, _BFAR = 0xD04, 0xD08, 0xD0C, 0xD14, 0xD24, 0xD28, 0xD2C, 0xD38
_FPCCR = 0xF34
_STIR = 0xF00


class SystemControl(Peripheral):
    """0xE000E000: everything between SysTick and the floating-point unit's control."""

    def __init__(self, part: int, now: Callable[[], int], core_hz: Callable[[], int]) -> None:
        """`part`: the core's identification (CPUID)."""
        self.KNOWN = frozenset([
            0x004, 0x008, 0x010, 0x014, 0x018,
            *range(0x100, 0x140, 4), *range(0x180, 0x1C0, 4), *range(0x200, 0x240, 4), *range(0x280, 0x2C0, 4),
            *range(_IPR, _IPR_END, 4),
            *range(0xD00, 0xD40, 4), 0xD78, 0xD7C, 0xD80, 0xD84, 0xD88, *range(0xD90, 0xDA4, 4),
            0xF00, 0xF34, 0xF38, 0xF3C, 0xF50, 0xF5C, 0xF60, 0xF64, 0xF68, 0xF6C, 0xF70, 0xF74, 0xF90, 0xF94, 0xF9C,
        ])
        regions = 8 if part >> 4 & 0xFFF == 0xC24 else 16
        self.RESET = {0xD00: part, 0xD0C: 0xFA05_0000, _CCR: 0x200, 0xD90: regions << 8,
                      0xD7C: 0x8303_C003, 0xD80: 0xF00F_E019, _FPCCR: 0xC000_0000, 0xF90: 0x1, 0xF94: 0x1}
        super().__init__("core", 0xE000_E000, size=0x1000)
        self._now, self._core_hz = now, core_hz
        # Called when software requests a reset of the chip.
        self.on_reset_request: Callable[[], None] = lambda: None
        # Whether an interrupt's line is still high, by its number: it is pending again when its handler is done.
        self.lines: dict[int, Callable[[], bool]] = {}
        self.enabled: set[int] = set()
        self.pending: set[int] = set()
        self.priorities = [0] * 512
        self.active: list[tuple[int, int]] = []
        # Grows whenever an exception may have become pending or enabled.
        self.changes = 0
        self._systick_from = 0

    def reset(self) -> None:
        super().reset()
        self.enabled, self.pending, self.priorities, self.active = set(), set(), [0] * 512, []

    def raise_interrupt(self, interrupt: int) -> None:
        """Its line rises."""
        self.changes += 1
        self.pending.add(FIRST_INTERRUPT + interrupt)

    @property
    def priority(self) -> int:
        """Of what runs."""
        return self.active[-1][1] if self.active else THREAD_PRIORITY

    def next_exception(self, primask: int, basepri: int) -> int | None:
        """The pending exception that the core takes now, if any."""
        if primask & 1:
            return None
        best, limit = None, self.priority
        if basepri:
            limit = min(limit, basepri)
        for exception in self.pending:
            if exception >= FIRST_INTERRUPT and exception not in self.enabled:
                continue
            priority = self.priorities[exception]
            if priority < limit or priority == limit and best is not None and exception < best:
                best, limit = exception, priority
        return best

    def wakes(self) -> bool:
        """Whether anything is pending that ends a WFE or WFI, masked by PRIMASK or not."""
        return any(exception < FIRST_INTERRUPT or exception in self.enabled for exception in self.pending)

    def enter(self, exception: int) -> None:
        """The core begins to handle it."""
        self.pending.discard(exception)
        self.active.append((exception, HARD_FAULT_PRIORITY if exception == HARD_FAULT else self.priorities[exception]))

    def leave(self) -> None:
        """The core is done with what it handled; a line that is still high is pending again."""
        exception, _ = self.active.pop()
        line = self.lines.get(exception - FIRST_INTERRUPT)
        if line is not None and line():
            self.pending.add(exception)

    @property
    def vector_table(self) -> int:
        """Its address."""
        return self.values.get(_VTOR, 0)

    @property
    def saves_floats(self) -> bool:
        """Whether an exception saves the floating-point registers (FPCCR.ASPEN)."""
        return bool(self.values.get(_FPCCR, 0) >> 31 & 1)

    def fault(self, status: int, address: int | None, hard: int = 1 << 30) -> None:
        """Records a fault that became a hard one: CFSR, BFAR and HFSR."""
        self.values[_CFSR] = self.values.get(_CFSR, 0) | status
        self.values[_HFSR] = self.values.get(_HFSR, 0) | hard
        if address is not None:
            self.values[_BFAR] = address

    def _bits(self, members: set[int], offset: int) -> int:
        first = FIRST_INTERRUPT + 8 * (offset & 0x3C)
        return sum(1 << bit for bit in range(32) if first + bit in members)

    def read(self, offset: int) -> int:
        if _ISER <= offset < _ISPR:
            return self._bits(self.enabled, offset)
        if _ISPR <= offset < _ICPR_END:
            return self._bits(self.pending, offset)
        if _IPR <= offset < _IPR_END:
            first = FIRST_INTERRUPT + offset - _IPR
            return int.from_bytes(bytes(self.priorities[first:first + 4]), "little")
        if offset == _ICSR:
            return self.active[-1][0] if self.active else 0
        if offset == 0x010:
            return self._systick()
        return self.values.get(offset, 0)

    def write(self, offset: int, value: int) -> None:
        self.changes += 1
        if _ISER <= offset < _ICPR_END:
            first = FIRST_INTERRUPT + 8 * (offset & 0x3C)
            members = {first + bit for bit in range(32) if value >> bit & 1}
            if offset < _ICER:
                self.enabled |= members
                for exception in members:
                    line = self.lines.get(exception - FIRST_INTERRUPT)
                    if line is not None and line():
                        self.pending.add(exception)
            elif offset < _ISPR:
                self.enabled -= members
            elif offset < _ICPR:
                self.pending |= members
            else:
                self.pending -= members
        elif _IPR <= offset < _IPR_END:
            # The chips have the upper four bits.
            first = FIRST_INTERRUPT + offset - _IPR
            self.priorities[first:first + 4] = [byte & 0xF0 for byte in value.to_bytes(4, "little")]
        elif offset == _STIR:
            self.pending.add(FIRST_INTERRUPT + (value & 0x1FF))
        elif offset == _ICSR:
            self.pending |= {exception for exception, bit in ((PENDSV, 28), (SYSTICK, 26)) if value >> bit & 1}
            self.pending -= {exception for exception, bit in ((PENDSV, 27), (SYSTICK, 25)) if value >> bit & 1}
        elif offset == _AIRCR:
            if value >> 16 == 0x05FA and value >> 2 & 1:
                self.on_reset_request()
        elif offset in (_CFSR, _HFSR):
            self.values[offset] = self.values.get(offset, 0) & ~value
        else:
            self.values[offset] = value
            if offset in (0x010, 0x018):
                self._systick_from = self._now()

    def _systick(self) -> int:
        """SysTick's control register: COUNTFLAG since it was read last."""
        control = self.values.get(0x010, 0)
        if control & 1:
            period_ns = (self.values.get(0x014, 0) + 1) * 1_000_000_000 // self._core_hz()
            periods = (self._now() - self._systick_from) // period_ns
            if periods:
                self._systick_from += periods * period_ns
                return control | 1 << 16
        return control
