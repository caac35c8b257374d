"""Sweeps: many small experiments, each a record in and a record out, here or on a Ray cluster.

``run("sweep.toml", "results")`` uses the cores of this machine; ``run("sweep.toml", "results", executor="ray", address=…)``
those of a cluster, on whose nodes this package is installed. The same jobs have the same bytes either way. What has
finished is kept in the folder and does not run again; ``python -m cohelm.sweep FOLDER`` does what is left of one that was
planned before (``cohelm sweep run --executor ray`` calls it). How to describe a sweep is in ``docs/sweeps.md``.
"""

from __future__ import annotations

import argparse
import collections
import json
import os
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from . import _native
from .errors import OptionError, RunError

# Jobs that wait in the cluster beside those that run, for each processor: enough to keep it busy while results travel.
_WAITING_PER_CPU = 2
# An attempt is lost with its worker or node. A job that so many workers died of is not to blame on them.
_MOST_ATTEMPTS = 8
_LONGEST_WAIT_S = 10.0

Report = Callable[[int, int], None]


def run(
    description: str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    executor: str = "local",
    address: str | None = None,
    threads: int = 0,
) -> Path:
    """Runs the jobs of a description (TOML) that have not finished in the folder ``out``; gives the folder."""
    if executor not in ("local", "ray"):
        raise OptionError(f'executor is "local" or "ray", got {executor!r}')
    _native.sweep_plan(description, out)
    if executor == "local":
        _native.sweep_locally(out, threads)
    else:
        run_on_ray(out, address=address)
    return Path(out)


def report(out: str | os.PathLike[str]) -> list[str]:
    """Writes tables, figures and the report of what has finished into the folder; gives the names of the files."""
    return _native.sweep_report(out)


def run_on_ray(
    out: str | os.PathLike[str], *, address: str | None = None, progress: Report | None = None
) -> dict[str, int]:
    """Runs the jobs in a planned folder that have not finished on Ray; gives how many ran on each node.

    Without ``address`` a cluster of this machine alone is started, unless this process is connected already. ``progress``
    is called with (finished, of how many). A job whose worker or node is lost runs again elsewhere.
    """
    jobs, models = _native.sweep_open(out)
    if not jobs:
        return {}
    ray = _ray()
    started = not ray.is_initialized()
    if started:
        ray.init(address=address, include_dashboard=False, log_to_driver=False, configure_logging=False)
    try:
        return _Spreading(ray, Path(out), jobs, models, progress).run()
    finally:
        if started:
            ray.shutdown()


class _Spreading:
    """Jobs on their way to the workers of a cluster and back."""

    def __init__(
        self, ray: Any, out: Path, jobs: list[tuple[str, str]], models: list[bytes], progress: Report | None
    ) -> None:
        self._ray = ray
        self._out = out
        self._progress = progress
        # A lost attempt is ours to count and to repeat, so that the table can say so.
        self._work = ray.remote(max_retries=0, num_cpus=1)(_work)
        self._models = ray.put(models)
        self._left = collections.deque((job, 1) for job in jobs)
        self._all = len(jobs)
        self._flying: dict[Any, tuple[tuple[str, str], int]] = {}
        self._by_node: collections.Counter[str] = collections.Counter()

    def run(self) -> dict[str, int]:
        while self._left or self._flying:
            self._send()
            ready, _ = self._ray.wait(list(self._flying), num_returns=1, timeout=_LONGEST_WAIT_S)
            for ref in ready:
                self._take(ref)
        return dict(self._by_node)

    def _send(self) -> None:
        # Asked anew each time: nodes come and go.
        cpus = int(self._ray.cluster_resources().get("CPU", 1)) if len(self._flying) < len(self._left) else 1
        room = max(1, cpus) * (1 + _WAITING_PER_CPU) - len(self._flying)
        for _ in range(min(room, len(self._left))):
            job, attempt = self._left.popleft()
            self._flying[self._work.remote(job[1], self._models)] = (job, attempt)

    def _take(self, ref: Any) -> None:
        (hash_, record), attempt = self._flying.pop(ref)
        lost = (self._ray.exceptions.WorkerCrashedError, self._ray.exceptions.RaySystemError)
        try:
            outcome, model, where = self._ray.get(ref)
        except self._ray.exceptions.RayTaskError as error:
            raise RunError(f"job {hash_} failed on its worker: {error.cause}") from error
        except lost as error:
            self._again((hash_, record), attempt, error)
            return
        except self._ray.exceptions.RayError as error:
            self._again((hash_, record), attempt, error)
            return
        _native.sweep_keep(self._out, outcome, model, json.dumps({"hash": hash_, "attempt": attempt, **where}))
        self._by_node[where["node"]] += 1
        if self._progress is not None:
            self._progress(sum(self._by_node.values()), self._all)

    def _again(self, job: tuple[str, str], attempt: int, error: Exception) -> None:
        if attempt >= _MOST_ATTEMPTS:
            raise RunError(f"job {job[0]} was lost {attempt} times with its worker: {error}") from error
        self._left.append((job, attempt + 1))


def _work(record: str, models: list[bytes]) -> tuple[str, bytes | None, dict[str, Any]]:
    """What a worker does."""
    import ray

    begun_ms, begun = time.time_ns() // 1_000_000, time.perf_counter()
    outcome, model = _native.run_job(record, models)
    context = ray.get_runtime_context()
    where = {
        "executor": "ray",
        "node": f"{ray.util.get_node_ip_address()} {context.get_node_id()[:8]}",
        "worker": f"process {os.getpid()}",
        "begun_ms": begun_ms,
        "seconds": time.perf_counter() - begun,
    }
    return outcome, model, where


def _ray() -> Any:
    # Nothing of a study is anybody's business.
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    try:
        import ray
    except ImportError as error:
        raise OptionError("the executor ray needs Ray: pip install 'cohelm[ray]'") from error
    return ray


def main(arguments: list[str] | None = None) -> int:
    """Does what is left in a planned folder."""
    parser = argparse.ArgumentParser(prog="python -m cohelm.sweep", description="Runs what is left in a folder on Ray.")
    parser.add_argument("folder", type=Path, help="a folder planned by `cohelm sweep run` or cohelm.sweep.run")
    parser.add_argument("--address", help="of the Ray cluster; one of this machine alone is started unless given")
    chosen = parser.parse_args(arguments)

    def progress(finished: int, jobs: int) -> None:
        if sys.stderr.isatty():
            print(f"\r{finished} of {jobs} jobs", end="", file=sys.stderr)

    by_node = run_on_ray(chosen.folder, address=chosen.address, progress=progress)
    for node, jobs in sorted(by_node.items()):
        print(f"{jobs:8} jobs on {node}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
