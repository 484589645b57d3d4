"""The three boards: what is wired to which pin, as docs/boards.md and firmware/src/boards/ have it, and what a whole
run of one is held to.
"""

from collections.abc import Callable
from dataclasses import dataclass

from card import Card
from chip import Chip
from escs import INTERVAL_MAX_NS, Escs, Output
from radio import RadioChip
from schedule import NS_PER_MS, Schedule
from sensors.bmi088 import Accelerometer, Gyroscope
from sensors.bmi270 import Bmi270
from sensors.icm42688 import Icm42688
from sensors.inertial import Inertial, Motion, Mounting, Wiring
from stm32f405 import Stm32F405
from stm32h743 import Stm32H743

_ALIGNED: Mounting = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@dataclass(frozen=True)
class Sensor:
    """A sensor's place: what makes it, its bus, its select and data-ready pins, its mounting."""

    make: Callable[[str, Wiring], Inertial]
    bus: str
    select: str
    data_ready: str | None
    mounting: Mounting


@dataclass(frozen=True)
class Wires:
    """A board."""

    feature: str
    chip: Callable[[], Chip]
    sensors: tuple[Sensor, ...]
    # By rotor.
    motors: tuple[Output, ...]
    link: str
    # The alternate function that each other pin must have been given.
    functions: dict[str, int]
    # Outputs that must be at a level in flight.
    levels: dict[str, int]
    # Counts of the converter for the battery, where the board measures it.
    battery_counts: int | None = None
    # Whether a memory card is in its slot: of the two boards that have one, one flies with it and one without.
    has_card: bool = False
    # The line to its radio chip, where it has one.
    radio: str | None = None


MICOAIR = Wires(
    feature="micoair-h743",
    chip=Stm32H743,
    sensors=(
        Sensor(Gyroscope, "SPI2", "D5", "C15", ((0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))),
        Sensor(Accelerometer, "SPI2", "D4", None, ((0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))),
        Sensor(Bmi270, "SPI3", "A15", "B7", _ALIGNED),
    ),
    motors=(Output("TIM1", 4, False, "E14", 1), Output("TIM1", 3, False, "E13", 1),
            Output("TIM1", 2, False, "E11", 1), Output("TIM1", 1, False, "E9", 1)),
    link="USART1",
    functions={"D3": 5, "C2": 5, "C3": 5, "B3": 6, "B4": 6, "D6": 5, "A9": 7, "A10": 7},
    levels={},
    # 16 V through a divider of 21.12.
    battery_counts=round(16.0 / 21.12 / 3.3 * 65535),
    has_card=True,
)
MATEK = Wires(
    feature="matek-h743",
    chip=Stm32H743,
    sensors=(
        Sensor(lambda select, wiring: Icm42688(select, wiring, 0x47), "SPI1", "C15", "B2",
               ((-1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, -1.0))),
        Sensor(lambda select, wiring: Icm42688(select, wiring, 0x42), "SPI4", "C13", "E15",
               ((0.0, 1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, -1.0))),
    ),
    motors=(Output("TIM8", 2, True, "B0", 3), Output("TIM8", 3, True, "B1", 3),
            Output("TIM2", 1, False, "A0", 1), Output("TIM2", 2, False, "A1", 1)),
    link="UART7",
    functions={"A5": 5, "A6": 5, "D7": 5, "E12": 5, "E13": 5, "E14": 5, "E7": 7, "E8": 7},
    levels={"A15": 0},
    battery_counts=round(16.0 / 11.0 / 3.3 * 65535),
)
BOLT = Wires(
    feature="crazyflie-bolt",
    chip=Stm32F405,
    sensors=(
        Sensor(Gyroscope, "SPI2", "B0", "C14", _ALIGNED),
        Sensor(Accelerometer, "SPI2", "B1", None, _ALIGNED),
    ),
    motors=(Output("TIM2", 2, False, "A1", 1), Output("TIM2", 4, False, "B11", 1),
            Output("TIM2", 1, False, "A15", 1), Output("TIM2", 3, False, "B10", 1)),
    link="USART2",
    functions={"B13": 5, "B14": 5, "B15": 5, "A2": 7, "A3": 7, "C6": 8, "C7": 8},
    levels={"A0": 1, "B12": 1, "C8": 1, "C15": 1},
    radio="USART6",
)
BOARDS = {"micoair": MICOAIR, "matek": MATEK, "bolt": BOLT}


