"""Results of large suites stand in their stream, and memory has little of each."""

import gc
import tracemalloc
from dataclasses import replace

import pytest

from harness.plugins.campaigns.shards import stated_variation
from harness.reporting.suite.columns import Columns
from harness.reporting.suite.record import SuiteCase
from harness.suite.results import Results
from harness.suite.stream import Stream, StreamEntry
from tests.reporting.suites import failed, passed

COUNT = 3000


def kept_in_memory(make):
    """Bytes that stay in memory for each of many results."""
    tracemalloc.start()
    kept = make()
    gc.collect()  # Python keeps up to 2000 tuples of a size for later use
    size, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert kept is not None
    return size / COUNT


def test_results_are_read_back_from_the_stream(tmp_path):
    stream = Stream(tmp_path)
    results = Results(stream)
    for index in range(COUNT):
        result = failed(index) if index % 7 == 0 else passed(index)
        entry = StreamEntry(f"key{index}", result, {"x": index / 8}, ("ur",))
        results.keep(index, result, stream.append(entry.line))
    assert len(results) == COUNT
    assert results[14] == failed(14)
    assert results[15] == passed(15)
    stored = results.stored(15)
    assert stored is not None
    assert stored.values == {"x": 1.875}
    results.drop(lambda index: index % 2 == 1)
    assert list(results) == list(range(0, COUNT, 2))
    assert sum(outcome == "failed" for _, outcome in results.outcomes()) == len(range(0, COUNT, 14))


@pytest.mark.nightly
def test_a_result_takes_little_memory(tmp_path):
    """The 100,000 cases that a file may have take 40 MB; a result itself has some kilobytes."""
    line = StreamEntry("key", passed(0), {"x": 1.0}).line

    def fill():
        stream = Stream(tmp_path)
        results = Results(stream)
        for index in range(COUNT):
            results.keep(index, passed(index), stream.append(line))
        return results

    assert kept_in_memory(fill) < 400
    made = (
        SuiteCase(replace(passed(i, 0.05 + i / 1e5), case=f"c{i}"), {"x": i / 7, "y": f"{i} cm"})
        for i in range(COUNT)
    )
    assert kept_in_memory(lambda: Columns(made, most_listed=100)) < 150
    variation = stated_variation({"samples": COUNT})  # builds the models of its keys
    assert kept_in_memory(variation.cases) < 5
