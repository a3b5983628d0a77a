"""scikit-learn's conventions, or what the networks need of them where it is not installed."""

from __future__ import annotations

from typing import Any

import numpy as np

try:
    from sklearn.base import BaseEstimator, ClusterMixin
    from sklearn.utils.validation import check_array, check_is_fitted, validate_data
except ImportError:  # as in a browser's Python

    class BaseEstimator:  # type: ignore[no-redef]
        """An estimator without scikit-learn's tools."""

    class ClusterMixin:  # type: ignore[no-redef]
        """The same."""

    def check_array(X: Any, **how: Any) -> Any:
        """Return a copy of finite rows."""
        rows = np.array(X, dtype=float, order="C")
        if rows.ndim != 2 or 0 in rows.shape or not np.isfinite(rows).all():
            raise ValueError(f"expected finite rows, got an array of shape {rows.shape}")
        return rows

    def check_is_fitted(estimator: Any) -> None:
        """Raise an error before the first `fit`."""
        if not estimator.__sklearn_is_fitted__():
            raise ValueError(f"this {type(estimator).__name__} is not fitted yet: call fit")

    def validate_data(estimator: Any, X: Any, *, reset: bool, **how: Any) -> None:
        """Remember the number of features, or compare it."""
        n = np.shape(X)[1]
        if reset:
            estimator.n_features_in_ = n
        elif n != estimator.n_features_in_:
            raise ValueError(f"X has {n} features, but {estimator.n_features_in_} were learned")


__all__ = ["BaseEstimator", "ClusterMixin", "check_array", "check_is_fitted", "validate_data"]
