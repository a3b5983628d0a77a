"""Models that cannot be changed: their arrays are read-only, and so are those of their copies."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from scipy import sparse


def frozen(x: Any) -> Any:
    """Make an array, or the arrays of a sparse matrix, read-only and return it.

    Examples
    --------
    >>> frozen(np.zeros(2)).flags.writeable
    False
    """
    for part in (x.data, x.indices, x.indptr) if sparse.issparse(x) else (x,):
        part.setflags(write=False)
    return x


class Frozen:
    """A model whose arrays are made read-only by `freeze`, also after a copy or a pickle.

    What a `functools.cached_property` has computed is left out of a copy; it is computed again.

    Examples
    --------
    >>> import copy
    >>> class Model(Frozen):
    ...     def __init__(self):
    ...         self.T = np.eye(2)
    ...         self.freeze()
    >>> copy.deepcopy(Model()).T.flags.writeable
    False
    """

    def freeze(self) -> None:
        """Make all arrays read-only, those in tuples included."""
        for value in vars(self).values():
            for x in value if isinstance(value, tuple) else (value,):
                if isinstance(x, np.ndarray) or sparse.issparse(x):
                    frozen(x)

    def __getstate__(self) -> dict[str, Any]:
        computed = {k for k in vars(self) if isinstance(getattr(type(self), k, 0), cached_property)}
        return {k: value for k, value in vars(self).items() if k not in computed}

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update(state)
        self.freeze()
