"""What an agent is to do: what subclasses define, kinds of action, the registered tasks, pictures and replays."""

import gymnasium
import numpy as np
import pytest
import saturated_hybrid as sh
from gymnasium.utils.env_checker import check_env
from PIL import Image
from saturated_hybrid.environment import Environment, Task, VectorEnvironment
from saturated_hybrid.tasks import GATE, POINT, Gate, GateRows, HoverRows, scenario_of

HUMMINGBIRD = sh.Scenario.built_in("hummingbird")
IDS = ["saturated_hybrid/Hover-v0", "saturated_hybrid/Gate-v0"]
START = sh.state([0.2, 0.0, 1.5])


class Mine:
    """Everything that a task may define."""

    def __init__(self, *arguments, **options):
        self.told = []
        super().__init__(*arguments, **options)

    def observation(self, rows):
        return np.concatenate([rows[..., 13:16] - rows[..., :3], rows[..., 3:6]], axis=-1)

    def reward(self, rows, actions):
        return 100.0 * rows[..., 2] + actions[..., 0]

    def terminated(self, rows):
        return rows[..., 2] < 1.4

    def drawn(self, random):
        return sh.state([random.uniform(), 0.0, 1.5])

    def begun(self, rows, chosen):
        self.told.append(("begun", np.array(chosen)))

    def moved(self, rows, actions):
        self.told.append(("moved", rows[..., 2]))

    def things(self):
        self.told.append(("things", None))
        return [np.zeros((2, 3))]


class MyOne(Mine, Environment):
    pass


class MyRows(Mine, VectorEnvironment):
    pass


def test_everything_that_a_task_may_define_counts_in_one_vehicle_as_in_rows():
    hooks = {name for name, member in vars(Task).items() if callable(member)}
    assert hooks == {name for name, member in vars(Mine).items() if callable(member)} - {"__init__"}
    one, rows = MyOne(HUMMINGBIRD, render_mode="rgb_array"), MyRows(HUMMINGBIRD, 3, render_mode="rgb_array")
    assert one.observation_space.shape == (6,) and rows.observation_space.shape == (3, 6)
    for environment in (one, rows):
        environment.told.clear()
    first, _ = one.reset(seed=5)
    many, _ = rows.reset(seed=4)
    assert np.array_equal(many[1], first) and first.shape == (6,) and abs(first[0]) <= 1.0
    falling = np.array([2.0, 0.0, 0.0, 0.0])
    for tick in range(40):
        alone, together = one.step(falling), rows.step(np.tile(falling, (3, 1)))
        assert np.array_equal(together[0][1], alone[0]) and together[1][1] == alone[1] and together[2][1] == alone[2]
        assert alone[1] == pytest.approx(100.0 * one.vehicles.states[0, 2] + 2.0, rel=1e-5)
        if alone[2]:
            break
    assert alone[2] and one.vehicles.states[0, 2] < 1.4 and 5 < tick < 30
    one.render(), rows.render()
    for environment in (one, rows):
        assert {name for name, _ in environment.told} == {"begun", "moved", "things"}
        assert [name for name, _ in environment.told].count("moved") == tick + 1
    rows.step(np.zeros((3, 4)))
    assert rows.told[-1][0] == "begun" and rows.told[-1][1].tolist() == [True] * 3


def test_an_answer_of_another_shape_is_refused_by_name():
    class Short(VectorEnvironment):
        def reward(self, rows, actions):
            return 1.0

    class Long(Environment):
        def terminated(self, rows):
            return rows[:2] > 0

    for environment, actions, said in [
        (Short(HUMMINGBIRD, 2), np.zeros((2, 4)), r"reward: must have shape \(2,\), found \(\)"),
        (Long(HUMMINGBIRD), np.zeros(4), r"terminated: must have shape \(\), found \(2,\)"),
    ]:
        environment.reset(seed=1)
        with pytest.raises(ValueError, match=said):
            environment.step(actions)


