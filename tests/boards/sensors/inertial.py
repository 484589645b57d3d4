"""What the inertial sensors have in common: a motion that is measured, a pace, a data-ready pin, noise.

Counts are of a sensor's own axes: `Mounting` turns the body's into them. The sensors' own filters are second-order
Butterworth ones of a BMI088's bandwidths, for all of them: a touchdown's blow lasts a millisecond, and a sensor without
a filter would show it once, twice or not at all.
"""

import math
import random
from collections.abc import Callable
from dataclasses import dataclass, field

from schedule import Schedule
from spi import Device

GRAVITY = 9.80665
# The range of all gyroscopes here: 2000 degrees a second in 16 bits.
RATE_PER_COUNT = 2000.0 / 32768.0 * 3.141592653589793 / 180.0

Vector = tuple[float, float, float]
# Rows of a rotation from a sensor's axes to the body's, as in the boards' files.
Mounting = tuple[Vector, Vector, Vector]


def to_sensor(mounting: Mounting, body: Vector) -> Vector:
    """A vector of the body's axes in the sensor's: the transposed rotation."""
    x, y, z = (sum(mounting[row][axis] * body[row] for row in range(3)) for axis in range(3))
    return x, y, z


MOTION_HZ = 1000.0
_GYRO_BANDWIDTH_HZ, _ACCELEROMETER_BANDWIDTH_HZ = 116.0, 145.0
# The range of the accelerometers, m/s^2.
_FORCE_MAX = 24.0 * GRAVITY


class _LowPass:
    """A second-order Butterworth filter of three axes, at [`MOTION_HZ`], by the bilinear transform."""

    def __init__(self, bandwidth_hz: float, value: Vector) -> None:
        k = math.tan(math.pi * bandwidth_hz / MOTION_HZ)
        scale = 1.0 / (1.0 + math.sqrt(2.0) * k + k * k)
        self._b, self._a1 = k * k * scale, 2.0 * (k * k - 1.0) * scale
        self._a2 = (1.0 - math.sqrt(2.0) * k + k * k) * scale
        self._states = [(x * (1.0 - self._b), x * (self._b - self._a2)) for x in value]

    def filter(self, value: Vector) -> Vector:
        """The next output."""
        b, a1, a2 = self._b, self._a1, self._a2
        output = []
        for axis, x in enumerate(value):
            first, second = self._states[axis]
            y = b * x + first
            self._states[axis] = (2.0 * b * x - a1 * y + second, b * x - a2 * y)
            output.append(y)
        return output[0], output[1], output[2]


class Motion:
    """The motion as sensors' filters show it, in the body's axes: rad/s and m/s^2."""

    def __init__(self) -> None:
        self.angular_velocity: Vector = (0.0, 0.0, 0.0)
        self.specific_force: Vector = (0.0, 0.0, GRAVITY)
        self._gyro = _LowPass(_GYRO_BANDWIDTH_HZ, self.angular_velocity)
        self._accelerometer = _LowPass(_ACCELEROMETER_BANDWIDTH_HZ, self.specific_force)

    def feel(self, angular_velocity: Vector, specific_force: Vector) -> None:
        """The true motion of the next millisecond."""
        cut = tuple(max(-_FORCE_MAX, min(_FORCE_MAX, force)) for force in specific_force)
        self.angular_velocity = self._gyro.filter(angular_velocity)
        self.specific_force = self._accelerometer.filter(cut)


@dataclass
class Wiring:
    """Where a sensor is."""

    motion: Motion
    mounting: Mounting
    schedule: Schedule
    # The data-ready pin rises.
    edge: Callable[[], None]
    draw: random.Random = field(default_factory=lambda: random.Random(1))


class Inertial(Device):
    """A device with registers and a pace."""

    PERIOD_NS = 1_000_000
    # Noise of one reading, counts.
    NOISE_COUNTS = 2.0
    # Where the samples are among the registers, how many bytes of an answer precede the first register's, and whether
    # it speaks SPI before its select pin ever rose.
    DATA = 0
    LEADING_BYTES = 1
    SPEAKS_SPI_AT_ONCE = True

    def __init__(self, select: str, wiring: Wiring) -> None:
        super().__init__(select)
        self.wiring = wiring
        self.registers: dict[int, int] = {}
        self._data = b""
        self._generation = 0
        # Set by who spoils a run: no edges any more, or none while it is on.
        self.is_silent = False
        # Settings that it was given, (register, value), in their order.
        self.settings: list[tuple[int, int]] = []
        self.samples = 0
        self.reset()

    def reset(self) -> None:
        """As after its own reset: it measures nothing."""
        self._generation += 1
        self._speaks_spi = self.SPEAKS_SPI_AT_ONCE

    def chosen(self, level: int) -> None:
        super().chosen(level)
        self._speaks_spi |= level == 1

    def exchange(self, sent: bytes) -> bytes:
        first, answer = sent[0] & 0x7F, bytearray(len(sent))
        if self._speaks_spi and sent[0] & 0x80:
            for place in range(self.LEADING_BYTES, len(sent)):
                answer[place] = self.read(first + place - self.LEADING_BYTES)
        elif self._speaks_spi:
            self.write(first, sent[1:])
        return bytes(answer)

    def read(self, register: int) -> int:
        """What a register holds."""
        place = register - self.DATA
        return self._data[place] if 0 <= place < len(self._data) else self.registers.get(register, 0)

    def write(self, register: int, values: bytes) -> None:
        """Sets a register: the first value, but for what takes more of them."""
        self.settings.append((register, values[0]))
        self.set(register, values[0])

    def set(self, register: int, value: int) -> None:
        """What a setting does."""
        raise NotImplementedError

    def start(self, wait_ns: int) -> None:
        """Begins to measure, the first time after `wait_ns`."""
        self._generation += 1
        self.wiring.schedule.after(wait_ns, self._tick, self._generation)

    def _tick(self, generation: int) -> None:
        if generation != self._generation:
            return
        self.wiring.schedule.after(self.PERIOD_NS, self._tick, generation)
        self.measure()
        self.samples += 1
        if not self.is_silent and self.has_pin():
            self.wiring.edge()

    def measure(self) -> None:
        """Takes a sample of the motion."""
        raise NotImplementedError

    def has_pin(self) -> bool:
        """Whether its settings make its pin rise."""
        raise NotImplementedError

    def counts(self, body: Vector, per_count: float, order: str = "little") -> bytes:
        """Three readings of 16 bits, with noise."""
        sensed = to_sensor(self.wiring.mounting, body)
        noisy = (value / per_count + self.wiring.draw.gauss(0.0, self.NOISE_COUNTS) for value in sensed)
        cut = (max(-32768, min(32767, round(value))) for value in noisy)
        return b"".join(value.to_bytes(2, order, signed=True) for value in cut)
