"""The environments that are registered with Gymnasium."""

from __future__ import annotations

import json
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.utils import EzPickle
from numpy.typing import NDArray

from ._native import IntentModel, Lander, ValueModel, World, shipped_for
from .arbitration import Rule
from .errors import OptionError
from .screen import Screen

# What Gymnasium's LunarLander declares, digit for digit.
_LANDER_LOW = np.array([-2.5, -2.5, -10.0, -10.0, -2 * np.pi, -10.0, -0.0, -0.0], dtype=np.float32)
_LANDER_HIGH = np.array([2.5, 2.5, 10.0, 10.0, 2 * np.pi, 10.0, 1.0, 1.0], dtype=np.float32)
_LANDER_SIZE = (600, 400)
_PICTURE_SIZE = (800, 600)
# Beyond it JavaScript's numbers, which name seeds in the page, are no longer exact.
MOST_SEED = 2**53


def lander_spaces(continuous: bool) -> tuple[spaces.Box, spaces.Space[Any]]:
    """Observation and action space of Gymnasium's LunarLander."""
    throttles = spaces.Box(-1, +1, (2,), dtype=np.float32)
    return spaces.Box(_LANDER_LOW, _LANDER_HIGH), throttles if continuous else spaces.Discrete(4)


class LunarLander(gymnasium.Env[NDArray[np.float32], Any], EzPickle):
    """Gymnasium's LunarLander-v3, bit for bit: the same seed and actions give the same observations and rewards.

    The keyword arguments are Gymnasium's. Only the picture is drawn otherwise, as cohelm's page draws it.
    """

    metadata = {"render_modes": ["human", "rgb_array"], "render_fps": 50}

    def __init__(
        self,
        render_mode: str | None = None,
        continuous: bool = False,
        gravity: float = -10.0,
        enable_wind: bool = False,
        wind_power: float = 15.0,
        turbulence_power: float = 1.5,
    ) -> None:
        EzPickle.__init__(self, render_mode, continuous, gravity, enable_wind, wind_power, turbulence_power)
        self.continuous = continuous
        observations, self.action_space = lander_spaces(continuous)
        self.observation_space: spaces.Space[Any] = observations
        self.render_mode = render_mode
        self._screen = Screen(render_mode, self.metadata, _LANDER_SIZE)
        self._lander = Lander(
            continuous=continuous,
            gravity=gravity,
            enable_wind=enable_wind,
            wind_power=wind_power,
            turbulence_power=turbulence_power,
        )
        self._begun = False

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begins an episode: that of ``seed``, or without one another with the random numbers that follow."""
        super().reset(seed=seed)
        if seed is None and not self._begun:
            # Gymnasium draws its first seed from the system; so does this, and it can be asked for like Gymnasium's.
            seed = int(np.random.SeedSequence().generate_state(1, np.uint64)[0])
        self._begun = True
        observation = self._lander.reset(seed)
        self._show()
        return observation, {}

    def step(self, action: Any) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """One tick. As in Gymnasium the time limit is the wrapper's."""
        if self.continuous:
            action = np.ascontiguousarray(action, dtype=np.float32)
        observation, reward, ending = self._lander.step(action)
        self._show()
        return observation, reward, ending is not None, False, {} if ending is None else {"ending": ending}

    def snapshot(self) -> Lander:
        """The state of the world, to be handed to :meth:`restore` as often as one likes."""
        return self._lander.snapshot()

    def restore(self, snapshot: Lander) -> None:
        """Goes back to a snapshot: what follows has the same bits again, later episodes without a seed too."""
        self._lander.restore(snapshot)
        self._begun = True

    def __deepcopy__(self, memo: dict[int, Any]) -> LunarLander:
        """A copy in the same state, unlike a pickle, which as Gymnasium's holds the arguments only."""
        arguments: Any = (self._ezpickle_args, self._ezpickle_kwargs)
        copied = type(self)(*arguments[0], **arguments[1])
        copied._lander.restore(self._lander)
        copied._begun = self._begun
        return copied

    def render(self) -> NDArray[np.uint8] | None:
        """The picture, (400, 600, 3) uint8, in the mode ``rgb_array``."""
        return self._screen.render(self._lander.render)

    def close(self) -> None:
        """Closes the window, if there is one."""
        self._screen.close()

    def _show(self) -> None:
        self._screen.show(self._lander.render)


