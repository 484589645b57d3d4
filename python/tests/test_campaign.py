"""Campaigns: the bytes of `host-sim campaign`, whole, in shards, and as tasks of a local Ray cluster with 1, 2 and 4 workers."""

import importlib.util

import pytest
import saturated_hybrid as sh
from conftest import TOP

FILE = TOP / "vehicles" / "hummingbird.toml"
FLIGHTS, SEED = 210, 5


def files(folder):
    return {file.name: file.read_bytes() for file in folder.iterdir() if file.is_file()}


@pytest.fixture(scope="module")
def scenario():
    return sh.Scenario.load(FILE)


@pytest.fixture(scope="module")
def whole(host_sim, tmp_path_factory):
    """What the repository's program writes."""
    folder = tmp_path_factory.mktemp("whole")
    done = host_sim("campaign", FILE, "--flights", FLIGHTS, "--seed", SEED, "--out", folder)
    assert done.returncode in (0, 1), done.stderr
    assert "campaign.arrow" in files(folder)
    return files(folder)


def test_a_campaign_writes_the_programs_bytes(scenario, whole, tmp_path):
    shown = sh.campaign(scenario, tmp_path, flights=FLIGHTS, seed=SEED)
    assert files(tmp_path) == whole
    assert shown.flights == FLIGHTS and shown.tracking <= FLIGHTS and shown.beyond == 0


def test_rotors_fail_as_the_file_says_and_no_other_is_taken_to(tmp_path):
    text = FILE.read_text() + "\n[campaign]\nduration = 4.0\nrotor_failures = 0.5\nthrust_left = [0.0, 0.0]\n"
    shown = sh.campaign(sh.Scenario.parse(text), tmp_path, flights=20)
    assert 0 < shown.failed_rotors < 20 and shown.false_alarms == 0
    assert f"a rotor failed in {shown.failed_rotors} flights" in str(shown)


def test_shards_merge_to_the_same_bytes(scenario, whole, tmp_path):
    for part in (3, 1, 2):
        sh.campaign(scenario, tmp_path / str(part), flights=FLIGHTS, seed=SEED, shard=(part, 3))
    sh.merge([tmp_path / str(part) for part in (2, 3, 1)], tmp_path / "out")
    assert files(tmp_path / "out") == whole


def test_another_law_flies_the_programs_bytes_too(scenario, whole, host_sim, tmp_path):
    done = host_sim("campaign", FILE, "--law", "lee", "--flights", 40, "--seed", SEED, "--out", tmp_path / "program")
    assert done.returncode in (0, 1), done.stderr
    shown = sh.campaign(scenario, tmp_path / "wheel", flights=40, seed=SEED, law="lee")
    assert files(tmp_path / "wheel") == files(tmp_path / "program") and shown.flights == 40
    with pytest.raises(ValueError, match='law: must be one of ours, lee, .*, found "nobody"'):
        sh.campaign(scenario, tmp_path / "a", law="nobody")
    with pytest.raises(ValueError, match="gains: our law's gains are the scenario's"):
        sh.campaign(scenario, tmp_path / "a", gains="rivals.toml")
    with pytest.raises(ValueError, match="gains: missing.toml: cannot be read"):
        sh.campaign(scenario, tmp_path / "a", law="lee", gains="missing.toml")
    assert not (tmp_path / "a").exists()


def test_another_seed_is_another_campaign(scenario, whole, tmp_path):
    sh.campaign(scenario, tmp_path, flights=FLIGHTS, seed=SEED + 1)
    assert files(tmp_path)["campaign.arrow"] != whole["campaign.arrow"]


def test_what_cannot_be_flown_or_merged_is_refused(scenario, tmp_path):
    with pytest.raises(ValueError, match=r"shard: must be \(I, N\) with I from 1 to N, found \(3, 2\)"):
        sh.campaign(scenario, tmp_path / "a", shard=(3, 2))
    with pytest.raises(ValueError, match="flights: must be a whole number from 1 to 100000000, found 0"):
        sh.campaign(scenario, tmp_path / "a", flights=0)
    assert not (tmp_path / "a").exists()
    with pytest.raises(ValueError, match="shard: 20 flights in chunks of 50 are 1 chunk, so there can be at most 1 shard"):
        sh.campaign(scenario, tmp_path / "a", flights=20, shard=(1, 2))
    sh.campaign(scenario, tmp_path / "first", flights=60, shard=(1, 2))
    with pytest.raises(ValueError, match="expects all 2 shards"):
        sh.merge([tmp_path / "first"], tmp_path / "out")
    with pytest.raises(ValueError, match="holds another campaign"):
        sh.campaign(scenario, tmp_path / "first", flights=61, shard=(1, 2))


@pytest.fixture(scope="module")
def example():
    spec = importlib.util.spec_from_file_location("campaign_on_ray", TOP / "python" / "examples" / "campaign_on_ray.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def cluster(example):
    """Ray on this machine, with four workers."""
    example.ray.init(num_cpus=4, include_dashboard=False, log_to_driver=False)
    yield
    example.ray.shutdown()


@pytest.mark.parametrize("workers", [1, 2, 4])
def test_on_ray_any_number_of_workers_gives_the_same_bytes(example, cluster, scenario, whole, tmp_path, workers):
    shown = example.campaign(scenario, tmp_path, FLIGHTS, SEED, workers)
    assert files(tmp_path) == whole
    assert shown.flights == FLIGHTS