@pytest.mark.parametrize("action", ["wrench", "acceleration", "forward", "attitude"])
@pytest.mark.parametrize("name", ["hummingbird", "paper"])
def test_zero_of_a_scaled_action_hovers_and_its_ends_are_the_bounds(action, name):
    scenario = scenario_of(
        sh.Scenario.built_in(name).edited({"drag": None} if name == "hummingbird" else {}), [0.0, 0.0, 1.5]
    )
    scaled = VectorEnvironment(scenario, 2, start="scenario", action=action, scaled=True)
    plain = VectorEnvironment(scenario, 2, start="scenario", action=action)
    assert np.all(scaled.action_space.low == -1.0) and np.all(scaled.action_space.high == 1.0)
    scaled.reset(seed=1)
    for _ in range(100):
        scaled.step(np.zeros((2, 4)))
    assert np.abs(scaled.vehicles.states[:, :3] - [0.0, 0.0, 1.5]).max() < 1e-3
    # The same flight in the columns' own units; what is beyond one is one.
    ends = np.stack([plain.single_action_space.low, plain.single_action_space.high])
    scaled.reset(seed=1), plain.reset(seed=1)
    for _ in range(5):
        scaled.step(np.array([[-1.0] * 4, [7.0] * 4])), plain.step(ends)
    assert np.allclose(scaled.vehicles.states, plain.vehicles.states, rtol=1e-4, atol=1e-4)
    assert np.abs(np.diff(plain.vehicles.states, axis=0)).max() > 0.1


def test_demands_are_flown_by_the_textbook_controller():
    scenario = scenario_of(HUMMINGBIRD.edited({"drag": None}), [0.0, 0.0, 1.5])
    environment = VectorEnvironment(scenario, 2, start="scenario", action="acceleration")
    facing_back = np.array([START, sh.state([0.2, 0.0, 1.5], euler=[0.0, 0.0, 3.0])])
    environment.reset(seed=1, options={"state": facing_back})
    for _ in range(100):
        environment.step(np.tile([1.0, -2.0, 0.5, 0.5], (2, 1)))
    states = environment.vehicles.states
    assert np.allclose(states[:, 3:6], [1.0, -2.0, 0.5], atol=0.3), states[:, 3:6]
    turned = 2.0 * np.arctan2(states[:, 9], states[:, 6])
    assert np.allclose(np.angle(np.exp(1j * (turned - [0.0, 3.0]))), 0.5, atol=0.15), turned
    environment = VectorEnvironment(scenario, 1, start="scenario", action="attitude")
    environment.reset(seed=1)
    for _ in range(60):
        environment.step([[scenario.mass * scenario.gravity, 0.2, -0.1, 0.4]])
    wanted = sh.state(euler=[0.2, -0.1, 0.4])[6:10]
    assert abs(environment.vehicles.states[0, 6:10] @ wanted) > 0.999


def test_what_no_action_can_be_is_refused():
    for options, said in [
        ({"action": "speed"}, "action: must be one of wrench, acceleration, forward, attitude, found 'speed'"),
        ({"shield": {"low": [-1] * 3, "high": [1] * 3}}, "shield: carries no wrenches"),
        ({"render_mode": "human"}, 'render_mode: must be None or "rgb_array"'),
    ]:
        with pytest.raises(ValueError, match=said):
            Environment(HUMMINGBIRD, **options)


@pytest.mark.filterwarnings("ignore:.*infinity")
@pytest.mark.parametrize("name", IDS)
def test_the_registered_tasks_pass_gymnasiums_checker_with_their_pictures(name):
    check_env(gymnasium.make(name, render_mode="rgb_array").unwrapped)
    with pytest.raises(ValueError, match="action: must be one of"):
        gymnasium.make(name, action="none")


