"""The rules alone, on arrays."""

import cohelm
import numpy as np
import pytest
from cohelm import Rule


def test_minimal_intervention_is_equations_3_and_4():
    rng = np.random.default_rng(0)
    values = rng.normal(size=(500, 6)).astype(np.float32)
    confidence = rng.uniform(size=500).astype(np.float32)
    asked = rng.integers(6, size=500)
    similarity = rng.uniform(-1, 1, size=(6, 6)).astype(np.float32)
    np.fill_diagonal(similarity, 1.0)
    decided = Rule("misc").decide(values, confidence, asked, similarity=similarity)
    above = values.astype(np.float64) - values.min(axis=1, keepdims=True)
    allowed = above >= confidence[:, None].astype(np.float64) * above.max(axis=1, keepdims=True)
    alike = np.where(allowed, similarity[:, asked].T, -np.inf)
    assert np.array_equal(decided, alike.argmax(axis=1))


def test_the_extremes_of_the_rules():
    values = [0.0, 0.4, 1.0]
    for asked in range(3):
        assert Rule("misc").decide(values, 0.0, asked) == asked
        assert Rule("misc").decide(values, 1.0, asked) == 2
        assert Rule("tolerance", alpha=1.0).decide(values, 0.5, asked) == asked
        assert Rule("tolerance", alpha=0.0).decide(values, 0.5, asked) == 2
        assert Rule("misc-r", kappa=0.0).decide(values, 0.5, asked) == 2
        assert Rule("misc-r", kappa=9.0).decide(values, 0.5, asked) == asked
        assert Rule("hic").decide(values, 0.9, asked) == asked
        assert Rule("robot").decide(values, 0.1, asked) == 2
    assert Rule("lasc").decide(values, 0.5, 0) == 0
    assert Rule("lasc").decide(values, 0.51, 0) == 2
    assert Rule("misc").decide(values, 0.3, None) == 2
    assert Rule("hic").decide(values, 0.3, None) is None


def test_continuous_actions():
    candidates = np.array([[0.0, 0.0], [1.0, 0.0], [0.6, 0.1]], dtype=np.float32)
    values = [0.0, 1.0, 0.7]
    asked = np.array([0.6, 0.1], dtype=np.float32)
    assert Rule("misc").decide_among(values, candidates, 0.0, asked).tobytes() == asked.tobytes()
    assert np.array_equal(Rule("misc").decide_among(values, candidates, 0.5, asked), asked)
    assert np.array_equal(Rule("misc").decide_among(values, candidates, 0.9, asked), candidates[1])
    blended = Rule("lasc").decide_among(values, candidates, 0.25, asked)
    assert np.allclose(blended, 0.25 * candidates[1] + 0.75 * asked)


def test_a_blend_is_the_cockpit_s_to_the_last_bit():
    rng = np.random.default_rng(1)
    one = np.float32(1)
    robot, asked = rng.uniform(-1, 1, size=(2, 200, 5)).astype(np.float32)
    asked[0] = -0.0
    differs = 0
    for weight in np.array([0.0, 0.1, 1 / 3, 0.7, 1.0], dtype=np.float32):
        for there, here in zip(robot, asked, strict=True):
            blended = Rule("lasc").decide_among([1.0, 0.0], np.stack([there, here]), float(weight), here)
            expected = here if weight == 0 else here + weight * (there - here)
            assert blended.tobytes() == expected.tobytes(), weight
            differs += (weight * there + (one - weight) * here).tobytes() != expected.tobytes()
    assert differs > 100, "another sum would be noticed"


def test_rules_that_weigh_every_goal():
    # The first goal wants action 0, the second action 2; action 1 is nearly as good for both.
    goals = [[1.0, 0.8, 0.0], [0.0, 0.8, 1.0]]
    of_goals = {"goal_values": goals, "probabilities": [0.5, 0.5]}
    assert Rule("hindsight").decide(goals[0], 0.0, 0, **of_goals) == 1
    assert Rule("hindsight", likeness=0.4).decide(goals[0], 0.0, 0, **of_goals) == 0
    assert Rule("ida").decide(goals[0], 0.9, 2, **of_goals) == 2, "good for the second goal"
    assert Rule("ida").decide(goals[0], 0.9, 2, goal_values=[goals[0]] * 2, probabilities=[0.5, 0.5]) == 0
    batch = Rule("hindsight").decide(
        [goals[0]] * 2, [0.0, 0.0], [0, 0], goal_values=[goals] * 2, probabilities=[[0.5, 0.5], [0.05, 0.95]]
    )
    assert batch.tolist() == [1, 2]
    candidates = np.array([[0.0], [0.5], [1.0]], dtype=np.float32)
    assert Rule("hindsight").decide_among(goals[0], candidates, 0.0, [0.0], **of_goals) == [0.5]


def test_parameters_go_by_name():
    assert repr(Rule("line-graph", start=0.1, most=0.5)) == "Rule('line-graph', start=0.1, full=0.8, most=0.5)"
    assert Rule("threshold", confidence=0.3).decide([0.0, 1.0], 0.4, 0) == 1
    assert Rule("threshold", confidence=0.5).decide([0.0, 1.0], 0.4, 0) == 0


@pytest.mark.parametrize(
    "call, error, words",
    [
        (lambda: Rule("mics"), cohelm.OptionError, "no rule is called"),
        (lambda: Rule("misc", alpha=0.5), cohelm.OptionError, "has no alpha"),
        (lambda: Rule("tolerance", alpha=2.0), cohelm.OptionError, r"\[0, 1\]"),
        (lambda: Rule("safe-nearest", hold=1.5), cohelm.OptionError, "whole number of ticks"),
        (lambda: Rule("safe-nearest").decide([0.0, 1.0], 0.5, 0), cohelm.OptionError, "fly it in a World"),
        (lambda: Rule("ida").decide([0.0, 1.0], 0.5, 0), cohelm.OptionError, "goal_values and probabilities"),
        (
            lambda: Rule("ida").decide([0.0, 1.0], 0.5, 0, goal_values=[[0.0, 1.0]], probabilities=[0.5, 0.5]),
            cohelm.ArrayError,
            "expected goal_values of shape",
        ),
        (lambda: Rule("misc").decide([0.0, np.nan], 0.5, 0), cohelm.ArrayError, "finite"),
        (lambda: Rule("misc").decide([0.0, 1.0], 1.5, 0), cohelm.ArrayError, "confidence"),
        (lambda: Rule("misc").decide([0.0, 1.0], 0.5, 2), cohelm.ActionError, "from 0 to 1"),
        (lambda: Rule("misc").decide([], 0.5, 0), cohelm.ArrayError, "1 to"),
        (lambda: Rule("misc").decide([[0.0, 1.0]], [0.5, 0.5], [0]), cohelm.ArrayError, "one for each of 1 rows"),
        (lambda: Rule("misc").decide(["a"], 0.5, 0), cohelm.ArrayError, "cannot be read"),
    ],
)
def test_bad_input_is_refused_in_words(call, error, words):
    with pytest.raises(error, match=words) as refused:
        call()
    assert isinstance(refused.value, cohelm.CohelmError) and isinstance(refused.value, ValueError)
