"""The native half: conversion only. Shapes and units stand here; what is computed is cohelm's."""

from collections.abc import Callable
from os import PathLike
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

__version__: str

@final
class Lander:
    """Gymnasium's LunarLander-v3, one world, bit for bit."""

    def __init__(
        self,
        *,
        continuous: bool = False,
        gravity: float = -10.0,
        enable_wind: bool = False,
        wind_power: float = 15.0,
        turbulence_power: float = 1.5,
    ) -> None: ...
    def reset(self, seed: int | None = None) -> NDArray[np.float32]:
        """Begins an episode; the observation, shape (8,)."""
    def step(self, action: int | NDArray[np.float32]) -> tuple[NDArray[np.float32], float, str | None]:
        """Observation (8,), reward, and how the episode ended, if it did: goal, crash or out-of-bounds."""
    @property
    def ticks(self) -> int:
        """Ticks flown since the episode began."""
    def snapshot(self) -> Lander:
        """A copy that goes on with the same bits."""
    def restore(self, snapshot: Lander) -> None:
        """Goes back to a snapshot."""
    def render(self, width: int = 600, height: int = 400) -> NDArray[np.uint8]:
        """A picture, shape (height, width, 3)."""
    def __copy__(self) -> Lander: ...
    def __deepcopy__(self, _memo: Any) -> Lander: ...

@final
class LanderVector:
    """Landers side by side. The arrays it returns are its own and are written anew by the next call."""

    def __init__(
        self,
        worlds: int,
        *,
        continuous: bool = False,
        gravity: float = -10.0,
        enable_wind: bool = False,
        wind_power: float = 15.0,
        turbulence_power: float = 1.5,
        autoreset: str = "next-step",
        threads: int = 0,
    ) -> None: ...
    @property
    def worlds(self) -> int:
        """How many worlds."""
    def reset(
        self, seeds: list[int | None] | None = None, mask: NDArray[np.bool_] | None = None
    ) -> NDArray[np.float32]:
        """Begins episodes; observations, shape (worlds, 8)."""
    def step(
        self, actions: NDArray[np.int64] | NDArray[np.float32]
    ) -> tuple[NDArray[np.float32], NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], NDArray[np.float32]]:
        """Observations (worlds, 8), rewards, terminated, truncated (worlds,), last observations (worlds, 8)."""

@final
class World:
    """A plant, alone or with a co-pilot in it."""

    def __init__(
        self,
        plant: str,
        options_json: str = "{}",
        *,
        rule: Rule | None = None,
        inference: str = "nearest",
        silence: str = "best",
        values: ValueModel | None = None,
        intent: IntentModel | None = None,
    ) -> None: ...
    def reset(self, seed: int) -> None:
        """Begins the episode of a seed."""
    def step(self, asked: int | NDArray[np.float32] | None = None) -> dict[str, Any]:
        """One tick with what is asked; the record of every stage."""
    def state(self) -> NDArray[np.float32]:
        """The state vector, in normalised units."""
    def position(self) -> list[float]:
        """Where the plant is, in the units of the goals."""
    def goals(self) -> NDArray[np.float32]:
        """Positions of the goals, shape (goals, 2)."""
    @property
    def pilot_goal(self) -> int:
        """Index of the pilot's own goal."""
    @property
    def ticks(self) -> int:
        """Ticks since the episode began."""
    @property
    def ticks_per_second(self) -> float:
        """Ticks a second in real time."""
    @property
    def commands(self) -> list[str]:
        """Labels of the commands; empty for axes."""
    @property
    def axes(self) -> tuple[list[str], list[float], list[float]] | None:
        """Names, lower and upper bounds of the axes; None for commands."""
    def similarity(self) -> NDArray[np.float32]:
        """f(a, asked) of Eq. 4 for every pair of commands, shape (commands, commands)."""
    def teacher(self, goal: int | None = None) -> int | NDArray[np.float32] | None:
        """What a hand-made controller would do for a goal, the pilot's own unless given."""
    def snapshot(self) -> World:
        """A copy that goes on with the same bits; with a co-pilot in it by flying the episode again up to here."""
    def __copy__(self) -> World: ...
    def __deepcopy__(self, _memo: Any) -> World: ...
    def render(self, width: int = 600, height: int = 450) -> NDArray[np.uint8]:
        """A picture, shape (height, width, 3)."""

