"""PyTorch and Stable-Baselines3: our weights there, their weights here, their checks on our environments."""

import runpy
import warnings
from pathlib import Path

import cohelm
import gymnasium
import numpy as np
import pytest

torch = pytest.importorskip("torch")
sb3 = pytest.importorskip("stable_baselines3")

EXAMPLES = Path(__file__).parent.parent.parent / "examples"


@pytest.mark.parametrize("name", ["cohelm/LunarLander-v3", "cohelm/FlagLander-v1", "cohelm/SharedControl-v1"])
def test_stable_baselines_check_passes(name):
    from stable_baselines3.common.env_checker import check_env

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(gymnasium.make(name, render_mode="rgb_array").unwrapped)


def test_our_weights_give_the_same_numbers_in_pytorch(measured):
    differences = runpy.run_path(str(EXAMPLES / "pytorch_weights.py"))["compare"]()
    # An intent model has two networks, and a critic of axes has two towers.
    two = ("intent", "continuous.values")
    assert len(differences) == sum(2 if name.endswith(two) else 1 for name in cohelm.shipped())
    measured["pytorch"] = {"version": torch.__version__, "largest_difference": max(differences.values())}
    assert max(differences.values()) < 1e-5, differences


def test_misc_flies_with_the_values_of_a_dqn_of_stable_baselines():
    example = runpy.run_path(str(EXAMPLES / "sb3_critic.py"))
    dqn = example["train"](4_000)
    critic = example["critic_of"](dqn)
    inputs = np.random.default_rng(0).normal(size=(32, dqn.observation_space.shape[0])).astype(np.float32)
    with torch.no_grad():
        theirs = dqn.q_net(torch.from_numpy(inputs)).numpy()
    assert np.abs(critic.forward(inputs) - theirs).max() < 1e-5
    shares = example["fly"](critic, "misc", 3, inference="softmax")
    assert sum(shares.values()) == pytest.approx(1.0)


def test_somebody_else_s_critic_lands_a_pilot_who_crashes_alone(measured):
    """The whole example, two to three minutes of processor time."""
    example = runpy.run_path(str(EXAMPLES / "sb3_critic.py"))
    critic = example["critic_of"](example["train"](80_000))
    alone = example["fly"](critic, "hic", 30)
    inferred = example["fly"](critic, "misc", 30, inference="softmax")
    known = example["fly"](critic, "misc", 30, inference="known")
    measured["dqn_of_stable_baselines"] = {
        "version": sb3.__version__,
        "trained_steps": 80_000,
        "episodes": 30,
        "hic": alone,
        "misc, softmax": inferred,
        "misc, known": known,
    }
    assert alone.get("goal", 0.0) <= 0.1 and inferred["goal"] >= 0.5 and known["goal"] >= 0.9, (alone, inferred, known)
