"""A quadrotor controller whose limits are proven before take-off: law, certificate, governor, tuning and flights.

    import saturated_hybrid as sh

    scenario = sh.Scenario.built_in("hummingbird")
    print(sh.certify(scenario))                  # certified, or why not
    flight = sh.fly(scenario)                    # flight.columns: what log.csv holds, as numpy arrays

Everywhere: SI units and rad; world frame with z up, body frame x forward, y left, z up; rotations and quaternions body
to world, quaternions scalar first. Arrays of rows are

    state      13   p(3) v(3) world | q(4) scalar first | omega(3) body
    reference  19   p_d(3) v(3) a(3) j(3) s(3) world | heading nu_x nu_y, a unit vector | psi' psi''
    wrench      4   thrust along body z, N | torque(3) body, N m
    demand      4   acceleration(3) world, m/s^2 | yaw rate, rad/s
                5   attitude q(4) scalar first | thrust, N

An input that cannot be used is a `ValueError` that names the field and the reason; an argument of a wrong
type is a `TypeError`, whose note names it. Well-posed work that comes to nothing (a flight that diverges, a
search that finds no gains) is a `RuntimeError`, and so is a call of an object that another thread uses. Long work lets
other threads run, and Ctrl-C ends it.

`saturated_hybrid.environment` has Gymnasium's environments, `saturated_hybrid.tasks` two that `gymnasium.make` knows,
`saturated_hybrid.rotorpy` a controller for RotorPy.
"""

from importlib.metadata import version as _version

from ._core import (
    Allocation,
    Campaign,
    Certificate,
    Claim,
    Flight,
    Governor,
    Inequality,
    Law,
    LawRows,
    Loop,
    Network,
    RotorVehicle,
    Scenario,
    Shield,
    ShieldRows,
    Tuned,
    Vehicle,
    VehicleRows,
    campaign,
    certify,
    fly,
    merge,
    picture,
    reference,
    replay,
    state,
    tune,
)

try:
    from gymnasium import register as _register
except ImportError:
    pass
else:
    for _task in ("Hover", "Gate"):
        _where = f"saturated_hybrid.tasks:{_task}"
        _register(f"saturated_hybrid/{_task}-v0", entry_point=_where, vector_entry_point=f"{_where}Rows")

__version__ = _version("saturated-hybrid")

__all__ = [
    "Allocation",
    "Campaign",
    "Certificate",
    "Claim",
    "Flight",
    "Governor",
    "Inequality",
    "Law",
    "LawRows",
    "Loop",
    "Network",
    "RotorVehicle",
    "Scenario",
    "Shield",
    "ShieldRows",
    "Tuned",
    "Vehicle",
    "VehicleRows",
    "campaign",
    "certify",
    "fly",
    "merge",
    "picture",
    "reference",
    "replay",
    "state",
    "tune",
]