@final
class PlantVector:
    """Worlds of a plant side by side. The arrays it returns are its own and are written anew by the next call."""

    def __init__(
        self,
        help: World,
        worlds: int,
        *,
        goal_visible: bool = True,
        autoreset: str = "next-step",
        threads: int = 0,
    ) -> None: ...
    @property
    def worlds(self) -> int:
        """How many worlds."""
    @property
    def width(self) -> int:
        """Numbers of one observation."""
    def reset(self, seeds: list[int | None]) -> NDArray[np.float32]:
        """Begins the episodes of these seeds, where there is one; observations, shape (worlds, width)."""
    def step(
        self, actions: NDArray[np.int64] | NDArray[np.float32], seeds: NDArray[np.uint64]
    ) -> tuple[
        NDArray[np.float32],
        NDArray[np.float64],
        NDArray[np.bool_],
        NDArray[np.bool_],
        NDArray[np.float32],
        NDArray[np.bool_],
    ]:
        """Observations (worlds, width), rewards, terminated, truncated (worlds,), last observations (worlds, width), and
        which worlds began the episode of their seed."""
    def stages(self) -> dict[str, NDArray[Any]]:
        """The stages of the last tick, an entry a world; nothing of a world that has begun and not flown yet."""
    def endings(self) -> list[str | None]:
        """How the episode of each world ended in the last step; None where it goes on."""
    def pilot_goals(self) -> NDArray[np.int64]:
        """Index of the pilot's own goal in every world."""

@final
class SimulatedPilot:
    """A model of a person at the keys of a world; never a person. A copy, or a pickle, is the same person before an episode."""

    def __init__(self, world: World, *, population: str = "ordinary", seed: int = 1, index: int = 0) -> None: ...
    def reset(self, seed: int) -> None:
        """Begins an episode; whatever is random about the pilot comes from the seed."""
    def ask(self, world: World) -> int | NDArray[np.float32] | None:
        """What it asks for in the world as it is now."""
    @property
    def key_presses(self) -> int:
        """Keys pressed since the episode began."""

@final
class Rule:
    """A rule of arbitration; :class:`cohelm.Rule` is the one to use."""

    def __init__(self, name: str, parameters: dict[str, float], *, median_range: float | None = None) -> None: ...
    @property
    def name(self) -> str:
        """The rule's word."""
    def decide_rows(
        self,
        values: NDArray[np.float32],
        confidence: NDArray[np.float32],
        asked: NDArray[np.int64],
        similarity: NDArray[np.float32],
        goals: tuple[NDArray[np.float32], NDArray[np.float32]] | None = None,
    ) -> NDArray[np.int64]:
        """The index decided for each row, -1 for nothing."""
    def decide_among(
        self,
        values: NDArray[np.float32],
        candidates: NDArray[np.float32],
        confidence: float,
        asked: NDArray[np.float32] | None = None,
        goals: tuple[NDArray[np.float32], NDArray[np.float32]] | None = None,
    ) -> NDArray[np.float32] | None:
        """The action carried out, of sampled ones."""

