"""What is flown, and the figures of each flight: the rows of the table.

Every flight has RotorPy's drag and motor lag unless it says otherwise, and starts at rest, on the circle in motion.
"""

import dataclasses

import numpy as np
from rotorpy.trajectories.circular_traj import ThreeDCircularTraj
from rotorpy.trajectories.hover_traj import HoverTraj

from flight import Flight
from sensors import Noise
from vehicle import Conditions, Start

# Durations, s, and how long the last part is that the circle's and the noisy hover's figures are of.
RECOVERY, HOLDING, STEP, CIRCLE, NOISY = 15.0, 30.0, 15.0, 40.0, 30.0
CIRCLE_FIGURE, NOISY_FIGURE = 20.0, 20.0
CIRCLE_FREQUENCY = 0.25  # Hz

# The law feeds drag forward and reckons with lag, as its file says; where there is neither, its file says so.
IDEAL = (("estimates", "drag_across", 0.0), ("rotors", "lag", 0.0))


@dataclasses.dataclass(frozen=True)
class Row:
    name: str
    figure: str  # what a cell says, with units
    flight: Flight
    measure: object  # from a Record to a dict of figures, by name
    eased: bool = False  # for RotorPy's controller with eased attitude gains only


def recovered(record):
    return {"height_lost": record.height_lost(), "risen": record.rise(), "arrival": record.arrival()}


def arrived(record):
    return {"arrival": record.arrival()}


def held(record):
    offset, drift = record.offset()
    return {"offset": offset, "drift": drift}


def deepest(record):
    return {"deepest": record.deepest(), "drift": record.offset()[1]}


def circled(record):
    return {"rms": record.rms(CIRCLE_FIGURE), "drift": record.offset(2 / CIRCLE_FREQUENCY)[1]}


def noisy(record):
    mean, root_mean_square = record.rotor_activity(NOISY_FIGURE)
    return {"rms": record.rms(NOISY_FIGURE), "rotor_change": mean, "rotor_change_rms": root_mean_square}


def hover(x=0.0):
    return HoverTraj(np.array([x, 0.0, 0.0]))


def recovery(name, roll, yaw):
    flight = Flight(hover(), RECOVERY, Start(roll=roll, yaw=yaw))
    return Row(f"hover from {name}", "height lost, risen [m], within 0.1 m [s]", flight, recovered)


def holding(**conditions):
    return Flight(hover(), HOLDING, conditions=Conditions(**conditions))


def offset(name, flight):
    return Row(f"hover, {name}", "steady offset [m]", flight, held)


def gust(name, flight):
    return Row(f"{name} begins in hover", "deepest excursion [m]", flight, deepest)


def step(metres):
    return Row(f"step of {metres} m", "within 0.1 m [s]", Flight(hover(metres), STEP), arrived)


def circle(name, believed=(), **conditions):
    reference = ThreeDCircularTraj(np.zeros(3), np.array([1.0, 1.0, 0.0]), np.array([CIRCLE_FREQUENCY] * 2 + [0.0]))
    start = Start(*(tuple(reference.update(0.0)[name].tolist()) for name in ("x", "x_dot")))
    flight = Flight(reference, CIRCLE, start=start, conditions=Conditions(**conditions), believed=believed)
    return Row(f"circle 1 m, 0.25 Hz, {name}", "RMS [m]", flight, circled)


def noisy_hover(name, bandwidth, accelerometer=None):
    noise = Noise(gyro=0.01, position=0.002, attitude=np.radians(0.2), bandwidth=bandwidth, delay=0.02,
                  accelerometer=accelerometer)
    flight = Flight(hover(), NOISY, noise=noise)
    figure = "RMS [m], mean rotor command change [N/tick]"
    return [Row(f"hover with noise, 20 ms late, {name}{gains}", figure, flight, noisy, eased)
            for gains, eased in (("", False), (", gains eased", True))]


def rows():
    push, blow = holding(acceleration=(1.0, 0.0, 0.0)), holding(acceleration=(2.5, 0.0, 0.0))
    wind = holding(wind=(5.0, 0.0, 0.0))
    return [
        *(recovery(f"roll {roll}, yaw 100 off", float(roll), 100.0) for roll in (0, 90, 135, 170, 179, 180)),
        *(recovery(f"roll {roll}, yaw as it should be", float(roll), 0.0) for roll in (179, 180)),
        offset("1 m/s^2", push),
        offset("5 m/s wind", wind),
        offset("thrust 20 % low", holding(rotor_thrust=(0.8,) * 4)),
        offset("thrust 20 % high", holding(rotor_thrust=(1.2,) * 4)),
        offset("mass 20 % high", holding(mass=1.2)),
        offset("centre of mass 5 mm off", holding(centre_of_mass=(0.005, 0.0, 0.0))),
        offset("one rotor 5 % weak", holding(rotor_thrust=(0.95, 1.0, 1.0, 1.0))),
        gust("5 m/s wind", wind),
        gust("2.5 m/s^2", blow),
        step(1),
        step(10),
        circle("ideal: no drag, no lag", IDEAL, drag=False, lag=False),
        circle("drag and lag"),
        circle("drag and lag, 5 m/s wind", wind=(5.0, 0.0, 0.0)),
        *noisy_hover("exact velocity", None),
        *noisy_hover("velocity from an observer", 8.0, accelerometer=0.05),
        *noisy_hover("velocity from positions, 20 rad/s", 20.0),
        *noisy_hover("velocity from positions, 40 rad/s", 40.0),
    ]
