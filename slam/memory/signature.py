"""Whether a node shows enough words to be recognised by them."""

from __future__ import annotations

import numpy as np

from slam.loop.likelihood import WordBag
from slam.memory.memory import Memory
from slam.params import Params
from slam.types import Refusal


def too_few_words(bag: WordBag, memory: Memory, params: Params) -> Refusal | None:
    """Refuses a node with fewer words than ``Kp/BadSignRatio`` of what nodes in RAM have on average.

    With no node in RAM yet the usual number is ``Kp/MaxFeatures``.
    """
    counts = [len(other.words) for other in memory.bags.values()]
    least = params.Kp.BadSignRatio * (float(np.mean(counts)) if counts else params.Kp.MaxFeatures)
    if len(bag.words) >= least:
        return None
    text = f"{len(bag.words)} words, fewer than Kp/BadSignRatio {params.Kp.BadSignRatio:g} of the usual number"
    return Refusal("Kp/BadSignRatio", float(len(bag.words)), least, text)
