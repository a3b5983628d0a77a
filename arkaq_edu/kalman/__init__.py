"""Kalman filter: the state of a linear system from noisy, incomplete sightings.

The thesis's section 2.5, eq 2.49 to 2.59; its use on the ball is section 5.2.

- `filter`: `KalmanFilter`, the trace it leaves, and the smoother;
- `batch`: `kalman_batch`, many tracks at once;
- `models`: `constant_velocity`;
- `consistency`: `nees` and `chi_square_band`, whether a filter knows how wrong it is;
- `noise`: `fit_noise`, Q and R from a recorded track;
- `compiled`: the loops, compiled at first use, that all of them run.
"""

from arkaq_edu.kalman.batch import kalman_batch
from arkaq_edu.kalman.consistency import chi_square_band, nees
from arkaq_edu.kalman.filter import KalmanFilter, KalmanTrace
from arkaq_edu.kalman.models import constant_velocity
from arkaq_edu.kalman.noise import fit_noise

__all__ = [
    "KalmanFilter",
    "KalmanTrace",
    "chi_square_band",
    "constant_velocity",
    "fit_noise",
    "kalman_batch",
    "nees",
]
