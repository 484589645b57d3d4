"""BMI270 (Bosch BST-BMI270-DS000): measures once a file of 328 bytes was written into it."""

from schedule import NS_PER_MS
from sensors.inertial import GRAVITY, RATE_PER_COUNT, Inertial

_FILE = 0x5E
_FILE_BYTES = 328


class Bmi270(Inertial):
    """Section 5.2: data from 0x0C, INT1 by registers 0x53 and 0x58, 800 Hz."""

    PERIOD_NS = 1_250_000
    DATA = 0x0C
    LEADING_BYTES = 2
    SPEAKS_SPI_AT_ONCE = False

    def reset(self) -> None:
        super().reset()
        self.registers = {0x00: 0x24, 0x7C: 0x03}
        self._data, self._file = bytes(12), 0

    def measure(self) -> None:
        motion = self.wiring.motion
        self._data = (self.counts(motion.specific_force, 16.0 * GRAVITY / 32768.0)
                      + self.counts(motion.angular_velocity, RATE_PER_COUNT))

    def has_pin(self) -> bool:
        return bool(self.registers.get(0x58, 0) & 4 and self.registers.get(0x53, 0) & 8)

    def write(self, register: int, values: bytes) -> None:
        if register == _FILE:
            self._file += len(values)
        else:
            super().write(register, values)

    def set(self, register: int, value: int) -> None:
        if register == 0x7E and value == 0xB6:
            self.reset()
            return
        self.registers[register] = value
        if register == 0x59 and value == 1:
            # INTERNAL_STATUS: initialised, or an error.
            self.registers[0x21] = 1 if self._file == _FILE_BYTES else 2
        if register == 0x7D and value & 6 == 6:
            self.start(45 * NS_PER_MS)
