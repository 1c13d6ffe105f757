"""Fixed dictionaries: always the nearest word, none is made, and the map file gets each word once."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from slam.database import MapReader, MapWriter, WordRows
from slam.errors import ParameterError
from slam.features.dictionary import Dictionary
from slam.features.dictionary_file import open_dictionary, read_dictionary
from slam.features.fixed_dictionary import FixedDictionary
from slam.params import Params
from slam.slam import Slam
from slam.types import Descriptors
from tests.nodes import random_descriptors
from tests.tours import EVERY, fed, there_and_back
from tests.unit.database.map_records import write_map

PARAMS = Params()


def floats(count: int, seed: int) -> NDArray[np.float32]:
    return np.random.default_rng(seed).normal(size=(count, 16)).astype(np.float32)


def words_of(descriptors: Descriptors) -> WordRows:
    """Words with every third number."""
    return WordRows(np.arange(3, 3 * len(descriptors) + 1, 3, dtype=np.int32), descriptors)


def text(words: WordRows) -> str:
    lines = [f"WordID Descriptors...{words.descriptors.shape[1]}"]
    lines += [
        f"{i} " + " ".join(f"{v:f}" for v in row) + " " for i, row in zip(words.ids, words.descriptors, strict=True)
    ]
    return "\n".join(lines) + "\n"


def test_a_binary_descriptor_is_its_nearest_word_however_far() -> None:
    words = words_of(random_descriptors(300, 0))
    queries = random_descriptors(100, 1)
    found, _, _ = FixedDictionary(words).quantize(queries, PARAMS)
    bits = np.unpackbits(queries[:, None] ^ np.asarray(words.descriptors)[None], axis=2).sum(axis=2)
    assert found.tolist() == words.ids[bits.argmin(axis=1)].tolist()


def test_a_float_descriptor_is_its_nearest_word_however_far() -> None:
    words = words_of(floats(300, 0))
    queries = 5 * floats(100, 1)
    found, _, _ = FixedDictionary(words).quantize(queries, PARAMS)
    distances = np.linalg.norm(queries[:, None] - words.descriptors[None], axis=2)
    assert found.tolist() == words.ids[distances.argmin(axis=1)].tolist()


def test_a_word_is_handed_out_until_a_node_that_is_kept_has_it() -> None:
    words = words_of(random_descriptors(5, 0))
    dictionary = FixedDictionary(words, stored=[6])
    seen = words.descriptors[[0, 0, 1, 3]]
    for _ in range(2):  # a node that is not kept leaves nothing in the file
        ids, fresh, descriptors = dictionary.quantize(seen, PARAMS)
        assert (ids.tolist(), fresh.tolist()) == ([3, 3, 6, 12], [3, 12])
        np.testing.assert_array_equal(descriptors, words.descriptors[[0, 3]])
        dictionary.discard(ids.tolist())
    dictionary.use(ids.tolist())
    assert dictionary.quantize(seen, PARAMS)[1].tolist() == []
    assert dictionary.ids() == [3, 6, 12]
    dictionary.release([3, 6, 12])
    assert (dictionary.ids(), len(dictionary)) == ([3], 5)
    assert dictionary.quantize(seen, PARAMS)[1].tolist() == [], "what left RAM is in the file"


def test_words_come_back_under_their_numbers_or_are_refused() -> None:
    dictionary = FixedDictionary(words_of(floats(5, 0)))
    assert dictionary.restore(np.array([3, 9], np.int32), floats(2, 0), PARAMS) == {3: 3, 9: 9}
    with pytest.raises(ParameterError, match="word 4 of the map is not in Kp/DictionaryPath"):
        dictionary.restore(np.array([3, 4], np.int32), floats(2, 0), PARAMS)


def test_descriptors_of_another_kind_are_refused() -> None:
    with pytest.raises(ParameterError, match="can't be compared"):
        FixedDictionary(words_of(floats(5, 0))).quantize(random_descriptors(2, 0), PARAMS)


def test_rtabmaps_text_is_read(tmp_path: Path) -> None:
    path, words = tmp_path / "words.txt", words_of(floats(20, 0))
    path.write_text(text(words) + "\n")
    read = read_dictionary(path)
    assert read.ids.tolist() == words.ids.tolist()
    assert read.descriptors.dtype == np.float32
    np.testing.assert_allclose(read.descriptors, words.descriptors, atol=1e-6)


def test_the_words_of_a_map_are_read(tmp_path: Path) -> None:
    path = write_map(tmp_path / "map.db", 3)
    read, expected = read_dictionary(path), MapReader(path).words()
    assert read.ids.tolist() == expected.ids.tolist() != []
    np.testing.assert_array_equal(read.descriptors, expected.descriptors)


@pytest.mark.parametrize(
    ("content", "why"),
    [
        ("", ":1: the first line"),
        ("WordID Descriptors...\n", ":1: the first line"),
        ("WordID Descriptors...5000\n", "1 to 1000"),
        ("WordID Descriptors...2\n", "has no words"),
        ("WordID Descriptors...2\n1 0.5 0.5\n2 0.5\n", ":3: must be"),
        ("WordID Descriptors...2\n1 0.5 0.5\n1 0.5 0.5\n", ":3: must be"),
        ("WordID Descriptors...2\n0 0.5 0.5\n", ":2: must be"),
        ("WordID Descriptors...2\n1 0.5 nan\n", ":2: must be"),
        ("WordID Descriptors...2\n1 0.5 x\n", ":2: must be"),
    ],
)
def test_a_wrong_text_is_refused_with_its_line(tmp_path: Path, content: str, why: str) -> None:
    path = tmp_path / "words.txt"
    path.write_text(content)
    with pytest.raises(ParameterError, match=why) as caught:
        read_dictionary(path)
    assert str(path) in str(caught.value)


@pytest.mark.parametrize("name", ["none.txt", "none.db"])
def test_a_dictionary_that_is_not_there_is_refused(tmp_path: Path, name: str) -> None:
    fixed = PARAMS.changed({"Kp/IncrementalDictionary": False, "Kp/DictionaryPath": str(tmp_path / name)})
    with pytest.raises(ParameterError, match="can't be read"):
        open_dictionary(fixed, seed=0)


def test_a_fixed_dictionary_needs_a_path() -> None:
    with pytest.raises(ParameterError, match="needs Kp/DictionaryPath"):
        Slam(PARAMS.changed({"Kp/IncrementalDictionary": False}))
    assert isinstance(open_dictionary(PARAMS, seed=0), Dictionary)


@pytest.mark.parametrize("type_number", [8, 1])
def test_a_map_made_with_the_words_of_another_has_only_those(tmp_path: Path, type_number: int) -> None:
    way = there_and_back(5)
    free = EVERY.changed({"Vis/FeatureType": type_number, "Kp/DetectorStrategy": type_number, "Mem/STMSize": 2})
    first, second = tmp_path / "first.db", tmp_path / "second.db"
    slam = Slam(free, MapWriter.create(first, free, seed=0, source="tour:"))
    fed(slam, way[:5])
    slam.close()
    fixed = free.changed({"Kp/IncrementalDictionary": False, "Kp/DictionaryPath": str(first), "Rtabmap/MemoryThr": 2})
    slam = Slam(fixed, MapWriter.create(second, fixed, seed=0, source="tour:"))
    updates = fed(slam, way)
    slam.close()
    given, used = MapReader(first).words(), MapReader(second).words()
    assert set(used.ids.tolist()) <= set(given.ids.tolist())
    assert used.descriptors.dtype == given.descriptors.dtype
    for word_id, descriptor in zip(used.ids.tolist(), used.descriptors, strict=True):
        np.testing.assert_array_equal(descriptor, given.descriptors[given.ids.tolist().index(word_id)])
    nodes = [u.node for u in updates if u.node is not None]
    assert set(used.ids.tolist()) == {w for node in nodes for w in node.word_ids.tolist() if w > 0}
    assert len(slam.memory.dictionary) == len(given)
    assert any(c.refusal is None for u in updates for c in u.candidates), "loops are closed with them"
