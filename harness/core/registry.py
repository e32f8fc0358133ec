"""Named plug-ins of each kind, and the package that each comes from.

Built-ins, installed packages and single files register through the same function. An installed
package names its modules (or classes) in the entry-point group `harness.plugins`:

    [project.entry-points."harness.plugins"]
    remark = "my_package.remark"

The built-ins of a kind are the modules of one package, and of the folders of its name in the
packages of `harness.plugins`, such as `harness/plugins/studio/commands`. They are found by their
names: a built-in is imported when its name is first looked up, installed packages when a name is
not a built-in's.
"""

from __future__ import annotations

import importlib
import importlib.util
import inspect
import os
import pkgutil
import sys
import traceback
from collections.abc import Collection, Generator, Iterable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cached_property
from pathlib import Path
from types import ModuleType
from typing import Any, ClassVar, TypeVar

from harness.core.errors import Problem, SpecError
from harness.core.suggestion import did_you_mean, is_slip, nearest

P = TypeVar("P")

ENTRY_POINTS = "harness.plugins"
OWN_PACKAGE = "armharness"
VARIABLE = "HARNESS_PLUGINS"  # modules of `--plugin`, here and in later processes
BUNDLED = Path(__file__).parents[1] / "plugins"  # this distribution's plug-ins; may be absent

BUILT_IN = {
    "command": "harness.cli.commands",
    **dict.fromkeys(("run_mode", "case_runner", "starter"), ""),
    "step": "harness.steps",
    "expectation": "harness.judging.expectations",
    "planner": "harness.planning.search.pipelines",
    "ik_solver": "harness.planning.ik.solvers",
    "controller": "harness.simulation.controllers",
    **dict.fromkeys(("robot", "robot_format", "robot_option", "world_format"), ""),
    **dict.fromkeys(("decomposer", "mass_estimator"), ""),
    "reporter": "harness.reporting.reporters",
    **dict.fromkeys(("observer", "suite_section", "suite_reporter", "result_format"), ""),
    **dict.fromkeys(("grip", "adhesion", "tracker", "motion", "camera_recorder"), ""),
    **dict.fromkeys(("explainer", "path_finder", "expansion", "program_part"), ""),
    **dict.fromkeys(("key", "syntax_adviser"), ""),
}
"""Every kind of plug-in, and the package of the core whose modules are built-in ones."""

HAS_DOCSTRINGS = sys.flags.optimize < 2  # with `PYTHONOPTIMIZE=2` no class has its docstring

NOUNS = {
    "planner": "planning pipeline",
    "ik_solver": "inverse kinematics solver",
    "controller": "joint controller",
    "robot": "robot collection",
}
"""What messages call the plug-ins of a kind whose key does not say it."""

_package: ContextVar[str] = ContextVar("package", default="")


class Plugin:
    """A class that states the kind of plug-in that it is, and the name that it is registered under.

    The docstring of a subclass with a name is its text in `harness list` and the reference pages.

    Attributes:
        plugin_kind: One of the keys of `BUILT_IN`.
        name: The word that selects the plug-in; empty in classes that several plug-ins share.
    """

    plugin_kind: ClassVar[str] = ""
    name: ClassVar[str] = ""

    @classmethod
    def plugin_name(cls) -> str:
        """The name that this class states itself; a base class's name is not inherited."""
        return cls.__dict__.get("name", "")


class PluginError(SpecError):
    """A plug-in cannot be used (exit code 2).

    Attributes:
        source: The package or module that the plug-in comes from.
        reason: What is wrong with it.
    """

    def __init__(self, source: str, reason: str, hint: str = "") -> None:
        self.source, self.reason = source, reason
        super().__init__([Problem(f"plug-in {source}", 0, 0, reason, hint)])


def noun(kind: str) -> str:
    """What messages call a plug-in of a kind: `ik_solver` is `inverse kinematics solver`."""
    return NOUNS.get(kind, kind.replace("_", " "))


