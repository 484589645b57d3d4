"""The STM32F405RG (RM0090): where its peripherals are, at the clocks that the firmware sets (168 MHz for the core, 84
and 168 MHz for timers, 42 MHz for serial lines and the sensor, 84 MHz for the radio chip's).
"""

from unicorn import arm_const as arm

from chip import BROWN_OUT, PIN, POWER, SOFTWARE, WATCHDOG, Chip, ResetAndClocks
from core import Core
from dma import Stream
from ears import SamplingTimer
from flash import FlashF405
from gpio import EdgeInterrupts
from peripheral import Store
from spi import MasterV1
from timers import PulseTimer, TimeBase
from uart import UartV1
from usb import UnpluggedPort
from watchdog import Watchdog

_TIMER_HZ, _SERIAL_HZ = 84_000_000, 42_000_000
PARAMETERS = 0x080C_0000

# Table 42: what a stream listens to, by its channel.
_REQUESTS = {(1, 3): "TIM2_UP", (3, 0): "SPI2_RX", (4, 0): "SPI2_TX", (5, 4): "USART2_RX", (6, 4): "USART2_TX",
             (7, 3): "TIM2_UP"}
# And table 43, of the second controller.
_REQUESTS_2 = {(1, 7): "TIM8_UP", (2, 5): "USART6_RX", (3, 7): "TIM8_CH2", (7, 5): "USART6_TX"}


class _Clocks(ResetAndClocks):
    """Chapter 7."""

    KNOWN = frozenset(range(0, 0x90, 4))
    RESET = {0x00: 0x83, 0x04: 0x2400_3010, 0x30: 0x0010_0000}
    READY = ((0, 1), (16, 17), (24, 25), (26, 27))
    FLAGS, FLAGS_CLEAR = 0x74, 1 << 24
    RESETS = {
        0x10: {**{bit: f"GPIO{'ABCDEFGHI'[bit]}" for bit in range(9)}, 21: "DMA1", 22: "DMA2"},
        0x14: {7: "OTG_FS"},
        0x20: {0: "TIM2", 3: "TIM5", 14: "SPI2", 17: "USART2", 18: "USART3"},
        0x24: {1: "TIM8", 5: "USART6", 14: "SYSCFG"},
    }

    def read(self, offset: int) -> int:
        value = self.values.get(offset, 0)
        if offset == 0x00:
            return self.ready(value)
        if offset == 0x08:
            return value & ~0xC | (value & 3) << 2
        if offset in (0x70, 0x74):
            return value & ~2 | (value & 1) << 1
        return value


class Stm32F405(Chip):
    """The chip. Its CCM, where the flight recorder is, is closed to the DMA controllers."""

    name = "STM32F405"
    VOLATILE = [(0x2000_0000, 0x2_0000), (0x1000_0000, 0x1_0000)]
    CAUSES = {POWER: 0x0E00_0000, BROWN_OUT: 0x0600_0000, PIN: 0x0400_0000, SOFTWARE: 0x1400_0000,
              WATCHDOG: 0x2400_0000}
    SYSTEM_MEMORY = 0x1FFF_0000
    BOOTLOADER = 0x1FFF_0000
    VECTORS = 0x0800_4000

    def __init__(self) -> None:
        memories = [(0x0800_0000, PARAMETERS - 0x0800_0000), *self.VOLATILE, (self.SYSTEM_MEMORY, 0x1_0000)]
        core = Core(arm.UC_CPU_ARM_CORTEX_M4, 0x410F_C241, 168_000_000, 9.0, memories)
        super().__init__(core)
        for address, size in [(0x4000_0000, 0x8_0000), (0x5000_0000, 0x4_0000)]:
            core.map_peripherals(address, size)
        self.clocks = self.add(_Clocks(0x4002_3800, self))
        self.power = self.add(Store("PWR", 0x4000_7000, [0x00, 0x04], {0x00: 0x4000}, {0x04: 1 << 14}))
        # No brown-out level, as delivered: BOR_LEV is 0b11.
        self.flash = self.add(FlashF405(0x4002_3C00, core, PARAMETERS, options=0x0FFF_AAED | 0xC))
        self.watchdog = self.add(Watchdog(0x4000_3000, core.schedule, lambda: self.request_restart(WATCHDOG)))
        reachable = [(0x2000_0000, 0x2002_0000), (0x0800_0000, 0x0810_0000)]
        self.add_controllers((0x4002_6000, 0x4002_6400), reachable, self._request)
        self.add_ports(0x4002_0000, "ABCDEFGHI", {"A": 0xA800_0000, "B": 0x0000_0280}, 0)
        selection = self.add(Store("SYSCFG", 0x4001_3800, range(0, 0x24, 4)))
        places = {"rising": 0x08, "mask": 0x00, "pending": 0x14}
        self.edges = self.add(EdgeInterrupts(0x4001_3C00, core, places, list(range(0, 0x18, 4)), selection, 0x08))
        self.spis["SPI2"] = self.add(MasterV1("SPI2", 0x4000_3800, core, self.dma[0], _SERIAL_HZ))
        for name, base, interrupt in (("USART2", 0x4000_4400, 38), ("USART3", 0x4000_4800, 39)):
            self.uarts[name] = self.add(UartV1(name, base, core, self.dma[0], _SERIAL_HZ, interrupt))
        # On the faster bus.
        line = UartV1("USART6", 0x4001_1400, core, self.dma[1], 2 * _SERIAL_HZ, 71)
        self.uarts["USART6"] = self.add(line)
        made = lambda pulses: self.on_pulses(pulses)  # noqa: E731
        timer = PulseTimer("TIM2", 0x4000_0000, core, self.dma[0], _TIMER_HZ, False, made)
        self.pulse_timers["TIM2"] = self.add(timer)
        # The timers of the faster bus count twice as fast.
        self.sampler = self.add(SamplingTimer("TIM8", 0x4001_0400, core, self.dma[1], 2 * _TIMER_HZ, self.ports,
                                              lambda *asked: self.on_samples(*asked)))
        self.time_base = self.add(TimeBase("TIM5", 0x4000_0C00, core, _TIMER_HZ, 50))
        self.usb = self.add(UnpluggedPort(0x5000_0000, 0x1200))
        self.debug = self.add(Store("DBGMCU", 0xE004_2000, [0x00, 0x04, 0x08, 0x0C], {0x00: 0x100F_6413}))

    @staticmethod
    def _request(stream: Stream) -> str | None:
        requests = _REQUESTS if stream.controller.name == "DMA1" else _REQUESTS_2
        return requests.get((stream.number, stream.control >> 25 & 7))
