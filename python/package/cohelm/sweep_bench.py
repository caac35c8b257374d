"""``python -m cohelm.sweep_bench``: what an executor adds to a job, and what a second worker brings.

The same jobs run alone in this process (the floor), on one and two threads, and on Ray with one and two workers, one after
the other in every run; the table shows medians. Overhead is the wall time beyond the jobs' own, per job; efficiency is the
speed of two workers as a share of twice that of one.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from . import _native, sweep

_DESCRIPTION = """
cohelm-sweep = 1
title = "Bench"
[fly]
plant = "flag-lander"
rules = ["misc"]
seeds = {{ first = 1, count = {jobs} }}
episodes = {episodes}
"""


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(prog="python -m cohelm.sweep_bench", description=__doc__)
    parser.add_argument("--jobs", type=int, default=100)
    parser.add_argument("--episodes", type=int, default=20, help="of each job")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--no-ray", action="store_true", help="only threads")
    chosen = parser.parse_args()
    rows = measure(chosen.jobs, chosen.episodes, chosen.runs, not chosen.no_ray)
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else float("nan")
    print(
        json.dumps(
            {"jobs": chosen.jobs, "episodes": chosen.episodes, "runs": chosen.runs, "load": load, **rows}, indent=2
        )
    )


def measure(jobs: int, episodes: int, runs: int, with_ray: bool) -> dict[str, Any]:
    """Medians over the runs."""
    text = _DESCRIPTION.format(jobs=jobs, episodes=episodes)
    ways: dict[str, Callable[[Path], None]] = {
        "alone": _alone,
        "1 thread": lambda out: _native.sweep_locally(out, 1),
        "2 threads": lambda out: _native.sweep_locally(out, 2),
    }
    if with_ray:
        ways |= {f"ray, {workers} worker{'s'[: workers - 1]}": _with_workers(workers) for workers in (1, 2)}
    walls: dict[str, list[float]] = {way: [] for way in ways}
    own: dict[str, list[float]] = {way: [] for way in ways}
    with tempfile.TemporaryDirectory() as scratch:
        description = Path(scratch) / "sweep.toml"
        description.write_text(text)
        for run in range(runs):
            for way, go in ways.items():
                out = Path(scratch) / f"{run}-{way}"
                _native.sweep_plan(description, out)
                begun = time.perf_counter()
                go(out)
                walls[way].append(_inside(out) or time.perf_counter() - begun)
                own[way].append(_own_seconds(out))
    return {"ways": {way: _row(way, walls, own, jobs) for way in ways}, "efficiency": _efficiency(walls)}


def _row(way: str, walls: dict[str, list[float]], own: dict[str, list[float]], jobs: int) -> dict[str, float]:
    workers = 2 if "2" in way else 1
    beyond = [wall - seconds / workers for wall, seconds in zip(walls[way], own[way])]
    return {
        "wall_s": round(statistics.median(walls[way]), 3),
        "job_ms": round(1000 * statistics.median(own[way]) / jobs, 3),
        "overhead_ms_per_job": round(1000 * statistics.median(beyond) / jobs, 3),
    }


def _efficiency(walls: dict[str, list[float]]) -> dict[str, float]:
    pairs = {"threads": ("1 thread", "2 threads"), "ray": ("ray, 1 worker", "ray, 2 workers")}
    return {
        name: round(statistics.median(a / (2 * b) for a, b in zip(walls[one], walls[two])), 3)
        for name, (one, two) in pairs.items()
        if one in walls
    }


def _alone(out: Path) -> None:
    jobs, _ = _native.sweep_open(out)
    for name, record in jobs:
        begun = time.perf_counter()
        outcome, model = _native.run_job(record)
        ran = {"hash": name, "executor": "alone", "node": "", "worker": "", "begun_ms": 0, "attempt": 1}
        _native.sweep_keep(out, outcome, model, json.dumps({**ran, "seconds": time.perf_counter() - begun}))


def _with_workers(workers: int) -> Callable[[Path], None]:
    def go(out: Path) -> None:
        os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
        # Ray's workers give way to everything else on the machine (nice 15), which here would be measured too.
        os.environ.setdefault("RAY_worker_niceness", "0")
        import ray

        ray.init(num_cpus=workers, include_dashboard=False, log_to_driver=False, configure_logging=False)
        try:
            # Workers start slowly and once; a sweep of hours does not feel it, so it is no part of a job's overhead.
            warm = ray.remote(_warm)
            ray.get([warm.remote() for _ in range(4 * workers)])
            begun = time.perf_counter()
            sweep.run_on_ray(out)
            (out / "wall").write_text(str(time.perf_counter() - begun))
        finally:
            ray.shutdown()

    return go


def _warm() -> int:
    """Loads the package and the models into a worker."""
    time.sleep(0.2)
    return len(_native.shipped())


def _inside(out: Path) -> float | None:
    path = out / "wall"
    return float(path.read_text()) if path.exists() else None


def _own_seconds(out: Path) -> float:
    return sum(float(json.loads(path.read_text())["seconds"]) for path in (out / "ran").glob("*.json"))


if __name__ == "__main__":
    main()
