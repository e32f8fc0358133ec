"""Reads SDF files into scopes: worlds, models, and the models that they include."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from harness.core.errors import SpecError, collected
from harness.core.files import is_dir
from harness.core.limits import SDF_MODELS
from harness.language.files.xml_file import XmlElement, read_xml
from harness.plugins.formats.notes import Notes
from harness.plugins.formats.sdf.elements import note_unread_elements
from harness.plugins.formats.sdf.model_path import MissingFileError, ModelPath, model_file
from harness.plugins.formats.sdf.scope import WORLD, Named, SdfScope, check_frames
from harness.plugins.formats.sdf.values import PlacedPose, is_flag, is_true, pose_of, text_of

OLDEST, NEWEST = (1, 4), (1, 11)
OWN_AXES = (1, 5)  # the version from which an axis is in the frame of its joint
NO_COLONS = (1, 8)  # the version from which `::` is in no name

MOST_INCLUDES_DEEP = 30
MERGED = "_merged__"


@dataclass(frozen=True, eq=False)
class SdfLight:
    """A light of the world, and its pose there."""

    element: XmlElement
    pose: PlacedPose


class SdfTree:
    """The scopes of a file and of the files that it includes.

    Attributes:
        root: The `<world>`, or the `<sdf>` of a file that has models alone.
        world: The scope of the world.
        lights: Lights in file order, those of included files last.
    """

    def __init__(self, path: Path, model_path: ModelPath, model: str = "model") -> None:
        """Read a file; `model` is the kind in `elements.READ` of its models.

        Raises:
            SpecError: It is not SDF of a supported version, or has a mistake; located.
        """
        self.notes = Notes()
        self._model_path, self._kind = model_path, model
        self._files: dict[Path, XmlElement] = {}
        self._versions: dict[str, tuple[int, int]] = {}
        self._count = 0
        sdf = self._sdf(path)
        worlds = sdf.findall("world")
        for other in worlds[1:]:
            if other.get("name") == worlds[0].get("name"):
                other.refuse("another <world> has this name", at="name")
            self.notes.add(other.place, "a second <world> is left out")
        self.root = worlds[0] if worlds else sdf
        note_unread_elements(sdf, "sdf", self.notes)
        if worlds:
            note_unread_elements(self.root, "world", self.notes)
        self.world = SdfScope("", self.root, path.parent)
        self.lights = [SdfLight(light, pose_of(light)) for light in self.root.findall("light")]
        self._fill(self.world, (path.resolve(),))
        self._apply_state()
        check_frames(self.world)

    def _apply_state(self) -> None:
        """Place the world's models where the first `<state>` has them, as Gazebo classic does."""
        state = self.root.find("state")
        for item in state.findall("model") if state is not None else ():
            known = self.world.named.get(item.need("name").strip())
            if known is None or known.kind != "model":
                self.notes.add(item.place, "a model of <state> is not in the world")
            elif item.find("pose") is not None:
                self.world.named[item.need("name").strip()] = replace(known, pose=pose_of(item))

    def _sdf(self, path: Path) -> XmlElement:
        """The `<sdf>` of a file."""
        known = self._files.get(path.resolve())
        if known is not None:
            return known
        root = read_xml(path)
        sdf = root.find("sdf") if root.tag in ("gazebo", "sdf-root") else root
        if sdf is None or sdf.tag != "sdf":
            root.refuse(f"the root element is <{root.tag}>; that of an SDF file is <sdf>")
        self._check_version(sdf)
        self._files[path.resolve()] = sdf
        return sdf

    def _check_version(self, sdf: XmlElement) -> None:
        text = sdf.need("version")
        parts = text.strip().split(".")
        if len(parts) != 2 or not all(part.isdigit() for part in parts):
            sdf.refuse(f"`{text}` is not a version of SDF", "such as 1.9", at="version")
        version = (int(parts[0]), int(parts[1]))
        self._versions[sdf.place.source.path] = version
        if version < OLDEST:
            hint = "`gz sdf -p FILE` converts it to a newer version"
            sdf.refuse(f"SDF {text} is older than 1.4", hint, at="version")
        if version > NEWEST:
            self.notes.add(sdf.place, f"SDF {text} is read as 1.11")

    def _fill(self, scope: SdfScope, files: tuple[Path, ...]) -> None:
        """Read the children of a scope's element."""
        children = scope.element.children
        collected(lambda child: self._read(scope, child, files), children, MissingFileError)

    def _read(self, scope: SdfScope, child: XmlElement, files: tuple[Path, ...]) -> None:
        match child.tag:
            case "link":
                self._name(scope, Named("link", child, pose_of(child)))
            case "joint":
                self._name(scope, self._joint(child, scope))
            case "frame":
                note_unread_elements(child, "frame", self.notes)
                base = child.get("attached_to").strip()
                self._name(scope, Named("frame", child, pose_of(child), base))
            case "model":
                self._model(scope, child, files)
            case "include":
                self._include(scope, child, files)
            case _:
                pass

    def _name(self, scope: SdfScope, item: Named) -> str:
        name = item.element.need("name").strip()
        self._claim(scope, name, item)
        return name

    def _claim(self, scope: SdfScope, name: str, item: Named) -> None:
        element = item.element
        if not name or not name.isprintable() or len(name) > 80:
            element.refuse(
                f"`{name[:80]!r}` is not a name of 1 to 80 printable characters", at="name"
            )
        if name in (WORLD, "__model__", "__root__"):
            element.refuse(f"'{name}' is a reserved name", "choose another name", at="name")
        version = self._versions[element.place.source.path]
        if "::" in name and version >= NO_COLONS:
            element.refuse(f"'{name}': a name has no '::' since SDF 1.8", at="name")
        if name in scope.named:
            first = scope.named[name].element.place.line
            element.refuse(f"'{name}' is defined twice; first in line {first}", at="name")
        scope.named[name] = item

    def _joint(self, element: XmlElement, scope: SdfScope) -> Named:
        note_unread_elements(element, "joint", self.notes)
        child = text_of(element, "child")
        if not child or not text_of(element, "parent"):
            element.refuse("a <joint> has a <parent> and a <child>")
        if self._versions[element.place.source.path] < OWN_AXES:
            for axis in element.findall("axis"):
                axis.children.append(XmlElement("use_parent_model_frame", {}, axis.place, [], "1"))
        base = "" if child == WORLD or scope.parent is None else child
        return Named("joint", element, pose_of(element), base)

    def _model(self, parent: SdfScope, element: XmlElement, files: tuple[Path, ...]) -> None:
        """A model written in the file itself."""
        scope = SdfScope(
            element.need("name").strip(),
            element,
            parent.folder,
            parent,
            is_flag(element, "static") or parent.is_static,
            element.get("placement_frame").strip(),
            canonical_link=element.get("canonical_link").strip(),
        )
        self._name(parent, Named("model", element, pose_of(element)))
        self._add(parent, scope, files)

    def _add(self, parent: SdfScope, scope: SdfScope, files: tuple[Path, ...]) -> None:
        self._count += 1
        if self._count > SDF_MODELS:
            scope.element.refuse(f"more than {SDF_MODELS} models")
        note_unread_elements(scope.element, self._kind, self.notes)
        parent.nested[scope.name] = scope
        self._fill(scope, files)
        scope.placement()

    def _include(self, parent: SdfScope, element: XmlElement, files: tuple[Path, ...]) -> None:
        """A model of another file, with the include's elements in place of its own."""
        note_unread_elements(element, "include", self.notes)
        uri = element.find("uri")
        if uri is None:
            element.refuse("an <include> has a <uri>")
        path = self._model_path.find(uri.text.strip(), uri, parent.folder)
        if is_dir(path):
            path = model_file(path, uri)
        if path.resolve() in files:
            chain = " -> ".join(file.name for file in (*files, path))
            uri.refuse(f"includes form a cycle: {chain}")
        if len(files) > MOST_INCLUDES_DEEP:
            uri.refuse(f"includes are nested more than {MOST_INCLUDES_DEEP} deep")
        sdf = self._included(path, uri)
        given = element.find("pose") is not None
        if parent.parent is None and not sdf.findall("model"):
            for light in sdf.findall("light"):
                self.lights.append(SdfLight(light, pose_of(element if given else light)))
            if sdf.findall("light"):
                return
        if not sdf.findall("model"):
            for tag in ("actor", "light"):
                if sdf.find(tag) is not None:
                    self.notes.add(element.place, f"an included <{tag}> is left out")
                    return
        model = self._model_of(sdf, path, uri)
        name = text_of(element, "name") or model.need("name").strip()
        is_merged = is_true(element, element.get("merge", "false"))
        stated = element.find("placement_frame")
        frame = stated.text.strip() if stated is not None else ""
        if not frame and not given:
            frame = model.get("placement_frame").strip()
        scope = SdfScope(
            f"{MERGED}{name}" if is_merged else name,
            model,
            path.parent,
            parent,
            is_flag(element, "static", is_flag(model, "static")) or parent.is_static,
            frame,
            stated,
            model.get("canonical_link").strip(),
            is_merged=is_merged,
        )
        own = pose_of(model)
        pose = pose_of(element) if given else PlacedPose(own.pose, "", own.element)
        self._claim(parent, scope.name, Named("model", element, pose))
        self._add(parent, scope, (*files, path.resolve()))

    def _included(self, path: Path, uri: XmlElement) -> XmlElement:
        """The `<sdf>` of an included file."""
        try:
            return self._sdf(path)
        except SpecError as error:
            raise SpecError([*error.problems, uri.problem("which is included here")]) from error

    def _model_of(self, sdf: XmlElement, path: Path, uri: XmlElement) -> XmlElement:
        models = sdf.findall("model")
        if not models:
            uri.refuse(f"there is no <model> in {path}", "an included file needs one")
        for other in models[1:]:
            self.notes.add(other.place, "a second <model> of an included file is left out")
        return models[0]
