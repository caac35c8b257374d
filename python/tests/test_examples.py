"""The examples do what they say."""

import runpy
from pathlib import Path

EXAMPLES = Path(__file__).parent.parent / "examples"


def test_the_readme_begins_with_the_first_example():
    code = (EXAMPLES / "ten_episodes.py").read_text().split('"""\n\n', 1)[1]
    assert f"```python\n{code}```" in (EXAMPLES.parent / "README.md").read_text()
    assert len([line for line in code.splitlines() if line]) <= 12


def test_ten_episodes(capsys):
    runpy.run_path(str(EXAMPLES / "ten_episodes.py"), run_name="__main__")
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 10 and sum(line.endswith("goal") for line in lines) >= 4


def test_somebody_s_robot_arm_is_helped_by_the_rule_alone():
    arm = runpy.run_path(str(EXAMPLES / "robot_arm.py"))
    alone, helped = ([arm["reach"](arm["Rule"](name), seed) for seed in range(10)] for name in ("hic", "misc"))
    assert sum(helped) < 0.5 * sum(alone)
