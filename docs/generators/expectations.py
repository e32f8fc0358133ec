"""The reference of expectations as Markdown, made from the models."""

from __future__ import annotations

from docs import ROOT
from docs.generators.reference import (
    VALUES,
    contents,
    part_sections,
    section,
    table,
    words,
)
from docs.generators.worked_examples import example
from harness.core.registry import OWN_PACKAGE, Registry, registry
from harness.language.annotations import description_of, keys_of
from harness.language.expectation import KIND, ExpectationFields, PredicateFields, Quantity
from harness.language.language import EXPECTATIONS, KEYS_BY_PREDICATE, PREDICATES, TEMPORAL
from harness.plugins.formulas.language.formula import SIGNALS

PICTURES = ROOT / "docs/pictures/expectations"
JUDGED = {
    "at_end": "Without a temporal word it must hold at the last sample of its window, which"
    " decides.",
    "always": "Without a temporal word it must hold at every sample of its window; the sample with"
    " the smallest margin decides.",
    "eventually": "Without a temporal word it must hold at some sample of its window; the sample"
    " with the largest margin decides.",
}
EXPECTATIONS_HEAD = """\
An expectation is a predicate, alone or inside a temporal word. Its window is the step if it is
listed under the step's `expect`, and the whole run if it is listed under the file's. A step that
puts, adds or removes objects takes no time: the sample after it is the first that shows what it
did, and belongs to it. Where another step changes an object at the same moment, that sample shows
what both did: an expectation of the first that names the object is not observable, unless a `wait`
stands between them.

```yaml
expect:
  - lifted: {object: green_cylinder, above: 5 cm, for: 1 s}
  - always: within_limits
  - never: {collision: {between: [robot, Table]}}
```

Every verdict follows from the recording alone. It states its numbers, the sample that decided,
and a margin: the distance from the limit, in the unit of the limit, positive where the predicate
holds. A predicate of several quantities holds where all of them do. The quantities are compared
as shares of their limits. Shares are compared by how much of the range from the limit to 1 is
left. The tightest one decides, and its margin is the margin of the verdict. What was not
observed does not pass: the verdict is `not reached` if the step was not reached or the object was
not in the scene, and `not observable` if the signal was not recorded.

Every verdict states how much it observed: the number of known and of unknown samples, the pairs of
bodies, and how often a premise held. Where the unknown samples could change the verdict it is `not
observable`; a violation at a known sample has failed nevertheless. A verdict that passes and shows
little carries a named warning. `harness run --strict`, `harness judge --strict` and `pytest
--harness-strict` turn warnings into failures:

| warning | condition |
| --- | --- |
| already true at the start | `eventually`, `lifted`, `displaced`, the second part of `until`, \
or what a formula awaits, holds at the first sample of its window; `placed`, `released` and `in` \
at the end, where the robot never touched the object and it moved by no more than 5 mm (for \
`placed` in the world, in the frame of `pose`, or on what carries it), or was in the container \
since the run began |
| premise never held | P of `P implies Q`, or of `not P or Q`, holds at no sample of the window |
| hardly observed | `always` or `never` of something that is in the scene at 1 % of the samples \
at most, as an object that the next step adds, over a step that takes no time, or of fewer than \
three pictures of more than 0.2 s; a formula without a temporal word, which reads its first \
sample alone |
| partly seen | `never: sees` of an object of which a picture shows less than `min_visible` |
| contact may be missed | `never: in_contact` or `never: collision` of an object that moves \
between two samples by more than its least width and the other's together: the physics looks for \
contacts at the samples |
| held object is nearer | `clearance` of the robot and an object, to which something that the hand \
holds, or carries on what it holds, comes nearer than the links may; not of what is taken from it \
or put on it |
| held on a running belt | `placed` of an object on a surface that runs at the end: a stop keeps \
it there, and not its support |
| held by a weld | `inserted` of a peg that is welded to the hand |
| still moving | `joint` of a door, drawer or lid that moves faster than what is `static`, \
5 mm/s or 0.05 rad/s, at the moment it is judged at |
| no collision shapes | `collision`, `in_contact` or `clearance` of a robot with moving links \
that have no collision shapes: they pass through everything |

A step that fails unexpectedly ends the run. Expectations that could still have become true are
then `not reached` and name that step: `lifted`, `eventually`, and everything that is judged at
the end. An expectation that no continuation could have fulfilled has failed: an `always` that was
violated, a deadline that has passed.

The pictures show real runs: the measured quantity that decides, its limit, green areas where the
predicate holds, and the sample that decides. The expectation on the left passes, the one on the
right fails. [Verdicts that cannot lie](verdicts.md) compares expectations with naive checks."""
PLAN_TEXT = """\
Every report compares the plan with the physics and lists differences as findings. A scenario can
also require that they agree:

| in the plan | in the physics | expectation |
| --- | --- | --- |
| the pose of an attached object | its pose while the fingers hold it | [`slip`](#slip) |
| an object is attached | both sides are in contact with it | `always: grasped` over the steps |
| commanded joint positions | measured joint positions | [`tracking_error`](#tracking_error) |
| planned clearance | remaining clearance | [`clearance`](#clearance): `max_below_plan` |
| allowed collisions | pairs in contact | [`never: collision`](#collision): `count_allowed` |"""


