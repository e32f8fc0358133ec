"""Groups links of SDF models into rigid objects."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from harness.core.errors import SpecError
from harness.core.spatial import SE3
from harness.core.suggestion import did_you_mean
from harness.language.files.xml_file import XmlElement
from harness.plugins.formats.notes import Notes
from harness.plugins.formats.sdf.joints import KINDS
from harness.plugins.formats.sdf.scope import OWN, WORLD, Named, SdfScope
from harness.plugins.formats.sdf.values import text_of


@dataclass(frozen=True, eq=False)
class SdfLink:
    """A link in the world.

    Attributes:
        name: Name with the enclosing models: `table::top`.
    """

    name: str
    element: XmlElement
    scope: SdfScope
    pose: SE3


@dataclass(frozen=True, eq=False)
class SdfJoint:
    """A joint between two links.

    Attributes:
        scope: The model with the joint.
        name: The name of the joint in its model.
        element: The element of the joint.
        parent: The full name of a link, or `world`.
        child: The full name of the link that it moves.
    """

    scope: SdfScope
    name: str
    element: XmlElement
    parent: str
    child: str


@dataclass(eq=False)
class SdfBody:
    """Links that form one rigid object.

    Attributes:
        name: Name of the object.
        links: The links in file order.
        is_static: Whether the object is fixed in the world.
        joint: The hinge or slide on which it hangs; None of an object of its own.
    """

    name: str
    pose: SE3
    links: list[SdfLink] = field(default_factory=list[SdfLink])
    is_static: bool = False
    joint: SdfJoint | None = None


class _Groups:
    """Disjoint sets of names (union-find)."""

    def __init__(self) -> None:
        self._above: dict[str, str] = {}

    def find(self, name: str) -> str:
        while name in self._above:
            above = self._above[name]
            if above in self._above:
                self._above[name] = self._above[above]
            name = above
        return name

    def join(self, first: str, second: str) -> None:
        first, second = self.find(first), self.find(second)
        if first != second:
            self._above[second] = first


def bodies_of(world: SdfScope, notes: Notes) -> list[SdfBody]:
    """The rigid objects of a world, in file order.

    The links of a static model, and links that a joint connects, are one object. What turns or
    slides on something static is an object with its joint; any other movable joint is held in its
    initial position, with a note.

    Raises:
        SpecError: A joint, frame or pose refers to an unknown name.
    """
    links = _links(world)
    groups, fixed = _Groups(), set[str]()
    firsts: dict[int, str] = {}
    for link in links:
        static = _outermost_static(link.scope)
        if static is not None:
            fixed.add(link.name)
            groups.join(firsts.setdefault(id(static), link.name), link.name)
    movable: list[SdfJoint] = []
    for scope in scopes_of(world):
        check_links(scope)
        for name, item in scope.named.items():
            if item.kind == "joint":
                joint = _joint(scope, name, item)
                if item.element.need("type").strip() == "fixed":
                    _join(joint, groups, fixed)
                else:
                    movable.append(joint)
    parts = _parts(movable, groups, fixed)
    for joint in movable:
        if joint not in parts.values():
            kind = joint.element.need("type").strip()
            message = f"the {kind} joint '{joint.name}' is held in its initial position"
            notes.add(joint.element.place, message)
            _join(joint, groups, fixed)
    by_group: dict[str, list[SdfLink]] = {}
    for link in links:
        by_group.setdefault(groups.find(link.name), []).append(link)
    held = {groups.find(name) for name in fixed}
    hanging = {groups.find(name): joint for name, joint in parts.items()}
    sizes = Counter(id(_top(link.scope)) for link in links if groups.find(link.name) not in hanging)
    return [
        _body(members, sizes, group in held, hanging.get(group))
        for group, members in by_group.items()
    ]


def _parts(movable: Sequence[SdfJoint], groups: _Groups, fixed: set[str]) -> dict[str, SdfJoint]:
    """The hinges and slides by which one body hangs on what is fixed, by the name of its link."""
    held = {WORLD, *(groups.find(name) for name in fixed)}
    children = Counter(groups.find(joint.child) for joint in movable)
    found: dict[str, SdfJoint] = {}
    for joint in movable:
        child = groups.find(joint.child)
        hangs = groups.find(joint.parent) in held and child not in held and children[child] == 1
        if hangs and joint.element.need("type").strip() in KINDS:
            found[joint.child] = joint
    return found


def check_links(scope: SdfScope) -> None:
    """Refuse a model that has no link, or not the one that represents it; and names given twice."""
    if scope.parent is not None:
        if scope.canonical_link:
            link_name(scope, scope.canonical_link, scope.element)
        if not scope.is_static and not any(scope.links()):
            scope.element.refuse(f"the model '{scope.name}' has no link, and is not static")
    for link in (item for item in scope.named.values() if item.kind == "link"):
        for tag in ("collision", "visual"):
            names = set[str]()
            for each in link.element.findall(tag):
                name = each.get("name").strip()
                if name and name in names:
                    each.refuse(f"another <{tag}> of this link is called '{name}'", at="name")
                names.add(name)


def _links(world: SdfScope) -> list[SdfLink]:
    found: list[SdfLink] = []
    for scope, name, item in world.links():
        prefix = f"{scope.path}::" if scope.path else ""
        pose = scope.in_world() @ scope.locate(name, item.element)
        found.append(SdfLink(f"{prefix}{name}", item.element, scope, pose))
    return found


def scopes_of(scope: SdfScope) -> list[SdfScope]:
    """A scope and all that are nested in it."""
    return [scope, *(inner for nested in scope.nested.values() for inner in scopes_of(nested))]


def _outermost_static(scope: SdfScope) -> SdfScope | None:
    """The outermost static model that contains a scope; None without one."""
    found: SdfScope | None = None
    current: SdfScope | None = scope
    while current is not None:
        found = current if current.is_static else found
        current = current.parent
    return found


def _top(scope: SdfScope) -> SdfScope:
    """The top-level model that contains a scope."""
    while scope.parent is not None and scope.parent.parent is not None:
        scope = scope.parent
    return scope


def _joint(scope: SdfScope, name: str, item: Named) -> SdfJoint:
    first, second = (
        link_name(scope, text_of(item.element, tag), item.element) for tag in ("parent", "child")
    )
    if first == second:
        place = item.element.find("child") or item.element
        place.refuse(f"'{first}' is parent and child of this joint")
    return SdfJoint(scope, name, item.element, first, second)


def _join(joint: SdfJoint, groups: _Groups, fixed: set[str]) -> None:
    """Join the two sides of a joint; a side that is the world makes the other static."""
    sides = (joint.parent, joint.child)
    if WORLD in sides:
        fixed.update(side for side in sides if side != WORLD)
    else:
        groups.join(*sides)


def link_name(scope: SdfScope, name: str, element: XmlElement, depth: int = 0) -> str:
    """The full name of the link that a name refers to.

    Args:
        name: A link; a frame or joint, for the link that it is attached to; a model, for its
            canonical link; or `world`.
        element: The element with the name, for messages.
        depth: Number of frames between this one and the first.

    Raises:
        SpecError: The name is unknown, or frames are attached to each other in a cycle.
    """
    if depth > 100:
        element.refuse(f"'{name}' is attached to itself in a cycle")
    if name == WORLD or (scope.parent is None and name in OWN):
        return WORLD
    if name in OWN:
        return _canonical(scope, element, depth)
    item = scope.named.get(name)
    if item is None:
        first, _, rest = name.partition("::")
        if rest and first in scope.nested:
            return link_name(scope.nested[first], rest, element, depth + 1)
        for nested in scope.nested.values():
            if nested.is_merged and nested.has(first):
                return link_name(nested, name, element, depth + 1)
        hint = did_you_mean(name, scope.named, "names")
        element.refuse(f"there is no link or frame '{name}' here", hint)
    if item.kind == "model":
        return _canonical(scope.nested[name], element, depth)
    if item.kind == "link":
        return f"{scope.path}::{name}" if scope.path else name
    base = text_of(item.element, "child") if item.kind == "joint" else item.base
    return link_name(scope, base, element, depth + 1)


def _canonical(scope: SdfScope, element: XmlElement, depth: int) -> str:
    """A model's canonical link: the one that it names, else its first."""
    if scope.canonical_link:
        return link_name(scope, scope.canonical_link, element, depth + 1)
    for inner, name, _ in scope.links():
        return f"{inner.path}::{name}" if inner.path else name
    raise SpecError([element.problem(f"the model '{scope.name}' has no link")])


def _body(
    members: list[SdfLink], sizes: Mapping[int, int], is_static: bool, joint: SdfJoint | None
) -> SdfBody:
    """An object, named after its model when it has all of its links, else after its first link.

    Args:
        sizes: Number of links of each top-level model, by the identity of its scope.
        is_static: Whether the object is fixed in the world.
        joint: The hinge or slide on which it hangs; None of an object of its own.
    """
    first = members[0]
    top = _top(first.scope)
    if sum(_top(link.scope) is top for link in members) == sizes[id(top)]:
        return SdfBody(top.name, top.in_world(), members, is_static, joint)
    return SdfBody(first.name, first.pose, members, is_static, joint)
