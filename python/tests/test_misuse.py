"""What makes no sense is refused in words, and takes neither the interpreter down nor for ever."""

import subprocess
import sys

import numpy as np
import pytest
import saturated_hybrid as sh
from saturated_hybrid.environment import VectorEnvironment
from saturated_hybrid.rotorpy import SaturatedHybridControl

PAPER = sh.Scenario.built_in("paper")
HUMMINGBIRD = sh.Scenario.built_in("hummingbird")


@pytest.mark.parametrize(
    "given, found",
    [
        ([1, None, 2], "object"),
        (["1", "2", "3"], "<U1"),
        (np.array([1j, 2, 3]), "complex128"),
        (np.zeros(3, "datetime64[D]"), "datetime64"),
        (np.zeros(3, [("a", "f4")]), "'a'"),
        (np.array([1, 2, 3], object), "object"),
    ],
)
def test_what_numpy_would_make_numbers_of_is_no_array_of_numbers(given, found):
    for call in (sh.state, sh.reference, sh.Governor(PAPER).start, lambda given: sh.Governor(PAPER).accept(None, given)):
        with pytest.raises(ValueError, match="(position|velocity): must be an array of numbers, found one of") as refused:
            call(given)
        assert found in str(refused.value)


def test_numbers_of_any_type_order_and_stride_are_the_same_numbers():
    wanted = sh.state([1, 2, 3])
    read_only = np.array([1, 2, 3])
    read_only.flags.writeable = False
    for given in (
        (1, 2, 3), range(1, 4), read_only, np.array([1, 2, 3], np.uint8), np.array([1, 2, 3], ">f4"), np.array([1, 2, 3], np.float16),
        np.array([1, 2, 3], np.longdouble), np.array([3, 2, 1.0])[::-1], np.array([[1, 9], [2, 9], [3, 9]])[:, 0],
    ):
        assert np.array_equal(sh.state(given), wanted), given


MILLION = "must be a whole number from 0 to 1000000, found"


