"""What the tests share: the repository's program and scenarios."""

import os
import pathlib
import subprocess

import numpy as np
import pytest

TOP = pathlib.Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def host_sim():
    """The program `host-sim`: the one that HOST_SIM names, or else the workspace's."""
    program = pathlib.Path(os.environ.get("HOST_SIM", TOP / "target" / "debug" / "host-sim"))
    if not program.exists():
        pytest.fail(f"{program} is missing; cargo build -p host-sim builds it")

    def run(*arguments, **options):
        return subprocess.run([program, *map(str, arguments)], text=True, capture_output=True, timeout=120, **options)

    return run


@pytest.fixture(scope="session")
def logged(host_sim, tmp_path_factory):
    """log.csv of the repository's program for a scenario's text: each column by its name."""

    def fly(text):
        folder = tmp_path_factory.mktemp("flight")
        file = folder / "scenario.toml"
        file.write_text(text)
        flown = host_sim("fly", file, "--out", folder)
        assert flown.returncode in (0, 1), flown.stderr
        with open(folder / "log.csv") as log:
            names = log.readline().strip().split(",")
            return dict(zip(names, np.loadtxt(log, delimiter=",", unpack=True)))

    return fly
