"""What the inertial sensors have in common: a motion that is measured, a pace, a data-ready pin, noise.

Counts are of a sensor's own axes: `Mounting` turns the body's into them. A sensor's own filters are left out.
"""

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


@dataclass
class Motion:
    """The true motion now, in the body's axes."""

    angular_velocity: Vector = (0.0, 0.0, 0.0)
    specific_force: Vector = (0.0, 0.0, GRAVITY)


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
    # Noise of one reading, counts, and the gyroscope's constant error.
    NOISE_COUNTS = 2.0

    def __init__(self, select: str, wiring: Wiring) -> None:
        super().__init__(select)
        self.wiring = wiring
        self.registers: dict[int, int] = {}
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
