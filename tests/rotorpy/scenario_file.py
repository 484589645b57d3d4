"""The scenario file whose law flies: is it RotorPy's vehicle, and copies of it with other values."""

import re
import tomllib

import numpy as np

from vehicle import GRAVITY, PARAMETERS


def check_vehicle(file):
    """Refuses a scenario of another vehicle than RotorPy's: its law would fly a body that it has no model of."""
    try:
        with open(file, "rb") as text:
            scenario = tomllib.load(text)
    except (OSError, tomllib.TOMLDecodeError) as error:
        raise ValueError(f"{file}: {error}") from error
    theirs = {
        "vehicle": {
            "mass": PARAMETERS["mass"],
            "inertia": [PARAMETERS[name] for name in ("Ixx", "Iyy", "Izz")],
            "gravity": GRAVITY,
        },
        "rotors": {
            "position": list(PARAMETERS["rotor_pos"].values()),
            "spin": [{1: "cw", -1: "ccw"}[turning] for turning in PARAMETERS["rotor_directions"]],
            "thrust_coefficient": PARAMETERS["k_eta"],
            "drag_coefficient": PARAMETERS["k_m"],
            "speed": [PARAMETERS["rotor_speed_min"], PARAMETERS["rotor_speed_max"]],
            "lag": PARAMETERS["tau_m"],
        },
    }
    for section, keys in theirs.items():
        for key, wanted in keys.items():
            found = scenario.get(section, {}).get(key)
            if found is None or not same(found, wanted):
                wanted = np.asarray(wanted).tolist()
                raise ValueError(f"{file}: {section}.{key}: {found}, but RotorPy's vehicle has {wanted}")


def same(found, wanted):
    """Equal, numbers to the five digits that files carry."""
    if np.shape(found) != np.shape(wanted):
        return False
    if np.asarray(wanted).dtype.kind == "U":
        return found == wanted
    return np.allclose(np.asarray(found, float), np.asarray(wanted, float), rtol=1e-5, atol=0.0)


def changed(text, changes):
    """The text of a scenario with other values, ((section, key, number), ...). A key stands on a line of its own or not at all:
    what follows from a vehicle's numbers can be given as well. `host-sim` refuses a key that it does not know."""
    for section, key, value in changes:
        place = re.compile(rf"(^\[{section}\][^\n]*\n(?:(?!\[)[^\n]*\n)*?{key} = )[^\s#]+", re.MULTILINE)
        text, found = place.subn(rf"\g<1>{value!r}", text)
        if found == 0 and f"[{section}]" in text:
            text = text.replace(f"[{section}]\n", f"[{section}]\n{key} = {value!r}\n", 1)
        elif found == 0:
            text += f"\n[{section}]\n{key} = {value!r}\n"
    return text
