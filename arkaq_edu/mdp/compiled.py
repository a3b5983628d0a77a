"""The loops of Q-learning: compiled where numba is, and plain Python, to the same bits, elsewhere.

`pairs` is the table of a `QLearner`: an array of shape (S, A) with the fields ``Q`` and ``visits``.
A draw is made from `u`, a number from [0, 1). Where a kernel turns an entry into a float, it is for
the plain run: NumPy's scalars warn of an overflow, and compiled code has no such thing.
"""

import math

import numpy as np

from arkaq_edu._compiled import kernel

# Value and count of a pair lie side by side: one array is cheaper to hand to a kernel than two.
PAIR = np.dtype([("Q", np.float64), ("visits", np.int64)])

# Handed to a kernel as the learning rate, this stands for one over the number of visits.
ONE_OVER_VISITS = -1.0


@kernel
def backup(pairs, s, a, r, s_next, discount, alpha):
    """Equation 2.12 for one experience; the change of Q(s, a), or NaN where it is refused.

    `discount` is gamma to the number of steps, or 0 where the episode ended.
    """
    Q = pairs["Q"]
    n_states, n_actions = Q.shape
    if not (0 <= s < n_states and 0 <= a < n_actions and 0 <= s_next < n_states):
        return math.nan
    best = float(Q[s_next, 0])
    for b in range(1, n_actions):
        best = max(best, float(Q[s_next, b]))
    n = pairs["visits"][s, a] + 1
    if alpha == ONE_OVER_VISITS:
        alpha = 1 / n
    old = float(Q[s, a])
    # Not old + alpha (target - old): so alpha = 1 takes the target over to the last bit.
    new = (1 - alpha) * old + alpha * (r + discount * best)
    if not math.isfinite(new):
        return math.nan
    Q[s, a] = new
    pairs["visits"][s, a] = n
    return new - old


@kernel
def replay(pairs, s, a, r, s_next, terminated, n_steps, alphas, gamma, changes):
    """`backup` over arrays; alphas[n - 1] is for the n-th visit, its last entry for all later."""
    for t in range(len(s)):
        alpha = alphas[min(pairs["visits"][s[t], a[t]], len(alphas) - 1)]
        discount = 0.0 if terminated[t] else gamma ** float(n_steps[t])
        changes[t] = backup(pairs, s[t], a[t], float(r[t]), s_next[t], discount, alpha)
        if math.isnan(changes[t]):
            return t
    return -1


@kernel
def weight(q, top, temperature):
    """exp((q - top) / T); halved on the way, so that no difference of two floats overflows."""
    return math.exp(2 * ((float(q) / 2 - float(top) / 2) / float(temperature)))


@kernel
def draw_boltzmann(pairs, s, temperature, u):
    """Equation 3.2: the action at quantile u of the Boltzmann distribution; -1 where refused."""
    Q = pairs["Q"]
    if not (0 <= s < Q.shape[0] and temperature > 0):
        return -1
    top = Q[s, 0]
    for a in range(1, Q.shape[1]):
        top = max(top, Q[s, a])
    total = 0.0
    for a in range(Q.shape[1]):
        total += weight(Q[s, a], top, temperature)
    below = 0.0
    for a in range(Q.shape[1]):
        below += weight(Q[s, a], top, temperature)
        if u * total < below:
            return a
    return -1


@kernel
def draw_greedy(pairs, s, u):
    """Equation 3.3: one of the n best actions, each with probability 1/n; -1 where refused."""
    Q = pairs["Q"]
    if not 0 <= s < Q.shape[0]:
        return -1
    top, ties = -math.inf, 0
    for a in range(Q.shape[1]):
        if not math.isfinite(Q[s, a]):
            return -1
        if Q[s, a] > top:
            top, ties = Q[s, a], 0
        ties += Q[s, a] == top
    skip = int(u * ties)
    for a in range(Q.shape[1]):
        if Q[s, a] == top:
            if skip == 0:
                return a
            skip -= 1
    return -1


@kernel
def walk_and_learn(
    pairs, cumulative, R, ends, starts, u, temperatures, alphas, gamma, changes, returns, lengths
):
    """Live len(u) steps in a model, learning from each; the number of episodes, -1 if refused."""
    n_episodes, earned, length = 0, 0.0, 0
    s = np.searchsorted(starts, u[0, 0], side="right")
    for t in range(len(u)):
        temperature = temperatures[min(t, len(temperatures) - 1)]
        if temperature > 0:
            a = draw_boltzmann(pairs, s, temperature, u[t, 1])
        else:
            a = draw_greedy(pairs, s, u[t, 1])
        if a < 0:
            return -1
        s_next = np.searchsorted(cumulative[a, s], u[t, 2], side="right")
        alpha = alphas[min(pairs["visits"][s, a], len(alphas) - 1)]
        discount = 0.0 if ends[s_next] else gamma
        changes[t] = backup(pairs, s, a, float(R[s, a]), s_next, discount, alpha)
        if math.isnan(changes[t]):
            return -1
        earned += R[s, a]
        length += 1
        s = s_next
        if ends[s]:
            returns[n_episodes], lengths[n_episodes] = earned, length
            n_episodes, earned, length = n_episodes + 1, 0.0, 0
            s = np.searchsorted(starts, u[t, 0], side="right")
    return n_episodes