class Registry(Mapping[str, P]):
    """The plug-ins of one kind by their names: the built-in ones first, in alphabetical order."""

    def __init__(self, kind: str, built_in: str = "") -> None:
        self.kind = kind
        self._built_in = built_in
        self._what = noun(kind)
        self._plugins: dict[str, tuple[P, str]] = {}  # with its package

    def add(self, name: str, plugin: P, package: str) -> None:
        """Register a plug-in under its name; the same one may be added again.

        Raises:
            PluginError: Another package provides this name.
        """
        built_in = (None, OWN_PACKAGE if name in self.built_in_modules else "")
        known, owner = self._plugins.get(name, built_in)
        if known is plugin:
            return
        if name in self._plugins or owner not in ("", package):
            both = f"two packages provide the {self._what} `{name}`: `{owner}` and `{package}`"
            twice = f"`{package}` provides the {self._what} `{name}` twice"
            raise PluginError(package, twice if owner == package else both, "rename one of them")
        self._plugins[name] = plugin, package

    def package_of(self, name: str) -> str:
        """The package (distribution) or module that a plug-in comes from."""
        self[name]
        return self._plugins[name][1]

    def is_own(self, name: str) -> bool:
        """Whether a plug-in comes with the program."""
        return self.package_of(name) == OWN_PACKAGE

    def modules(self) -> set[str]:
        """The modules of the registered classes and functions that are not built in."""
        others = (each for each, package in self._plugins.values() if package != OWN_PACKAGE)
        return {getattr(each, "__module__", "") for each in others}

    def find(self, name: str) -> P:
        """The plug-in of this name.

        Raises:
            LookupError: There is none; the message has the nearest name, then all names.
        """
        if name in self:
            return self[name]
        hints = plugin_hints(name, list(self), self._what, "known")
        raise LookupError("; ".join([f"there is no {self._what} '{name}'", *hints]))

    def __getitem__(self, name: str) -> P:
        if name not in self.built_in_modules:
            load_installed()
        elif name not in self._plugins:
            with _loading(OWN_PACKAGE):
                register_module(importlib.import_module(self.built_in_modules[name]))
        return self._plugins[name][0]

    def __contains__(self, name: object) -> bool:
        if name in self.built_in_modules:
            return True
        load_installed()
        return name in self._plugins

    def __iter__(self) -> Iterator[str]:
        load_installed()
        others = sorted(name for name in self._plugins if name not in self.built_in_modules)
        return iter([*self.built_in_modules, *others])

    def __len__(self) -> int:
        return len(list(iter(self)))

    def built_in(self) -> list[P]:
        """The built-in plug-ins, for which no installed package is loaded."""
        return [self[name] for name in self.built_in_modules]

    def module_of(self, name: str) -> str:
        """The module that defines a plug-in, or is a built-in one."""
        return self.built_in_modules.get(name) or str(getattr(self[name], "__module__", ""))

    @cached_property
    def built_in_modules(self) -> dict[str, str]:
        """Module of each built-in by its name; they may not be imported yet.

        The module of a name that is a keyword has an underscore; names of commands have hyphens.
        """
        spec = importlib.util.find_spec(self._built_in) if self._built_in else None
        places = dict.fromkeys((spec and spec.submodule_search_locations) or (), self._built_in)
        for folder in sorted(BUNDLED.glob(f"*/{self.kind}s")):
            places[str(folder)] = f"harness.plugins.{folder.parent.name}.{folder.name}"
        between = "-" if self.kind == "command" else "_"
        found = (
            (module.name.rstrip("_").replace("_", between), f"{package}.{module.name}")
            for folder, package in places.items()
            for module in pkgutil.iter_modules([folder])
            if not module.ispkg and not module.name.startswith("_")
        )
        return dict(sorted(found))


_registries: dict[str, Registry[Any]] = {
    kind: Registry[Any](kind, package) for kind, package in BUILT_IN.items()
}
_broken: dict[str, str] = {}
_is_loaded = False


