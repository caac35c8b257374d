"""``python -m cohelm.bench``: steps a second of the lander, beside Gymnasium and EnvPool where they are installed.

All contenders fly the same number of worlds with random discrete actions drawn beforehand, in this process, on the same
cores, one after the other in every run; the table shows the median of the runs.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import statistics
import time
from collections.abc import Callable
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

Step = Callable[[NDArray[np.int64]], Any]


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(prog="python -m cohelm.bench", description=__doc__)
    parser.add_argument("--worlds", type=int, default=64)
    parser.add_argument("--steps", type=int, default=1000, help="steps of all worlds a run")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--json", action="store_true")
    chosen = parser.parse_args()
    rates, cpu_rates = measure(chosen.worlds, chosen.steps, chosen.runs)
    result = {
        "worlds": chosen.worlds,
        "steps": chosen.steps,
        "runs": chosen.runs,
        "cores": len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count(),
        "machine": platform.processor() or platform.machine(),
        "load": os.getloadavg()[0] if hasattr(os, "getloadavg") else None,
        "steps_per_s": {name: statistics.median(runs) for name, runs in rates.items()},
        "steps_per_cpu_s": {name: statistics.median(runs) for name, runs in cpu_rates.items()},
    }
    if chosen.json:
        print(json.dumps(result, indent=2))
        return
    print(f"{chosen.worlds} worlds, {result['cores']} cores, median of {chosen.runs} interleaved runs")
    print(f"{'':12} {'steps/s':>12} {'cohelm is':>12} {'steps/CPU-s':>12} {'cohelm is':>12}")
    for name in rates:
        cells = [(of[name], of["cohelm"] / of[name]) for of in (result["steps_per_s"], result["steps_per_cpu_s"])]
        print(f"{name:12} " + " ".join(f"{rate:12,.0f} {ratio:10.1f} x" for rate, ratio in cells))


def measure(worlds: int, steps: int, runs: int) -> tuple[dict[str, list[float]], dict[str, list[float]]]:
    """Steps a second, and a second of processor time, of every contender in every run.

    Processor time is all that this process used on all cores, and hardly changes when others use the machine too.
    """
    actions = np.random.default_rng(0).integers(4, size=(steps, worlds))
    contenders = {name: step for name, make in _CONTENDERS.items() if (step := make(worlds)) is not None}
    rates: dict[str, list[float]] = {name: [] for name in contenders}
    cpu_rates: dict[str, list[float]] = {name: [] for name in contenders}
    for _ in range(runs):
        for name, step in contenders.items():
            # Gymnasium's worlds step one after the other: a tenth of the steps is as good a measure.
            part = actions if name != "gymnasium" else actions[: max(1, steps // 10)]
            begun, cpu_begun = time.perf_counter(), time.process_time()
            for row in part:
                step(row)
            rates[name].append(part.size / (time.perf_counter() - begun))
            cpu_rates[name].append(part.size / (time.process_time() - cpu_begun))
    return rates, cpu_rates


def _cohelm(worlds: int) -> Step:
    vector = gymnasium.make_vec(
        "cohelm/LunarLander-v3", num_envs=worlds, vectorization_mode="vector_entry_point", copy=False
    )
    vector.reset(seed=0)
    return vector.step


def _gymnasium(worlds: int) -> Step | None:
    try:
        vector = gymnasium.make_vec("LunarLander-v3", num_envs=worlds, vectorization_mode="sync")
    except gymnasium.error.Error:
        return None
    vector.reset(seed=0)
    return vector.step


def _envpool(worlds: int) -> Step | None:
    try:
        import envpool
    except ImportError:
        return None
    vector = envpool.make_gymnasium("LunarLander-v3", num_envs=worlds, seed=0)
    vector.reset()
    return lambda actions: vector.step(actions.astype(np.int32))


_CONTENDERS: dict[str, Callable[[int], Step | None]] = {
    "cohelm": _cohelm,
    "envpool": _envpool,
    "gymnasium": _gymnasium,
}

if __name__ == "__main__":
    main()
