"""Kalman filter: the state of a linear system from noisy, incomplete sightings.

The thesis's section 2.5, eq 2.49 to 2.59; its use on the ball is section 5.2.

- `filter`: the equations and `KalmanFilter`;
- `trace`: `KalmanTrace`, what a filter computed along a track;
- `matrices`: products and the inverse of small matrices, which the equations use;
- `compiled`: the same equations over whole tracks and batches, and the smoother;
- `batch`: `kalman_batch`, many tracks at once;
- `models`: `constant_velocity`;
- `consistency`: `chi_square_band`, the NIS expected of a correct filter;
- `noise`: `fit_noise`, Q and R from a recorded track;
- `walk`: a simulated walk to the ball, and its filter.
"""

from arkaq_edu.kalman.batch import kalman_batch
from arkaq_edu.kalman.consistency import chi_square_band
from arkaq_edu.kalman.filter import KalmanFilter
from arkaq_edu.kalman.models import constant_velocity
from arkaq_edu.kalman.noise import fit_noise
from arkaq_edu.kalman.trace import KalmanTrace

__all__ = [
    "KalmanFilter",
    "KalmanTrace",
    "chi_square_band",
    "constant_velocity",
    "fit_noise",
    "kalman_batch",
]
