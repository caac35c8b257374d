"""Many worlds of a plant at once, each with a co-pilot of its own or with none, stepped natively on all cores."""

from __future__ import annotations

from typing import Any

import numpy as np
from gymnasium.utils import seeding
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from ._native import PlantVector
from .envs import MOST_SEED, FlagLander, PlantTask, SharedControl
from .errors import ClosedError, OptionError
from .vector import MODES


class PlantTaskVector(VectorEnv):
    """``gymnasium.make_vec("cohelm/PlantTask-v1", num_envs=…, vectorization_mode="vector_entry_point", plant=…)``.

    World i is bit for bit what a single environment would be. With ``copy=False`` the arrays that ``step`` returns are the
    same ones every time and are written anew by the next call. ``threads=0`` uses all cores. Other keyword arguments are those
    of the single environment.

    ``info`` holds arrays, one entry a world, with a mask under the name with ``_`` before it: ``seed`` and ``goal`` of the
    episodes that began, ``asked`` and ``executed`` of the worlds that were stepped (-1 is nothing), ``ending`` of those whose
    episode ended. With a co-pilot there are the stages ``goal`` (the inferred one), ``confidence``, ``intervened`` and
    ``opposed`` too; values and probabilities of every world are only told by single environments.
    """

    metadata: dict[str, Any] = {"autoreset_mode": AutoresetMode.NEXT_STEP, "render_modes": []}

    def __init__(
        self,
        num_envs: int = 1,
        render_mode: str | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        threads: int = 0,
        copy: bool = True,
        goal_visible: bool = True,
        **options: Any,
    ) -> None:
        if render_mode is not None:
            raise OptionError("a vector of worlds draws nothing: render one environment instead")
        mode = AutoresetMode(autoreset_mode)
        single = self._single(goal_visible=goal_visible, **options)
        self.num_envs = num_envs
        self.metadata = {**self.metadata, "autoreset_mode": mode}
        self.single_observation_space, self.single_action_space = single.observation_space, single.action_space
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._dtype = np.int64 if single.nothing is not None else np.float32
        self._same_step = mode is AutoresetMode.SAME_STEP
        self._copy = copy
        self._worlds: PlantVector | None = PlantVector(
            single.world, num_envs, goal_visible=goal_visible, autoreset=MODES[mode], threads=threads
        )
        # Of each world: where its seeds come from, and the next one that does.
        self._numbers: list[np.random.Generator | None] = [None] * num_envs
        self._next = np.zeros(num_envs, dtype=np.uint64)

    def _single(self, **arguments: Any) -> PlantTask:
        return PlantTask(**arguments)

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begins an episode in every world, or where ``options["reset_mask"]`` says so: of ``seed`` + i, or of the i-th seed."""
        if isinstance(seed, (int, np.integer)):
            seeds: list[int | None] = [int(seed) + i for i in range(self.num_envs)]
        else:
            seeds = [None] * self.num_envs if seed is None else list(seed)
        if len(seeds) != self.num_envs:
            raise OptionError(f"expected {self.num_envs} seeds, one a world, got {len(seeds)}")
        given = None if options is None else options.get("reset_mask")
        mask = np.ones(self.num_envs, dtype=bool) if given is None else np.asarray(given, dtype=bool)
        if mask.shape != (self.num_envs,):
            raise OptionError(f"expected a reset_mask of shape ({self.num_envs},), got {mask.shape}")
        episodes = [self._episode(world, one) if mask[world] else None for world, one in enumerate(seeds)]
        observations = self._native().reset(episodes)
        return self._given(observations), self._begun(mask, np.array([one or 0 for one in episodes], dtype=np.int64))

    def step(
        self, actions: NDArray[Any]
    ) -> tuple[NDArray[np.float32], NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """One tick of every world."""
        seeds = self._next.copy()
        native = self._native()
        stepped = native.step(np.ascontiguousarray(actions, dtype=self._dtype), seeds)  # type: ignore[arg-type]
        observations, rewards, terminated, truncated, last, restarted = stepped
        over = terminated | truncated
        for world in np.flatnonzero(restarted):
            self._draw(int(world))
        infos = self._begun(restarted, seeds.astype(np.int64)) if restarted.any() else {}
        stages: dict[str, NDArray[Any]] = native.stages()
        if over.any():
            stages["ending"] = np.array(native.endings(), dtype=object)
        if self._same_step and over.any():
            final = np.full(self.num_envs, None, dtype=object)
            for world in np.flatnonzero(over):
                final[world] = last[world].copy()
            infos["final_obs"], infos["_final_obs"] = final, over.copy()
            infos["final_info"], infos["_final_info"] = _masked(stages, over, {}), over.copy()
        infos = _masked(stages, ~restarted, infos)
        return (
            self._given(observations),
            self._given(rewards),
            self._given(terminated),
            self._given(truncated),
            infos,
        )

    def close_extras(self, **kwargs: Any) -> None:
        """Lets go of the worlds."""
        self._worlds = None

    def _native(self) -> PlantVector:
        if self._worlds is None:
            raise ClosedError("this vector of worlds was closed; make another")
        return self._worlds

    def _given(self, array: NDArray[Any]) -> NDArray[Any]:
        return array.copy() if self._copy else array

    def _episode(self, world: int, seed: int | None) -> int:
        """The seed of the episode that a world begins now: as a single environment would choose it."""
        if seed is not None and not 0 <= seed <= MOST_SEED:
            raise OptionError(f"a seed lies between 0 and 2**53, got {seed}")
        if seed is not None or self._numbers[world] is None:
            self._numbers[world] = seeding.np_random(None if seed is None else int(seed))[0]
            self._draw(world)
        if seed is not None:
            return int(seed)
        episode = int(self._next[world])
        self._draw(world)
        return episode

    def _draw(self, world: int) -> None:
        numbers = self._numbers[world]
        if numbers is not None:
            self._next[world] = numbers.integers(MOST_SEED)

    def _begun(self, where: NDArray[np.bool_], seeds: NDArray[np.int64]) -> dict[str, Any]:
        return _masked({"seed": seeds, "goal": self._native().pilot_goals()}, where, {})


class FlagLanderVector(PlantTaskVector):
    """``gymnasium.make_vec("cohelm/FlagLander-v1", num_envs=…, vectorization_mode="vector_entry_point")``."""

    def _single(self, **arguments: Any) -> FlagLander:
        return FlagLander(**arguments)


class SharedControlVector(PlantTaskVector):
    """``gymnasium.make_vec("cohelm/SharedControl-v1", num_envs=…, vectorization_mode="vector_entry_point")``.

    A co-pilot in every world; keyword arguments as those of :class:`cohelm.envs.SharedControl`.
    """

    def _single(self, **arguments: Any) -> SharedControl:
        return SharedControl(**arguments)


def _masked(arrays: dict[str, NDArray[Any]], where: NDArray[np.bool_], infos: dict[str, Any]) -> dict[str, Any]:
    """Adds arrays as Gymnasium gathers ``info``: with a mask of the worlds that have an entry, and zero (or None) elsewhere."""
    if not where.any():
        return infos
    for name, array in arrays.items():
        there, mask = infos.get(name), infos.get(f"_{name}", np.zeros(len(where), dtype=bool))
        nothing = None if array.dtype == object else array.dtype.type(0)
        elsewhere: Any = nothing if there is None else there
        infos[name] = np.where(where.reshape((-1,) + (1,) * (array.ndim - 1)), array, elsewhere)
        infos[f"_{name}"] = mask | where
    return infos
