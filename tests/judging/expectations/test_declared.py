"""What expectations declare, and the limits of the rules, are changed on purpose alone."""

import ast
import importlib
from pathlib import Path

import numpy as np
import pytest

from harness.judging.expectation import Expectation
from harness.judging.expectations.placed import Placed
from harness.judging.expectations.tcp_pose import TcpPose
from harness.language.language import PREDICATES
from harness.language.poses import Pose
from harness.plugins.arms.expectations.clearance import Clearance
from harness.plugins.cameras.expectations.sees import HUES, HueRange, Sees
from harness.plugins.formulas.expectations.formula import Formula
from harness.plugins.paths.expectations.tcp_path import TcpPath
from tests.approved import SAID
from tests.code_mutation.mutants import modules
from tests.judging.evidence_runs import LINE

ROOT = Path(__file__).parents[3]
RULES = (
    "subject", "synonyms", "opposite", "judged", "short", "is_upper_bound", "is_proposed",
    "is_opposed", "is_change",
)  # fmt: skip


def is_plain(value: object) -> bool:
    """Whether a value is a number or a text, or consists of such; functions have no fixed text."""
    if isinstance(value, tuple | dict):
        return all(map(is_plain, value.values() if isinstance(value, dict) else value))
    return isinstance(value, int | float | str)


@pytest.mark.parametrize("word", sorted(PREDICATES))
def test_the_keys_defaults_and_rules_of_a_predicate(word):
    model = PREDICATES[word]
    assert model.word == word
    SAID.extend(f"{key}: {field.default!r}" for key, field in model.model_fields.items())
    SAID.extend(f"{rule}: {getattr(model, rule)!r}" for rule in RULES)
    SAID.extend(map(str, model.quantities))


def test_the_limits_of_the_rules():
    """Whichever modules they are in."""
    limits: set[str] = set()
    for path in modules(ROOT):
        name = ".".join(path.relative_to(ROOT).with_suffix("").parts)
        module = importlib.import_module(name.removesuffix(".__init__"))
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.Assign | ast.AnnAssign):
                targets = node.targets if isinstance(node, ast.Assign) else [node.target]
                keys = [each.id for each in targets if isinstance(each, ast.Name)]
                values = {key: getattr(module, key) for key in keys if hasattr(module, key)}
                limits |= {f"{key}: {it!r}" for key, it in values.items() if is_plain(it)}
    SAID.extend(sorted(limits))


@pytest.mark.parametrize(
    "spec",
    [
        Clearance(at_least=0.3),
        Clearance(max_below_plan=0.01),
        Clearance(at_least=0.02, max_below_plan=0.01),
        Formula(formula="always distance(robot, box) > 3 m and z(palm) > 0 and x(tcp) > 0"),
        Formula(formula="distance(robot, box) > 0.3 and time > 2 and z(box) > 50 cm"),
        Formula(formula="distance(robot, box) > distance(robot, Table)"),
        Formula(formula="time > 5 s"),
        Placed(object="box"),
        Placed(object="box", pose=Pose(xyz=(0, 0, 0), frame="bin")),
        Sees(camera="eye", object="box"),
        Sees(camera="eye", marker=3),
        TcpPath(),
        TcpPath(line=LINE),
        TcpPose(pose=Pose(xyz=(0, 0, 0), frame="palm")),
        PREDICATES["collision"](),
        PREDICATES["collision"](count_allowed=True),
        PREDICATES["upright"](object="box"),
    ],
    ids=lambda spec: spec.word,
)
def test_what_has_to_be_recorded_for_an_expectation(spec: Expectation):
    found = spec.observations()
    pictures = sorted(found.pictures)
    SAID.append(
        f"frames {sorted(found.frames)}, exact up to {found.clearance_cutoff}, recorded up to"
        f" {found.recorded_cutoff}, measures {found.reads_distances}, planned"
        f" {found.planned_clearances}, pictures {pictures}"
    )


def test_the_named_hues_are_the_whole_circle_without_gaps():
    edges = list(HUES.values())
    assert [low for low, _ in edges[1:]] == [high for _, high in edges[:-1]]
    assert edges[0][0] == edges[-1][1]


@pytest.mark.parametrize(
    ("hue", "degrees"),
    [
        ((0, 10), (0, 10)),
        ((340, 20), (340, 20)),
        ((-20, 10), (340, 10)),
        ((10, 360), (10, 0)),
        ((0, 360), (0, 360)),
        ((-20, 359.5), (0, 360)),
    ],
)
def test_a_hue_is_an_angle_on_the_circle(hue, degrees):
    assert HueRange(hue=tuple(np.radians(hue))).degrees() == pytest.approx(degrees)
    assert HueRange(named="blue").degrees() == HUES["blue"]
