"""The pictures of the reference of expectations, from real runs; arguments name some of them."""

from __future__ import annotations

import io
import re
import sys
import tempfile
import textwrap
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import cv2
import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from docs import ROOT
from docs.generators.picture_scenes import PICTURES, expectation, scenario
from docs.generators.picture_scenes import expectations_of as texts_of
from harness.core.types import FloatArray
from harness.judging.contacts import debounced
from harness.judging.margins import MarginSignal
from harness.judging.placed import PlacedExpectation
from harness.judging.temporal import episodes
from harness.judging.window import Window, window_of
from harness.language.reading.load import load_scenario
from harness.plugins.comparison.rejudge import expectations_of
from harness.recording.read_run import read_run
from harness.recording.run import Run
from harness.recording.verdict import Measure, Verdict
from tests.running import run_case

FOLDER = ROOT / "docs/pictures/expectations"
RENEW = "python -m docs.generators.expectation_pictures"
SAMPLES = 160
GREEN, RED, BLUE, GREY = "#1a7f37", "#cf222e", "#0b57d0", "#57606a"
Panel = tuple[str, Run, PlacedExpectation, Verdict]
"""The YAML of an expectation, the run, the expectation, and its verdict."""
STYLE = {
    "svg.fonttype": "none",
    "svg.hashsalt": "armharness",
    "font.family": "sans-serif",
    "font.size": 8,
    "axes.spines.top": False,
    "axes.spines.right": False,
}
SHOWN = {"m": (1e3, "mm"), "rad": (180 / np.pi, "deg"), "m/s": (1e3, "mm/s")}
SHOWN |= {"rad/s": (180 / np.pi, "deg/s"), "1": (1.0, "")}


def run_scene(title: str, folder: Path) -> tuple[Run, dict[str, tuple[PlacedExpectation, Verdict]]]:
    """The run of a scene, and its expectations with their verdicts, by their YAML."""
    path = folder / "scene.scenario.yaml"
    path.write_text(scenario(title), encoding="utf-8")
    result = run_case(path, report_dir=folder / "report", stills=False, page=False)
    assert result.verdicts, (title, result.problems, result.message)
    placed = expectations_of(load_scenario(path))
    pairs = zip(placed, result.verdicts, strict=True)
    return read_run(folder / "report").run, dict(zip(texts_of(title), pairs, strict=True))


def course(
    window: Window, margins: MarginSignal, measure: Measure
) -> tuple[FloatArray, FloatArray]:
    """Times, and the measure at each of them; NaN where it is not shown."""
    decided = np.argmin(np.abs(window.times - measure.time)) + np.arange(-2, 3)
    picked = np.linspace(0, len(window.times) - 1, SAMPLES).astype(int)
    picked = np.unique(np.clip([*picked, *decided], 0, len(window.times) - 1))
    pair = tuple(measure.detail.split(" and "))
    if pair in window.run.signals.contact_forces:  # a collision shows its peak at every sample
        force = debounced(window.run, window.run.signals.contact_forces[pair])
        return window.times[picked], window.cut(force)[picked]
    values = np.full(len(picked), np.nan)
    for place, index in enumerate(picked):
        if np.isfinite(margins.values[index]):
            found = [m for m in margins.evidence(int(index)).measures if m.name == measure.name]
            values[place] = found[0].value if found else np.nan
    return window.times[picked], values


def draw_course(
    axes: Axes, run: Run, placed: PlacedExpectation, verdict: Verdict, quantity: str
) -> None:
    """Draw the deciding quantity, its limit, where it holds, and the sample that decides."""
    terms = placed.spec.terms(placed.step)
    window = window_of(run, terms.step)
    margins = placed.spec.predicates().get("predicate", placed.spec).margins(window)
    measure = next((m for m in verdict.measures if m.name == quantity), verdict.measures[0])
    factor, unit = SHOWN.get(measure.unit, (1.0, measure.unit))
    times, values = course(window, margins, measure)
    for start, stop in episodes(margins.values >= 0):
        bad = terms.word == "never"
        ends = window.time(start), window.time(stop - 1)
        axes.axvspan(*ends, color=RED if bad else GREEN, alpha=0.13, lw=0)
    axes.plot(times, factor * values, color=BLUE, lw=1.2)
    axes.axhline(factor * measure.limit, color=GREY, lw=0.9, ls=(0, (4, 3)))
    axes.plot([measure.time], [factor * measure.value], "o", ms=5, color=colour(verdict))
    axes.set_xlabel("time [s]")
    axes.set_ylabel(measure.name + (f" [{unit}]" if unit else ""))
    low, high = axes.get_ylim()
    axes.set_ylim(low - 0.05 * (high - low), high + 0.1 * (high - low))


