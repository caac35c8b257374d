"""Flights as a standard offline data set: Minari's, which its own loader and others read."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from .envs import PlantTask

if TYPE_CHECKING:
    from minari import MinariDataset

Choose = Callable[[Any, dict[str, Any]], Any]


def write_minari(
    env: Any, choose: Choose, dataset_id: str, *, episodes: int, seed: int = 0, description: str = "", **metadata: Any
) -> MinariDataset:
    """Flies ``episodes`` episodes of ``env`` and keeps them as the Minari data set ``dataset_id``
    (such as ``"study/flights-v0"``).

    ``choose(observation, info)`` gives the action. Episode i is that of ``seed + i``. Each step keeps, beside what Minari
    asks for, what the co-pilot carried out (``infos/executed``, -1 for nothing) and its confidence where there is one.
    ``metadata`` goes to :func:`minari.create_dataset_from_buffers` (``author``, ``algorithm_name``, …). The data lie where
    Minari keeps them: ``MINARI_DATASETS_PATH``.
    """
    from minari import create_dataset_from_buffers

    about = description or f"{episodes} flights from seed {seed} on"
    buffers = [_fly(env, choose, number, seed + number) for number in range(episodes)]
    return create_dataset_from_buffers(dataset_id, buffers, env=env, description=about, **metadata)


def _fly(env: Any, choose: Choose, number: int, seed: int) -> Any:
    from minari.data_collector import EpisodeBuffer

    observation, info = env.reset(seed=seed)
    observations, infos = [observation], [_kept(info, env.unwrapped)]
    actions, rewards, endings = [], [], [(False, False)]
    while not any(endings[-1]):
        action = choose(observation, info)
        observation, reward, terminated, truncated, info = env.step(action)
        actions.append(np.asarray(action, dtype=env.action_space.dtype))
        rewards.append(float(reward))
        endings.append((bool(terminated), bool(truncated)))
        observations.append(observation)
        infos.append(_kept(info, env.unwrapped))
    return EpisodeBuffer(
        id=number,
        seed=seed,
        observations=np.stack(observations),
        actions=np.stack(actions),
        rewards=rewards,
        terminations=[terminated for terminated, _ in endings[1:]],
        truncations=[truncated for _, truncated in endings[1:]],
        infos={key: np.stack([kept[key] for kept in infos]) for key in infos[0]},
    )


def _kept(info: dict[str, Any], env: Any) -> dict[str, Any]:
    kept: dict[str, Any] = {}
    if isinstance(env, PlantTask) and env.world.commands:
        kept["executed"] = np.int64(info.get("executed", -1))
        kept["confidence"] = np.float32(info.get("confidence", 0.0))
        # Where nothing was decided yet, or nobody infers, `goal` is the pilot's own.
        kept["inferred_goal"] = np.int64(info["goal"] if "confidence" in info else -1)
        kept["goal"] = np.int64(env.world.pilot_goal)
    return kept
