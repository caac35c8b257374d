"""Runs these tests and prints what they measured as JSON; what pytest says goes to standard error."""

import contextlib
import json
import sys
from pathlib import Path

import pytest

FOLDER = Path(__file__).parent


class Gather:
    """Takes what was measured out of the session that is over."""

    def __init__(self):
        self.told = {}

    def pytest_sessionfinish(self, session):
        stats = session.config.pluginmanager.get_plugin("terminalreporter").stats
        self.told = {"tests": {word: len(stats.get(word, [])) for word in ("passed", "failed", "skipped")}}
        self.told |= session.config.measured


gather = Gather()
with contextlib.redirect_stdout(sys.stderr):
    status = pytest.main([str(FOLDER), *sys.argv[1:]], plugins=[gather])
print(json.dumps(gather.told, indent=2))
sys.exit(status)
