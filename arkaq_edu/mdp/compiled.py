"""The compiled twins of `QLearner.update` and of the loop in `arkaq_edu.mdp.training`.

They compute the same numbers in the same order as the plain forms, and the tests hold them equal
to the last bit. The plain forms are the ones to read first. Without numba the twins run as plain
Python.

Of `alphas` (by visit), `temperatures` (by step), `terminated` and `n_steps` (by experience) the
last entry also holds for all that follow. A draw is made from `u`, a number from [0, 1).
"""

import math

import numpy as np

from arkaq_edu._checks import LARGEST
from arkaq_edu._compiled import kernel


@kernel
def highest(Q, s):
    """Return max_b Q(s, b)."""
    best = Q[s, 0]
    for b in range(1, Q.shape[1]):
        best = max(best, Q[s, b])
    return best


@kernel
def update(Q, visits, s, a, r, best, discount, alphas):
    """Make one backup (eq 2.12) and return the change of Q(s, a). `best` is max_b Q(s', b)."""
    alpha = alphas[min(visits[s, a], len(alphas) - 1)]
    visits[s, a] += 1
    target = r + discount * best
    old = Q[s, a]
    Q[s, a] += alpha * (target - Q[s, a])
    return Q[s, a] - old


@kernel
def replay(Q, visits, s, a, r, s_next, terminated, n_steps, alphas, gamma, changes):
    """Make the backups of N experiences in their order, up to one that is out of range.

    Return how many were made.
    """
    n_states, n_actions = Q.shape
    for t in range(len(s)):
        inside = (0 <= s[t] < n_states) & (0 <= a[t] < n_actions) & (0 <= s_next[t] < n_states)
        if not (inside and abs(r[t]) <= LARGEST):
            return t
        best = highest(Q, s_next[t])
        if best == -math.inf or Q[s[t], a[t]] == -math.inf:  # not allowed
            return t
        k = n_steps[min(t, len(n_steps) - 1)]
        discount = gamma if k == 1 else gamma ** float(k)
        if terminated[min(t, len(terminated) - 1)]:
            discount = 0.0
        changes[t] = update(Q, visits, s[t], a[t], r[t], best, discount, alphas)
    return len(s)


@kernel
def weight(gap, temperature):
    """Return the weight of an action that is worth `gap` <= 0 more than the best one."""
    if gap == -math.inf:  # not allowed
        return 0.0
    return 1.0 if temperature == math.inf else math.exp(gap / temperature)


@kernel
def boltzmann(Q, s, temperature, u):
    """Draw an action by its Boltzmann probability (eq 3.2)."""
    top = highest(Q, s)
    total = 0.0
    for a in range(Q.shape[1]):
        total += weight(Q[s, a] - top, temperature)
    below, chosen = 0.0, 0
    for a in range(Q.shape[1]):
        below += weight(Q[s, a] - top, temperature)
        # Counted, not branched, as a processor often guesses such a branch wrong. The product can
        # be rounded up to the total: then it is the last action with a weight.
        chosen += (below <= u * total) & (below < total)
    return chosen


@kernel
def greedy(Q, s, u):
    """Draw one of the best actions, each of n with probability 1/n (eq 3.3)."""
    top = highest(Q, s)
    ties = 0
    for a in range(Q.shape[1]):
        ties += Q[s, a] == top
    skip = int(u * ties)
    for a in range(Q.shape[1]):
        if Q[s, a] == top:
            if skip == 0:
                return a
            skip -= 1
    return -1


@kernel
def running_sums(p, first):
    """Return the running sums of each row of probabilities; the last of a row is 1.

    Row i is p[first[i]:first[i + 1]], as in a sparse matrix (CSR).
    """
    sums = np.empty(len(p))
    for i in range(len(first) - 1):
        total = 0.0
        for k in range(first[i], first[i + 1]):
            total += p[k]
            sums[k] = total
        for k in range(first[i], first[i + 1]):
            sums[k] /= total
    return sums


@kernel
def draw(sums, successors, first, row, u):
    """Draw the next state: the first successor with a running sum above u.

    A row of a dense model has all states. Then `successors` is empty: the place is the state.
    """
    low, high = first[row], first[row + 1] - 1
    while low < high:
        middle = (low + high) // 2
        if sums[middle] > u:
            high = middle
        else:
            low = middle + 1
    return successors[low] if len(successors) else low - first[row]


@kernel
def draws(sums, successors, first, rows, u):
    """Draw the next state of many walkers."""
    drawn = np.empty(len(rows), np.int64)
    for i in range(len(rows)):
        drawn[i] = draw(sums, successors, first, rows[i], u[i])
    return drawn


@kernel
def train(
    Q, visits, sums, successors, first, R, ends, starts, u, temperatures, alphas, gamma, changes,
    returns, lengths,
):  # fmt: skip
    """Run the loop of figures 4.3 and 4.4 for len(u) steps; return the number of episodes."""
    episode, earned, length = 0, 0.0, 0
    s = np.searchsorted(starts, u[0, 0], side="right")
    for t in range(len(u)):
        temperature = temperatures[min(t, len(temperatures) - 1)]
        a = boltzmann(Q, s, temperature, u[t, 1]) if temperature > 0 else greedy(Q, s, u[t, 1])
        s_next = draw(sums, successors, first, a * len(R) + s, u[t, 2])
        discount = 0.0 if ends[s_next] else gamma
        changes[t] = update(Q, visits, s, a, R[s, a], highest(Q, s_next), discount, alphas)
        earned, length, s = earned + R[s, a], length + 1, s_next
        if ends[s]:
            returns[episode], lengths[episode] = earned, length
            episode, earned, length = episode + 1, 0.0, 0
            s = np.searchsorted(starts, u[t, 0], side="right")
    return episode
