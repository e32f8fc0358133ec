"""Files that are broken, hostile or huge: a located error, in seconds, in little memory."""

import resource
import subprocess
import sys
import time

import pytest

from harness.core.errors import SpecError
from tests.waiting import HANG, MOST_WORK
from tests.world.sdf_files import load, text_with, write

MEMORY = 1 << 30


def problem_of(folder, text):
    started = time.process_time()
    with pytest.raises(SpecError) as caught:
        load(folder, text)
    assert time.process_time() - started < MOST_WORK
    return caught.value.problems[0]


BOMB = "<!DOCTYPE b [<!ENTITY a 'aaaaaaaaaa'>" + "".join(
    f"<!ENTITY {chr(98 + n)} '{f'&{chr(97 + n)};' * 10}'>" for n in range(9)
)


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("", 1, "no element found"),
        ("<sdf version='1.9'>\n<world>\n</sdf>", 3, "mismatched tag"),
        (f"{BOMB}]><sdf version='1.9'>&j;</sdf>", 1, "a DOCTYPE, and with it entities"),
        ("<!DOCTYPE s SYSTEM 'file:///etc/passwd'><sdf version='1.9'/>", 1, "a DOCTYPE"),
        ("<robot/>", 1, "the root element is <robot>; that of an SDF file is <sdf>"),
        ("<sdf/>", 1, "<sdf> lacks its attribute 'version'"),
        ("<sdf version='1.3'/>", 1, "SDF 1.3 is older than 1.4"),
        ("<sdf version='nine'/>", 1, "`nine` is not a version of SDF"),
        ("<sdf version='1.9'>\n" + "<a>" * 300 + "</a>" * 300 + "</sdf>", 2, "nested more than"),
        (text_with("model", "\n<pose>0 0 zero 0 0 0</pose>"), 8, "expected 6 finite numbers"),
        (text_with("model", "\n<pose>0 0 inf 0 0 0</pose>"), 8, "expected 6 finite numbers"),
        (
            text_with("model", "\n<pose rotation_format='quat_xyzw'>0 0 0 0 0 0</pose>"),
            8,
            "expected 7 finite numbers",
        ),
        (text_with("model", "\n<static>maybe</static>"), 8, "`maybe` is neither true nor false"),
        (text_with("inertial", "\n<mass>0</mass>"), 10, "has a mass above 0, not 0 kg"),
        (
            text_with("inertial", "\n<inertia><ixx>1</ixx><iyy>1</iyy><izz>9</izz></inertia>"),
            10,
            "no rigid body has this inertia",
        ),
        (
            text_with("geometry", "\n<box><size>1 1 0</size></box>"),
            12,
            "<size> of a <box> is above 0, not 1 1 0",
        ),
        (text_with("geometry", "\n<sphere/>"), 12, "<sphere> lacks its <radius>"),
        (text_with("geometry", "\n<ball/>"), 12, "a collision cannot be a <ball>"),
        (
            text_with("geometry", "\n<mesh><uri>none.stl</uri></mesh>"),
            12,
            "`none.stl` is not found",
        ),
        (text_with("geometry", "\n<mesh><uri>crate</uri></mesh>"), 12, "`crate` is not a file"),
        (
            text_with("mesh", "\n<uri>http://example.org/a.stl</uri>"),
            23,
            "`http://example.org/a.stl` is not in Gazebo's cache",
        ),
        (
            text_with("mesh", "\n<uri>/etc/passwd</uri>"),
            23,
            "`/etc/passwd` is outside the folders that may be read",
        ),
        (
            text_with("mesh", "\n<uri>file:///etc/passwd</uri>"),
            23,
            "`file:///etc/passwd` is outside the folders that may be read",
        ),
        (
            text_with("include", "\n<uri>model://crate/../../../../../../../../etc</uri>"),
            27,
            "is outside the folders that may be read",
        ),
        (text_with("include", "\n<uri>model://crat</uri>"), 27, "`model://crat` is not found"),
        (text_with("physics", "\n<max_step_size>0</max_step_size>"), 5, "longer than 0 s, not 0 s"),
    ],
)
def test_a_mistake_is_reported_at_its_line(tmp_path, text, line, message):
    problem = problem_of(tmp_path, text)
    assert message in problem.message
    assert (problem.path, problem.line) == (str(tmp_path / "world.sdf"), line)


def test_all_missing_models_and_meshes_are_reported_together(tmp_path):
    includes = "<include><uri>model://a</uri></include><include><uri>model://b</uri></include>"
    with pytest.raises(SpecError) as caught:
        load(tmp_path, text_with("world", includes))
    assert [problem.message for problem in caught.value.problems] == [
        "`model://a` is not found",
        "`model://b` is not found",
    ]
    shapes = "".join(
        f"<collision name='{name}'><geometry><mesh><uri>{name}.stl</uri></mesh></geometry>"
        "</collision>"
        for name in ("e", "f")
    )
    with pytest.raises(SpecError) as caught:
        load(tmp_path, text_with("link", shapes))
    assert [problem.message for problem in caught.value.problems] == [
        "`e.stl` is not found",
        "`f.stl` is not found",
    ]


