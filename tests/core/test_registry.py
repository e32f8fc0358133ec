import subprocess
import sys
import textwrap

import pytest

from harness.core.registry import OWN_PACKAGE, PluginError, Registry

PLUGIN = """
import harness

class Tool:
    plugin_kind = "robot"

    @classmethod
    def plugin_name(cls):
        return cls.__dict__.get("word", "")

class Base(Tool):
    pass

class Remark(Base):
    word = "{name}"
"""


def install(folder, package, entry, source):
    """A package with one module and an entry point, as a wheel leaves it in a folder."""
    module, _, _ = entry.partition(":")
    (folder / f"{module}.py").write_text(source, encoding="utf-8")
    info = folder / f"{package.replace('-', '_')}-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {package}\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(f"[harness.plugins]\n{module} = {entry}\n")


def output_of(folder, code, **environment):
    """What Python code prints in a process of its own, whose path has a folder more."""
    head = (
        f"import sys, os; sys.path.insert(0, {str(folder)!r}); os.environ.update({environment})\n"
    )
    head += "from harness.core.registry import *\n"
    done = subprocess.run(
        [sys.executable, "-c", head + textwrap.dedent(code)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert not done.stderr, done.stderr
    return done.stdout.split("\n")[:-1]


def test_names_of_installed_packages_come_with_their_package(tmp_path):
    install(tmp_path, "remarks-for-arms", "remarks", PLUGIN.format(name="remark"))
    install(tmp_path, "one-class", "single:Remark", PLUGIN.format(name="other"))
    code = "r = registry('robot'); print([(n, r.package_of(n), r[n].__name__) for n in r])"
    assert output_of(tmp_path, code) == [
        "[('other', 'one-class', 'Remark'), ('remark', 'remarks-for-arms', 'Remark')]"
    ]


def test_a_name_of_two_packages_is_refused_with_both(tmp_path):
    install(tmp_path, "first", "first", PLUGIN.format(name="remark"))
    install(tmp_path, "second", "second", PLUGIN.format(name="remark"))
    code = """
    for attempt in range(2):
        try:
            "remark" in registry("robot")
        except PluginError as error:
            print(error)
    """
    said = output_of(tmp_path, code)
    message = (
        "plug-in second: two packages provide the robot collection `remark`: `first` and `second`"
    )
    assert [line for line in said if line.startswith("plug-in")] == [message, message]


def test_a_package_that_cannot_be_imported_is_named_where_a_name_is_missing(tmp_path):
    install(tmp_path, "remarks-for-arms", "remarks", PLUGIN.format(name="remark"))
    install(tmp_path, "broken-for-arms", "broken", "import no_such_module\n")
    code = """
    try:
        registry("robot").find("remarkk")
    except LookupError as error:
        print(error.args[0])
    """
    assert output_of(tmp_path, code) == [
        "there is no robot collection 'remarkk'; did you mean `remark`? known: remark; the"
        " plug-ins of the package `broken-for-arms` cannot be loaded: ModuleNotFoundError: No"
        " module named 'no_such_module'"
    ]


@pytest.mark.parametrize("by_path", [True, False])
def test_a_named_module_is_loaded_here_and_in_later_processes(tmp_path, by_path):
    (tmp_path / "remarks.py").write_text(PLUGIN.format(name="remark"), encoding="utf-8")
    module = str(tmp_path / "remarks.py") if by_path else "remarks"
    code = f"load_plugin({module!r}); print(dict(registry('robot')), os.environ[VARIABLE])"
    (said,) = output_of(tmp_path, code)
    assert said.startswith("{'remark': <class 'remarks.Remark'>}")
    code = "print(registry('robot').package_of('remark'))"
    assert output_of(tmp_path, code, HARNESS_PLUGINS=module) == ["remarks"]


def test_anything_registers_under_a_given_kind_and_name(tmp_path):
    code = """
    import harness
    harness.register(len, kind="planner", name="longest")
    print(registry("planner").find("longest") is len)
    for arguments in ({}, {"kind": "plannr", "name": "x"}, {"kind": "planner"}):
        try:
            harness.register(len, **arguments)
        except PluginError as error:
            print(error.reason)
    """
    assert output_of(tmp_path, code) == [
        "True",
        "<built-in function len> has no known `plugin_kind`",
        "<built-in function len> has no known `plugin_kind`",
        "<built-in function len> has no name to be registered under",
    ]


def test_built_ins_are_found_by_their_modules_and_imported_on_demand(tmp_path):
    package = tmp_path / "words"
    package.mkdir()
    (package / "__init__.py").write_text("")
    (package / "_shared.py").write_text("raise RuntimeError\n")
    for name in ("lift", "in_"):
        (package / f"{name}.py").write_text(PLUGIN.format(name=name.rstrip("_")))
    code = """
    r = Registry("planner", "words")
    print("lift" in r, "words.lift" in sys.modules)
    print(list(r), "words.in_" in sys.modules)
    """
    assert output_of(tmp_path, code) == ["True False", "['in', 'lift'] False"]


def test_a_built_in_name_cannot_be_taken():
    tools = Registry("step", "harness.core")
    with pytest.raises(PluginError, match=f"`errors`: `{OWN_PACKAGE}` and `mine`"):
        tools.add("errors", object(), "mine")
    tools.add("other", int, "mine")
    tools.add("other", int, "mine")
    with pytest.raises(PluginError, match="`mine` provides the step `other` twice"):
        tools.add("other", float, "mine")
