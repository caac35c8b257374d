"""Many landers at once, stepped natively on all cores."""

from __future__ import annotations

from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from ._native import LanderVector
from .envs import lander_spaces
from .errors import ClosedError, OptionError

MODES = {
    AutoresetMode.NEXT_STEP: "next-step",
    AutoresetMode.SAME_STEP: "same-step",
    AutoresetMode.DISABLED: "disabled",
}
_LIMIT = 1000


class LunarLanderVector(VectorEnv):
    """``gymnasium.make_vec("cohelm/LunarLander-v3", num_envs=…, vectorization_mode="vector_entry_point")``.

    World i is bit for bit what a single environment would be. With ``copy=False`` the arrays that ``step`` returns are the
    same ones every time and are written anew by the next call; it saves some microseconds. ``threads=0`` uses all cores.
    """

    metadata: dict[str, Any] = {"autoreset_mode": AutoresetMode.NEXT_STEP, "render_modes": []}

    def __init__(
        self,
        num_envs: int = 1,
        max_episode_steps: int = _LIMIT,
        render_mode: str | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        threads: int = 0,
        copy: bool = True,
        continuous: bool = False,
        gravity: float = -10.0,
        enable_wind: bool = False,
        wind_power: float = 15.0,
        turbulence_power: float = 1.5,
    ) -> None:
        if max_episode_steps != _LIMIT:
            raise OptionError(f"the lander's time limit is {_LIMIT} ticks, got {max_episode_steps}")
        if render_mode is not None:
            raise OptionError("a vector of landers draws nothing: render one environment instead")
        mode = AutoresetMode(autoreset_mode)
        self.num_envs = num_envs
        self.continuous = continuous
        self.metadata = {**self.metadata, "autoreset_mode": mode}
        self.single_observation_space, self.single_action_space = lander_spaces(continuous)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._same_step = mode is AutoresetMode.SAME_STEP
        self._copy = copy
        self._begun = False
        self._worlds: LanderVector | None = LanderVector(
            num_envs,
            continuous=continuous,
            gravity=gravity,
            enable_wind=enable_wind,
            wind_power=wind_power,
            turbulence_power=turbulence_power,
            autoreset=MODES[mode],
            threads=threads,
        )

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begins an episode in every world, or where ``options["reset_mask"]`` says so: of ``seed`` + i, or of the i-th seed."""
        if isinstance(seed, (int, np.integer)):
            seeds: list[int | None] = [int(seed) + i for i in range(self.num_envs)]
        elif seed is None:
            seeds = [None] * self.num_envs
        else:
            seeds = [None if one is None else int(one) for one in seed]
        if not self._begun:
            fresh = np.random.SeedSequence().generate_state(self.num_envs, np.uint64)
            seeds = [int(fresh[i]) if one is None else one for i, one in enumerate(seeds)]
        mask = None if options is None else options.get("reset_mask")
        observations = self._native().reset(seeds, None if mask is None else np.asarray(mask, dtype=bool))
        self._begun = True
        return self._given(observations), {}

    def step(
        self, actions: NDArray[Any]
    ) -> tuple[NDArray[np.float32], NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """One tick of every world."""
        dtype = np.float32 if self.continuous else np.int64
        given = self._native().step(np.ascontiguousarray(actions, dtype=dtype))  # type: ignore[arg-type]
        observations, rewards, terminated, truncated, last = given
        over = terminated | truncated
        infos: dict[str, Any] = {}
        if self._same_step and over.any():
            final = np.full(self.num_envs, None, dtype=object)
            for world in np.flatnonzero(over):
                final[world] = last[world].copy()
            infos = {"final_obs": final, "_final_obs": over, "final_info": {}, "_final_info": over.copy()}
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

    def _native(self) -> LanderVector:
        if self._worlds is None:
            raise ClosedError("this vector of landers was closed; make another")
        return self._worlds

    def _given(self, array: NDArray[Any]) -> NDArray[Any]:
        return array.copy() if self._copy else array
