"""The rules of arbitration alone, on numpy arrays: for a robot and a critic of one's own."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._native import Rule as _Rule
from .errors import ArrayError

_NOTHING = -1


class Rule:
    """A rule of arbitration with its parameters.

    ``name`` is one of these words; parameters that are left out have their usual values:

    - ``"hic"`` (human alone), ``"robot"`` (robot alone), ``"lasc"`` (linear)
    - ``"line-graph"``: a blend, linear between the confidences ``start`` and ``full``, at most ``most``
    - ``"threshold"``: the robot takes over above a ``confidence``
    - ``"hindsight"``: the best action on average over the goals, ``likeness`` to what is asked being worth so many
      median ranges
    - ``"misc"`` (minimal intervention, Eqs. 3-4 of the paper), ``"tolerance"`` (constant tolerance ``alpha``)
    - ``"misc-r"``: regret of at most ``kappa * median_range``
    - ``"misc-h"``: the same over all goals by how likely they are, and ``release`` of ``kappa`` after an intervention (in
      ``decide`` every row is taken for one without an intervention before it)
    - ``"ida"``: the robot's action if it is better for every goal
    - ``"safe-nearest"``: the nearest action that flights ahead find safe (``hold``, ``horizon`` in ticks); only in a
      ``World``, as it needs a copy of the plant

    ``median_range`` is the median over states of max Q - min Q, in the values' units; 1 if left out.

    >>> rule = Rule("misc")
    >>> rule.decide([0.0, 0.9, 1.0], confidence=0.8, asked=1)
    1
    >>> rule.decide([0.0, 0.9, 1.0], confidence=0.8, asked=0)
    2
    """

    def __init__(self, name: str, *, median_range: float | None = None, **parameters: float) -> None:
        self._parameters = parameters
        self._median_range = median_range
        self.native = _Rule(name, parameters, median_range=median_range)

    @property
    def name(self) -> str:
        """The rule's word."""
        return self.native.name

    def __getstate__(self) -> tuple[str, float | None, dict[str, float]]:
        return self.name, self._median_range, self._parameters

    def __setstate__(self, state: tuple[str, float | None, dict[str, float]]) -> None:
        name, median_range, parameters = state
        self.__init__(name, median_range=median_range, **parameters)  # type: ignore[misc]

    def __repr__(self) -> str:
        return repr(self.native)

    def decide(
        self,
        values: ArrayLike,
        confidence: ArrayLike,
        asked: ArrayLike | None,
        *,
        similarity: ArrayLike | None = None,
        goal_values: ArrayLike | None = None,
        probabilities: ArrayLike | None = None,
    ) -> int | NDArray[np.int64] | None:
        """The action to carry out, given what every action is worth.

        Parameters
        ----------
        values
            Q(s, a): shape (actions,) for one decision or (rows, actions) for a batch, finite.
        confidence
            c of Eq. 1, in [0, 1]: one number, or one a row.
        asked
            Index of the action that the person asks for, or one a row; ``None`` (in a batch -1) for nothing.
        similarity
            f(a, asked) of Eq. 4: shape (actions, actions). Without it an action is like itself alone, and ties go to
            the higher value.
        goal_values, probabilities
            For the rules that weigh all goals (hindsight, misc-h, ida): Q_g(s, a) for every goal, shape (goals, actions) or
            (rows, goals, actions), and how likely each goal is, shape (goals,) or (rows, goals).

        Returns
        -------
        The index (``None`` for nothing), or for a batch an int64 array of shape (rows,) with -1 for nothing.
        """
        table = _floats(values, "values")
        if table.ndim not in (1, 2):
            raise ArrayError(f"values have shape (actions,) or (rows, actions), got {table.shape}")
        rows = np.atleast_2d(table)
        count, actions = rows.shape
        likeness = np.eye(actions, dtype=np.float32) if similarity is None else _floats(similarity, "similarity")
        indices = np.asarray(_NOTHING if asked is None else asked)
        if indices.dtype.kind not in "iu":
            raise ArrayError(f"asked is an index or an array of indices, got dtype {indices.dtype}")
        decided = self.native.decide_rows(
            np.ascontiguousarray(rows),
            _spread(_floats(confidence, "confidence"), count),
            _spread(indices.astype(np.int64), count),
            np.atleast_2d(likeness),
            _of_goals(goal_values, probabilities, table.ndim == 2),
        )
        if table.ndim == 2:
            return decided
        return None if decided[0] == _NOTHING else int(decided[0])

    def decide_among(
        self,
        values: ArrayLike,
        candidates: ArrayLike,
        confidence: float,
        asked: ArrayLike | None,
        *,
        goal_values: ArrayLike | None = None,
        probabilities: ArrayLike | None = None,
    ) -> NDArray[np.float32] | None:
        """The action to carry out among sampled actions of a continuous space.

        ``candidates`` has shape (n, dimensions), ``values`` shape (n,), ``asked`` shape (dimensions,) or is ``None``.
        f of Eq. 4 is minus the Euclidean distance, so put what the person asks for among the candidates. LASC blends:
        c * robot + (1 - c) * asked. ``goal_values`` has shape (goals, n), ``probabilities`` (goals,).
        """
        wanted = None if asked is None else _floats(asked, "asked")
        return self.native.decide_among(
            _floats(values, "values"),
            _floats(candidates, "candidates"),
            float(confidence),
            wanted,
            _of_goals(goal_values, probabilities, False),
        )


def _floats(numbers: ArrayLike, what: str) -> NDArray[np.float32]:
    try:
        return np.ascontiguousarray(numbers, dtype=np.float32)
    except (TypeError, ValueError) as error:
        raise ArrayError(f"{what} cannot be read as an array of numbers: {error}") from error


def _of_goals(
    goal_values: ArrayLike | None, probabilities: ArrayLike | None, batch: bool
) -> tuple[NDArray[np.float32], NDArray[np.float32]] | None:
    """Values and probabilities of the goals with a first axis of rows."""
    if goal_values is None and probabilities is None:
        return None
    if goal_values is None or probabilities is None:
        raise ArrayError("goal_values and probabilities belong together; one of them is missing")
    values, likely = _floats(goal_values, "goal_values"), _floats(probabilities, "probabilities")
    expected = (3, 2) if batch else (2, 1)
    if (values.ndim, likely.ndim) != expected:
        shapes = "(rows, goals, actions) and (rows, goals)" if batch else "(goals, actions) and (goals,)"
        raise ArrayError(f"goal_values and probabilities have shapes {shapes}, got {values.shape} and {likely.shape}")
    return (values, likely) if batch else (values[None], likely[None])


def _spread(numbers: NDArray[Any], count: int) -> NDArray[Any]:
    if numbers.ndim == 0:
        return np.full(count, numbers)
    if numbers.shape != (count,):
        raise ArrayError(f"expected one number or one for each of {count} rows, got shape {numbers.shape}")
    return np.ascontiguousarray(numbers)