@pytest.mark.parametrize("name", IDS)
def test_rows_are_what_gymnasiums_own_vectors_make_of_single_ones(name):
    rows = gymnasium.make_vec(name, num_envs=3)
    assert isinstance(rows.unwrapped, VectorEnvironment)
    actions = np.random.default_rng(2).uniform(-1.0, 1.0, (6, 3, 4)).astype(np.float32).repeat(25, 0)
    actions[:, 0, 2] = -1.0

    def flown(environment):
        seen = [environment.reset(seed=6)[0]]
        for each in actions:
            observations, rewards, terminated, truncated, _ = environment.step(each)
            seen.append(
                np.concatenate([observations, rewards[:, None], terminated[:, None], truncated[:, None]], axis=1)
            )
        environment.close()
        return np.array(seen[1:]), seen[0]

    ours, first = flown(rows)
    assert ours[:, :, -2].any(), "no episode ends: none starts anew"
    for mode in ("sync", "async"):
        theirs, begun = flown(gymnasium.make_vec(name, num_envs=3, vectorization_mode=mode))
        assert np.array_equal(theirs, ours) and np.array_equal(begun, first), mode
    wrapped = gymnasium.wrappers.vector.RecordEpisodeStatistics(gymnasium.make_vec(name, num_envs=2))
    wrapped.reset(seed=1)
    wrapped.step(wrapped.action_space.sample())


def test_the_gate_is_passed_hit_or_not_yet_reached():
    environment = GateRows(None, 3)
    x = GATE[0] - 0.05
    starts = [sh.state([x, y, 1.5], [3.0, 0.0, 0.0]) for y in (0.0, 0.6)] + [sh.state([x - 1.0, 0.0, 1.5])]
    observations, _ = environment.reset(options={"state": np.array(starts)})
    assert np.allclose(observations[:, 0], [0.35, 0.35, 1.35])
    for _ in range(5):
        observations, rewards, terminated, *_ = environment.step(np.zeros((3, 4)))
        if terminated.any():
            break
    assert environment.through.tolist() == [True, False, False] and terminated.tolist() == [False, True, False]
    assert rewards[0] > 1.0 > rewards[2] > -1.0 > rewards[1] and observations[0, 0] > 1.5


def test_a_picture_shows_the_vehicle_and_the_gate_and_grows_with_the_path():
    environment = Gate(render_mode="rgb_array")
    environment.reset(seed=1)
    first = environment.render()
    for _ in range(120):
        environment.step(np.array([0.4, 0.0, 0.0, 0.0]))
    later = environment.render()
    for picture in (first, later):
        assert picture.shape == (420, 480, 3) and picture.dtype == np.uint8
        # The ground is light, arms are dark, the thrust axis is vermilion.
        assert np.median(picture) > 200 and picture.min() < 90
    blue = [(picture[..., 2].astype(int) - picture[..., 0] > 80).sum() for picture in (first, later)]
    assert blue[1] > blue[0] + 50
    without = sh.picture(*environment._rows.episode(0)[:2])
    assert not np.array_equal(without, sh.picture(*environment._rows.episode(0)[:2], things=environment.things()))
    assert Gate().render() is None


def test_an_episode_is_written_as_a_moving_picture_and_as_a_page(tmp_path):
    environment = HoverRows(None, 2, render_mode="rgb_array")
    with pytest.raises(RuntimeError, match="replay: the episode has no step yet"):
        environment.reset(seed=1), environment.replay(tmp_path / "none.gif")
    for _ in range(100):
        environment.step(np.zeros((2, 4)))
    environment.replay(tmp_path / "flight.gif", row=1)
    with Image.open(tmp_path / "flight.gif") as moving:
        assert moving.n_frames == 21
    environment.replay(tmp_path / "flight.html", row=1)
    page = (tmp_path / "flight.html").read_text()
    assert page.startswith("<!DOCTYPE html>") and '"replays":[{' in page and "Distance from the reference" in page
    for call, said in [
        (lambda: environment.replay(tmp_path / "flight.mp4"), "path: must end in .gif or .html"),
        (lambda: environment.replay(tmp_path / "flight.gif", row=2), "row: must be from 0 to 1, found 2"),
        (lambda: environment.replay(tmp_path / "flight.gif", speed=0.0), "speed: must be from 0.05 to 100, found 0"),
        (lambda: sh.picture(np.zeros((0, 13)), np.zeros((0, 19))), "states: must have a row at least"),
        (lambda: sh.picture([START], np.zeros((2, 19))), r"references: must have shape \(1, 19\)"),
        (
            lambda: sh.picture([START], np.zeros((1, 19)), things=[np.zeros((2, 2))]),
            r"things: must have shape \(n, 3\)",
        ),
    ]:
        with pytest.raises(ValueError, match=said):
            call()
    with pytest.raises(OSError, match="cannot be written"):
        environment.replay(tmp_path / "nowhere" / "flight.gif")
    with pytest.raises(
        RuntimeError, match='replay: nothing is kept: make the environment with render_mode="rgb_array"'
    ):
        HoverRows(None, 2).replay(tmp_path / "flight.gif")


