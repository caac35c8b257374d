"""Flights as a Minari data set, read by Minari's own loader."""

import runpy
import sys
from pathlib import Path

import cohelm
import gymnasium
import numpy as np
import pytest
from cohelm.offline import write_minari

minari = pytest.importorskip("minari")

EXAMPLES = Path(__file__).parent.parent.parent / "examples"


@pytest.fixture(autouse=True)
def own_folder(tmp_path, monkeypatch):
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path))


def test_what_is_loaded_is_what_was_flown():
    env = gymnasium.make("cohelm/SharedControl-v1", rule="misc", inference="known")
    write_minari(env, lambda observation, info: 2, "cohelm/test-v0", episodes=3, seed=5)
    data = minari.load_dataset("cohelm/test-v0")
    assert data.total_episodes == 3
    again = gymnasium.make("cohelm/SharedControl-v1", rule="misc", inference="known")
    for number, episode in enumerate(data.iterate_episodes()):
        observation, _ = again.reset(seed=5 + number)
        assert np.array_equal(episode.observations[0], observation)
        assert episode.infos["inferred_goal"][0] == -1, "nothing was inferred yet"
        for step, action in enumerate(episode.actions):
            observation, reward, terminated, truncated, tick = again.step(action)
            assert np.array_equal(episode.observations[step + 1], observation) and episode.rewards[step] == reward
            assert episode.infos["executed"][step + 1] == tick["executed"]
            assert episode.infos["confidence"][step + 1] == 1.0
        assert terminated == episode.terminations[-1] and truncated == episode.truncations[-1]
    recovered = data.recover_environment()
    assert isinstance(recovered.unwrapped, cohelm.envs.SharedControl)


def test_the_example_writes_and_reads(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["minari_flights.py", "cohelm/example-v0", "3"])
    runpy.run_path(str(EXAMPLES / "minari_flights.py"), run_name="__main__")
    assert len(capsys.readouterr().out.splitlines()) == 3
