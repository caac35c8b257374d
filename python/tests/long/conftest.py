"""What the long tests measured is gathered here; `python python/tests/long` prints it."""

import os

import pytest

# The networks here are small: several threads of PyTorch mostly wait for each other, and use up processor time meanwhile.
os.environ.setdefault("OMP_NUM_THREADS", "1")


def pytest_configure(config):
    config.measured = {}


@pytest.fixture
def measured(pytestconfig):
    """A dictionary for numbers that are worth keeping, which plain JSON can hold."""
    return pytestconfig.measured
