"""Scenarios, certificates and the search for gains: what they say, and what they refuse."""

import pickle

import numpy as np
import pytest
import saturated_hybrid as sh


def test_a_certified_scenario_has_bounds_margins_and_no_reasons(host_sim):
    scenario = sh.Scenario.built_in("hummingbird")
    certificate = sh.certify(scenario)
    assert certificate and certificate.certified and certificate.reasons == [] and str(certificate) == "certified"
    assert all(inequality.holds and inequality.margin > 0 for inequality in certificate.inequalities)
    least, greatest = certificate.thrust
    assert 0 < least < scenario.mass * scenario.gravity < greatest <= scenario.thrust_max
    assert certificate.torque.shape == (3,) and (certificate.torque > 0).all()
    assert certificate.rotors.shape == (4, 2)
    assert [loop.axis for loop in certificate.loops] == ["roll", "pitch", "yaw", "lateral x", "lateral y", "vertical"]
    assert all(loop.stable and loop.gain_up > 1.5 and loop.delay > 0.002 and loop.lacks is None for loop in certificate.loops)
    # The program folds prose to a hundred columns.
    printed = host_sim("certify", "vehicles/hummingbird.toml", cwd=_top()).stdout
    assert certificate.report.split() == printed.split()


def test_a_refused_scenario_says_why_in_words():
    late = sh.certify(sh.Scenario.built_in("hummingbird").edited({"rotors.lag": 1.0}))
    assert not late and late.reasons
    assert late.reasons[0].startswith("sampled loop lateral x: unstable at ") and "0.67 times" in late.reasons[0]
    weak = sh.certify(sh.Scenario.built_in("paper").edited({"limits.torque_max": [0.1, 0.5, 0.5]}))
    assert not weak.commands_proven
    assert any("requires" in reason and "available 0.1000 N m" in reason for reason in weak.reasons)


def test_an_edited_scenario_is_another_and_keeps_its_comments():
    paper = sh.Scenario.built_in("paper")
    mass = paper.mass
    heavy = paper.edited({"vehicle.mass": np.float32(0.5), "plant": None, "drag": {"linear": [0.1, 0.1, 0.1]},
                          "wind.steady": np.array([1, 0, 0])})
    assert (paper.mass, heavy.mass) == (mass, 0.5)
    assert "# kg" in heavy.text and "step" not in heavy.text
    assert "wind_x" in sh.fly(heavy.edited({"duration": 0.1})).columns
    assert pickle.loads(pickle.dumps(heavy)).text == heavy.text


@pytest.mark.parametrize(
    "changes, said",
    [
        ({"vehicle.mass": -1.0}, "vehicle.mass"),
        ({"vehicle.mass": float("nan")}, "vehicle.mass"),
        ({"vehicle.mas": 1.0}, 'did you mean "mass"'),
        ({"vehicle.mass": object()}, "vehicle.mass"),
        ({"name.x": 1}, "name is no section"),
        ({"vehicle..mass": 1}, "no dotted path"),
        ({"vehicle": None}, "vehicle"),
        ({3: 1}, "dotted paths"),
    ],
)
def test_a_change_that_cannot_be_is_refused_by_name(changes, said):
    with pytest.raises(ValueError, match=None) as refused:
        sh.Scenario.built_in("paper").edited(changes)
    assert said in str(refused.value)


def test_files_and_names_that_are_none_are_refused(tmp_path):
    with pytest.raises(ValueError, match="nowhere.toml: cannot be read"):
        sh.Scenario.load(tmp_path / "nowhere.toml")
    with pytest.raises(ValueError, match="here.toml: line 1, column .*not TOML"):
        sh.Scenario.parse("name = ", "here.toml")
    with pytest.raises(ValueError, match="there are paper, .*hummingbird"):
        sh.Scenario.built_in("bee")
    file = tmp_path / "copy.toml"
    file.write_text(sh.Scenario.built_in("circle").text)
    assert sh.Scenario.load(file).name == "circle"


PAPER = sh.Scenario.built_in("paper")
GOOD = sh.reference([0, 0, 1])


