"""Kalman filter: the state of a linear system from noisy, incomplete sightings.

The thesis's section 2.5, eq 2.49 to 2.59; its use on the ball is section 5.2.

- `filter`: `KalmanFilter` and the trace it leaves;
- `batch`: `kalman_batch`, many tracks at once;
- `models`: `constant_velocity`;
- `_kernels`: the loops, compiled at first use, that all of them run.
"""

from arkaq_edu.kalman.batch import kalman_batch
from arkaq_edu.kalman.filter import KalmanFilter, KalmanTrace
from arkaq_edu.kalman.models import constant_velocity

__all__ = ["KalmanFilter", "KalmanTrace", "constant_velocity", "kalman_batch"]