def described(kind: str, name: str) -> str:
    """A plug-in in a message: ``the planning pipeline `spline` of the package `acme` ``."""
    package = registry(kind).package_of(name)
    source = "" if package == OWN_PACKAGE else f" of the package `{package}`"
    return f"the {noun(kind)} `{name}`{source}"


def raised(error: BaseException) -> str:
    """An exception of a plug-in and where it was raised: `ValueError: no way (spline.py:7)`."""
    frames = traceback.extract_tb(error.__traceback__)
    place = f" ({Path(frames[-1].filename).name}:{frames[-1].lineno})" if frames else ""
    text = f": {error}" if str(error) else ""
    return f"{type(error).__name__}{text}{place}"


def registry(kind: str) -> Registry[Any]:
    """The registry of a kind of plug-in."""
    return _registries[kind]


def plugin_files() -> frozenset[Path]:
    """The files of the modules whose plug-ins are registered, without those that are built in."""
    names = set[str]().union(*(each.modules() for each in _registries.values()))
    found = (getattr(sys.modules.get(name), "__file__", None) for name in names)
    return frozenset(Path(file).resolve() for file in found if file)


def register(plugin: P, *, kind: str = "", name: str = "") -> P:
    """Register a plug-in; its package is the one that is being loaded, else its module's.

    Args:
        plugin: A class that states its kind and name, such as a step, or anything else.
        kind: One of the keys of `BUILT_IN`; needed where the plug-in does not state it.
        name: Needed where the plug-in does not state it.

    Returns:
        The plug-in, so that this function is a decorator too.

    Raises:
        PluginError: The kind, the name, a class's text or a method is missing, or another package
            provides the name.
    """
    module = str(getattr(plugin, "__module__", "")).partition(".")[0]
    package = _package.get() or (OWN_PACKAGE if module == "harness" else module)
    kind = kind or getattr(plugin, "plugin_kind", "")
    if kind not in _registries:
        kinds = ", ".join(_registries)
        raise PluginError(package, f"{plugin!r} has no known `plugin_kind`", f"kinds: {kinds}")
    name = name or _stated_name(plugin)
    if not name:
        raise PluginError(package, f"{plugin!r} has no name to be registered under")
    if inspect.isclass(plugin) and issubclass(plugin, Plugin):
        what = f"the {noun(kind)} `{name}`"
        if not plugin.__doc__ and HAS_DOCSTRINGS:
            raise PluginError(package, f"{what} has no docstring, which is its reference text")
        if missing := sorted(getattr(plugin, "__abstractmethods__", ())):
            names = ", ".join(f"`{each}`" for each in missing)
            raise PluginError(package, f"{what} needs the method {names}")
    _registries[kind].add(name, plugin, package)
    return plugin


def import_built_in(kinds: Collection[str], words: Collection[str]) -> list[Any]:
    """Import the built-in plug-ins that words name, for this process and its forks."""
    places = [_registries[kind] for kind in kinds]
    return [found[name] for found in places for name in found.built_in_modules.keys() & set(words)]


def built_in_class(kind: str, name: str) -> Any:
    """The class of a built-in plug-in by its name in Python: `MoveTo` of the step `move_to`.

    Raises:
        AttributeError: There is none.
    """
    found = _registries[kind]
    for word in found.built_in_modules.keys() if name[:1].isupper() else ():
        starts = name.lower().startswith(word.replace("_", ""))
        if starts and found[word].__name__ == name:
            return found[word]
    raise AttributeError(f"there is no built-in {noun(kind)} of the class {name}")


def register_module(module: ModuleType) -> None:
    """Register every plug-in class that a module defines."""
    for value in list(vars(module).values()):
        is_defined_here = inspect.isclass(value) and value.__module__ == module.__name__
        if is_defined_here and hasattr(value, "plugin_kind") and _stated_name(value):
            register(value)


