"""The native vectors of plants: world by world, seed by seed, what single environments are in Gymnasium's vector."""

import cohelm
import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode, SyncVectorEnv

WORLDS = 5
TASKS = [
    ("cohelm/FlagLander-v1", {"limit": 90}),
    ("cohelm/FlagLander-v1", {"actions": "continuous", "goal_visible": False, "limit": 90}),
    ("cohelm/FlagLander-v1", {"actions": "main-side", "elsewhere": "end"}),
    ("cohelm/PlantTask-v1", {"plant": "drone", "limit": 90}),
    ("cohelm/PlantTask-v1", {"plant": "arm", "limit": 90}),
    ("cohelm/SharedControl-v1", {"rule": "misc", "inference": "softmax", "limit": 90}),
    ("cohelm/SharedControl-v1", {"rule": "lasc", "inference": "known", "silence": "nothing", "limit": 60}),
]


def native(name, mode, **options):
    return gymnasium.make_vec(
        name, num_envs=WORLDS, vectorization_mode="vector_entry_point", autoreset_mode=mode, **options
    )


def gymnasium_s(name, mode, **options):
    return SyncVectorEnv([lambda: gymnasium.make(name, **options)] * WORLDS, autoreset_mode=mode)


def same(ours, theirs, names):
    for name in names:
        assert (name in ours) == (name in theirs), name
        if name not in ours:
            continue
        there = theirs[f"_{name}"]
        assert np.array_equal(ours[f"_{name}"], there), name
        assert np.array_equal(np.asarray(ours[name])[there], np.asarray(theirs[name])[there]), name


def stages(name):
    return ["seed", "goal", "asked", "executed"] + (
        ["confidence", "intervened", "opposed"] if name.endswith("SharedControl-v1") else []
    )


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
@pytest.mark.parametrize("name, options", TASKS)
def test_they_do_what_gymnasium_s_sync_vector_does(name, options, mode):
    ours, theirs = native(name, mode, **options), gymnasium_s(name, mode, **options)
    assert ours.observation_space == theirs.observation_space and ours.action_space == theirs.action_space
    theirs.action_space.seed(1)
    for seed in (5, None, [9, None, 3, None, 4]):
        (begun, told), (expected, infos) = ours.reset(seed=seed), theirs.reset(seed=seed)
        assert np.array_equal(begun, expected) and begun.dtype == expected.dtype
        same(told, infos, ["seed", "goal"])
        ended = 0
        for _ in range(250):
            actions = theirs.action_space.sample()
            given, expected = ours.step(actions), theirs.step(actions)
            for a, b in zip(given[:4], expected[:4]):
                assert np.array_equal(a, b) and a.dtype == b.dtype
            told, infos = given[4], expected[4]
            same(told, infos, stages(name))
            over = expected[2] | expected[3]
            ended += int(over.sum())
            if mode is AutoresetMode.SAME_STEP and over.any():
                assert np.array_equal(told["_final_obs"], infos["_final_obs"])
                for world in np.flatnonzero(over):
                    assert np.array_equal(told["final_obs"][world], infos["final_obs"][world])
                same(told["final_info"], infos["final_info"], ["ending", *stages(name)[2:]])
            elif over.any():
                assert list(told["ending"][over]) == list(infos["ending"][over])
        assert ended > WORLDS


def test_the_number_of_threads_changes_no_bit():
    flights = []
    for threads in (1, 2, 5):
        vector = native("cohelm/SharedControl-v1", AutoresetMode.NEXT_STEP, threads=threads)
        vector.reset(seed=3)
        rng = np.random.default_rng(0)
        flights.append([vector.step(rng.integers(7, size=WORLDS))[0].tobytes() for _ in range(80)])
    assert flights[0] == flights[1] == flights[2]


