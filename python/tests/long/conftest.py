"""What the long tests measured is gathered here; `python python/tests/long` prints it."""

import pytest


def pytest_configure(config):
    config.measured = {}


@pytest.fixture
def measured(pytestconfig):
    """A dictionary for numbers that are worth keeping, which plain JSON can hold."""
    return pytestconfig.measured