class Board:
    """A board with its image in flash."""

    def __init__(self, name: str, image: str) -> None:
        self.name, self.wires = name, BOARDS[name]
        chip = self.chip = self.wires.chip()
        self.core, self.motion = chip.core, Motion()
        self.escs = Escs(chip.core.schedule, self.wires.motors, chip.ports)
        chip.on_pulses, chip.on_samples = self.escs.take, self.escs.levels
        self.sensors = [self._wire(sensor) for sensor in self.wires.sensors]
        self._selects = {sensor.select: sensor for sensor in self.sensors}
        chip.on_pin = self._pin
        self.link = chip.uarts[self.wires.link]
        radio = self.wires.radio
        self.radio = None if radio is None else RadioChip(chip.uarts[radio], chip.core.schedule)
        if self.wires.battery_counts is not None:
            chip.converter.counts = self.wires.battery_counts
        if self.wires.has_card:
            chip.slot.card = Card()
        self.vectors = self.core.load(image)
        # Why it was started again, each time.
        self.restarts: list[str] = []
        # Called after each start of the chip, before its first instruction.
        self.on_start: Callable[[], None] = lambda: None

    @property
    def schedule(self) -> Schedule:
        """Vehicle time."""
        return self.core.schedule

    def _wire(self, sensor: Sensor) -> Inertial:
        pin = sensor.data_ready
        edge = (lambda: None) if pin is None else (lambda: self.chip.edges.rise(pin))
        made = sensor.make(sensor.select, Wiring(self.motion, sensor.mounting, self.chip.core.schedule, edge))
        self.chip.spis[sensor.bus].devices.append(made)
        return made

    def _pin(self, pin: str, level: int) -> None:
        device = self._selects.get(pin)
        if device is not None:
            device.chosen(level)

    def start(self, cause: str) -> None:
        """A reset, or power; then the image from its vector table, as the hardware does."""
        self.chip.reset(cause)
        if self.vectors == self.chip.VECTORS:
            # Where the core looks for vectors after a reset.
            self.core.system.values[0xD08] = self.vectors
        self.on_start()
        self.core.begin(self.vectors)

    def run(self, duration_ns: int, restarts: bool = True) -> None:
        """Runs for so long; a chip that resets itself starts again, if it may."""
        end = self.schedule.now + duration_ns
        while self.schedule.now < end:
            self.core.run(end)
            cause = self.core.stopped
            if cause is None:
                continue
            if cause not in self.chip.CAUSES or not restarts:
                raise AssertionError(f"{self.name} stopped at {self.schedule.now / 1e9:.6f} s: {cause}")
            self.restarts.append(cause)
            self.start(cause)

    def complaints(self) -> list[str]:
        """All that went wrong at its pins, on its buses and in its registers since power came."""
        wrong = [f"register {name} {offset}, {kind} {count} times: no model knows it"
                 for (name, offset, kind), count in self.core.bus.unknown.items()]
        for controller in self.chip.dma:
            wrong += [f"DMA {key}, {count} times: not memory that it reaches, or another register"
                      for key, count in controller.unreachable.items()]
        for name, spi in self.chip.spis.items():
            wrong += [f"{name}: {what}, {count} times" for what, count in spi.wrong.items()]
        wrong += [f"motors: {what}, {count} times" for what, count in self.escs.wrong.items()]
        wrong += [f"{self.chip.sampler.name}: {what}, {count} times" for what, count in self.chip.sampler.wrong.items()]
        wrong += [f"flash: {what}" for what in self.chip.flash.wrong]
        if self.chip.slot is not None:
            wrong += [f"SDMMC1: {what}, {count} times: not memory that it reaches"
                      for what, count in self.chip.slot.unreachable.items()]
        return wrong

    def flight_complaints(self) -> list[str]:
        """What else must hold of a board that has flown."""
        wrong = self.complaints()
        for pin, function in self.wires.functions.items():
            found = self.chip.ports[pin[0]].function(int(pin[1:]))
            if found != function:
                wrong.append(f"P{pin} has alternate function {found}, not {function}")
        for pin, level in self.wires.levels.items():
            port = self.chip.ports[pin[0]]
            if not port.is_output(int(pin[1:])) or port.values.get(0x14, 0) >> int(pin[1:]) & 1 != level:
                wrong.append(f"P{pin} is not driven to {level}")
        if self.escs.longest_interval_ns > INTERVAL_MAX_NS:
            wrong.append(f"{self.escs.longest_interval_ns / 1e6:.2f} ms between two frames")
        if abs(self.link.baud / 921_600 - 1) > 0.02:
            wrong.append(f"{self.link.baud:.0f} baud")
        if self.radio is not None:
            wrong += self.radio.complaints()
        if self.chip.watchdog.longest_wait_ns > 30 * NS_PER_MS:
            wrong.append(f"{self.chip.watchdog.longest_wait_ns / 1e6:.1f} ms between two feeds of the watchdog")
        return wrong
