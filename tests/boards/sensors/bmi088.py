"""BMI088 (Bosch BST-BMI088-DS001): gyroscope and accelerometer, two devices in one package."""

from schedule import NS_PER_MS
from sensors.inertial import GRAVITY, RATE_PER_COUNT, Inertial

_SOFT_RESET = 0xB6
_READ = 0x80


class Gyroscope(Inertial):
    """Section 5.5: data from 0x02, INT3 by registers 0x15 and 0x18, 1000 Hz."""

    def reset(self) -> None:
        super().reset()
        self.registers = {0x00: 0x0F, 0x10: 0x80, 0x16: 0x0F}
        self._data = bytes(6)

    def measure(self) -> None:
        self._data = self.counts(self.wiring.motion.angular_velocity, RATE_PER_COUNT)

    def has_pin(self) -> bool:
        return bool(self.registers.get(0x15, 0) & 0x80 and self.registers.get(0x18, 0) & 1)

    def exchange(self, sent: bytes) -> bytes:
        first, answer = sent[0] & 0x7F, bytearray(len(sent))
        if sent[0] & _READ:
            for place in range(1, len(sent)):
                register = first + place - 1
                answer[place] = self._data[register - 2] if 2 <= register < 8 else self.registers.get(register, 0)
        else:
            self.settings.append((first, sent[1]))
            if first == 0x14 and sent[1] == _SOFT_RESET:
                self.reset()
            else:
                # The highest bit of the bandwidth reads as one.
                self.registers[first] = sent[1] | (0x80 if first == 0x10 else 0)
                if first == 0x15:
                    self.start(NS_PER_MS)
        return bytes(answer)


class Accelerometer(Inertial):
    """Section 5.3: data from 0x12, a byte that means nothing before each answer, SPI from its select's first edge."""

    PERIOD_NS = 625_000
    NOISE_COUNTS = 4.0

    def reset(self) -> None:
        super().reset()
        self.registers = {0x00: 0x1E, 0x40: 0xA8, 0x41: 0x01, 0x7C: 0x03}
        self._data, self._speaks_spi = bytes(6), False

    def chosen(self, level: int) -> None:
        super().chosen(level)
        self._speaks_spi |= level == 1

    def measure(self) -> None:
        self._data = self.counts(self.wiring.motion.specific_force, 24.0 * GRAVITY / 32768.0)

    def has_pin(self) -> bool:
        return False

    def exchange(self, sent: bytes) -> bytes:
        first, answer = sent[0] & 0x7F, bytearray(len(sent))
        if not self._speaks_spi:
            return bytes(answer)
        if sent[0] & _READ:
            for place in range(2, len(sent)):
                register = first + place - 2
                inside = 0x12 <= register < 0x18
                answer[place] = self._data[register - 0x12] if inside else self.registers.get(register, 0)
        else:
            self.settings.append((first, sent[1]))
            if first == 0x7E and sent[1] == _SOFT_RESET:
                self.reset()
            else:
                self.registers[first] = sent[1]
                if first == 0x7D and sent[1] == 0x04:
                    self.start(50 * NS_PER_MS)
        return bytes(answer)
