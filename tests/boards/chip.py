"""What both chips have in common: what a chip is made of, and how it starts."""

from collections.abc import Callable
from typing import Any

from card import Slot
from core import Core
from dma import Controller, Stream
from ears import SamplingTimer
from flash import Flash
from gpio import EdgeInterrupts, Port
from peripheral import Peripheral
from spi import Master
from timers import PulseTimer, Pulses, TimeBase
from uart import Uart
from watchdog import Watchdog

# Why a chip starts, as its flags can say it.
POWER, BROWN_OUT, PIN, SOFTWARE, WATCHDOG = "power", "brown-out", "pin", "software", "watchdog"

# The DMA streams' interrupts: the same in both vector tables.
_STREAM_INTERRUPTS = [[11, 12, 13, 14, 15, 16, 17, 47], [56, 57, 58, 59, 60, 68, 69, 70]]


class Chip:
    """A chip. Its models are in these places; whoever wires a board takes them from there."""

    # Memory that is lost without power: (address, bytes).
    VOLATILE: list[tuple[int, int]] = []
    # Bits of the reset flags for each cause.
    CAUSES: dict[str, int] = {}
    # Where bootloaders may leave it other than after a reset; see spoiled.py.
    name = ""

    def __init__(self, core: Core) -> None:
        self.core = core
        self.dma: list[Controller] = []
        self.ports: dict[str, Port] = {}
        self.spis: dict[str, Master] = {}
        self.uarts: dict[str, Uart] = {}
        self.pulse_timers: dict[str, PulseTimer] = {}
        self.sampler: SamplingTimer
        self.clocks: ResetAndClocks
        self.edges: EdgeInterrupts
        self.flash: Flash
        self.watchdog: Watchdog
        self.time_base: TimeBase
        self.slot: Slot | None = None
        self.cause = POWER
        # Told of every edge of an output, and of pulses.
        self.on_pin: Callable[[str, int], None] = lambda pin, level: None
        self.on_pulses: Callable[[Pulses], None] = lambda pulses: None
        # Asked for the levels of a port's pins at so many times, from a first one at a distance, ns.
        self.on_samples: Callable[[Port, float, float, int], list[int]] = lambda port, first, period, count: [0] * count
        self.restarts: list[str] = []
        core.system.on_reset_request = lambda: self.request_restart(SOFTWARE)

    def add(self, peripheral: Any) -> Any:
        """Puts a peripheral on the bus."""
        self.core.bus.add(peripheral)
        return peripheral

    def add_controllers(self, bases: tuple[int, int], reachable: list[tuple[int, int]],
                        request: Callable[[Stream], str | None]) -> None:
        """Both DMA controllers."""
        for number, base in enumerate(bases):
            interrupts = _STREAM_INTERRUPTS[number]
            controller = Controller(f"DMA{number + 1}", base, self.core, interrupts, reachable, request)
            self.dma.append(self.add(controller))

    def add_ports(self, base: int, letters: str, modes: dict[str, int], other_modes: int) -> None:
        """The ports, with what their pins are after a reset."""
        for number, letter in enumerate(letters):
            port = Port(letter, base + 0x400 * number, modes.get(letter, other_modes),
                        lambda pin, level: self.on_pin(pin, level))
            self.ports[letter] = self.add(port)

    def request_restart(self, cause: str) -> None:
        """Has the core stop where it is; `start` begins anew."""
        self.core.stopped = cause
        self.core.uc.emu_stop()

    def reset(self, cause: str) -> None:
        """As after a reset for that reason. Memory that needs power is filled with what may be there after it came."""
        self.cause = cause
        for peripheral in self.core.bus.peripherals:
            peripheral.reset()
        self.clocks.began(self.CAUSES[cause])
        if cause in (POWER, BROWN_OUT):
            for address, size in self.VOLATILE:
                self.core.uc.mem_write(address, b"\xa5" * size)
        self.core.reset()


class ResetAndClocks(Peripheral):
    """RCC: clocks are ready as soon as they are turned on; the crystal only where the board has one that runs."""

    # (turns on, is ready) bits of CR, the crystal's, and where the flags of the last reset are.
    READY: tuple[tuple[int, int], ...] = ()
    CRYSTAL = (16, 17)
    FLAGS = 0
    FLAGS_CLEAR = 0
    # Registers that reset peripherals: {offset: {bit: the peripheral's name}}.
    RESETS: dict[int, dict[int, str]] = {}

    def __init__(self, base: int, chip: Chip) -> None:
        super().__init__("RCC", base)
        self.chip = chip
        self.crystal_runs = True

    def began(self, flags: int) -> None:
        """The chip was reset, and these are its flags."""
        self.values[self.FLAGS] = flags

    def ready(self, value: int) -> int:
        """CR with what is ready."""
        for on, is_ready in self.READY:
            runs = value >> on & 1 and (on != self.CRYSTAL[0] or self.crystal_runs)
            value = value & ~(1 << is_ready) | (1 << is_ready if runs else 0)
        return value

    def write(self, offset: int, value: int) -> None:
        if offset == self.FLAGS and value & self.FLAGS_CLEAR:
            self.values[offset] = 0
            return
        if offset in self.RESETS:
            for bit, name in self.RESETS[offset].items():
                if value >> bit & 1:
                    for peripheral in self.chip.core.bus.peripherals:
                        if peripheral.name == name:
                            peripheral.reset()
        self.values[offset] = value
