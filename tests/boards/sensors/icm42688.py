"""ICM-42688-P (TDK DS-000347) and ICM-42605 (DS-000292): registers in banks."""

from schedule import NS_PER_MS
from sensors.inertial import GRAVITY, RATE_PER_COUNT, Inertial, Wiring

_BANK = 0x76
_NO_DATA = bytes([0x80, 0x00]) * 6


class Icm42688(Inertial):
    """Data from 0x1F of the first bank, INT1 by register 0x65, 1000 Hz."""

    def __init__(self, select: str, wiring: Wiring, identity: int) -> None:
        self._identity = identity
        super().__init__(select, wiring)

    def reset(self) -> None:
        super().reset()
        self._banks = {
            0: {0x75: self._identity, 0x4C: 0x30, 0x4D: 0x91, 0x64: 0x10, 0x65: 0x10, 0x4F: 0x06, 0x50: 0x06,
                0x52: 0x11},
            1: {0x0C: 0x0D, 0x0D: 0xAA, 0x0E: 0x80},
            2: {0x03: 0x18, 0x04: 0x40, 0x05: 0x62},
        }
        self._bank, self._data = 0, _NO_DATA

    def measure(self) -> None:
        motion = self.wiring.motion
        # INTF_CONFIG0, bit 4: the higher byte first.
        order = "big" if self._banks[0][0x4C] >> 4 & 1 else "little"
        self._data = (self.counts(motion.specific_force, 16.0 * GRAVITY / 32768.0, order)
                      + self.counts(motion.angular_velocity, RATE_PER_COUNT, order))

    def has_pin(self) -> bool:
        return bool(self._banks[0].get(0x65, 0) & 8)

    def read(self, register: int) -> int:
        if register == _BANK:
            return self._bank
        if self._bank == 0 and 0x1F <= register < 0x2B:
            return self._data[register - 0x1F]
        return self._banks.get(self._bank, {}).get(register, 0)

    def set(self, register: int, value: int) -> None:
        if register == _BANK:
            self._bank = value & 7
        elif self._bank == 0 and register == 0x11 and value & 1:
            self.reset()
        else:
            self._banks.setdefault(self._bank, {})[register] = value
            if self._bank == 0 and register == 0x4E and value & 0xF == 0xF:
                self.start(30 * NS_PER_MS)
