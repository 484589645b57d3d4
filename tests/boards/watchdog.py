"""The independent watchdog: RM0433 chapter 46, RM0090 chapter 21. Its clock is taken to be exact."""

from collections.abc import Callable

from peripheral import Peripheral
from schedule import NS_PER_S, Schedule

_LSI_HZ = 32_000
_KEY, _PRESCALER, _RELOAD = 0x00, 0x04, 0x08


class Watchdog(Peripheral):
    """Restarts the chip unless it is fed; nothing but a restart stops it."""

    KNOWN = frozenset([0x00, 0x04, 0x08, 0x0C, 0x10])
    RESET = {_RELOAD: 0xFFF, 0x10: 0xFFF}

    def __init__(self, base: int, schedule: Schedule, bites: Callable[[], None]) -> None:
        super().__init__("IWDG", base)
        self.schedule, self.bites = schedule, bites
        self.is_running, self._generation = False, 0
        self.feeds, self.last_feed_ns, self.longest_wait_ns = 0, 0, 0

    def reset(self) -> None:
        super().reset()
        self.is_running, self._generation, self.feeds = False, self._generation + 1, 0

    def timeout_ns(self) -> int:
        """By its settings."""
        ticks = (self.values[_RELOAD] + 1) * (4 << min(6, self.values.get(_PRESCALER, 0)))
        return ticks * NS_PER_S // _LSI_HZ

    def start(self) -> None:
        """Starts it, as the firmware or a bootloader does."""
        self.is_running = True
        self._feed()

    def _feed(self) -> None:
        now = self.schedule.now
        if self.is_running:
            if self.feeds:
                self.longest_wait_ns = max(self.longest_wait_ns, now - self.last_feed_ns)
            self.feeds, self.last_feed_ns = self.feeds + 1, now
            self._generation += 1
            self.schedule.after(self.timeout_ns(), self._starves, self._generation)

    def _starves(self, generation: int) -> None:
        if generation == self._generation:
            self.bites()

    def read(self, offset: int) -> int:
        return self.values.get(offset, 0) if offset != 0x0C else 0

    def write(self, offset: int, value: int) -> None:
        if offset == _KEY and value == 0xAAAA:
            self._feed()
        elif offset == _KEY and value == 0xCCCC:
            self.start()
        else:
            self.values[offset] = value
