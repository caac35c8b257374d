"""Training and the paper's experiment, from Python."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from . import _native
from ._native import IntentModel, ValueModel

Progress = Callable[[str, int, int], None]


def train_values(
    plant: str = "flag-lander",
    *,
    options: dict[str, Any] | None = None,
    preset: str | None = None,
    changes: dict[str, Any] | None = None,
    seed: int = 0,
    threads: int = 0,
    name: str | None = None,
    checkpoints: Path | None = None,
    progress: Progress | None = None,
) -> tuple[ValueModel, dict[str, Any]]:
    """Trains values from nothing by double DQN: ten seconds or so for the lander.

    ``options`` are the plant's, ``changes`` differ from the ``preset`` of training (by default that of ``cohelm train``:
    ``axes`` for actions on axes, otherwise the plant's own). The same seed gives the same weights for
    any number of threads. ``progress`` is called with (stage, done, total). Ctrl-C stops between two rounds; with a folder
    for ``checkpoints`` the same call then goes on. Returns the model and how it did.
    """
    order = _order(plant, options, preset, changes, seed, threads, name, checkpoints)
    model, report = _native.train_values(order, progress)
    return model, json.loads(report)


def train_intent(
    values: ValueModel,
    plant: str = "flag-lander",
    *,
    options: dict[str, Any] | None = None,
    changes: dict[str, Any] | None = None,
    seed: int = 0,
    threads: int = 0,
    name: str | None = None,
    checkpoints: Path | None = None,
    progress: Progress | None = None,
) -> tuple[IntentModel, dict[str, Any]]:
    """Trains the two intent networks on flights of simulated pilots helped by ``values``; see :func:`train_values`."""
    order = _order(plant, options, None, changes, seed, threads, name, checkpoints)
    model, report = _native.train_intent(order, values, progress)
    return model, json.loads(report)


def reproduce(
    *,
    seed: int = 1,
    participants: int = 10,
    episodes: int = 40,
    population: str = "ordinary",
    actions: str = "switches",
    threads: int = 0,
) -> list[dict[str, Any]]:
    """Flies the paper's experiment with simulated pilots, never with people: one row a participant and condition.

    ``pandas.DataFrame(reproduce())`` is the table; ``cohelm reproduce`` writes the report. What the columns mean is in
    ``docs/measures.md``.
    """
    rows = _native.reproduce(
        seed=seed,
        participants=participants,
        episodes=episodes,
        population=population,
        actions=actions,
        threads=threads,
    )
    table: list[dict[str, Any]] = json.loads(rows)
    return table


def _order(
    plant: str,
    options: dict[str, Any] | None,
    preset: str | None,
    changes: dict[str, Any] | None,
    seed: int,
    threads: int,
    name: str | None,
    checkpoints: Path | None,
) -> str:
    order = {
        "plant": plant,
        "options": options or {},
        "preset": preset,
        "changes": changes or {},
        "seed": seed,
        "threads": threads,
        "name": name or plant,
        "checkpoints": None if checkpoints is None else str(checkpoints),
    }
    return json.dumps(order)
