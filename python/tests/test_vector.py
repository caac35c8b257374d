"""The native vector: world by world what single environments are, under each way of beginning the next episode."""

import cohelm
import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode, SyncVectorEnv

WORLDS = 7
STEPS = 400


def native(mode, **options):
    return gymnasium.make_vec(
        "cohelm/LunarLander-v3",
        num_envs=WORLDS,
        vectorization_mode="vector_entry_point",
        autoreset_mode=mode,
        **options,
    )


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
@pytest.mark.parametrize("continuous", [False, True])
def test_it_does_what_gymnasium_s_sync_vector_does(mode, continuous):
    make = lambda: gymnasium.make("LunarLander-v3", continuous=continuous)  # noqa: E731
    theirs = SyncVectorEnv([make] * WORLDS, autoreset_mode=mode)
    ours = native(mode, continuous=continuous)
    theirs.action_space.seed(1)
    assert np.array_equal(theirs.reset(seed=5)[0], ours.reset(seed=5)[0])
    ended = 0
    for _ in range(STEPS):
        actions = theirs.action_space.sample()
        expected, given = theirs.step(actions), ours.step(actions)
        for a, b in zip(expected[:4], given[:4]):
            assert np.array_equal(a, b) and a.dtype == b.dtype
        over = expected[2] | expected[3]
        ended += int(over.sum())
        if mode is AutoresetMode.SAME_STEP and over.any():
            assert np.array_equal(expected[4]["_final_obs"], given[4]["_final_obs"])
            for world in np.flatnonzero(over):
                assert np.array_equal(expected[4]["final_obs"][world], given[4]["final_obs"][world])
    assert ended > WORLDS


def test_the_number_of_threads_changes_no_bit():
    flights = []
    for threads in (1, 2, 5):
        vector = native(AutoresetMode.NEXT_STEP, threads=threads)
        vector.reset(seed=3)
        rng = np.random.default_rng(0)
        flights.append([vector.step(rng.integers(4, size=WORLDS))[0].tobytes() for _ in range(100)])
    assert flights[0] == flights[1] == flights[2]


def test_without_copying_the_arrays_are_the_same_ones():
    vector = native(AutoresetMode.NEXT_STEP, copy=False)
    vector.reset(seed=0)
    first = vector.step(np.zeros(WORLDS, dtype=np.int64))[0]
    kept = first.copy()
    second = vector.step(np.zeros(WORLDS, dtype=np.int64))[0]
    assert first is second or np.shares_memory(first, second)
    assert not np.array_equal(kept, second)


def test_worlds_are_reset_where_a_mask_says_so():
    vector = native(AutoresetMode.DISABLED)
    begun = vector.reset(seed=0)[0].copy()
    vector.step(np.full(WORLDS, 2))
    mask = np.array([True] + [False] * (WORLDS - 1))
    now = vector.reset(seed=0, options={"reset_mask": mask})[0]
    assert np.array_equal(now[0], begun[0]) and not np.array_equal(now[1], begun[1])


def test_wrong_actions_and_closed_vectors_are_refused_in_words():
    vector = native(AutoresetMode.NEXT_STEP)
    with pytest.raises(cohelm.ClosedError, match="no episode has begun"):
        vector._native().step(np.zeros(WORLDS, dtype=np.int64))
    vector.reset(seed=0)
    with pytest.raises(cohelm.ActionError, match="from 0 to 3, got 4"):
        vector.step(np.full(WORLDS, 4))
    with pytest.raises(cohelm.ArrayError, match="expected 7 actions, one a world, got 3"):
        vector.step(np.zeros(3, dtype=np.int64))
    vector.close()
    with pytest.raises(cohelm.ClosedError, match="was closed"):
        vector.step(np.zeros(WORLDS, dtype=np.int64))
