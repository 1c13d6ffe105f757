"""How much the words of a new node speak for each place in working memory."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slam.params import Params
from slam.types import Node

Array = NDArray[np.float64]
Ints = NDArray[np.int32]
_TABLE = 1 << 16
#: Scores that differ by less are as good as equal: their deviation says nothing about a new place.
_ALIKE = 1e-4


@dataclass(frozen=True, slots=True, eq=False)
class WordBag:
    """Distinct words of a node, how often each occurs, and the number of all its key points."""

    words: NDArray[np.int32]
    counts: NDArray[np.int64]
    features: int

    @classmethod
    def of(cls, node: Node) -> WordBag:
        """Words of a node; key points that were not quantised only count as features."""
        words, counts = np.unique(node.word_ids[node.word_ids > 0], return_counts=True)
        return cls(words, counts, max(1, len(node.word_ids)))


def similarity(first: WordBag, second: WordBag) -> float:
    """Share of common words: common occurrences over the larger number of words, 0 to 1."""
    _, a, b = np.intersect1d(first.words, second.words, assume_unique=True, return_indices=True)
    common = int(np.minimum(first.counts[a], second.counts[b]).sum())
    larger = max(int(first.counts.sum()), int(second.counts.sum()))
    return common / larger if larger else 0.0


def raw_likelihood(new: WordBag, places: Sequence[WordBag], others: Sequence[WordBag], params: Params) -> Array:
    """Score (P,) of each place; ``others`` are the remaining nodes in RAM, which make words more or less telling."""
    if not params.Kp.TfIdfLikelihoodUsed:
        return np.array([similarity(new, place) for place in places])
    bags = [*places, *others]
    if not places or not len(new.words):
        return np.zeros(len(places))
    rows, asked = _occurrences(np.concatenate([bag.words for bag in bags]), new.words)
    having = np.bincount(asked, minlength=len(new.words))
    inverse_frequency = np.log10(len(bags) / np.maximum(having, 1))
    weight = np.concatenate([bag.counts / bag.features for bag in places])
    owner = np.repeat(np.arange(len(places)), [len(bag.words) for bag in places])
    known = rows < len(weight)
    rows, asked = rows[known], asked[known]
    terms = weight[rows] * inverse_frequency[asked]
    return np.bincount(owner[rows], weights=terms, minlength=len(places)).astype(np.float64)


def _occurrences(words: Ints, asked: Ints) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Where in ``words`` each of ``asked`` (ascending) occurs: rows, and which one it is.

    Ids grow with the map, so that no table is made over all of them: one over their last bits leaves few to search.
    """
    table = np.zeros(_TABLE, np.bool_)
    table[asked % _TABLE] = True
    rows = np.flatnonzero(table[words % _TABLE])
    at = np.minimum(np.searchsorted(asked, words[rows]), len(asked) - 1)
    found = asked[at] == words[rows]
    return rows[found], at[found]


def adjust(scores: Array, params: Params) -> tuple[Array, float]:
    """Scores to likelihoods: what does not stand out counts 1; with the likelihood of a new place.

    Mean and deviation are over the scores that are not zero (Labbe and Michaud 2013, equations 5 and 6).
    """
    positive = scores[scores > 0]
    if len(positive) < 2:
        return np.ones(len(scores)), 2.0
    mean, deviation = float(positive.mean()), float(positive.std(ddof=1))
    likelihood = np.where(scores > mean + deviation, (scores - deviation + _ALIKE) / mean, 1.0)
    largest = float(scores.max())
    if params.Rtabmap.VirtualPlaceLikelihoodRatio == 0:
        virtual = mean / deviation + 1.0 if deviation > _ALIKE else 2.0
    else:
        virtual = deviation / (largest - mean) + 1.0 if largest > mean else 2.0
    return likelihood, virtual
