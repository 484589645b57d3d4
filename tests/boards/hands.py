"""A person's hands on the emulated vehicle that stands: what its sensors and the motion capture show of that. Words and
speeds are those of `host-sim sitl --hands` (host-sim/src/sessions/sitl/hands.rs).
"""

import math

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]

# How fast hands turn it, rad/s, and carry it, m/s.
_TURN_RAD_PER_S, _CARRY_M_PER_S = 1.2, 0.5
_STEP_S = 0.001
_THIRD, _QUARTER = math.pi / 6.0, math.pi / 2.0
# Nose up is a turn about left by a negative angle.
_HOLDS: dict[str, Vector] = {
    "flat": (0.0, 0.0, 0.0), "turned-left": (0.0, 0.0, 0.0),
    "nose-up": (0.0, -_THIRD, 0.0), "left-up": (_THIRD, 0.0, 0.0),
    "on-tail": (0.0, -_QUARTER, 0.0), "on-nose": (0.0, _QUARTER, 0.0),
    "on-right": (_QUARTER, 0.0, 0.0), "on-left": (-_QUARTER, 0.0, 0.0), "on-back": (math.pi, 0.0, 0.0),
}


def product(a: Quaternion, b: Quaternion) -> Quaternion:
    """Of two quaternions, scalar first."""
    (s, x, y, z), (t, u, v, w) = a, b
    return (s * t - x * u - y * v - z * w, s * u + x * t + y * w - z * v, s * v - x * w + y * t + z * u,
            s * w + x * v - y * u + z * t)


def _conjugate(q: Quaternion) -> Quaternion:
    return q[0], -q[1], -q[2], -q[3]


def _turned(axis: Vector) -> Quaternion:
    angle = math.sqrt(sum(x * x for x in axis))
    share = 0.5 if angle < 1e-9 else math.sin(0.5 * angle) / angle
    return math.cos(0.5 * angle), axis[0] * share, axis[1] * share, axis[2] * share


def _axis(q: Quaternion) -> Vector:
    sine = math.sqrt(q[1] ** 2 + q[2] ** 2 + q[3] ** 2)
    angle = 2.0 * math.atan2(sine, abs(q[0]))
    share = 0.0 if sine < 1e-9 else math.copysign(angle / sine, q[0])
    return q[1] * share, q[2] * share, q[3] * share


def _capped(vector: Vector, most: float) -> Vector:
    length = math.sqrt(sum(x * x for x in vector))
    share = min(1.0, most / length) if length > 0.0 else 0.0
    return vector[0] * share, vector[1] * share, vector[2] * share


class Hands:
    """What they do, and how far that is."""

    def __init__(self) -> None:
        self._hold, self._spin = (1.0, 0.0, 0.0, 0.0), 0.0
        self._place: Vector = (0.0, 0.0, 0.0)
        self.turn: Quaternion = (1.0, 0.0, 0.0, 0.0)
        self.rate: Vector = (0.0, 0.0, 0.0)
        self.carried: Vector = (0.0, 0.0, 0.0)
        self.is_seen = True

    def take(self, line: str) -> None:
        """Does as a line says."""
        match line.split():
            case []:
                pass
            case [word] if word in _HOLDS:
                self._hold, self._spin = _turned(_HOLDS[word]), float(word == "turned-left")
            case ["hide" | "show" as word]:
                self.is_seen = word == "show"
            case ["carry", x, y, z]:
                self._place = float(x), float(y), float(z)
            case _:
                raise ValueError(f"{line!r}: hands know {', '.join(_HOLDS)}, hide, show, carry EAST NORTH UP")

    def pass_step(self) -> None:
        """Goes on for a millisecond."""
        step = _capped(_axis(product(_conjugate(self.turn), self._hold)), _TURN_RAD_PER_S * _STEP_S)
        self.turn = product(self.turn, _turned(step))
        self.rate = step[0] / _STEP_S, step[1] / _STEP_S, step[2] / _STEP_S + self._spin
        east, north, up = (goal - at for goal, at in zip(self._place, self.carried))
        way = _capped((east, north, up), _CARRY_M_PER_S * _STEP_S)
        self.carried = tuple(at + by for at, by in zip(self.carried, way))  # type: ignore[assignment]

    @property
    def are_still(self) -> bool:
        """Whether they have turned it as far as they were told to."""
        return max(abs(rate) for rate in self.rate) < 1e-3

    def felt(self, rate: Vector, force: Vector) -> tuple[Vector, Vector]:
        """Body rates and specific force of the vehicle that is held."""
        _, *held = product(product(_conjugate(self.turn), (0.0, *force)), self.turn)
        return (rate[0] + self.rate[0], rate[1] + self.rate[1], rate[2] + self.rate[2]), (held[0], held[1], held[2])

    def seen(self, position: Vector, attitude: Quaternion) -> tuple[Vector, Quaternion]:
        """Where it is."""
        place = position[0] + self.carried[0], position[1] + self.carried[1], position[2] + self.carried[2]
        return place, product(attitude, self.turn)