BOX = {"low": [-3.0, -3.0, 0.3], "high": [3.0, 3.0, 4.0]}


@pytest.mark.parametrize("action", ["acceleration", "attitude"])
def test_behind_the_shield_a_dive_ends_above_the_floor_and_says_who_flew(action):
    rows = HoverRows(None, 3, action=action, shield=BOX)
    one = gymnasium.make(IDS[0], action=action, shield=BOX)
    down = np.array([0.0, 0.0, -1.0, 0.0] if action == "acceleration" else [-1.0, 0.0, 0.0, 0.0], np.float32)
    rows.reset(seed=4), one.reset(seed=5)
    lowest, reasons, flown = np.inf, set(), []
    for tick in range(400):
        # Of the last row nothing is a number.
        actions = np.array([down, down, np.full(4, np.nan)])
        _, _, terminated, truncated, info = rows.step(actions)
        *_, alone = one.step(down)
        assert not terminated.any() and not info["clipped"].any()
        assert alone["by_policy"] == info["by_policy"][1] and alone["reasons"] == info["reasons"][1]
        assert np.array_equal(info["by_policy"], [reason == "" for reason in info["reasons"]])
        lowest, flown = min(lowest, rows.vehicles.states[:, 2].min()), [*flown, info["by_policy"]]
        reasons |= set(info["reasons"])
    assert lowest > BOX["low"][2] - 0.02, lowest
    assert {"", "stop", "demand"} <= reasons
    share = np.mean(flown, axis=0)
    assert 0.02 < share[0] < 0.98 and share[2] < 0.05, share


def test_what_the_shield_cannot_be_is_refused():
    with pytest.raises(ValueError, match="low"):
        HoverRows(None, 2, shield={"low": [0, 0, 2], "high": [1, 1, 1]})
    with pytest.raises(ValueError, match="control.law"):
        HoverRows(sh.Scenario.built_in("paper"), 2, shield=BOX)
    with pytest.raises(TypeError, match="unexpected keyword argument 'height'"):
        HoverRows(None, 2, shield=BOX | {"height": 2})


@pytest.mark.parametrize("shield", [None, BOX])
def test_a_task_shows_what_boards_show_a_network_and_forward_is_where_it_faces(shield):
    rows = HoverRows(None, 3, shield=shield)
    yaw = np.array([0.0, 2.0, -1.5])
    observations, _ = rows.reset(
        seed=2, options={"state": np.array([sh.state(POINT, euler=[0.0, 0.0, each]) for each in yaw])}
    )
    last, goals = np.zeros((3, 4)), np.tile(POINT, (3, 1))
    for tick in range(60):
        wanted = sh.Network.observe(rows.vehicles.states, goals, rows.headings, last)
        assert np.allclose(observations, wanted, atol=1e-5), tick
        last = np.tile([0.3, 0.0, 0.0, 0.1], (3, 1))
        observations, *_ = rows.step(last)
    velocity = rows.vehicles.states[:, 3:5]
    assert (
        np.allclose(np.arctan2(velocity[:, 1], velocity[:, 0]), yaw + 0.04, atol=0.12)
        and (np.hypot(*velocity.T) > 0.2).all()
    )
    if shield:
        assert np.array_equal(rows.headings, rows._rows.flier.shield.references[:, 15:17])


@pytest.mark.parametrize("shield", [None, BOX])
def test_an_episode_flies_the_same_whatever_was_flown_before(shield):
    environment = HoverRows(None, 2, shield=shield)
    random = np.random.default_rng(7)
    actions = random.uniform(-1.0, 1.0, (8, 2, 4)).repeat(20, 0)
    flights = []
    for _ in range(2):
        environment.reset(seed=3)
        flights.append([environment.step(each)[0] for each in actions])
    assert np.array_equal(*flights)
