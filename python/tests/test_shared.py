"""The flag task, alone and with a co-pilot in it."""

import cohelm
import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

ACTIONS = ["switches", "main-side", "gymnasium", "continuous"]


@pytest.mark.filterwarnings("ignore:.*observation space m.* value is")
@pytest.mark.parametrize("name", ["cohelm/LunarLander-v3", "cohelm/FlagLander-v1", "cohelm/SharedControl-v1"])
def test_gymnasium_s_own_check_passes(name):
    check_env(gymnasium.make(name, render_mode="rgb_array").unwrapped)


@pytest.mark.filterwarnings("ignore:.*observation space m.* value is")
@pytest.mark.parametrize("actions", ACTIONS)
def test_every_action_set_flies(actions):
    env = gymnasium.make("cohelm/FlagLander-v1", actions=actions, goal_visible=False)
    check_env(env.unwrapped, skip_render_check=True)
    env.action_space.seed(0)
    env.reset(seed=1)
    over = False
    while not over:
        _, _, terminated, truncated, tick = env.step(env.action_space.sample())
        over = terminated or truncated
    assert tick["ending"] in {"crash", "out-of-bounds", "goal", "elsewhere", "time-limit"}


def test_the_observation_shows_the_goal_only_if_it_may():
    seen = gymnasium.make("cohelm/FlagLander-v1").unwrapped
    hidden = gymnasium.make("cohelm/FlagLander-v1", goal_visible=False).unwrapped
    with_goal, info = seen.reset(seed=4)
    without, _ = hidden.reset(seed=4)
    assert np.array_equal(with_goal[:-3], without)
    assert with_goal[-3:].argmax() == info["goal"] and with_goal[-3:].sum() == 1


def fly(rule, pilot_index, seeds, **options):
    """How episodes end that a simulated pilot flies under a rule."""
    env = gymnasium.make("cohelm/SharedControl-v1", rule=rule, **options).unwrapped
    pilot = cohelm.SimulatedPilot(env.world, index=pilot_index)
    endings = []
    for seed in seeds:
        env.reset(seed=seed)
        pilot.reset(seed)
        tick = {"ending": None}
        while tick["ending"] is None:
            asked = pilot.ask(env.world)
            *_, tick = env.step(6 if asked is None else asked)
        endings.append(tick["ending"])
    return endings


def test_help_turns_crashes_into_landings():
    alone = fly("hic", 0, range(10))
    helped = fly("misc", 0, range(10), inference="known")
    assert alone.count("goal") <= 2 and helped.count("goal") >= 8


def test_the_same_seeds_give_the_same_flight():
    assert fly("misc", 3, range(3)) == fly("misc", 3, range(3))


def test_human_alone_carries_out_what_is_asked():
    env = gymnasium.make("cohelm/SharedControl-v1", rule="hic").unwrapped
    env.reset(seed=0)
    for action in [2, 0, 3, 6, 5]:
        tick = env.step(action)[4]
        assert tick["asked"] == tick["executed"] == (-1 if action == 6 else action)
        assert tick["intervened"] is False and tick["opposed"] is False


def test_values_from_elsewhere_steer():
    """Dense layers with ReLU between them, as numpy computes them, steer the craft."""
    rng = np.random.default_rng(0)
    layers = [
        (rng.normal(size=(16, 13)).astype(np.float32), rng.normal(size=16).astype(np.float32)),
        (rng.normal(size=(6, 16)).astype(np.float32), rng.normal(size=6).astype(np.float32)),
    ]
    critic = cohelm.ValueModel.from_layers(layers)
    inputs = rng.normal(size=(5, 13)).astype(np.float32)
    hidden = np.maximum(inputs @ layers[0][0].T + layers[0][1], 0)
    assert np.allclose(critic.forward(inputs), hidden @ layers[1][0].T + layers[1][1], atol=1e-4)
    env = gymnasium.make("cohelm/SharedControl-v1", rule="robot", inference="known", values=critic).unwrapped
    env.reset(seed=2)
    tick = env.step(6)[4]
    assert tick["executed"] == int(tick["values"].argmax())


@pytest.mark.parametrize(
    "make, error, words",
    [
        (lambda: gymnasium.make("cohelm/FlagLander-v1", gravty=1), cohelm.OptionError, "gravty"),
        (
            lambda: gymnasium.make("cohelm/FlagLander-v1", vanishes_at=50),
            cohelm.OptionError,
            "vanishes_at.*cohelm.World",
        ),
        (lambda: gymnasium.make("cohelm/FlagLander-v1", actions="keys"), cohelm.OptionError, "actions"),
        (lambda: gymnasium.make("cohelm/SharedControl-v1", inference="guess"), cohelm.OptionError, "guess"),
        (lambda: cohelm.World("rowing-boat"), cohelm.OptionError, "no plant is called"),
        (lambda: cohelm.ValueModel.load("no-such-file"), cohelm.ModelError, "cannot read"),
        (lambda: cohelm.World("flag-lander").step(0), cohelm.ClosedError, "reset"),
        (lambda: cohelm.Lander(gravity=1.0), cohelm.OptionError, "between -12 and 0"),
    ],
)
def test_bad_input_is_refused_in_words(make, error, words):
    with pytest.raises(error, match=words):
        make()
