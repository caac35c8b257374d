"""A real Ray cluster of two nodes on this machine, one of which is killed while jobs run."""

import threading
import time

import cohelm.sweep
import pytest
from cohelm import _native

ray = pytest.importorskip("ray")

# (On 127.0.0.1 two nodes take each other for one.)
ADDRESS = "127.0.0.2"
STORE_BYTES = 80_000_000
DESCRIPTION = """
cohelm-sweep = 1
title = "Two nodes"
[fly]
plant = "flag-lander"
rules = ["hic", "misc"]
pilots = ["ordinary", "slow"]
seeds = { first = 1, count = 30 }
episodes = 40
"""


@pytest.fixture
def cluster(monkeypatch):
    monkeypatch.setenv("RAY_USAGE_STATS_ENABLED", "0")
    from ray.cluster_utils import Cluster

    node = {"num_cpus": 1, "object_store_memory": STORE_BYTES}
    cluster = Cluster(
        initialize_head=True, head_node_args={**node, "node_ip_address": ADDRESS, "include_dashboard": False}
    )
    second = cluster.add_node(**node, node_ip_address=ADDRESS)
    cluster.wait_for_nodes()
    ray.init(address=cluster.address, log_to_driver=False, configure_logging=False)
    yield cluster, second
    ray.shutdown()
    cluster.shutdown()


@pytest.fixture
def description(tmp_path):
    path = tmp_path / "sweep.toml"
    path.write_text(DESCRIPTION)
    return path


def outcomes(folder):
    return {path.name: path.read_bytes() for path in (folder / "done").iterdir()}


def test_a_killed_node_costs_only_its_running_jobs(cluster, description, tmp_path):
    nodes, second = cluster
    jobs, _ = _native.sweep_plan(description, tmp_path / "ray")
    killed = threading.Event()

    def kill_after(finished, _):
        if finished >= jobs // 4 and not killed.is_set():
            killed.set()
            # At once and without a farewell, as power cuts do.
            threading.Thread(target=lambda: nodes.remove_node(second, allow_graceful=False)).start()

    by_node = cohelm.sweep.run_on_ray(tmp_path / "ray", progress=kill_after)
    assert killed.is_set() and len(by_node) == 2 and sum(by_node.values()) == jobs == 120
    local = cohelm.sweep.run(description, tmp_path / "local", executor="local")
    assert outcomes(tmp_path / "ray") == outcomes(local)

    cohelm.sweep.report(tmp_path / "ray")
    table = (tmp_path / "ray" / "ran.csv").read_text().splitlines()
    header, *rows = (line.split(",") for line in table)
    assert len(rows) == jobs
    again = [row for row in rows if int(row[header.index("attempt")]) > 1]
    print("\n".join(f"{jobs_} jobs on {node}" for node, jobs_ in sorted(by_node.items())), f"\n{len(again)} ran again")
    # What was running on the lost node, and what waited there: never what had finished.
    assert 1 <= len(again) <= 2 * (1 + 2)


def test_an_interrupted_sweep_goes_on_with_what_is_left(cluster, description, tmp_path):
    class Enough(Exception):
        pass

    def stop(finished, _):
        if finished == 10:
            raise Enough

    _native.sweep_plan(description, tmp_path)
    with pytest.raises(Enough):
        cohelm.sweep.run_on_ray(tmp_path, progress=stop)
    before = outcomes(tmp_path)
    assert len(before) == 10
    begun = time.time_ns() // 1_000_000
    assert sum(cohelm.sweep.run_on_ray(tmp_path).values()) == 110
    now = outcomes(tmp_path)
    assert len(now) == 120 and all(now[name] == bytes_ for name, bytes_ in before.items())
    assert (tmp_path / "done" / next(iter(before))).stat().st_mtime < begun
