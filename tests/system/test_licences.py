"""Licences and sizes of dependencies, and the lock file, against pyproject.toml and packages."""

import re
import tomllib
from importlib.metadata import PackageNotFoundError, distribution

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from docs import ROOT

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
EXTRAS = ("cameras", "meshes", "bags", "video", "search", "ik-test", "studio", "parquet", "mcp")
PAGE = (ROOT / "docs/reference/licences.md").read_text()
LOCK = (ROOT / ".ci/requirements.lock").read_text()
TABLE = {
    name: (licence, needed)
    for name, licence, needed in re.findall(r"(?m)^\| ([\w-]+) \| (.+?) \| (.+?) \|$", PAGE)
}
PERMISSIVE = {
    *("0BSD", "Apache-2.0", "BSD-2-Clause", "BSD-3-Clause", "BSL-1.0", "CC0-1.0", "MIT"),
    *("MIT-CMU", "PSF-2.0", "Qhull", "Zlib", "any OSI licence"),
}
CLASSIFIERS = {
    "MIT License": "MIT",
    "BSD License": "BSD-3-Clause",
    "Apache Software License": "Apache-2.0",
    "Mozilla Public License 2.0 (MPL 2.0)": "MPL-2.0",
    "Python Software Foundation License": "PSF-2.0",
}


def dependencies(requirements):
    """The installed distributions that requirements bring, by name; None for an absent one."""
    found, left = {}, [Requirement(each) for each in requirements]
    while left:
        requirement = left.pop()
        name = canonicalize_name(requirement.name)
        if name in found or not applies(requirement, requirement.extras):
            continue
        try:
            found[name] = distribution(name)
        except PackageNotFoundError:
            found[name] = None
            continue
        stated = map(Requirement, found[name].requires or ())
        left += [each for each in stated if applies(each, requirement.extras)]
    return found


def applies(requirement, extras):
    marker = requirement.marker
    return marker is None or any(marker.evaluate({"extra": each}) for each in ("", *extras))


def stated_licence(found):
    """The licence in the metadata, as the page has it; empty where there is none."""
    data = found.metadata
    if expression := data.get("License-Expression"):
        return "any OSI licence" if expression == "any-OSI" else expression
    titles = [each.split("::")[-1].strip() for each in data.get_all("Classifier") or ()]
    return next((CLASSIFIERS[each] for each in titles if each in CLASSIFIERS), "")


def parts(licence):
    return {each.strip("() ") for each in re.split(r" AND | OR ", licence)}


def test_every_required_package_is_listed_with_a_permissive_licence():
    for name, found in dependencies(PROJECT["dependencies"]).items():
        licence, needed = TABLE[name]
        assert needed == "every installation"
        assert parts(licence) <= PERMISSIVE, name
        assert found is None or stated_licence(found) in ("", licence), name


def test_the_required_packages_leave_room_for_a_lesson_in_600_megabytes():
    sizes = {
        name: sum(file.size or 0 for file in found.files or ())
        for name, found in dependencies(PROJECT["dependencies"]).items()
        if found is not None
    }
    assert sizes["libpinocchio"] > 10e6  # the sizes are those of RECORD, without bytecode
    rest = 45e6  # pip, setuptools, armharness, bytecode of what a lesson imports: 44 MB measured
    assert sum(sizes.values()) < 600e6 - rest, sorted(sizes.items(), key=lambda each: each[1])


@pytest.mark.nightly
@pytest.mark.parametrize("extra", EXTRAS)
def test_packages_of_an_extra_are_listed_with_their_licence(extra):
    for name, found in dependencies(PROJECT["optional-dependencies"][extra]).items():
        licence, _needed = TABLE[name]
        assert parts(licence) <= PERMISSIVE | {"MPL-2.0"}, name
        assert found is None or stated_licence(found) in ("", licence), name


def test_a_licence_that_is_not_permissive_is_found():
    assert not parts("GPL-3.0-only") <= PERMISSIVE
    assert not parts("MIT AND LGPL-2.1-only") <= PERMISSIVE


def test_the_lock_file_has_a_version_of_every_package_that_the_tests_need():
    pinned = {}
    for line in LOCK.splitlines():
        name, _, version = line.partition(";")[0].strip().partition("==")
        pinned.setdefault(canonicalize_name(name), []).append(version)
    extras = PROJECT["optional-dependencies"]
    own = {each for line in extras["dev"] + extras["test"] for each in Requirement(line).extras}
    lines = [*PROJECT["dependencies"], *extras["dev"], *extras["test"]]
    lines += [line for extra in own & set(extras) for line in extras[extra]]
    for requirement in map(Requirement, lines):
        if requirement.name != "armharness":
            versions = pinned[canonicalize_name(requirement.name)]
            assert all(version in requirement.specifier for version in versions), requirement
