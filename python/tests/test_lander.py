"""The lander beside Gymnasium's, both stepped in this process: every number must be the same number."""

import copy

import cohelm
import gymnasium
import numpy as np
import pytest

OPTIONS = [
    {},
    {"continuous": True},
    {"enable_wind": True, "wind_power": 18.0, "turbulence_power": 1.9},
    {"gravity": -3.5},
]
SEEDS_EACH = 50


def side_by_side(options, seed):
    """Flies the same random actions in both and compares every step; gives how many there were."""
    theirs = gymnasium.make("LunarLander-v3", **options)
    ours = gymnasium.make("cohelm/LunarLander-v3", **options)
    theirs.action_space.seed(seed)
    seen, _ = theirs.reset(seed=seed)
    mine, _ = ours.reset(seed=seed)
    assert np.array_equal(seen, mine)
    for step in range(1, 1001):
        action = theirs.action_space.sample()
        expected, given = theirs.step(action), ours.step(action)
        assert np.array_equal(expected[0], given[0]) and expected[0].dtype == given[0].dtype
        assert (expected[1], expected[2], expected[3]) == (given[1], given[2], given[3])
        if expected[2] or expected[3]:
            # Without a seed the next episode goes on with the same random numbers.
            assert np.array_equal(theirs.reset()[0], ours.reset()[0])
            return step
    raise AssertionError("an episode has at most a thousand steps")


@pytest.mark.parametrize("options", OPTIONS, ids=str)
def test_every_number_is_gymnasium_s(options):
    steps = sum(side_by_side(options, seed) for seed in range(SEEDS_EACH))
    assert steps > 20 * SEEDS_EACH


def test_spaces_are_gymnasium_s():
    for continuous in (False, True):
        theirs = gymnasium.make("LunarLander-v3", continuous=continuous)
        ours = gymnasium.make("cohelm/LunarLander-v3", continuous=continuous)
        assert (theirs.observation_space, theirs.action_space) == (ours.observation_space, ours.action_space)
        assert theirs.spec.max_episode_steps == ours.spec.max_episode_steps


def test_a_snapshot_goes_on_with_the_same_bits():
    lander = cohelm.Lander()
    lander.reset(7)
    for action in [2, 2, 1, 0, 2]:
        lander.step(action)
    kept = lander.snapshot()
    ahead = [lander.step(2)[0].tobytes() for _ in range(20)]
    again = [copy.deepcopy(kept).step(2)[0].tobytes()]
    lander.restore(kept)
    assert again + [lander.step(2)[0].tobytes()] == [ahead[0]] * 2
    assert [lander.step(2)[0].tobytes() for _ in range(19)] == ahead[1:]


def test_the_picture_is_filled_to_its_borders():
    env = gymnasium.make("cohelm/LunarLander-v3", render_mode="rgb_array").unwrapped
    env.reset(seed=3)
    picture = env.render()
    assert picture.shape == (400, 600, 3)
    lowest = picture[-1]
    assert (lowest == lowest[300]).all(), "the ground goes on to both sides"
