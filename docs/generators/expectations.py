"""The reference of expectations as Markdown, made from the models."""

from __future__ import annotations

from docs.generators.reference import (
    VALUES,
    contents,
    part_sections,
    section,
    table,
    words,
)
from harness.core.registry import OWN_PACKAGE, Registry, registry
from harness.language.annotations import description_of, keys_of
from harness.language.expectation import KIND, ExpectationFields, PredicateFields, Quantity
from harness.language.formula.formula import SIGNALS
from harness.language.language import BESIDE_CHECK, EXPECTATIONS, PREDICATES, TEMPORAL

JUDGED = {
    "at_end": "Bare, it must hold at the last sample of its step or run, which decides.",
    "always": "Bare, it must hold at every sample of its step or run; the one with the least margin"
    " decides.",
    "eventually": "Bare, it must hold at some sample of its step or run; the one with the largest"
    " margin decides.",
}
EXPECTATIONS_HEAD = """An expectation is a predicate, bare or inside a temporal word. Under a
step's `expect` it is judged over that step, under the file's over the whole run: its window.

```yaml
expect:
  - lifted: {object: green_cylinder, above: 5 cm, for: 1 s}
  - always: within_limits
  - never: {collision: {between: [robot, Table]}}
```

Every verdict is read from the recording alone and names its numbers, the sample that decided and a
margin: how far that was from the limit, in its unit, positive where it holds. A predicate of
several quantities holds where all of them do. They are compared as shares of their limits (a share
that cannot exceed 1, as a part of what lies between its limit and 1); the tightest decides, and the
margin is its own. What was never observed does not pass: a step that was not reached, or an object
that was not there, is `not reached`, and what nobody recorded is `not observable`.

A step that fails unexpectedly ends the run. What could still have come true then is `not reached`,
and names that step: `lifted` and `eventually`, and everything that is judged at the end. What no
continuation could make good has failed: an `always` that was violated, a deadline that has passed.

The pictures are real runs: what the deciding quantity measured, its limit, green where the
predicate holds, and the sample that decided; on the left an expectation that passes, on the right
one that does not. [Verdicts that cannot lie](verdicts.md) compares them with naive checks."""
PLAN_TEXT = """The plan is compared with the physics in every report, as findings. What must not
differ can be expected, too:

| the plan | the physics | expectation |
| --- | --- | --- |
| carries an attached object along | where it is, since the fingers had it | [`slip`](#slip) |
| believes that it holds an object | contact on both sides | `always: grasped` over the steps |
| commands joints | measured joints | [`tracking_error`](#tracking_error) |
| keeps a distance | the distance that was left | [`clearance`](#clearance): `max_below_plan` |
| lets pairs touch | pairs that touched | [`never: collision`](#collision): `count_allowed` |"""


UNTIL_TEXT = """- `{always: A, until: B}`: A holds at every sample before one at which B does, and
B does; with `for`, B is held from there on; with `within`, B begins by then.

The words are formulas of signal temporal logic: with a hold T and a deadline W, `eventually A` is
`eventually[0, W] always[0, T] A`, `never A` is `not eventually[0, W] always[0, T] A`, `always A` is
`always A` (with a deadline `eventually[0, W] always A`), and `until` is
`A until[0, W] always[0, T] B`. `during` gives them the step's samples as their window."""
FORMULA_TEXT = """```yaml
expect:
  - formula: always (z(red_box) > 5 cm implies force(gripper, red_box) > 0.1 N)
  - formula: {formula: "eventually[0, 3] always[0, 500 ms] speed(tcp) < 0.005", during: lift}
```

From the weakest binding to the strongest: `implies`, `or`, `and`, `until[a, b]`, then `not`,
`always[a, b]`, `eventually[a, b]`, then `<` `<=` `>` `>=`, `+` `-`, `*` `/`. Parentheses group.
`->`, `|`, `&`, `!`, `U`, `G`, `F` are other ways to write implies, or, and, not, until, always,
eventually. `abs(a)`, `min(a, b)`, `max(a, b)` are numbers, `5 cm`, `90 deg`, `200 ms`, `2 N` too.
An interval is in seconds after the moment at which its word is judged; without one it lasts to the
end of the window. Names with other characters than letters, digits and `_` stand in quotes.

The margin is that of the comparison that decides, in its unit. Where the window ends before a
formula is decided it is not reached: `always[0, 5] A` in a window of 3 s may fail, and cannot pass.
Where a signal is missing it is not observable."""


def expectations_reference() -> str:
    """Every temporal word and predicate, and when a bare one is judged."""
    registered: Registry[type[ExpectationFields]] = registry(KIND)
    beside = table((key, keys_of(PredicateFields)[key]) for key in BESIDE_CHECK)
    parts = ["# Expectations", EXPECTATIONS_HEAD, VALUES, contents(PREDICATES)]
    parts += ["These keys may stand inside or next to every word:", beside]
    parts += ["## Temporal words", words({w: description_of(m) for w, m in TEMPORAL.items()})]
    parts += [UNTIL_TEXT, *_formula_section(), "## Plan against physics", PLAN_TEXT]
    for word, model in PREDICATES.items():
        assert issubclass(model, PredicateFields)  # as PREDICATES says
        package = registered.package_of(word)
        is_own = package == OWN_PACKAGE
        notes = [] if is_own else [f"This expectation comes from the package `{package}`."]
        parts += section(word, model, BESIDE_CHECK, (*notes, JUDGED[model.judged]))
        parts += [_measured(model.quantities), *([_picture(word)] if is_own else [])]
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


def _picture(word: str) -> str:
    """A picture that is kept next to the page."""
    return f"![Where `{word}` holds, and where it does not](../pictures/expectations/{word}.svg)"
