"""Sweeps from Python, on this machine: the same bytes again, and nothing twice."""

import json
from pathlib import Path

import cohelm
import cohelm.sweep
import pytest
from cohelm import _native

DESCRIPTION = """
cohelm-sweep = 1
title = "Small"
[fly]
plant = "flag-lander"
rules = ["hic", "misc"]
seeds = [1, 2, 3]
episodes = 2
"""


@pytest.fixture
def description(tmp_path):
    path = tmp_path / "sweep.toml"
    path.write_text(DESCRIPTION)
    return path


def outcomes(folder):
    return {path.name: path.read_bytes() for path in (Path(folder) / "done").iterdir()}


def test_jobs_run_once_and_alike_for_any_number_of_threads(description, tmp_path):
    one = cohelm.sweep.run(description, tmp_path / "one", threads=1)
    two = cohelm.sweep.run(description, tmp_path / "two", threads=2)
    assert len(outcomes(one)) == 6 and outcomes(one) == outcomes(two)
    assert _native.sweep_plan(description, one) == (6, 0)
    assert "report.html" in cohelm.sweep.report(one)


def test_a_job_is_a_function_of_its_record(description, tmp_path):
    folder = cohelm.sweep.run(description, tmp_path / "local")
    _native.sweep_plan(description, tmp_path / "other")
    jobs, models = _native.sweep_open(tmp_path / "other")
    assert len(jobs) == 6 and models == []
    for name, record in jobs:
        outcome, model = _native.run_job(record)
        assert outcome.encode() == outcomes(folder)[f"{name}.json"] and model is None


def test_a_model_of_one_s_own_travels_with_the_sweep(description, tmp_path):
    values, _ = cohelm.train_values(
        changes={"steps": 2000, "warm_up": 500, "validations": 1, "validation_episodes": 2},
        options={"actions": "switches"},
    )
    (tmp_path / "mine.safetensors").write_bytes(values.to_bytes())
    description.write_text(DESCRIPTION + 'values = ["shipped", "mine.safetensors"]\nheads = ["nearest"]\n')
    _native.sweep_plan(description, tmp_path / "out")
    jobs, models = _native.sweep_open(tmp_path / "out")
    assert models == [values.to_bytes()] and len(jobs) == 12
    (record,) = [record for _, record in jobs if json.loads(record)["work"]["values"] == values.hash][:1]
    with pytest.raises(cohelm.RunError, match="no values model with the hash"):
        _native.run_job(record)
    assert _native.run_job(record, models)[1] is None


def test_a_record_of_another_job_is_not_kept(description, tmp_path):
    _native.sweep_plan(description, tmp_path)
    (first, record), (second, _) = _native.sweep_open(tmp_path)[0][:2]
    outcome, _ = _native.run_job(record)
    ran = {"hash": second, "executor": "x", "node": "x", "worker": "x", "begun_ms": 0, "seconds": 0.0, "attempt": 1}
    with pytest.raises(cohelm.RunError, match=first):
        _native.sweep_keep(tmp_path, outcome, None, json.dumps(ran))


def test_bad_descriptions_are_refused_in_words(description, tmp_path):
    for old, new, words in [("hic", "hci", "no rule is called"), ("seeds", "seed", "unknown field")]:
        description.write_text(DESCRIPTION.replace(old, new))
        with pytest.raises(cohelm.OptionError, match=words):
            cohelm.sweep.run(description, tmp_path / "out")
    with pytest.raises(cohelm.OptionError, match="cannot read"):
        cohelm.sweep.run(tmp_path / "none.toml", tmp_path / "out")
    with pytest.raises(cohelm.RunError, match="no sweep ran here"):
        cohelm.sweep.report(tmp_path / "nothing")
