"""RotorPy, a simulator that others wrote, flies its Hummingbird under the law, in place of its own controller."""

import numpy as np
import pytest
import saturated_hybrid as sh
from rotorpy.controllers.quadrotor_control import SE3Control
from rotorpy.environments import Environment
from rotorpy.trajectories.circular_traj import ThreeDCircularTraj
from rotorpy.trajectories.hover_traj import HoverTraj
from rotorpy.trajectories.minsnap import MinSnap
from rotorpy.vehicles.crazyflie_params import quad_params as crazyflie
from rotorpy.vehicles.crazyfliebrushless_params import quad_params as brushless
from rotorpy.vehicles.hummingbird_params import quad_params as hummingbird
from rotorpy.vehicles.multirotor import Multirotor
from rotorpy.vehicles.px4_sihsim_quadx_params import quad_params as px4_sihsim
from rotorpy.world import World
from saturated_hybrid.rotorpy import SaturatedHybridControl

CIRCLE = ThreeDCircularTraj(radius=np.array([1, 1, 0]))
FREE = World.empty((-50, 50, -50, 50, -50, 50))


def flown(controller, trajectory, duration, start=None, quad_params=hummingbird, **options):
    vehicle = Multirotor(quad_params)
    if start is not None:
        vehicle.initial_state.update(start)
    environment = Environment(vehicle, controller, trajectory, world=FREE, **options)
    return environment.run(t_final=duration, use_mocap=False, terminate=False)


def distance(results):
    return np.linalg.norm(results["state"]["x"] - results["flat"]["x"], axis=1)


@pytest.mark.parametrize(
    "trajectory, near",
    [
        (HoverTraj(), 0.001),
        (CIRCLE, 0.02),
        # It states the snap of its end for ever after it, 47 m/s^4 at rest, and the law follows that: 66 mm.
        (MinSnap(np.array([[0, 0, 0], [1, 0, 1], [1, 1, 1], [0, 1, 0]]), v_avg=1.0), 0.1),
    ],
)
def test_rotorpys_example_trajectories_are_flown(trajectory, near):
    results = flown(SaturatedHybridControl(hummingbird), trajectory, 7)
    assert distance(results)[-100:].max() < near
    assert str(results["exit"].value).startswith("Timeout")


@pytest.mark.parametrize(
    "quad_params, near",
    [(crazyflie, 0.05), (brushless, 0.03), (px4_sihsim, 0.03)],
    ids=["crazyflie", "brushless", "px4_sihsim"],
)
def test_any_vehicle_of_rotorpys_flies_with_constants_that_are_certified(quad_params, near):
    controller = SaturatedHybridControl(quad_params)
    assert sh.certify(controller.scenario) and controller.scenario.law == "extended"
    slow = ThreeDCircularTraj(radius=np.array([1, 1, 0]), freq=np.array([0.1, 0.1, 0.0]))
    results = flown(controller, slow, 12, quad_params=quad_params)
    assert distance(results)[-200:].max() < near, distance(results)[-200:].max()
    half = np.sqrt(0.5)
    upside_down = {"x": np.array([0.0, 0.0, 8.0]), "q": np.array([half, half, 0.0, 0.0])}
    results = flown(SaturatedHybridControl(quad_params), HoverTraj(x0=np.array([0, 0, 8.0])), 12, upside_down, quad_params=quad_params)
    assert distance(results)[-100:].max() < 0.1, distance(results)[-100:].max()


def test_a_vehicle_that_cannot_be_certified_or_lacks_a_number_is_refused():
    weak = dict(crazyflie, rotor_speed_max=1850)
    with pytest.raises(ValueError, match="quad_params: not certified with the constants that follow from it: .*give a scenario"):
        SaturatedHybridControl(weak)
    with pytest.raises(ValueError, match="quad_params: 'tau_m' is missing"):
        SaturatedHybridControl({key: value for key, value in crazyflie.items() if key != "tau_m"})


def test_its_own_controllers_keys_and_shapes_are_ours():
    state = {"x": np.zeros(3), "v": np.zeros(3), "q": np.array([0, 0, 0, 1.0]), "w": np.zeros(3)}
    flat = CIRCLE.update(0.0)
    theirs, ours = (kind(hummingbird).update(0.0, state, flat) for kind in (SE3Control, SaturatedHybridControl))
    assert set(theirs) == set(ours)
    for key in theirs:
        assert np.shape(theirs[key]) == np.shape(ours[key]), key
        assert isinstance(ours[key], np.ndarray) == isinstance(theirs[key], np.ndarray) or key == "cmd_thrust"