def draw_picture(axes: Axes, run: Run, placed: PlacedExpectation, *_: object) -> None:
    """Draw the camera picture that was judged, with the object's pixels outlined."""
    window = window_of(run, placed.spec.terms(placed.step).step)
    spec = placed.spec
    taken = [each for each in run.captures if each.sample == window.stop - 1]
    files = {kind: run.files[path] for each in taken for kind, path in each.files.items()}
    whole = [each for each in taken if "segmentation" in each.files][-1]
    labels = cv2.imdecode(np.frombuffer(files["segmentation"], np.uint8), cv2.IMREAD_UNCHANGED)
    mask = (labels == whole.labels.get(spec.object, -1)).astype(np.uint8)
    picture = cv2.imdecode(np.frombuffer(files["color"], np.uint8), cv2.IMREAD_COLOR)
    found, _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    cv2.drawContours(picture, found, -1, (55, 200, 26), 1)
    axes.imshow(cv2.cvtColor(picture, cv2.COLOR_BGR2RGB), interpolation="nearest")
    axes.set_axis_off()


def title_of(text: str, verdict: Verdict) -> str:
    """The expectation and its verdict."""
    reason = textwrap.fill(f"{verdict.status}: {verdict.reason}", 66, max_lines=2)
    return f"{textwrap.fill(text, 66)}\n{reason}"


def colour(verdict: Verdict) -> str:
    """Green for an expectation that passes, red for one that does not."""
    return GREEN if verdict.status == "passed" else RED


def drawn(word: str, panels: list[Panel]) -> str:
    """The picture of a predicate as SVG: an expectation that passes next to one that fails."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(8.4, 2.7), layout="constrained")
        for axes, (text, run, placed, verdict) in zip(figure.subplots(1, 2), panels, strict=True):
            draw = draw_picture if word == "sees" else draw_course
            draw(axes, run, placed, verdict, panels[-1][-1].measures[0].name)
            title = title_of(text, verdict)
            axes.set_title(title, fontsize=7, loc="left", color=colour(verdict))
        stream = io.StringIO()
        figure.savefig(stream, format="svg", metadata={"Date": None, "Creator": None})
    return _small(stream.getvalue())


def _small(svg: str) -> str:
    """The same picture with coordinates rounded to a tenth of a pixel, and fewer lines."""
    svg = re.sub(r"<metadata>.*?</metadata>|<!--.*?-->", "", svg, flags=re.DOTALL)
    svg = re.sub(r"font-family: [^;\"]*", "font-family: sans-serif", svg)
    svg = re.sub(r' transform="rotate\(-0 [^)]*\)"', "", svg)
    parts = re.split(r"(<text.*?</text>)", svg, flags=re.DOTALL)
    for place in range(0, len(parts), 2):
        parts[place] = re.sub(r"\d+\.\d{2,}", lambda n: f"{float(n[0]):.1f}", parts[place])
    return re.sub(r"\s*\n\s*", "\n", "".join(parts))


def pictures(words: Iterable[str] = PICTURES) -> Iterator[tuple[str, list[Panel]]]:
    """Predicates with the panels of their pictures, from runs made for this purpose."""
    pairs = {word: PICTURES[word] for word in words}
    with tempfile.TemporaryDirectory() as folder:
        runs = {}
        for title in dict.fromkeys(title for pair in pairs.values() for title, _ in pair):
            place = Path(folder) / title
            place.mkdir()
            runs[title] = run_scene(title, place)
        for word, pair in pairs.items():
            panels: list[Panel] = []
            for title, content in pair:
                run, verdicts = runs[title]
                text = expectation(word, content)
                panels.append((text, run, *verdicts[text]))
            yield word, panels


def words_in(svg: str) -> str:
    """The words of a picture in one line."""
    return " ".join(re.findall(r"<text[^>]*>(.*?)</text>", svg, re.DOTALL))


def main(words: Sequence[str]) -> None:
    """Draw the pictures of these predicates, or all."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    for word, panels in pictures(words or PICTURES):
        statuses = [verdict.status for *_, verdict in panels]
        assert statuses == ["passed", "failed"], (word, panels)
        (FOLDER / f"{word}.svg").write_text(drawn(word, panels), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
