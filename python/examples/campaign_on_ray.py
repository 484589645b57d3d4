"""A campaign of randomised flights on a Ray cluster: its shards as tasks, merged to the bytes of the campaign that was never split.

    python python/examples/campaign_on_ray.py vehicles/hummingbird.toml --flights 1000 --shards 4 --out campaigns/on-ray

It needs the wheel with Ray (`pip install "./python[ray]"`), and joins the cluster that RAY_ADDRESS names, or else starts one on this
machine. Each task has one core to itself and needs no shared disk: it gives its files back as bytes. A task whose machine is lost is
flown again by Ray, to the same bytes.
"""

import argparse
import pathlib
import sys
import tempfile

import ray
import saturated_hybrid as sh

# Flights of a task run on the core that Ray gives it, and on no other.
ONE_CORE = {"env_vars": {"RAYON_NUM_THREADS": "1"}}


@ray.remote(num_cpus=1, runtime_env=ONE_CORE)
def shard(scenario, flights, seed, law, part, parts):
    """Flies one part; its files by their names."""
    with tempfile.TemporaryDirectory() as folder:
        sh.campaign(scenario, folder, flights=flights, seed=seed, shard=(part, parts), law=law)
        return {file.name: file.read_bytes() for file in pathlib.Path(folder).iterdir() if file.is_file()}


def campaign(scenario, out, flights, seed, parts, law="ours"):
    """Flies all parts and merges them into the directory `out`; what they showed."""
    tasks = [shard.remote(scenario, flights, seed, law, part, parts) for part in range(1, parts + 1)]
    with tempfile.TemporaryDirectory() as folder:
        shards = []
        for part, files in enumerate(ray.get(tasks), start=1):
            shards.append(pathlib.Path(folder, str(part)))
            shards[-1].mkdir()
            for name, content in files.items():
                (shards[-1] / name).write_bytes(content)
        return sh.merge(shards, out)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file", help="scenario file")
    parser.add_argument("--flights", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--shards", type=int, default=4, help="tasks; Ray runs as many at once as it has cores")
    parser.add_argument("--law", default="ours", help="whose flights: ours, or one of docs/rivals.md")
    parser.add_argument("--out", required=True, help="directory for the whole campaign")
    arguments = parser.parse_args()
    ray.init(log_to_driver=False)
    scenario = sh.Scenario.load(arguments.file)
    shown = campaign(scenario, arguments.out, arguments.flights, arguments.seed, arguments.shards, arguments.law)
    print(shown)
    return 0 if shown.holds else 1


if __name__ == "__main__":
    sys.exit(main())