def load_plugin(module: str) -> None:
    """Load a module of plug-ins, by its name or as the path of a .py file, and keep it loaded.

    Processes that are started later load it too.

    Raises:
        PluginError: It cannot be imported, or another package provides one of its names.
    """
    path = Path(module)
    if path.suffix == ".py":
        module = str(path.resolve())
    _load_module(module)
    listed = _listed_plugins()
    if module not in listed:
        os.environ[VARIABLE] = os.pathsep.join([*listed, module])


def load_installed() -> None:
    """Load the modules of `--plugin` and of the installed packages, once.

    A package that cannot be imported is left out; `broken_plugins` says why.

    Raises:
        PluginError: Two packages provide the same name, or a module of `--plugin` cannot be loaded.
    """
    global _is_loaded
    if _is_loaded:
        return
    _is_loaded = True  # at once, since a plug-in may look up names while it is imported
    try:
        for module in _listed_plugins():
            _load_module(module)
        _load_entry_points()
    except PluginError:
        _is_loaded = False
        raise


def _load_entry_points() -> None:
    from importlib.metadata import entry_points  # takes time

    for entry in sorted(entry_points(group=ENTRY_POINTS), key=lambda each: each.value):
        package = entry.dist.name if entry.dist else entry.module
        try:
            with _loading(package):
                loaded = entry.load()
                if isinstance(loaded, ModuleType):
                    register_module(loaded)
                else:
                    register(loaded)
        except PluginError:
            raise
        except Exception as error:  # noqa: BLE001 - a foreign package may raise anything
            _broken[package] = f"{type(error).__name__}: {error}"


def plugin_hints(
    name: str, valid: Iterable[str], what: str, listed: str = "", is_misspelt: bool = False
) -> list[str]:
    """Hints on a name that no loaded plug-in has: the nearest, all, and where others come from.

    Args:
        listed: What stands in front of the valid names; by default the noun's plural.
        is_misspelt: Whether more than its letters says that the name is the nearest one, misspelt.
    """
    near = nearest(name, valid)
    article = "an" if what[0] in "aeiou" else "a"
    of_plugin = f"{article} {what} of a plug-in that is not installed needs `--plugin`"
    is_misspelt = is_misspelt or (near is not None and is_slip(name, near))
    known = did_you_mean(name, valid, listed or f"{what}s")
    return [known, *([] if is_misspelt else [of_plugin, *absent_plugins()]), *broken_plugins()]


def absent_plugins() -> list[str]:
    """A sentence where this installation is the core alone."""
    if BUNDLED.is_dir():
        return []
    return ["this installation lacks the built-in plug-ins; install it again"]


def broken_plugins() -> list[str]:
    """A sentence for each installed package whose plug-ins cannot be loaded."""
    load_installed()
    return [
        f"the plug-ins of the package `{package}` cannot be loaded: {reason}"
        for package, reason in _broken.items()
    ]


def _listed_plugins() -> list[str]:
    return [each for each in os.environ.get(VARIABLE, "").split(os.pathsep) if each]


def _load_module(name: str) -> None:
    path = Path(name)
    is_file = path.suffix == ".py"
    try:
        with _loading(path.stem if is_file else name):
            register_module(_module_of_file(path) if is_file else importlib.import_module(name))
    except PluginError:
        raise
    except Exception as error:
        raise PluginError(name, raised(error)) from error


def _module_of_file(path: Path) -> ModuleType:
    if known := sys.modules.get(path.stem):
        if getattr(known, "__file__", None) == str(path):
            return known
        raise ImportError(f"there is another module `{path.stem}`; rename the file")
    spec = importlib.util.spec_from_file_location(path.stem, path)
    if spec is None or spec.loader is None or (path.exists() and not path.is_file()):
        raise ImportError(f"{path} is no regular Python file")
    module = sys.modules[path.stem] = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[path.stem]
        raise
    return module


def _stated_name(plugin: object) -> str:
    name = getattr(plugin, "plugin_name", None)
    return str(name()) if callable(name) else ""


@contextmanager
def _loading(package: str) -> Generator[None]:
    """Attribute what is registered meanwhile to a package."""
    token = _package.set(package)
    try:
        yield
    finally:
        _package.reset(token)
