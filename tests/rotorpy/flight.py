"""One flight: what it starts from and has to follow, how it is flown, and the figures read off it.

Each control period: measure, compute, hold the rotor commands until the next. A flight ends when its time is over, or is lost:
200 m from the reference, or a state that is not finite. Nothing else ends it: a vehicle that is pushed away and comes back looks
at rest for a while.

Positions are true ones, in m, at the control ticks.
"""

import dataclasses

import numpy as np

from sensors import Noise, Sensors
from vehicle import PARAMETERS, Conditions, Start, Vehicle

LOST = 200.0  # m
NEAR = 0.1  # m
NEAR_FOR = 5.0  # s, at least, at the end of the flight
STEADY_FOR = 4.0  # s


@dataclasses.dataclass(frozen=True)
class Flight:
    reference: object  # a trajectory of RotorPy's: update(t) gives flat outputs
    duration: float  # s
    start: Start = Start()
    conditions: Conditions = Conditions()
    noise: Noise | None = None
    believed: tuple = ()  # the law's model where it differs: (section, key, number) changed in a copy of its file


@dataclasses.dataclass
class Record:
    period: float  # s
    position: np.ndarray  # at every tick
    error: np.ndarray  # position - reference
    thrusts: np.ndarray  # commanded, of each rotor, N
    clipped: int  # ticks at which a rotor was commanded beyond its limits
    lost: bool

    def last(self, duration):
        """The ticks of the last seconds."""
        return slice(-round(duration / self.period), None)

    def distance(self):
        return np.linalg.norm(self.error, axis=1)

    def height_lost(self):
        return float(self.position[0, 2] - self.position[:, 2].min())

    def rise(self):
        return float(self.position[:, 2].max() - self.position[0, 2])

    def arrival(self):
        """Time from which the vehicle is near its reference to the end, s. None if that is less than the last 5 s."""
        far = np.flatnonzero(self.distance() > NEAR)
        first = far[-1] + 1 if len(far) else 0
        return first * self.period if len(self.error) - first >= round(NEAR_FOR / self.period) else None

    def offset(self, duration=STEADY_FOR):
        """Distance of the mean error of the last seconds, m, and its speed from their first half to their second, m/s."""
        late = self.error[self.last(duration)]
        half = len(late) // 2
        drift = (late[half:].mean(axis=0) - late[:half].mean(axis=0)) / (half * self.period)
        return float(np.linalg.norm(late.mean(axis=0))), float(np.linalg.norm(drift))

    def deepest(self):
        return float(self.distance().max())

    def rms(self, duration):
        return float(np.sqrt((self.distance()[self.last(duration)] ** 2).mean()))

    def rotor_activity(self, duration):
        """How much a rotor's command changes from tick to tick, N: mean absolute value, and root mean square."""
        change = np.diff(self.thrusts[self.last(duration)], axis=0)
        return float(np.abs(change).mean()), float(np.sqrt((change**2).mean()))


def fly(flight, controller, period, step):
    """Flies it; `period` of the controller and `step` of the vehicle in s, one a whole multiple of the other."""
    vehicle = Vehicle(flight.conditions, flight.start, step)
    sensors = Sensors(flight.noise, period)
    positions, errors, thrusts, clipped, lost = [], [], [], 0, False
    for tick in range(round(flight.duration / period)):
        time = tick * period
        reference = flight.reference.update(time)
        error = vehicle.state["x"] - reference["x"]
        if not all(np.isfinite(part).all() for part in vehicle.state.values()) or np.linalg.norm(error) > LOST:
            lost = True
            break
        speeds, within = controller.command(time, period, sensors.measure(vehicle.state), reference)
        positions.append(vehicle.state["x"].copy())
        errors.append(error)
        thrusts.append(PARAMETERS["k_eta"] * speeds**2)
        clipped += not within
        vehicle.hold(speeds, time, period)
    return Record(period, np.array(positions), np.array(errors), np.array(thrusts), clipped, lost)
