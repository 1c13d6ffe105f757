"""A forest of randomised k-d trees over float descriptors (Silpa-Anan and Hartley 2008), as compiled code.

Each tree cuts a full leaf at the mean of one of its most varied components, drawn at random; a query walks all trees
at once, the nearest cells first, until it has looked at enough words (Muja and Lowe 2009).

The trees are one tuple of arrays; node k of tree t is [t, k], node 0 is the root:
axes, the component that a node cuts, -1 for a leaf; cuts, the value at which it does: what is below goes left;
children, the row of the left child, the right one is next; heads, the newest word of a leaf, -1 where it is empty;
fills, the words of a leaf; chain (T, N), the word before in the same leaf; counts (T,), the nodes in use.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from slam.features.distances import distance

TREES = 4
#: Words of a leaf before it is cut.
_LEAF = 24
#: Components with the largest variance, of which one is drawn to cut a leaf.
_VARIED = 5
#: Words a query looks at: among 50,000 SIFT descriptors it finds the nearest of 93 in 100, in 0.08 ms each.
_CHECKS = 1000
_BRANCHES = 8192

Floats = NDArray[np.float32]
Ints = NDArray[np.int32]
Bools = NDArray[np.bool_]
Random = NDArray[np.uint64]
Trees = tuple[Ints, Floats, Ints, Ints, Ints, Ints, Ints]


def planted(size: int) -> Trees:
    """Empty trees with room for ``size`` words."""
    shape = (TREES, 2 * size + 2)
    axes, children, heads, fills = (np.full(shape, fill, np.int32) for fill in (-1, 0, -1, 0))
    chain = np.full((TREES, size), -1, np.int32)
    return axes, np.zeros(shape, np.float32), children, heads, fills, chain, np.ones(TREES, np.int32)


def grown(trees: Trees, size: int) -> Trees:
    """The same trees with room for ``size`` words."""
    larger = planted(size)
    for old, new in zip(trees, larger, strict=True):
        new[..., : old.shape[-1]] = old
    return larger


@njit(cache=True, nogil=True)
def _drawn(random: Random, below: int) -> int:
    """A number from 0 to ``below`` - 1 (xorshift, Marsaglia 2003); the state moves on."""
    state = random[0]
    state ^= state << np.uint64(13)
    state ^= state >> np.uint64(7)
    state ^= state << np.uint64(17)
    random[0] = state
    return int((state >> np.uint64(33)) % np.uint64(below))


@njit(cache=True, nogil=True)
def _cut_axis(members: Ints, words: Floats, random: Random) -> tuple[int, float]:
    """One of the most varied components of these words and its mean; -1 when all of them are equal."""
    width = words.shape[1]
    means = np.zeros(width)
    variances = np.zeros(width)
    for row in members:
        for k in range(width):
            means[k] += words[row, k]
    means /= len(members)
    for row in members:
        for k in range(width):
            variances[k] += (words[row, k] - means[k]) ** 2
    best = np.argsort(-variances)[: min(_VARIED, width)]
    axis = best[_drawn(random, len(best))]
    if variances[axis] == 0.0:
        axis = best[0]
    return (int(axis), means[axis]) if variances[axis] > 0.0 else (-1, 0.0)


@njit(cache=True, nogil=True)
def _split(tree: int, leaf: int, words: Floats, trees: Trees, random: Random) -> None:
    axes, cuts, children, heads, fills, chain, counts = trees
    members = np.empty(fills[tree, leaf], np.int32)
    row = heads[tree, leaf]
    for k in range(len(members)):
        members[k] = row
        row = chain[tree, row]
    axis, mean = _cut_axis(members, words, random)
    if axis < 0:
        return
    cut = np.float32(mean)
    left = counts[tree]
    counts[tree] += 2
    axes[tree, leaf], cuts[tree, leaf], children[tree, leaf] = axis, cut, left
    for member in members[::-1]:
        child = left + (0 if words[member, axis] < cut else 1)
        chain[tree, member] = heads[tree, child]
        heads[tree, child] = member
        fills[tree, child] += 1


@njit(cache=True, nogil=True)
def _insert(descriptor: Floats, row: int, words: Floats, alive: Bools, trees: Trees, random: Random) -> None:
    axes, cuts, children, heads, fills, chain, _ = trees
    words[row] = descriptor
    alive[row] = True
    for tree in range(axes.shape[0]):
        node = 0
        while axes[tree, node] >= 0:
            node = children[tree, node] + (0 if descriptor[axes[tree, node]] < cuts[tree, node] else 1)
        chain[tree, row] = heads[tree, node]
        heads[tree, node] = row
        fills[tree, node] += 1
        if fills[tree, node] > _LEAF:
            _split(tree, node, words, trees, random)


@njit(cache=True, nogil=True)
def insert_all(descriptors: Floats, first: int, words: Floats, alive: Bools, trees: Trees, random: Random) -> None:
    """Takes in words from row ``first`` on."""
    for k in range(len(descriptors)):
        _insert(descriptors[k], first + k, words, alive, trees, random)


@njit(cache=True, nogil=True)
def _push(bounds: Floats, places: Ints, size: int, bound: float, place: int) -> int:
    """Adds a branch to a heap whose top has the least bound; a full heap refuses."""
    if size == len(bounds):
        return size
    k = size
    while k > 0 and bounds[(k - 1) // 2] > bound:
        bounds[k], places[k] = bounds[(k - 1) // 2], places[(k - 1) // 2]
        k = (k - 1) // 2
    bounds[k], places[k] = bound, place
    return size + 1


@njit(cache=True, nogil=True)
def _pop(bounds: Floats, places: Ints, size: int) -> int:
    """Takes the top off a heap."""
    size -= 1
    bound, place = bounds[size], places[size]
    k = 0
    while 2 * k + 1 < size:
        child = 2 * k + 1
        if child + 1 < size and bounds[child + 1] < bounds[child]:
            child += 1
        if bounds[child] >= bound:
            break
        bounds[k], places[k] = bounds[child], places[child]
        k = child
    bounds[k], places[k] = bound, place
    return size


@njit(cache=True, nogil=True)
def assign(
    descriptors: Floats,
    words: Floats,
    alive: Bools,
    trees: Trees,
    stamps: Ints,
    stamp: int,
    count: int,
    known: int,
    ratio: float,
    learn: bool,
    random: Random,
) -> tuple[Ints, int, int]:
    """Row of the word of each descriptor (-1 for none), then the number of words and the newest stamp."""
    axes, cuts, children, heads, _, chain, _ = trees
    span = axes.shape[1]
    bounds, places = np.empty(_BRANCHES, np.float32), np.empty(_BRANCHES, np.int32)
    rows = np.empty(len(descriptors), np.int32)
    for i in range(len(descriptors)):
        query = descriptors[i]
        stamp += 1
        best, second, best_row, checked, size = np.inf, np.inf, -1, 0, 0
        for tree in range(axes.shape[0]):
            size = _push(bounds, places, size, 0.0, tree * span)
        while size > 0 and (checked < _CHECKS or second == np.inf):
            bound, place = bounds[0], places[0]
            size = _pop(bounds, places, size)
            if bound >= second:
                continue
            tree, node = place // span, place % span
            while axes[tree, node] >= 0:
                off = query[axes[tree, node]] - cuts[tree, node]
                near = children[tree, node] + (0 if off < 0 else 1)
                far = children[tree, node] + (1 if off < 0 else 0)
                size = _push(bounds, places, size, bound + off * off, tree * span + far)
                node = near
            row = heads[tree, node]
            while row >= 0:
                if stamps[row] != stamp and alive[row] and row < known:
                    stamps[row] = stamp
                    checked += 1
                    d = distance(query, words[row])
                    if d < best:
                        second = best
                        best, best_row = d, row
                    elif d < second:
                        second = d
                row = chain[tree, row]
        sure = best_row >= 0 and (np.isinf(ratio) or (second < np.inf and best <= ratio * second))
        rows[i] = best_row if sure else -1
        if rows[i] < 0 and learn:
            _insert(query, count, words, alive, trees, random)
            rows[i] = count
            count += 1
    return rows, count, stamp