class PlantTask(gymnasium.Env[NDArray[np.float32], Any], EzPickle):
    """A task of any plant: goals, one of them the pilot's own. ``cohelm.plants()`` says which plants there are.

    Observation (float32): the plant's state, then x and y of every goal relative to the plant, and if ``goal_visible`` a 1 at
    the pilot's own goal and 0 at the others. Actions: the plant's commands and, last, one that asks for nothing; or the plant's
    axes. Other keyword arguments are options of the plant. What they and the numbers mean is told where the plant is described.
    """

    metadata = {"render_modes": ["human", "rgb_array"], "render_fps": 50}

    def __init__(
        self, render_mode: str | None = None, goal_visible: bool = True, plant: str = "flag-lander", **options: Any
    ) -> None:
        EzPickle.__init__(self, render_mode, goal_visible, plant, **options)
        if moving := {"appears_at", "vanishes_at"} & options.keys():
            raise OptionError(
                f"with {' and '.join(sorted(moving))} the goals and so the size of an observation would change in mid-episode, "
                "which Gymnasium's spaces do not allow; fly such a task with cohelm.World"
            )
        self.plant = plant
        self.goal_visible = goal_visible
        self.render_mode = render_mode
        self.world = self._make(json.dumps(options))
        self.metadata = {**self.metadata, "render_fps": round(self.world.ticks_per_second)}
        self._screen = Screen(render_mode, self.metadata, _PICTURE_SIZE)
        self._begun = False
        commands, axes = self.world.commands, self.world.axes
        if axes is None:
            self.action_space: spaces.Space[Any] = spaces.Discrete(len(commands) + 1)
            self.nothing: int | None = len(commands)
        else:
            _, low, high = axes
            self.action_space = spaces.Box(np.array(low, np.float32), np.array(high, np.float32))
            self.nothing = None
        size = self._observe().shape
        self.observation_space = spaces.Box(-np.inf, np.inf, size, dtype=np.float32)

    def _make(self, options: str) -> World:
        return World(self.plant, options)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begins an episode. ``seed`` fixes it and those that follow without one."""
        super().reset(seed=seed)
        if seed is not None and not 0 <= seed <= MOST_SEED:
            raise OptionError(f"a seed lies between 0 and 2**53, got {seed}")
        episode = seed if seed is not None else int(self.np_random.integers(MOST_SEED))
        self.world.reset(episode)
        self._show()
        return self._observe(), {"seed": episode, "goal": self.world.pilot_goal}

    def step(self, action: Any) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """One tick. ``info`` is the tick's record; its ``ending`` says how the episode ended, if it did.

        Where :meth:`cohelm.World.step` says ``None`` for an action, there is a number here, so that Gymnasium's vectors can
        gather them: -1 for nothing (NaN among axes). Where nothing was asked, nothing is ``intervened`` or ``opposed``.
        """
        tick = self.world.step(self._asked(action))
        self._show()
        terminated = tick["terminated"]
        truncated = tick["ending"] is not None and not terminated
        return self._observe(), tick["reward"], terminated, truncated, self._told(tick)

    def snapshot(self) -> tuple[World, Any]:
        """The state of the world, to be handed to :meth:`restore` as often as one likes."""
        return self.world.snapshot(), self.np_random.bit_generator.state

    def restore(self, snapshot: tuple[World, Any]) -> None:
        """Goes back to a snapshot: what follows has the same bits again, later episodes without a seed too."""
        world, numbers = snapshot
        self.world = world.snapshot()
        self.np_random.bit_generator.state = numbers

    def __deepcopy__(self, memo: dict[int, Any]) -> PlantTask:
        """A copy in the same state, unlike a pickle, which as Gymnasium's holds the arguments only."""
        arguments: Any = (self._ezpickle_args, self._ezpickle_kwargs)
        copied = type(self)(*arguments[0], **arguments[1])
        copied.restore(self.snapshot())
        return copied

    def render(self) -> NDArray[np.uint8] | None:
        """The picture, (600, 800, 3) uint8, in the mode ``rgb_array``."""
        return self._screen.render(self.world.render)

    def close(self) -> None:
        """Closes the window, if there is one."""
        self._screen.close()

    def _asked(self, action: Any) -> Any:
        if self.nothing is None:
            return np.ascontiguousarray(action, dtype=np.float32)
        return None if int(action) == self.nothing else int(action)

    def _told(self, tick: dict[str, Any]) -> dict[str, Any]:
        for action in ("asked", "executed"):
            if tick[action] is None:
                tick[action] = (
                    -1 if self.nothing is not None else np.full(self.action_space.shape or (), np.nan, np.float32)
                )
        for difference in ("intervened", "opposed"):
            if difference in tick:
                tick[difference] = bool(tick[difference])
        return tick

    def _observe(self) -> NDArray[np.float32]:
        goals = self.world.goals()
        parts = [self.world.state(), (goals - np.array(self.world.position(), np.float32)).ravel()]
        if self.goal_visible:
            own = np.zeros(len(goals), np.float32)
            own[self.world.pilot_goal] = 1.0
            parts.append(own)
        return np.concatenate(parts)

    def _show(self) -> None:
        self._screen.show(self.world.render)