@pytest.mark.parametrize(
    "call, said",
    [
        (lambda: sh.LawRows(PAPER, -1), f"rows: {MILLION} -1"),
        (lambda: sh.LawRows(PAPER, 2**63), f"rows: {MILLION} {2**63}"),
        (lambda: sh.LawRows(PAPER, 10**9), f"rows: {MILLION} {10**9}"),
        (lambda: sh.VehicleRows(PAPER, 10**30), f"rows: {MILLION} 1{'0' * 30}"),
        (lambda: sh.VehicleRows(PAPER, 10**5000), f"rows: {MILLION} one of thousands of digits"),
        (lambda: VectorEnvironment(PAPER, 2).reset(seed=[1, -3]), "seed: must not be below zero, found -3"),
        (lambda: SaturatedHybridControl({"mass": 0.5}), "quad_params: 'Ixx' is missing"),
        (lambda: VectorEnvironment(PAPER, -1), f"rows: {MILLION} -1"),
        (lambda: sh.VehicleRows(PAPER, 1).place([sh.state()], None, [-1]), "seeds: must be a whole number from 0 to 18446744073709551615"),
        (lambda: sh.Governor(PAPER).run(-1), "ticks: must be a whole number from 0 to 10000000, found -1"),
        (lambda: sh.tune(PAPER, generations=-1), "generations: must be a whole number from 1 to 4294967295, found -1"),
        (lambda: sh.tune(PAPER, generations=0), "generations: must be a whole number from 1 to 4294967295, found 0"),
        (lambda: sh.tune(PAPER, recovery=0.05), "recovery: must be from 2 to 3600 s, found 0.05"),
        (lambda: sh.tune(PAPER, recovery=np.nan), "recovery: must be from 2 to 3600 s, found NaN"),
        (lambda: sh.tune(PAPER, seed=2**64), "seed: must be a whole number from 0 to 18446744073709551615"),
        (lambda: sh.campaign(PAPER, "nowhere", flights=0), "flights: must be a whole number from 1 to 100000000, found 0"),
        (lambda: sh.campaign(PAPER, "nowhere", seed=-1), "seed: must be a whole number"),
        (lambda: sh.campaign(PAPER, "nowhere", shard=(3, 2)), r"shard: must be \(I, N\) with I from 1 to N, found \(3, 2\)"),
        (lambda: sh.campaign(PAPER, "nowhere", shard=(-1, 2)), r"shard: must be \(I, N\) with I from 1 to N, found \(-1, 2\)"),
        (lambda: sh.campaign(PAPER.edited({"ground.height": 0.0}), "nowhere"), r"paper \(built in\): ground: a campaign throws"),
        (lambda: sh.Law(PAPER).for_rotors([np.nan, 0, 0, 0]), "wrench: must be finite"),
        (lambda: sh.LawRows(PAPER, 1).for_rotors([[1e39, 0, 0, 0]]), "row 0: wrench: must be finite"),
        (lambda: sh.VehicleRows(PAPER, 2).step([[1, 0, 0, 0], [1e39, 0, 0, 0]]), "row 1: wrench: must be finite"),
        (lambda: sh.Allocation(HUMMINGBIRD).speeds([1, np.nan, 1, 1]), "thrusts: must be finite and not below zero, found NaN"),
        (lambda: sh.Allocation(HUMMINGBIRD).speeds([1, 1, -1, 1]), "thrusts: must be finite and not below zero, found -1"),
        (lambda: sh.Governor(HUMMINGBIRD).start([0, 0, 1], [4, 3.01, 0]),
         "velocity: must be at most the scenario's reference_bounds.horizontal_speed across, 5 m/s, found 5.006"),
        (lambda: sh.Governor(HUMMINGBIRD).accept([None, 0, 1], [1, 0, 0], [0, 1, 0]), "acceleration: needs a position on every axis"),
        (lambda: PAPER.edited({"wind": {1: 2}}), '"wind": its keys must be text, found 1'),
        (lambda: PAPER.edited({"wind": {"gust": {None: 2}}}), '"wind.gust": its keys must be text, found None'),
        (lambda: PAPER.edited({"vehicle.mass": 2**63}), '"vehicle.mass": must be a whole number of at most 64 bits'),
        (lambda: PAPER.edited({"name": "\udc80"}), '"name": must be text that UTF-8 has'),
    ],
)
def test_what_makes_no_sense_is_refused_by_name(call, said):
    with pytest.raises(ValueError, match=said):
        call()


def test_a_governor_starts_at_the_greatest_speed_of_the_scenario():
    governor = sh.Governor(HUMMINGBIRD)
    governor.start([0, 0, 1], [4, 3, 0])
    assert np.hypot(*governor.run(10)[:, 3:5].T).max() <= 5 * (1 + 1e-6)


def test_a_change_that_holds_itself_is_refused():
    endless = []
    endless.append(endless)
    round_about = {}
    round_about["steady"] = round_about
    for changes in ({"vehicle.inertia": endless}, {"wind": round_about}):
        with pytest.raises(ValueError, match="lies too deep in lists and dictionaries"):
            PAPER.edited(changes)


FORKED = """
import os, signal, numpy as np, saturated_hybrid as sh
scenario = sh.Scenario.built_in("paper")
laws, vehicles = sh.LawRows(scenario, 2000), sh.VehicleRows(scenario, 2000)
states = np.tile(sh.state([0, 0, 1]), (2000, 1))
asked = np.tile(sh.reference([0, 0, 1]), (2000, 1))
wrenches = laws.step(states, asked)
vehicles.step(wrenches)
child = os.fork()
if child == 0:
    signal.alarm(20)
    laws.reset()
    assert np.array_equal(laws.step(states, asked), wrenches)
    vehicles.step(wrenches)
    sh.campaign(scenario.edited({"duration": 0.1}), "forked", flights=2)
    os._exit(0)
_, status = os.waitpid(child, 0)
laws.step(states, asked)
raise SystemExit(status)
"""


def test_a_forked_process_has_threads_of_its_own(tmp_path):
    done = subprocess.run([sys.executable, "-c", FORKED], cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