@final
class ValueModel:
    """What every action is worth for a goal."""

    @staticmethod
    def load(path: str | PathLike[str]) -> ValueModel:
        """Reads a model's file."""
    @staticmethod
    def from_bytes(bytes: bytes) -> ValueModel:
        """Reads the bytes of a model's file."""
    @staticmethod
    def from_layers(layers: list[tuple[NDArray[np.float32], NDArray[np.float32]]]) -> ValueModel:
        """A network trained elsewhere: (weights (outputs, inputs), bias (outputs,)) a layer, ReLU between them."""
    @property
    def hash(self) -> str | None:
        """SHA-256 of the file; None for one from elsewhere."""
    @property
    def card_json(self) -> str | None:
        """The card as JSON; None for one from elsewhere."""
    def to_bytes(self) -> bytes:
        """The bytes of the model's file (safetensors)."""
    def assess(
        self, world: World, actions: NDArray[np.int64] | NDArray[np.float32], *, goal: int | None = None
    ) -> NDArray[np.float32]:
        """What actions are worth in a world as it is now, shape (actions,): commands (actions,) or axes (actions, axes)."""
    def forward(self, inputs: NDArray[np.float32]) -> NDArray[np.float32]:
        """The network's outputs for rows of inputs, shape (rows, outputs); those of a critic of axes are w(s), then V(s)."""
    def embed(self, encoded: NDArray[np.float32]) -> NDArray[np.float32]:
        """What a critic of axes makes of encoded actions, shape (rows, features)."""

@final
class IntentModel:
    """Which goal the pilot wants."""

    @staticmethod
    def load(path: str | PathLike[str]) -> IntentModel:
        """Reads a model's file."""
    @staticmethod
    def from_bytes(bytes: bytes) -> IntentModel:
        """Reads the bytes of a model's file."""
    def forward(self, network: str, inputs: NDArray[np.float32]) -> NDArray[np.float32]:
        """Outputs of the network "regression" or "calibrated" over one sequence, shape (ticks, outputs)."""
    @property
    def hash(self) -> str:
        """SHA-256 of the file."""
    @property
    def card_json(self) -> str:
        """The card as JSON."""
    def to_bytes(self) -> bytes:
        """The bytes of the model's file (safetensors)."""

def shipped() -> dict[str, ValueModel | IntentModel]:
    """The models that come with the package, by name."""

def shipped_for(
    plant: str, options_json: str, *, imagined: bool = False
) -> tuple[ValueModel | None, IntentModel | None]:
    """The models among them that are meant for a plant with these options, unless others are named."""

def plants() -> dict[str, str]:
    """The plants there are: what each is, by name."""

def train_values(order_json: str, progress: Callable[[str, int, int], None] | None = None) -> tuple[ValueModel, str]:
    """See :func:`cohelm.train_values`."""

def train_intent(
    order_json: str, values: ValueModel, progress: Callable[[str, int, int], None] | None = None
) -> tuple[IntentModel, str]:
    """See :func:`cohelm.train_intent`."""

def reproduce(
    *,
    seed: int = 1,
    participants: int = 10,
    episodes: int = 40,
    population: str = "ordinary",
    actions: str = "switches",
    threads: int = 0,
) -> str:
    """See :func:`cohelm.reproduce`."""

def sweep_plan(description: str | PathLike[str], out: str | PathLike[str]) -> tuple[int, int]:
    """Plans a description into a folder: how many jobs there are, and how many of them have not finished."""

def sweep_open(out: str | PathLike[str]) -> tuple[list[tuple[str, str]], list[bytes]]:
    """Hash and record of the jobs that have not finished, and the files of models that they need brought along."""

def sweep_keep(out: str | PathLike[str], record: str, model: bytes | None, ran_json: str) -> None:
    """Keeps what came of a job that ran elsewhere."""

def sweep_locally(out: str | PathLike[str], threads: int = 0) -> None:
    """Runs the jobs that have not finished on this machine; 0 threads for one a core."""

def sweep_report(out: str | PathLike[str]) -> list[str]:
    """See :func:`cohelm.sweep.report`."""

def run_job(job_json: str, models: list[bytes] = ...) -> tuple[str, bytes | None]:
    """Runs one job on this thread: its outcome as JSON, and the file of the model that it trained, if it did."""
