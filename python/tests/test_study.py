"""What the program writes, read into pandas with its data dictionary."""

import cohelm
import cohelm.sweep
import pytest
from cohelm.study import read_tables

pytest.importorskip("pandas")

DESCRIPTION = """
cohelm-sweep = 1
title = "Small"
[fly]
plant = "flag-lander"
rules = ["hic", "misc"]
seeds = [1, 2]
episodes = 2
"""


def test_tables_come_with_what_their_columns_mean(tmp_path):
    (tmp_path / "sweep.toml").write_text(DESCRIPTION)
    cohelm.sweep.report(cohelm.sweep.run(tmp_path / "sweep.toml", tmp_path / "out"))
    tables = read_tables(tmp_path / "out")
    assert {"jobs", "episodes", "ran", "dictionary"} <= set(tables)
    episodes = tables["episodes"]
    assert len(episodes) == 8 and set(episodes["condition"]) == {"hic", "misc"}
    assert episodes.attrs["dictionary"]["steps"]["unit"] == "ticks"
    assert set(episodes.columns) <= set(episodes.attrs["dictionary"])


def test_a_dictionary_may_tell_tables_apart(tmp_path):
    (tmp_path / "trials.csv").write_text("number\n1\n")
    (tmp_path / "answers.csv").write_text("number\n2\n")
    (tmp_path / "dictionary.csv").write_text("table,column,meaning\ntrials,number,Which.\nanswers,number,How much.\n")
    tables = read_tables(tmp_path)
    assert tables["trials"].attrs["dictionary"]["number"]["meaning"] == "Which."
    assert tables["answers"].attrs["dictionary"]["number"]["meaning"] == "How much."


def test_a_folder_without_tables_is_refused_in_words(tmp_path):
    with pytest.raises(cohelm.OptionError, match="no tables"):
        read_tables(tmp_path)
