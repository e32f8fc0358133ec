"""Nested SDF models: their names and poses."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from harness.core.errors import SpecError
from harness.core.spatial import SE3
from harness.core.suggestion import did_you_mean
from harness.language.files.xml_file import XmlElement
from harness.plugins.formats.sdf.values import PlacedPose, text_of

MODEL_FRAME = "__model__"
OWN = ("", MODEL_FRAME)
WORLD = "world"
MOST_FRAMES_DEEP = 50


@dataclass(frozen=True, eq=False)
class Named:
    """A link, joint, frame or nested model of a scope.

    Attributes:
        kind: Kind of the element: `link`, `joint`, `frame`, `model`.
        base: Default frame of the pose; empty for the scope's frame.
    """

    kind: str
    element: XmlElement
    pose: PlacedPose
    base: str = ""


@dataclass(eq=False)
class SdfScope:
    """A model, or the world.

    Attributes:
        name: Name of the model; empty for the world.
        folder: Folder of its file; relative paths start there.
        parent: The scope that encloses it.
        is_static: Whether it or an enclosing scope is static.
        placement_frame: The frame that its pose places; empty for its own frame.
        placed_by: The element that names that frame, which may be in another file; None where the
            model itself does.
        canonical_link: The link that represents the model in joints; empty for the first link.
        named: Its links, joints, frames and nested models, in file order.
        nested: Scopes of its nested models.
        is_merged: Whether its names are also names of the enclosing scope.
    """

    name: str
    element: XmlElement
    folder: Path
    parent: SdfScope | None = None
    is_static: bool = False
    placement_frame: str = ""
    placed_by: XmlElement | None = None
    canonical_link: str = ""
    named: dict[str, Named] = field(default_factory=dict[str, Named])
    nested: dict[str, SdfScope] = field(default_factory=dict[str, "SdfScope"])
    is_merged: bool = False
    _located: dict[str, SE3] = field(default_factory=dict[str, SE3])
    _open: set[str] = field(default_factory=set[str])

    @property
    def path(self) -> str:
        """Its name with those of the enclosing scopes: `table::leg`."""
        if self.parent is None:
            return ""
        if self.is_merged:
            return self.parent.path
        return f"{self.parent.path}::{self.name}" if self.parent.path else self.name

    def locate(self, name: str, element: XmlElement) -> SE3:
        """T_scope_frame of a name in the scope.

        Args:
            name: `a`, or `a::b` of a nested model; empty or `__model__` for the scope's own frame.

        Raises:
            SpecError: The frame is unknown, or frames refer to each other in a cycle.
        """
        if name in OWN or (name == WORLD and self.parent is None):
            return SE3.identity()
        if name not in self._located:
            if name in self._open:
                element.refuse(f"the frame '{name}' is relative to itself in a cycle")
            if len(self._open) >= MOST_FRAMES_DEEP:
                element.refuse(
                    f"frames are relative to each other more than {MOST_FRAMES_DEEP} deep"
                )
            self._open.add(name)
            self._located[name] = self._find(name, element)
            self._open.discard(name)
        return self._located[name]

    def placement(self) -> SE3:
        """T_scope_frame of the frame that the scope's pose places."""
        return self.locate(self.placement_frame, self.placed_by or self.element)

    def in_world(self) -> SE3:
        """T_world_scope."""
        if self.parent is None:
            return SE3.identity()
        return self.parent.in_world() @ self.parent.locate(self.name, self.element)

    def pose_in(self, placed: PlacedPose, base: str = "") -> SE3:
        """T_scope_this of a pose whose default frame is `base`."""
        return self.locate(placed.relative_to or base, placed.element) @ placed.pose

    def links(self) -> Iterator[tuple[SdfScope, str, Named]]:
        """Every link with the scope and name it is in, nested models included, in file order."""
        for name, item in self.named.items():
            if item.kind == "link":
                yield self, name, item
            elif item.kind == "model":
                yield from self.nested[name].links()

    def has(self, name: str) -> bool:
        """Whether a name without `::` is in the scope or in a model merged into it."""
        merged = [scope for scope in self.nested.values() if scope.is_merged]
        return name in self.named or any(scope.has(name) for scope in merged)

    def _find(self, name: str, element: XmlElement) -> SE3:
        item = self.named.get(name)
        if item is not None:
            T_scope_item = self.pose_in(item.pose, item.base)
            if item.kind != "model":
                return T_scope_item
            return T_scope_item @ self.nested[name].placement().inverse()
        first, _, rest = name.partition("::")
        if rest and first in self.nested:
            return self.locate(first, element) @ self.nested[first].locate(rest, element)
        for nested in self.nested.values():
            if nested.is_merged and nested.has(first):
                return self.locate(nested.name, element) @ nested.locate(name, element)
        own = WORLD if self.parent is None else MODEL_FRAME
        known = [own, *self.named, *(f"{name}::" for name in self.nested)]
        hint = did_you_mean(name, known, "frames")
        is_here = element.place.source.path == self.element.place.source.path
        where = "here" if is_here else f"in the model '{self.element.get('name').strip()}'"
        raise SpecError([element.problem(f"there is no frame '{name}' {where}", hint)])


def check_frames(scope: SdfScope) -> None:
    """Check every pose and joint of a scope and of its models, needed or not, as SDFormat does.

    Raises:
        SpecError: A frame is unknown or relative to itself, or a joint connects what it cannot.
    """
    for name, item in scope.named.items():
        scope.locate(name, item.element)
        if item.kind == "joint":
            _check_joint(item.element)
        elif item.kind == "model":
            check_frames(scope.nested[name])


def _check_joint(joint: XmlElement) -> None:
    if text_of(joint, "child") == WORLD:
        (joint.find("child") or joint).refuse("the child of a joint cannot be the world")
