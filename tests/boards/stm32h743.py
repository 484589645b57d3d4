"""The STM32H743VI (RM0433): where its peripherals are, at the clocks that the firmware sets (400 MHz for the core, 200
MHz for timers, 100 MHz for serial lines and sensors).
"""

from unicorn import arm_const as arm

from card import Slot
from chip import BROWN_OUT, PIN, POWER, SOFTWARE, WATCHDOG, Chip, ResetAndClocks
from core import Core
from dma import Stream
from ears import SamplingTimer
from flash import FlashH743
from gpio import EdgeInterrupts
from peripheral import Peripheral, Store
from spi import MasterV4
from timers import PulseTimer, TimeBase
from uart import UartV3
from usb import UnpluggedPort
from watchdog import Watchdog

_TIMER_HZ, _SERIAL_HZ = 200_000_000, 100_000_000
PARAMETERS = 0x081C_0000

_REQUESTS = {
    15: "TIM1_UP", 22: "TIM2_UP", 30: "TIM4_CH2", 32: "TIM4_UP", 37: "SPI1_RX", 38: "SPI1_TX", 39: "SPI2_RX",
    40: "SPI2_TX", 41: "USART1_RX", 42: "USART1_TX", 51: "TIM8_UP", 61: "SPI3_RX", 62: "SPI3_TX", 79: "UART7_RX",
    80: "UART7_TX", 83: "SPI4_RX", 84: "SPI4_TX",
}
_SPIS = {"SPI1": 0x4001_3000, "SPI2": 0x4000_3800, "SPI3": 0x4000_3C00, "SPI4": 0x4001_3400}
_UARTS = {"USART1": (0x4001_1000, 37), "USART2": (0x4000_4400, 38), "USART6": (0x4001_1400, 71),
          "UART7": (0x4000_7800, 82)}
_TIMERS = {"TIM1": (0x4001_0000, True), "TIM8": (0x4001_0400, True), "TIM2": (0x4000_0000, False)}


class _Clocks(ResetAndClocks):
    """Chapter 8."""

    KNOWN = frozenset(range(0, 0x180, 4))
    RESET = {0x00: 0x83}
    READY = ((0, 2), (7, 8), (12, 13), (16, 17), (24, 25), (26, 27), (28, 29))
    FLAGS, FLAGS_CLEAR = 0xD0, 1 << 16
    RESETS = {
        0x7C: {16: "SDMMC1"},
        0x80: {0: "DMA1", 1: "DMA2", 5: "ADC1", 27: "OTG_FS"},
        0x88: {bit: f"GPIO{'ABCDEFGHIJK'[bit]}" for bit in range(11)},
        0x90: {0: "TIM2", 2: "TIM4", 3: "TIM5", 14: "SPI2", 15: "SPI3", 17: "USART2", 30: "UART7"},
        0x98: {0: "TIM1", 1: "TIM8", 4: "USART1", 5: "USART6", 12: "SPI1", 13: "SPI4"},
    }

    def read(self, offset: int) -> int:
        value = self.values.get(offset, 0)
        if offset == 0x00:
            # The domains' clocks are ready with their source (HSIDIVF).
            return self.ready(value) | 1 << 5
        if offset == 0x10:
            return value & ~0x38 | (value & 7) << 3
        if offset in (0x70, 0x74):
            return value & ~2 | (value & 1) << 1
        return value


class _Power(Peripheral):
    """Chapter 6: supplies and scales are ready at once."""

    KNOWN = frozenset(range(0, 0x30, 4))
    RESET = {0x00: 0xF000_C000, 0x0C: 0x46, 0x18: 0x4000}

    def __init__(self) -> None:
        super().__init__("PWR", 0x5802_4800)
        self.has_usb_supply = True

    def read(self, offset: int) -> int:
        value = self.values.get(offset, 0)
        if offset == 0x04:
            return value | 1 << 13 | (self.values.get(0x18, 0) >> 14 & 3) << 14
        if offset == 0x0C:
            return value | (1 << 26 if value >> 24 & 1 and self.has_usb_supply else 0)
        if offset == 0x18:
            return value | 1 << 13
        return value


class _Converter(Peripheral):
    """ADC1 (chapter 25): calibrated and ready at once, a conversion is over when it begins."""

    KNOWN = frozenset([*range(0, 0xD0, 4), 0x300, 0x308, 0x30C])

    def __init__(self) -> None:
        super().__init__("ADC1", 0x4002_2000)
        self.counts = 0

    def read(self, offset: int) -> int:
        if offset == 0x00:
            return self.values.get(offset, 0) | 1 | 1 << 12
        return self.counts if offset == 0x40 else self.values.get(offset, 0)

    def write(self, offset: int, value: int) -> None:
        if offset == 0x00:
            self.values[offset] = self.values.get(offset, 0) & ~value
        elif offset == 0x08:
            if value >> 2 & 1:
                self.values[0x00] = self.values.get(0x00, 0) | 0xC
            # ADCAL and ADSTART fall by themselves.
            self.values[offset] = value & ~(1 << 31 | 1 << 2)
        else:
            self.values[offset] = value


