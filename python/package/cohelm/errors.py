"""Everything that cohelm raises.

``CohelmError`` catches them all; each is also the exception of Python's own that one would expect.
"""


class CohelmError(Exception):
    """Anything that cohelm refuses or cannot do."""


class OptionError(CohelmError, ValueError):
    """An option of a world, a rule or a training has a value that it cannot have."""


class ActionError(CohelmError, ValueError):
    """An action is not one of the world's, or an array of actions has the wrong shape or dtype."""


class ArrayError(CohelmError, ValueError):
    """An array has the wrong shape or dtype, or numbers that are not finite."""


class ModelError(CohelmError, ValueError):
    """A file is no model, or a model does not fit the world."""


class ClosedError(CohelmError, RuntimeError):
    """A world was stepped before its episode began or after it ended, or after it was closed."""


class RunError(CohelmError, RuntimeError):
    """A training or an experiment could not be carried out."""