class FlagLander(PlantTask):
    """The paper's task: three pairs of flags at random places, one of them the goal. See :class:`PlantTask`.

    Keyword arguments are options of the plant ``flag-lander``: ``actions`` (``"switches"``, ``"main-side"``,
    ``"gymnasium"``, or ``"continuous"`` with two throttles), ``limit`` (ticks), ``shaping``, ``elsewhere`` and others. Reward:
    see ``docs/lander.md``.
    """

    def __init__(self, render_mode: str | None = None, goal_visible: bool = True, **options: Any) -> None:
        super().__init__(render_mode, goal_visible, "flag-lander", **options)
        EzPickle.__init__(self, render_mode, goal_visible, **options)


class SharedControl(PlantTask):
    """A task with a co-pilot in it: the agent is the pilot, and what it asks for is arbitrated. See :class:`PlantTask`.

    ``rule`` is a :class:`cohelm.Rule` or its name; ``inference`` is ``"inverse-distance"`` (the paper's), ``"softmax"``,
    ``"calibrated"``, ``"bayesian"`` (by the values), ``"calibrated-bayesian"``, ``"imagined"`` (the co-pilot knows no goals),
    ``"nearest"`` or ``"known"``; ``values`` and ``intent`` are models, the shipped ones for the plant and its actions unless
    given. ``info`` holds every stage of the tick: ``asked``, ``goal``, ``confidence``, ``probabilities``, ``values``,
    ``allowed``, ``executed``, ``intervened``, ``opposed``.
    """

    def __init__(
        self,
        render_mode: str | None = None,
        goal_visible: bool = True,
        plant: str = "flag-lander",
        rule: Rule | str = "misc",
        inference: str = "inverse-distance",
        silence: str = "best",
        values: ValueModel | None = None,
        intent: IntentModel | None = None,
        **options: Any,
    ) -> None:
        self.rule = Rule(rule) if isinstance(rule, str) else rule
        self._help = {"inference": inference, "silence": silence}
        self._models = (values, intent)
        super().__init__(render_mode, goal_visible, plant, **options)
        EzPickle.__init__(self, render_mode, goal_visible, plant, rule, inference, silence, values, intent, **options)

    def _make(self, options: str) -> World:
        values, intent = self._models
        if values is None or intent is None:
            usual_values, usual_intent = shipped_for(
                self.plant, options, imagined=self._help["inference"] == "imagined"
            )
            values, intent = values or usual_values, intent or usual_intent
        return World(self.plant, options, rule=self.rule.native, values=values, intent=intent, **self._help)


class CriticView(gymnasium.Wrapper[NDArray[np.float32], Any, NDArray[np.float32], Any]):
    """A task as a value model sees it, for training a critic of one's own with any library.

    Observation: the plant's state, then the pilot's own goal relative to the plant (x, y). Actions: the commands, without the
    one that asks for nothing. A network of dense layers with ReLU that was trained on it becomes a value model by
    :meth:`cohelm.ValueModel.from_layers`.
    """

    def __init__(self, env: gymnasium.Env[NDArray[np.float32], Any]) -> None:
        super().__init__(env)
        world = self._world
        size = len(world.state()) + 2
        self.observation_space = spaces.Box(-np.inf, np.inf, (size,), dtype=np.float32)
        if not world.commands:
            raise OptionError("values are estimated for commands: make the task with actions other than 'continuous'")
        self.action_space = spaces.Discrete(len(world.commands))

    def reset(self, **arguments: Any) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begins an episode."""
        _, info = self.env.reset(**arguments)
        return self._observe(), info

    def step(self, action: Any) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """One tick."""
        _, reward, terminated, truncated, info = self.env.step(int(action))
        return self._observe(), float(reward), terminated, truncated, info

    @property
    def _world(self) -> World:
        plain: Any = self.unwrapped
        world: World = plain.world
        return world

    def _observe(self) -> NDArray[np.float32]:
        world = self._world
        own = world.goals()[world.pilot_goal] - np.array(world.position(), np.float32)
        return np.concatenate([world.state(), own])