def test_it_recovers_from_upside_down_facing_away():
    half = np.sqrt(0.5)
    upside_down = {"x": np.array([0.0, 0.0, 5.0]), "q": np.array([half, half, 0.0, 0.0])}
    results = flown(SaturatedHybridControl(hummingbird), HoverTraj(x0=np.array([0, 0, 5.0])), 8, upside_down)
    assert distance(results)[0:100].max() > 0.5
    assert distance(results)[-100:].max() < 0.1
    assert np.abs(results["state"]["q"][-1, 3]) > 0.99


def test_at_a_faster_simulator_the_command_is_held_between_ticks():
    results = flown(SaturatedHybridControl(hummingbird), CIRCLE, 1, sim_rate=500)
    speeds = results["control"]["cmd_motor_speeds"]
    changes = np.flatnonzero(np.any(np.diff(speeds, axis=0) != 0, axis=1))
    assert len(changes) > 90 and (np.diff(changes) == 5).all()


def test_the_command_is_the_laws_through_the_boards_mixer():
    controller = SaturatedHybridControl(hummingbird)
    law = sh.Law(controller.scenario)
    random = np.random.default_rng(2)
    trajectory = CIRCLE
    for tick in range(200):
        q = random.normal(size=4) + [0, 0, 0, 5]
        q /= np.linalg.norm(q)
        state = {"x": random.normal(size=3), "v": random.normal(size=3), "q": q, "w": random.normal(size=3)}
        flat = trajectory.update(0.01 * tick)
        control = controller.update(0.01 * tick, state, flat)
        measured = sh.state(state["x"], state["v"], np.roll(q, 1), state["w"])
        asked = sh.reference(flat["x"], flat["x_dot"], flat["x_ddot"], flat["x_dddot"], flat["x_ddddot"],
                             yaw=float(flat["yaw"]), yaw_rate=float(flat["yaw_dot"]), yaw_acceleration=float(flat.get("yaw_ddot", 0.0)))
        wrench = law.for_rotors(law.step(measured, asked)) 
        assert np.array_equal(wrench, np.r_[control["cmd_thrust"], control["cmd_moment"]])
        if not np.allclose(_delivered(control["cmd_motor_speeds"]), wrench, atol=1e-5):
            law.hold_estimates()


def _delivered(speeds):
    """Thrust and torque of rotors at these speeds, by RotorPy's own allocation."""
    return SE3Control(hummingbird).f_to_TM @ (hummingbird["k_eta"] * speeds**2)


def test_a_new_flight_begins_reset_and_times_off_the_clock_are_refused():
    controller = SaturatedHybridControl(hummingbird)
    state = {"x": np.ones(3), "v": np.zeros(3), "q": np.array([0, 0, 0, 1.0]), "w": np.zeros(3)}
    flat = HoverTraj().update(0.0)
    first = controller.update(0.0, state, flat)["cmd_motor_speeds"]
    for tick in range(1, 50):
        later = controller.update(0.01 * tick, state, flat)["cmd_motor_speeds"]
    assert not np.array_equal(first, later)
    assert np.array_equal(controller.update(0.0, state, flat)["cmd_motor_speeds"], first)
    with pytest.raises(ValueError, match="t: went on by 0.02 s, but the law runs every 0.01 s: set sim_rate to a multiple of 100 Hz"):
        controller.update(0.02, state, flat)


def test_another_vehicle_than_the_scenarios_is_refused_by_what_differs():
    scenario = sh.Scenario.built_in("hummingbird")
    with pytest.raises(ValueError, match="hummingbird: vehicle.mass: 0.5, but RotorPy's vehicle has 0.03"):
        SaturatedHybridControl(crazyflie, scenario)
    turned = dict(hummingbird, rotor_directions=-hummingbird["rotor_directions"])
    with pytest.raises(ValueError, match="rotors.spin"):
        SaturatedHybridControl(turned, scenario)
    with pytest.raises(ValueError, match="paper: rotors: the scenario has no such section"):
        SaturatedHybridControl(hummingbird, sh.Scenario.built_in("paper"))
