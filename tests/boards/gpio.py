"""Pins: GPIO ports (RM0433 chapter 11, RM0090 chapter 8) and the interrupts of their edges (EXTI, RM0433 chapter 20,
RM0090 chapter 12)."""

from collections.abc import Callable

from core import Core
from peripheral import Peripheral

_MODER, _PUPDR, IDR, _ODR, _BSRR, _AFRL = 0x00, 0x0C, 0x10, 0x14, 0x18, 0x20


class Port(Peripheral):
    """One port of sixteen pins."""

    KNOWN = frozenset(range(0, 0x28, 4))

    def __init__(self, letter: str, base: int, moder: int, changed: Callable[[str, int], None]) -> None:
        """`moder`: after a reset. `changed` is told of every output's edge: the pin ("A5") and its level."""
        self.RESET = {_MODER: moder}
        super().__init__(f"GPIO{letter}", base)
        self.letter, self.changed = letter, changed

    def function(self, pin: int) -> int | None:
        """The alternate function that drives a pin, or none where it is a plain one."""
        if self.values.get(_MODER, 0) >> 2 * pin & 3 != 2:
            return None
        return self.values.get(_AFRL + 4 * (pin // 8), 0) >> 4 * (pin % 8) & 0xF

    def is_output(self, pin: int) -> bool:
        """Whether it is a plain output."""
        return self.values.get(_MODER, 0) >> 2 * pin & 3 == 1

    def is_input(self, pin: int) -> bool:
        """Whether nothing here drives it."""
        return self.values.get(_MODER, 0) >> 2 * pin & 3 == 0

    def is_pulled_up(self, pin: int) -> bool:
        """Whether it rests high where nobody drives it."""
        return self.values.get(_PUPDR, 0) >> 2 * pin & 3 == 1

    def read(self, offset: int) -> int:
        return self.values.get(_ODR if offset == IDR else offset, 0)

    def write(self, offset: int, value: int) -> None:
        if offset == _BSRR:
            self._drive((self.values.get(_ODR, 0) | value & 0xFFFF) & ~(value >> 16 & ~value))
        elif offset == _ODR:
            self._drive(value & 0xFFFF)
        else:
            self.values[offset] = value

    def _drive(self, levels: int) -> None:
        before = self.values.get(_ODR, 0)
        self.values[_ODR] = levels
        edges = before ^ levels
        while edges:
            pin = (edges & -edges).bit_length() - 1
            self.changed(f"{self.letter}{pin}", levels >> pin & 1)
            edges &= edges - 1


class EdgeInterrupts(Peripheral):
    """EXTI: an interrupt of its own for the first five lines, a common one for the next five and for the last six."""

    def __init__(self, base: int, core: Core, places: dict[str, int], known: list[int], selection: Peripheral,
                 selection_offset: int) -> None:
        """`places`: of "rising", "mask" and "pending". `selection`: SYSCFG, which says whose pin a line is."""
        self.KNOWN = frozenset(known)
        super().__init__("EXTI", base)
        self.core, self.places = core, places
        self.selection, self.selection_offset = selection, selection_offset
        self.interrupts = [6 + line if line < 5 else 23 if line < 10 else 40 for line in range(16)]
        for interrupt in set(self.interrupts):
            lines = sum(1 << line for line in range(16) if self.interrupts[line] == interrupt)
            core.system.lines[interrupt] = lambda lines=lines: bool(self._raised() & lines)

    def _raised(self) -> int:
        return self.values.get(self.places["pending"], 0) & self.values.get(self.places["mask"], 0)

    def rise(self, pin: str) -> None:
        """An edge on a pin ("C15")."""
        line = int(pin[1:])
        chosen = self.selection.values.get(self.selection_offset + 4 * (line // 4), 0) >> 4 * (line % 4) & 0xF
        if "ABCDEFGHIJK"[chosen] != pin[0] or not self.values.get(self.places["rising"], 0) >> line & 1:
            return
        pending = self.places["pending"]
        self.values[pending] = self.values.get(pending, 0) | 1 << line
        if self.values.get(self.places["mask"], 0) >> line & 1:
            self.core.system.raise_interrupt(self.interrupts[line])

    def write(self, offset: int, value: int) -> None:
        if offset == self.places["pending"]:
            self.values[offset] = self.values.get(offset, 0) & ~value
        else:
            self.values[offset] = value
