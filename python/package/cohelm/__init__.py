"""Shared control of a person and a co-pilot: the exact lander, the co-pilot and the rules, in Python.

The loop in five words: the pilot asks, the co-pilot infers the intent and estimates values, arbitration decides,
the plant moves. Importing this package registers with Gymnasium:

``cohelm/LunarLander-v3``
    Gymnasium's own environment, bit for bit, several times faster.
``cohelm/FlagLander-v1``
    The paper's task: three pairs of flags, one of them the goal.
``cohelm/PlantTask-v1``
    The task of any plant that :func:`plants` names: ``plant="drone"`` lands a drone, ``plant="arm"`` reaches for things.
``cohelm/SharedControl-v1``
    A task with a co-pilot in it: the agent is the pilot, and a rule decides what is carried out.

Each is a native vector environment too: ``gymnasium.make_vec(…, vectorization_mode="vector_entry_point")``.
"""

import gymnasium as _gymnasium

from . import errors
from ._native import IntentModel, Lander, SimulatedPilot, ValueModel, World, __version__, plants, shipped
from .arbitration import Rule
from .errors import ActionError, ArrayError, ClosedError, CohelmError, ModelError, OptionError, RunError
from .training import reproduce, train_intent, train_values

__all__ = [
    "ActionError",
    "ArrayError",
    "ClosedError",
    "CohelmError",
    "IntentModel",
    "Lander",
    "ModelError",
    "OptionError",
    "Rule",
    "RunError",
    "SimulatedPilot",
    "ValueModel",
    "World",
    "__version__",
    "errors",
    "plants",
    "reproduce",
    "shipped",
    "train_intent",
    "train_values",
]

_gymnasium.register(
    id="cohelm/LunarLander-v3",
    entry_point="cohelm.envs:LunarLander",
    vector_entry_point="cohelm.vector:LunarLanderVector",
    max_episode_steps=1000,
    reward_threshold=200,
)
_gymnasium.register(
    id="cohelm/FlagLander-v1",
    entry_point="cohelm.envs:FlagLander",
    vector_entry_point="cohelm.plant_vector:FlagLanderVector",
)
_gymnasium.register(
    id="cohelm/PlantTask-v1",
    entry_point="cohelm.envs:PlantTask",
    vector_entry_point="cohelm.plant_vector:PlantTaskVector",
)
_gymnasium.register(
    id="cohelm/SharedControl-v1",
    entry_point="cohelm.envs:SharedControl",
    vector_entry_point="cohelm.plant_vector:SharedControlVector",
)
