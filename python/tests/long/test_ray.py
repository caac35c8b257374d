"""A real Ray cluster of two nodes on this machine, one of which is killed while jobs run."""

import contextlib
import csv
import json
import os
import signal
import subprocess
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
    # Beside other programs workers at Ray's usual niceness would hardly run.
    monkeypatch.setenv("RAY_worker_niceness", "0")
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


def where(folder):
    """Where each job ran that has finished."""
    return {path.name: json.loads(path.read_text()) for path in (folder / "ran").iterdir()}


def outcomes(folder):
    return {path.name: path.read_bytes() for path in (folder / "done").iterdir()}


def workers(node):
    """Processes of a node's workers: number → what Ray calls them, after what they do."""
    raylet = node.all_processes["raylet"][0].process.pid
    listed = subprocess.run(["ps", "-A", "-o", "pid=,ppid=,args="], capture_output=True, text=True, check=True).stdout
    rows = (line.split(None, 2) for line in listed.splitlines())
    return {int(row[0]): row[2] for row in rows if len(row) == 3 and int(row[1]) == raylet}


def stop_in_mid_job(node, patience_s=60.0):
    """Stops a worker of the node while it has a job in hand: stopped, it cannot finish it. Gives its process."""
    until = time.monotonic() + patience_s
    while time.monotonic() < until:
        for pid in [pid for pid, name in workers(node).items() if name.startswith("ray::_work")]:
            os.kill(pid, signal.SIGSTOP)
            # What it was seen to do it may have finished meanwhile: only what it is called now holds.
            if workers(node).get(pid, "").startswith("ray::_work"):
                return pid
            os.kill(pid, signal.SIGCONT)
        time.sleep(0.002)
    pytest.fail(f"no job was seen on the node to be killed within {patience_s} s: {workers(node)}")


def test_a_killed_node_costs_only_its_running_jobs(cluster, description, tmp_path, measured):
    nodes, second = cluster
    jobs, _ = _native.sweep_plan(description, tmp_path / "ray")
    lost = second.node_id[:8]
    ran_there = []

    def kill_after(finished, _):
        if finished >= jobs // 4 and not ran_there:
            worker = stop_in_mid_job(second)
            ran_there.extend(path for path, row in where(tmp_path / "ray").items() if row["node"].endswith(lost))
            # At once and without a farewell, as power cuts do.
            nodes.remove_node(second, allow_graceful=False)
            with contextlib.suppress(ProcessLookupError):
                os.kill(worker, signal.SIGKILL)

    by_node = cohelm.sweep.run_on_ray(tmp_path / "ray", progress=kill_after)
    assert ran_there and len(by_node) == 2 and sum(by_node.values()) == jobs == 120
    local = cohelm.sweep.run(description, tmp_path / "local", executor="local")
    assert outcomes(tmp_path / "ray") == outcomes(local)

    ran = where(tmp_path / "ray")
    again = {name for name, row in ran.items() if row["attempt"] > 1}
    nodes_ = {("killed" if node.endswith(lost) else "survived"): jobs_ for node, jobs_ in by_node.items()}
    measured["killed_node"] = {"jobs": jobs, "finished_on": nodes_, "ran_again": len(again)}
    # What was running on the lost node, one at least, and what waited there: never what had finished there.
    assert 1 <= len(again) <= 2 * (1 + 2) and again.isdisjoint(ran_there)
    assert all(not ran[name]["node"].endswith(lost) for name in again)

    cohelm.sweep.report(tmp_path / "ray")
    header, *rows = csv.reader((tmp_path / "ray" / "ran.csv").read_text().splitlines())
    assert len(rows) == jobs and sum(int(row[header.index("attempt")]) > 1 for row in rows) == len(again)


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
