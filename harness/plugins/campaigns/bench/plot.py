"""The comparison as a picture: one panel for each quantity, one box for each planner (SVG)."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

import numpy as np

from harness.plugins.campaigns.bench.collect import MotionTrials
from harness.plugins.campaigns.bench.summary import QUANTITIES, ComparedQuantity, of_planner, values

PANEL_WIDTH, LABEL_WIDTH, ROW, TOP, BOTTOM, GAP = 360, 130, 26, 42, 34, 24  # [px]
COLUMNS, HEAD = 2, 56
LEGEND = (
    "Thick line: median; box: quartiles; thin line: extremes. Failed plans count only in success "
    "and state checks."
)
WIDE = 20.0  # ratio of the largest to the smallest value above which a panel's axis is logarithmic
INK, FAINT, BOX, LINE = "#333", "#ddd", "#9ec1e0", "#1f5f99"


def plot(motions: Sequence[MotionTrials], planners: Sequence[str], title: str) -> str:
    """The text of an SVG file: boxes from quartile to quartile, whiskers to the extremes.

    Args:
        planners: The rows of each panel, in this order.
    """
    panels = [_success(motions, planners)]
    panels += [_boxes(quantity, motions, planners) for quantity in QUANTITIES]
    height = TOP + ROW * len(planners) + BOTTOM
    rows = -(-len(panels) // COLUMNS)
    whole_width = COLUMNS * (LABEL_WIDTH + PANEL_WIDTH + GAP) + GAP
    whole_height = HEAD + rows * (height + GAP)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{whole_width}" height="{whole_height}" '
        f'viewBox="0 0 {whole_width} {whole_height}" font-family="sans-serif" font-size="12">',
        f'<rect width="{whole_width}" height="{whole_height}" fill="white"/>',
        f'<text x="{GAP}" y="24" font-size="16" fill="{INK}">{escape(title)}</text>',
        f'<text x="{GAP}" y="44" fill="{INK}">{escape(LEGEND)}</text>',
    ]
    for index, panel in enumerate(panels):
        x = GAP + (index % COLUMNS) * (LABEL_WIDTH + PANEL_WIDTH + GAP)
        y = HEAD + (index // COLUMNS) * (height + GAP)
        parts += [f'<g transform="translate({x},{y})">', *panel, "</g>"]
    return "\n".join([*parts, "</svg>", ""])


def _success(motions: Sequence[MotionTrials], planners: Sequence[str]) -> list[str]:
    parts = _frame("success [%]", planners, [(0, "0"), (0.5, "50"), (1, "100")])
    for row, planner in enumerate(planners):
        trials = of_planner(motions, planner)
        share = sum(trial.is_solved for trial in trials) / max(1, len(trials))
        width = max(0.5, share * PANEL_WIDTH)
        parts.append(_rectangle(LABEL_WIDTH, row, width))
    return parts


def _boxes(
    quantity: ComparedQuantity, motions: Sequence[MotionTrials], planners: Sequence[str]
) -> list[str]:
    found = {planner: values(quantity, of_planner(motions, planner)) for planner in planners}
    every = [value for row in found.values() for value in row]
    if not every:
        return _frame(f"{quantity.name}: none", planners, [])
    axis = _Axis(min(every), max(every), may_be_log=quantity.may_be_log)
    parts = _frame(quantity.name, planners, axis.ticks())
    for row, planner in enumerate(planners):
        if not found[planner]:
            continue
        places = np.percentile([axis.place(v) for v in found[planner]], [0, 25, 50, 75, 100])
        least, low, middle, high, most = (LABEL_WIDTH + PANEL_WIDTH * p for p in places)
        y = TOP + ROW * (row + 0.5)
        parts.append(f'<path d="M{least:.1f} {y}H{most:.1f}" stroke="{LINE}" stroke-width="1.5"/>')
        parts.append(_rectangle(low, row, max(high - low, 1.0)))
        parts.append(
            f'<path d="M{middle:.1f} {y - 9}V{y + 9}" stroke="{LINE}" stroke-width="2.5"/>'
        )
    return parts


class _Axis:
    """Maps values to places from 0 to 1, logarithmically if the values span decades."""

    def __init__(self, least: float, most: float, *, may_be_log: bool) -> None:
        self.is_log = may_be_log and least > 0 and most / least > WIDE
        if self.is_log:
            self.low, self.high = np.floor(np.log10(least)), np.ceil(np.log10(most))
            self.step = 1.0
            return
        self.low = min(0.0, least)
        self.step = _nice_step((most - self.low) or 1.0)
        self.low = self.step * np.floor(self.low / self.step + 1e-9)
        self.high = max(self.step, self.step * np.ceil(most / self.step - 1e-9))

    def place(self, value: float) -> float:
        """The place of a value on the axis, from 0 to 1."""
        number = np.log10(value) if self.is_log else value
        return float((number - self.low) / (self.high - self.low))

    def ticks(self) -> list[tuple[float, str]]:
        """Places and labels."""
        marks = np.arange(self.low, self.high + 0.5 * self.step, self.step)
        values = 10.0**marks if self.is_log else marks
        return [(self.place(value), f"{value:,.6g}") for value in values]


def _nice_step(span: float) -> float:
    """1, 2 or 5 times a power of ten, so that a span has three to six steps."""
    power = 10.0 ** np.floor(np.log10(span / 4))
    return next(float(power * nice) for nice in (1, 2, 5, 10) if span / (power * nice) <= 5.5)


def _frame(title: str, planners: Sequence[str], ticks: Sequence[tuple[float, str]]) -> list[str]:
    """Title, names of the planners, grid and its labels."""
    bottom = TOP + ROW * len(planners)
    parts = [f'<text x="{LABEL_WIDTH}" y="24" font-weight="bold" fill="{INK}">{title}</text>']
    for row, planner in enumerate(planners):
        y = TOP + ROW * (row + 0.5) + 4
        parts.append(
            f'<text x="{LABEL_WIDTH - 8}" y="{y}" text-anchor="end" fill="{INK}">'
            f"{escape(planner)}</text>"
        )
    for place, label in ticks:
        x = LABEL_WIDTH + PANEL_WIDTH * place
        parts.append(f'<path d="M{x:.1f} {TOP}V{bottom}" stroke="{FAINT}"/>')
        parts.append(
            f'<text x="{x:.1f}" y="{bottom + 16}" text-anchor="middle" fill="{INK}" '
            f'font-size="11">{label}</text>'
        )
    return parts


def _rectangle(x: float, row: int, width: float) -> str:
    return (
        f'<rect x="{x:.1f}" y="{TOP + ROW * row + 5}" width="{width:.1f}" height="{ROW - 10}" '
        f'fill="{BOX}" stroke="{LINE}"/>'
    )