@pytest.mark.parametrize("name", ["a", "a/meshes/b.stl"])
def test_a_model_in_models_next_to_worlds_is_named_with_its_folder(tmp_path, name):
    (tmp_path / "models" / name).mkdir(parents=True)
    (tmp_path / "worlds").mkdir()
    include = f"<include><uri>model://{name}</uri></include>"
    problem = problem_of(tmp_path / "worlds", text_with("world", include))
    assert problem.message == f"`model://{name}` is not found"
    assert problem.hint.startswith(f"it is in {tmp_path / 'models'}; name its folder in `world:")


@pytest.mark.parametrize("name", ["models/a", "models/a/meshes/b.dae"])
def test_a_file_below_the_package_of_a_world_is_named_with_its_folder(tmp_path, name):
    (tmp_path / name).mkdir(parents=True)
    (tmp_path / "worlds").mkdir()
    include = f"<include><uri>file://{name}</uri></include>"
    problem = problem_of(tmp_path / "worlds", text_with("world", include))
    assert problem.message == f"`file://{name}` is not found"
    assert problem.hint.startswith(f"it is in {tmp_path}; name its folder in `world:")
    assert problem.hint.endswith("or with --model-path or --package-path")


@pytest.mark.parametrize("scheme", ["model", "package"])
@pytest.mark.parametrize("folder", ["bucket", "else"])
def test_a_model_that_is_the_world_names_its_own_files(tmp_path, folder, scheme):
    """As a file of a folder of models does, whose other folders need not be readable."""
    (tmp_path / folder).mkdir()
    (tmp_path / "bucket.stl").write_text("above the folder of the file")
    uri = f"<uri>{scheme}://bucket/{{}}</uri>"
    shape = "<collision name='d'><geometry><mesh>{}</mesh></geometry></collision>"
    own = text_with("link", shape.format(uri.format("part.obj")))
    if folder == "bucket":
        load(tmp_path / folder, own)
    else:
        assert problem_of(tmp_path / folder, own).message.endswith("part.obj` is not found")
    outside = text_with("link", shape.format(uri.format("../bucket.stl")))
    assert "bucket.stl`" in problem_of(tmp_path / folder, outside).message


def test_models_that_include_each_other_are_reported_with_the_circle(tmp_path):
    (tmp_path / "loop").mkdir()
    loop = "<sdf version='1.9'><model name='a'>\n<include><uri>model://loop</uri></include></model></sdf>"
    (tmp_path / "loop" / "model.sdf").write_text(loop)
    problem = problem_of(tmp_path, text_with("world", "<include><uri>model://loop</uri></include>"))
    assert problem.message == "includes form a cycle: world.sdf -> model.sdf -> model.sdf"
    assert (problem.path, problem.line) == (str(tmp_path / "loop" / "model.sdf"), 2)


def test_models_that_include_others_twice_each_end_at_a_number(tmp_path):
    for level in range(25):
        (tmp_path / f"level{level}").mkdir()
        below = f"<uri>model://level{level + 1}</uri>" if level < 24 else "<uri>model://crate</uri>"
        twice = "".join(f"<include><name>{name}</name>{below}</include>" for name in "ab")
        text = f"<sdf version='1.9'><model name='l'>{twice}</model></sdf>"
        (tmp_path / f"level{level}" / "model.sdf").write_text(text)
    text = text_with("world", "<include><uri>model://level0</uri></include>")
    assert problem_of(tmp_path, text).message == "more than 2000 models"


def test_frames_on_frames_without_end_are_refused(tmp_path):
    chain = "".join(
        f"<frame name='f{n}'><pose relative_to='f{n + 1}'/></frame>" for n in range(5000)
    )
    text = text_with("world", f"{chain}<frame name='f5000'/>")
    text = text.replace('relative_to="cell"', 'relative_to="f0"')
    assert "more than 50 deep" in problem_of(tmp_path, text).message


def test_a_link_out_of_the_folder_is_not_followed(tmp_path):
    (tmp_path / "inside").mkdir()
    (tmp_path / "secret.stl").write_text("solid")
    (tmp_path / "inside" / "part2.stl").symlink_to(tmp_path / "secret.stl")
    text = text_with("mesh", "<uri>part2.stl</uri>")
    problem = problem_of(tmp_path / "inside", text)
    assert "`part2.stl` is outside the folders that may be read" in problem.message
    assert "model_path" in problem.hint


@pytest.mark.nightly
def test_a_file_of_a_hundred_megabytes_is_refused_in_little_memory(tmp_path):
    path = write(tmp_path, "")
    with path.open("w", encoding="utf-8") as file:
        file.write("<sdf version='1.9'><world name='w'>\n")
        for _ in range(100):
            file.write("<model name='m'/>" * 61_000)
        file.write("</world></sdf>")
    assert path.stat().st_size > 100e6
    script = (
        "import sys\nfrom pathlib import Path\n"
        "from harness.plugins.formats.sdf.world import load_sdf\n"
        "from harness.core.errors import SpecError\n"
        "try: load_sdf(Path(sys.argv[1]))\nexcept SpecError as error: print(error); sys.exit(2)"
    )

    def in_little_memory():
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))

    done = subprocess.run(
        [sys.executable, "-c", script, str(path)],
        capture_output=True, text=True, timeout=HANG, preexec_fn=in_little_memory, check=False,
    )  # fmt: skip
    assert done.returncode == 2, done.stderr
    assert "the file has 10" in done.stdout