def test_without_copying_the_arrays_are_the_same_ones():
    vector = native("cohelm/FlagLander-v1", AutoresetMode.NEXT_STEP, copy=False)
    vector.reset(seed=0)
    first = vector.step(np.full(WORLDS, 2))[0]
    kept = first.copy()
    second = vector.step(np.full(WORLDS, 2))[0]
    assert np.shares_memory(first, second) and not np.array_equal(kept, second)


def test_worlds_are_reset_where_a_mask_says_so_and_not_stepped_past_their_end():
    vector = native("cohelm/FlagLander-v1", AutoresetMode.DISABLED, limit=3)
    theirs = gymnasium_s("cohelm/FlagLander-v1", AutoresetMode.DISABLED, limit=3)
    begun = vector.reset(seed=0)[0]
    theirs.reset(seed=0)
    for _ in range(3):
        over = vector.step(np.full(WORLDS, 6))[3]
        theirs.step(np.full(WORLDS, 6))
    assert over.all()
    mask = np.array([True] + [False] * (WORLDS - 1))
    now, infos = vector.reset(options={"reset_mask": mask})
    expected, told = theirs.reset(options={"reset_mask": mask})
    assert np.array_equal(now, expected) and not np.array_equal(now[0], begun[0])
    same(infos, told, ["seed", "goal"])
    with pytest.raises(cohelm.ClosedError, match="the episode of world 1 is over"):
        vector.step(np.full(WORLDS, 6))


def test_a_world_that_has_begun_anew_tells_nothing_of_the_episode_before():
    envs = native("cohelm/SharedControl-v1", AutoresetMode.NEXT_STEP, rule="misc", inference="softmax", limit=20)
    envs.reset(seed=1)
    asked = np.zeros(WORLDS, dtype=np.int64)
    before = None
    for _ in range(25):
        _, _, terminated, truncated, _ = envs.step(asked)
        stages = envs.unwrapped._native().stages()
        if before is not None and before.any():
            assert (stages["confidence"][before] == 0).all() and (stages["asked"][before] == -1).all()
            assert (stages["confidence"][~before] > 0).all()
            return
        before = terminated | truncated
    pytest.fail("no episode ended")


def test_what_is_wrong_is_refused_in_words():
    vector = native("cohelm/FlagLander-v1", AutoresetMode.NEXT_STEP)
    with pytest.raises(cohelm.ClosedError, match="no episode has begun"):
        vector.step(np.zeros(WORLDS, dtype=np.int64))
    vector.reset(seed=0)
    with pytest.raises(cohelm.ActionError, match=r"from 0 to 6 \(nothing\), got 7"):
        vector.step(np.full(WORLDS, 7))
    with pytest.raises(cohelm.ActionError, match=r"shape \(5,\).*got 3"):
        vector.step(np.zeros(3, dtype=np.int64))
    with pytest.raises(cohelm.OptionError, match="expected 5 seeds"):
        vector.reset(seed=[1, 2])
    with pytest.raises(cohelm.OptionError, match="between 0 and"):
        vector.reset(seed=-1)
    axes = native("cohelm/FlagLander-v1", AutoresetMode.NEXT_STEP, actions="continuous")
    axes.reset(seed=0)
    with pytest.raises(cohelm.ActionError, match="world 2: expected axes within their bounds"):
        axes.step(np.array([[0, 0], [0, 0], [0, 9], [0, 0], [0, 0]], dtype=np.float32))
    with pytest.raises(cohelm.OptionError, match="draws nothing"):
        native("cohelm/FlagLander-v1", AutoresetMode.NEXT_STEP, render_mode="rgb_array")
    with pytest.raises(cohelm.ModelError, match="does not fit"):
        native(
            "cohelm/SharedControl-v1", AutoresetMode.NEXT_STEP, values=cohelm.shipped()["flag-lander-main-side.values"]
        )
    vector.close()
    with pytest.raises(cohelm.ClosedError, match="was closed"):
        vector.step(np.zeros(WORLDS, dtype=np.int64))