class Stm32H743(Chip):
    """The chip."""

    name = "STM32H743"
    VOLATILE = [(0x2000_0000, 0x2_0000), (0x2400_0000, 0x8_0000), (0x3000_0000, 0x4_8000), (0x3800_0000, 0x1_0000)]
    CAUSES = {POWER: 0x00E0_0000, BROWN_OUT: 0x0060_0000, PIN: 0x0040_0000, SOFTWARE: 0x0140_0000,
              WATCHDOG: 0x0440_0000}
    SYSTEM_MEMORY = 0x1FF0_0000
    BOOTLOADER = 0x1FF0_9800
    VECTORS = 0x0800_0000

    def __init__(self) -> None:
        memories = [(0x0000_0000, 0x1_0000), (0x0800_0000, PARAMETERS - 0x0800_0000), *self.VOLATILE,
                    (self.SYSTEM_MEMORY, 0x2_0000)]
        core = Core(arm.UC_CPU_ARM_CORTEX_M7, 0x411F_C271, 400_000_000, 4.0, memories)
        super().__init__(core)
        for address, size in [(0x4000_0000, 0x10_0000), (0x4802_0000, 0x1_0000), (0x5100_0000, 0x10_0000),
                              (0x5200_0000, 0x1_0000), (0x5800_0000, 0x3_0000), (0x5C00_1000, 0x1000)]:
            core.map_peripherals(address, size)
        self.clocks = self.add(_Clocks(0x5802_4400, self))
        self.power = self.add(_Power())
        self.flash = self.add(FlashH743(0x5200_2000, core, PARAMETERS, options=0x1BC6_AAF0 & ~0xC))
        self.watchdog = self.add(Watchdog(0x5800_4800, core.schedule, lambda: self.request_restart(WATCHDOG)))
        self._multiplexer = self.add(Store("DMAMUX1", 0x4002_0800, range(0, 0x90, 4)))
        reachable = [(0x2400_0000, 0x2408_0000), (0x3000_0000, 0x3004_8000), (0x3800_0000, 0x3801_0000),
                     (0x0800_0000, 0x0820_0000)]
        self.add_controllers((0x4002_0000, 0x4002_0400), reachable, self._request)
        self.add_ports(0x5802_0000, "ABCDEFGHIJK", {"A": 0xABFF_FFFF, "B": 0xFFFF_FEBF}, 0xFFFF_FFFF)
        selection = self.add(Store("SYSCFG", 0x5800_0400, range(0, 0x40, 4)))
        places = {"rising": 0x00, "mask": 0x80, "pending": 0x88}
        self.edges = self.add(EdgeInterrupts(0x5800_0000, core, places, list(range(0, 0xC0, 4)), selection, 0x08))
        for name, base in _SPIS.items():
            self.spis[name] = self.add(MasterV4(name, base, core, self.dma[0], _SERIAL_HZ))
        for name, (base, interrupt) in _UARTS.items():
            self.uarts[name] = self.add(UartV3(name, base, core, self.dma[0], _SERIAL_HZ, interrupt))
        for name, (base, is_advanced) in _TIMERS.items():
            made = lambda pulses: self.on_pulses(pulses)  # noqa: E731
            self.pulse_timers[name] = self.add(PulseTimer(name, base, core, self.dma[0], _TIMER_HZ, is_advanced, made))
        self.sampler = self.add(SamplingTimer("TIM4", 0x4000_0800, core, self.dma[1], _TIMER_HZ, self.ports,
                                              lambda *asked: self.on_samples(*asked)))
        self.time_base = self.add(TimeBase("TIM5", 0x4000_0C00, core, _TIMER_HZ, 50))
        self.converter = self.add(_Converter())
        self.slot = self.add(Slot(core, 49, (0x2400_0000, 0x2408_0000)))
        self.usb = self.add(UnpluggedPort(0x4008_0000, 0x2300))
        self.debug = self.add(Store("DBGMCU", 0x5C00_1000, [0x00, 0x04, 0x3C], {0x00: 0x2003_6450}))
        self.add(Store("AXI", 0x5100_8000, [0x108]))

    def _request(self, stream: Stream) -> str | None:
        first = 0 if stream.controller.name == "DMA1" else 8
        return _REQUESTS.get(self._multiplexer.values.get(4 * (first + stream.number), 0) & 0x7F)