@pytest.mark.parametrize(
    "call, said",
    [
        (lambda: sh.Law(PAPER).step(np.zeros(12), GOOD), r"state: must have shape \(13,\), found \(12,\)"),
        (lambda: sh.Law(PAPER).step(sh.state(), np.zeros((1, 19))), r"reference: must have shape \(19,\), found \(1, 19\)"),
        (lambda: sh.Law(PAPER).step("here", GOOD), "state: must be an array of numbers"),
        (lambda: sh.Law(PAPER).step(np.zeros(13), GOOD), "state.attitude: quaternion must have unit length"),
        (lambda: sh.Law(PAPER).step(sh.state([np.nan, 0, 0]), GOOD), "state.position: must be finite"),
        (lambda: sh.Law(PAPER).step(sh.state([1e300, 0, 0]), GOOD), "state.position: must be finite"),
        (lambda: sh.Law(PAPER).step(sh.state(), np.zeros(19)), "heading.direction: must be a unit vector"),
        (lambda: sh.Law(PAPER).step(sh.state(), sh.reference(acceleration=[0, 0, -9])), "its vertical part must stay above"),
        (lambda: sh.Law(PAPER).set_period(0.0), "control.period"),
        (lambda: sh.Law(PAPER).set_period(1e-30), "control.period"),
        (lambda: sh.LawRows(PAPER, 2).step([sh.state(), np.zeros(13)], [GOOD, GOOD]), "row 1: state.attitude"),
        (lambda: sh.LawRows(PAPER, 2).reset([True]), r"chosen: must have shape \(2,\)"),
        (lambda: sh.state(attitude=[1, 0, 0, 0], euler=[0, 0, 0]), "euler: attitude is given already"),
        (lambda: PAPER.reference([-1.0]), "times: must be from 0"),
        (lambda: PAPER.reference([np.nan]), "times: must be from 0"),
        (lambda: sh.Allocation(PAPER), "rotors: the scenario has no such section"),
        (lambda: sh.Governor(PAPER, timeout=0.0), "governor.timeout"),
        (lambda: sh.Governor(PAPER).accept(), "velocity: there is neither"),
        (lambda: sh.Governor(PAPER).accept([np.nan, 0, 0]), "setpoint.position: must be finite"),
        (lambda: sh.Governor(PAPER).accept([0, 0, 0], yaw=np.inf), "setpoint.yaw"),
        (lambda: sh.VehicleRows(PAPER, 1).step([[np.nan, 0, 0, 0]]), "row 0: wrench: must be finite"),
        (lambda: sh.VehicleRows(PAPER, 1).place([sh.state(angular_velocity=[1e6, 0, 0])]), "row 0: state.angular_velocity"),
        (lambda: sh.tune(PAPER, margin=1.0), "margin: must be from 0 to below 1, found 1"),
        (lambda: sh.tune(PAPER, population=3), "population: must be a whole number from 4 to 1000, found 3"),
        (lambda: sh.tune(PAPER, name="a/b"), "name: must be 1 to 64 letters"),
    ],
)
def test_what_cannot_be_used_is_refused_by_name(call, said):
    with pytest.raises(ValueError, match=said):
        call()


def test_a_refused_step_changes_nothing():
    for law, step in [
        (sh.Law(PAPER), lambda law, state: law.step(state, GOOD)),
        (sh.LawRows(PAPER, 2), lambda law, state: law.step([sh.state([1, 0, 0]), state], [GOOD, GOOD])),
    ]:
        other = type(law)(PAPER) if isinstance(law, sh.Law) else sh.LawRows(PAPER, 2)
        for wanted in (law, other):
            step(wanted, sh.state([1, 0, 0]))
        with pytest.raises(ValueError):
            step(law, np.zeros(13))
        assert np.array_equal(step(law, sh.state([2, 0, 0])), step(other, sh.state([2, 0, 0])))


def test_a_governor_takes_positions_on_some_axes_and_velocities_on_others():
    governor = sh.Governor(sh.Scenario.built_in("hummingbird"))
    governor.start([0, 0, 1])
    for _ in range(20):
        governor.accept([None, None, 1.5], [0.5, 0, 0])
        path = governor.run(40)
    assert abs(path[-1, 2] - 1.5) < 1e-3 and abs(path[-1, 3] - 0.5) < 1e-3
    assert path[-1, 0] > 1 and abs(path[-1, 1]) < 1e-6


def test_a_search_finds_gains_that_certify_and_is_the_same_again():
    scenario = sh.Scenario.built_in("hummingbird").edited({"duration": 20.0})
    easy = dict(generations=1, population=4, position_error=10.0, mrp_error=1.0, margin=0.0, gain_margin=1.5, delay_margin=0.002)
    tuned = sh.tune(scenario, **easy)
    assert tuned.scenario.name == "hummingbird-tuned" and tuned.scenario.text.startswith("# Tuned:")
    assert sh.certify(tuned.scenario).certified
    assert tuned.judged >= 4 and tuned.height_lost > 0 and tuned.gust > 0
    assert sh.tune(scenario, **easy).scenario.text == tuned.scenario.text
    with pytest.raises(RuntimeError, match="no gains meet the requirements; the closest fail in"):
        sh.tune(scenario, generations=1, population=4, margin=0.9999)


def test_a_flight_says_whether_its_claims_hold():
    flight = sh.fly(sh.Scenario.built_in("paper"))
    assert flight.every_claim_holds and flight.certified and flight.reasons == [] and len(flight) == 4000
    assert [claim.holds for claim in flight.claims].count(True) > 10
    assert "every claim holds" in repr(flight) and "position error" in flight.table
    early = sh.fly(sh.Scenario.built_in("paper").edited({"duration": 2.0}))
    assert not early.every_claim_holds


def _top():
    from conftest import TOP

    return TOP
