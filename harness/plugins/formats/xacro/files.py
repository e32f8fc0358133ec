"""The files of one rendering: documents and YAML files, from the folders that may be read."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from glob import glob
from pathlib import Path
from typing import Any

from harness.core.files import is_file
from harness.core.inputs import is_there, read_bounded
from harness.core.limits import XACRO_FILES, XML_FILE
from harness.language.files.source import Located, Source
from harness.language.files.xml_file import XmlElement
from harness.language.files.yaml_file import read_text
from harness.plugins.formats.xacro.mixed_xml import MixedReader
from harness.plugins.formats.xacro.ros_yaml import parse_ros_yaml
from harness.plugins.formats.xacro.values import Budget, ExpressionError, YamlDict
from harness.robot.packages import PackagePath

DEEPEST_INCLUDE = 40  # levels of files that include each other
STEPS_OF_VALUE = 5
"""Steps that a value of a YAML file counts as; reading it takes as long as so many."""

WILDCARD = re.compile(r"[*?\[]")


class MissingFile(ExpressionError):
    """A file does not exist."""


class Files:
    """Reads the files of one rendering."""

    def __init__(self, packages: PackagePath, budget: Budget) -> None:
        self.open: list[Path] = []
        """The file that is rendered, after those that include it."""

        self._packages = packages
        self._budget = budget
        self._bytes = 0

    def absolute(self, name: str) -> str:
        """A file name, from the folder of the file that is rendered."""
        return os.path.join(self.open[-1].parent, name)  # noqa: PTH118 - `..` stays as written

    def named(self, name: str) -> Path:
        """The path of a file.

        Raises:
            ExpressionError: It may not be read.
            MissingFile: It does not exist.
        """
        path = Path(self.absolute(name))
        if not self._packages.may_read(path):
            raise ExpressionError(self._packages.outside(name, path.resolve()))
        if not (is_there(path) and is_file(path)):
            raise MissingFile(f"there is no file '{name}'")
        return path

    def matching(self, name: str, missing: str = "") -> list[Path]:
        """The files of a name that may have wildcards.

        Args:
            name: The path as the file states it.
            missing: Why a package in it is missing.

        Raises:
            ExpressionError: They may not be read.
            MissingFile: A file without wildcards does not exist.
        """
        if missing:
            raise ExpressionError(missing)
        if not WILDCARD.search(name):
            return [self.named(name)]
        path = Path(self.absolute(name))
        if WILDCARD.search(str(path.parent)):
            raise ExpressionError(f"'{name}': only the name of a file may have wildcards")
        if not self._packages.may_read(path):
            raise ExpressionError(self._packages.outside(name, path.resolve()))
        is_there(path)  # what it matches is an input
        return [self.named(each) for each in sorted(glob(str(path)))]  # noqa: PTH207 - `**` is `*`

    def document(self, path: Path) -> XmlElement:
        """The document of a file, which is rendered from now on.

        Raises:
            SpecError: It is not XML.
            ExpressionError: It includes itself, or files include each other too deeply.
        """
        above = [each.resolve() for each in self.open]
        if path.resolve() in above:
            circle = [*self.open[above.index(path.resolve()) :], path]
            names = " includes ".join(f"'{each.name}'" for each in circle)
            raise ExpressionError(f"files include each other in a circle: {names}")
        if len(above) > DEEPEST_INCLUDE:
            raise ExpressionError(f"files include each other more than {DEEPEST_INCLUDE} deep")
        content = read_bounded(path, "xacro file", XML_FILE)
        self._bytes += len(content)
        if self._bytes > XACRO_FILES:
            raise ExpressionError(f"more than {XACRO_FILES / 1e6:.0f} MB are included")
        root = MixedReader(content, str(path)).root()
        self.open.append(path)
        return root

    def load_yaml(self, name: str, number: Callable[[str], float]) -> Any:
        """The content of a YAML file, as xacro's `load_yaml` has it.

        Args:
            number: The value of an expression with a unit, such as that of `!degrees 2 * 45`.
        """
        path = self.named(name)
        text = read_text(path)
        self._bytes += len(text)
        if self._bytes > XACRO_FILES:
            raise ExpressionError(f"more than {XACRO_FILES / 1e6:.0f} MB are included")
        return self._plain(parse_ros_yaml(text, Source.of_text(str(path), text), number))

    def _plain(self, item: Located) -> Any:
        self._budget.spend(STEPS_OF_VALUE)
        if isinstance(item.value, dict):
            return YamlDict({key: self._plain(each.value) for key, each in item.value.items()})
        if isinstance(item.value, list):
            return [self._plain(each) for each in item.value]
        return item.value