UNTIL_TEXT = """\
- `{always: A, until: B}`: A holds at every sample before the first one at which B holds, and
  there is such a sample. With `for`, B is held from there on; with `within`, B begins by then.

The temporal words are formulas of signal temporal logic, with the hold T of `for` and the deadline
W of `within`. With `during`, their window is that step.

| in a file | formula |
| --- | --- |
| `eventually: A` | `eventually[0, W] always[0, T] A` |
| `never: A` | `not eventually[0, W] always[0, T] A` |
| `always: A` | `always A`; with a deadline `eventually[0, W] always A` |
| `{always: A, until: B}` | `A until[0, W] always[0, T] B` |

They differ where the window ends before W or T is over. What must become true and was not seen to
do so has failed, while its formula is `not reached`. `never` is `not reached`, as its formula is,
where A holds at the end and could go on for T, or could still begin by W."""
FORMULA_TEXT = """\
```yaml
expect:
  - formula: always (z(red_box) > 5 cm implies force(gripper, red_box) > 0.1 N)
  - formula: {formula: "eventually[0, 3] always[0, 500 ms] speed(tcp) < 0.005", during: lift}
```

Operators, from the weakest to the strongest binding: `implies`; `or`; `and`; `until[a, b]`;
`not`, `always[a, b]`, `eventually[a, b]`; `<` `<=` `>` `>=`; `+` `-`; `*` `/`. Parentheses group.
`->`, `|`, `&`, `!`, `U`, `G` and `F` are alternative spellings of implies, or, and, not, until,
always and eventually. Numbers may carry units (`5 cm`, `90 deg`, `200 ms`, `2 N`), and `abs(a)`,
`min(a, b)` and `max(a, b)` combine them. An interval is in seconds after the moment at which its
operator is judged; without an interval an operator extends to the end of the window. Names with
characters other than letters, digits and `_` are written in quotes.

The margin is that of the comparison that decides, in its unit. If the window ends before a
formula is decided, the verdict is `not reached`: `always[0, 5] A` in a window of 3 s may fail,
and cannot pass. If a signal is missing, the verdict is `not observable`."""


def expectations_reference() -> str:
    """Every temporal word and predicate, and when a bare one is judged."""
    registered: Registry[type[ExpectationFields]] = registry(KIND)
    shared = table((key, keys_of(PredicateFields)[key]) for key in KEYS_BY_PREDICATE)
    parts = ["# Expectations", EXPECTATIONS_HEAD, VALUES, contents(PREDICATES)]
    parts += ["Every expectation also has these keys, inside the word or next to it:", shared]
    parts += ["## Temporal words", words({w: description_of(m) for w, m in TEMPORAL.items()})]
    parts += [UNTIL_TEXT, *_formula_section(), "## Plan against physics", PLAN_TEXT]
    for word, model in PREDICATES.items():
        assert issubclass(model, PredicateFields)  # as PREDICATES says
        package = registered.package_of(word)
        is_own = package == OWN_PACKAGE
        notes = [] if is_own else [f"This expectation comes from the package `{package}`."]
        parts += section(word, model, KEYS_BY_PREDICATE, (*notes, JUDGED[model.judged]))
        parts += [_measured(model.quantities)]
        parts += [example(word, is_step=False), *_picture(word)] if is_own else []
    parts += part_sections(PREDICATES.values())
    return "\n\n".join(parts) + "\n"


def _formula_section() -> list[str]:
    rows = ["| signal | unit | meaning |", "| --- | --- | --- |"]
    for name, (kinds, unit, meaning) in SIGNALS.items():
        arguments = f"({', '.join(kinds)})" if kinds else ""
        unit = unit or "the joint's"
        rows.append(f"| `{name}{arguments}` | {unit} | {meaning} |")
    formula = description_of(EXPECTATIONS["formula"])
    return ["## `formula`", formula, FORMULA_TEXT, "\n".join(rows)]


def _measured(quantities: tuple[Quantity, ...]) -> str:
    rows = ["| measured | unit | holds |", "| --- | --- | --- |"]
    return "\n".join(
        rows + [f"| {each.name} | {each.unit} | {each.holds} |" for each in quantities]
    )


def _picture(word: str) -> list[str]:
    """The picture that is kept next to the page; none where it is not drawn yet."""
    if not (PICTURES / f"{word}.svg").is_file():
        return []
    return [f"![Where `{word}` holds, and where it does not](../pictures/expectations/{word}.svg)"]
