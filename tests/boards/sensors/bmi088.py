"""BMI088 (Bosch BST-BMI088-DS001): gyroscope and accelerometer, two devices in one package."""

from schedule import NS_PER_MS
from sensors.inertial import GRAVITY, RATE_PER_COUNT, Inertial

_SOFT_RESET = 0xB6


class Gyroscope(Inertial):
    """Section 5.5: data from 0x02, INT3 by registers 0x15 and 0x18, 1000 Hz."""

    DATA = 0x02

    def reset(self) -> None:
        super().reset()
        self.registers = {0x00: 0x0F, 0x10: 0x80, 0x16: 0x0F}
        self._data = bytes(6)

    def measure(self) -> None:
        self._data = self.counts(self.wiring.motion.angular_velocity, RATE_PER_COUNT)

    def has_pin(self) -> bool:
        return bool(self.registers.get(0x15, 0) & 0x80 and self.registers.get(0x18, 0) & 1)

    def set(self, register: int, value: int) -> None:
        if register == 0x14 and value == _SOFT_RESET:
            self.reset()
            return
        # The highest bit of the bandwidth reads as one.
        self.registers[register] = value | (0x80 if register == 0x10 else 0)
        if register == 0x15:
            self.start(NS_PER_MS)


class Accelerometer(Inertial):
    """Section 5.3: data from 0x12, a byte that means nothing before each answer, SPI from its select's first edge."""

    PERIOD_NS = 625_000
    NOISE_COUNTS = 4.0
    DATA = 0x12
    LEADING_BYTES = 2
    SPEAKS_SPI_AT_ONCE = False

    def reset(self) -> None:
        super().reset()
        self.registers = {0x00: 0x1E, 0x40: 0xA8, 0x41: 0x01, 0x7C: 0x03}
        self._data = bytes(6)

    def measure(self) -> None:
        self._data = self.counts(self.wiring.motion.specific_force, 24.0 * GRAVITY / 32768.0)

    def has_pin(self) -> bool:
        return False

    def set(self, register: int, value: int) -> None:
        if register == 0x7E and value == _SOFT_RESET:
            self.reset()
            return
        self.registers[register] = value
        if register == 0x7D and value == 0x04:
            self.start(50 * NS_PER_MS)
