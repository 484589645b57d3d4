"""BMI270 (Bosch BST-BMI270-DS000): measures once a file of 328 bytes was written into it."""

from schedule import NS_PER_MS
from sensors.inertial import GRAVITY, RATE_PER_COUNT, Inertial

_READ = 0x80
_FILE_BYTES = 328


class Bmi270(Inertial):
    """Section 5.2: data from 0x0C, INT1 by registers 0x53 and 0x58, 800 Hz."""

    PERIOD_NS = 1_250_000

    def reset(self) -> None:
        super().reset()
        self.registers = {0x00: 0x24, 0x7C: 0x03}
        self._data, self._speaks_spi, self._file = bytes(12), False, 0

    def chosen(self, level: int) -> None:
        super().chosen(level)
        self._speaks_spi |= level == 1

    def measure(self) -> None:
        motion = self.wiring.motion
        self._data = (self.counts(motion.specific_force, 16.0 * GRAVITY / 32768.0)
                      + self.counts(motion.angular_velocity, RATE_PER_COUNT))

    def has_pin(self) -> bool:
        return bool(self.registers.get(0x58, 0) & 4 and self.registers.get(0x53, 0) & 8)

    def exchange(self, sent: bytes) -> bytes:
        first, answer = sent[0] & 0x7F, bytearray(len(sent))
        if not self._speaks_spi:
            return bytes(answer)
        if sent[0] & _READ:
            for place in range(2, len(sent)):
                register = first + place - 2
                inside = 0x0C <= register < 0x18
                answer[place] = self._data[register - 0x0C] if inside else self.registers.get(register, 0)
        elif first == 0x5E:
            self._file += len(sent) - 1
        else:
            self.settings.append((first, sent[1]))
            if first == 0x7E and sent[1] == 0xB6:
                self.reset()
                return bytes(answer)
            self.registers[first] = sent[1]
            if first == 0x59 and sent[1] == 1:
                # INTERNAL_STATUS: initialised, or an error.
                self.registers[0x21] = 1 if self._file == _FILE_BYTES else 2
            if first == 0x7D and sent[1] & 6 == 6:
                self.start(45 * NS_PER_MS)
        return bytes(answer)
