from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from harness.core.resources import data_folder
from harness.language.files.source import Place, Source, located
from harness.language.files.yaml_file import parse_yaml
from harness.language.files.yaml_text import yaml_text
from harness.language.reading.load import load_scenario, parse_scenario
from harness.language.reading.resolve import resolved_text
from harness.language.variation import VARIATION_KEYS

FILES = Path(__file__).parent / "files"
LESSONS = sorted(data_folder("scenarios").rglob("*.scenario.yaml"))

texts = st.text(st.characters(exclude_categories=("Cs",)), max_size=20) | st.sampled_from(
    [
        "on",
        "1e3",
        "0o17",
        "null",
        "~",
        "",
        "- a",
        "a: b",
        "#x",
        "12:30",
        "=",
        "<<",
        "5 cm",
        "'",
        '"',
    ]
)
scalars = (
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False)
)
values = st.recursive(
    scalars | texts,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(texts, inner, max_size=4),
    max_leaves=12,
)


@settings(max_examples=150)
@given(st.dictionaries(texts, values, min_size=1, max_size=4))
def test_any_values_written_are_read_again(data):
    text = yaml_text(located(data, Place(Source(""))), block_keys=("steps",))
    assert parse_yaml(text, Source.of_text("", text)).plain() == data


@pytest.mark.parametrize("path", [FILES / "design.yaml", *LESSONS], ids=lambda path: path.name)
def test_a_resolved_scenario_loads_to_an_equal_one(path):
    loaded = load_scenario(path, seed=11)
    text = resolved_text(loaded)
    again = parse_scenario(text, path)
    # one case is resolved: which others there are is not its business
    unvaried = loaded.scenario.model_copy(update=dict.fromkeys(VARIATION_KEYS))
    assert again.scenario == unvaried
    assert again.scenario.seed == 11
    assert resolved_text(again) == text


def test_parameters_and_overrides_are_applied():
    overrides = {"lift": "0.2", "robot.model": "ur5e"}
    text = resolved_text(load_scenario(FILES / "design.yaml", overrides))
    assert "robot: {model: ur5e, gripper: rh_p12_rn_a" in text
    assert "distance: 0.2}" in text
    assert "  - move_to: mogi_home\n" in text


def test_text_that_looks_like_a_reference_is_escaped():
    text = "scenario: a $${b} c\nrobot: ur3e\nsteps: [settle]\n"
    loaded = parse_scenario(text, Path("f.yaml"))
    assert loaded.scenario.scenario == "a ${b} c"
    assert parse_scenario(resolved_text(loaded), Path("f.yaml")).scenario == loaded.scenario


def test_relative_paths_are_written_as_from_the_new_folder(tmp_path):
    text = """\
scenario: x
robot: {urdf: arm/arm.urdf, srdf: /abs/arm.srdf}
world: worlds/my.yaml
objects: [{name: a, mesh: {file: a.stl}}]
steps: [{include: parts/one.yaml}]
"""
    part = tmp_path / "in" / "parts" / "one.yaml"
    part.parent.mkdir(parents=True)
    part.write_text("steps: [{add_object: {name: b, mesh: {file: b.stl}}}]")
    loaded = parse_scenario(text, tmp_path / "in" / "f.yaml")
    resolved = resolved_text(loaded, folder=tmp_path / "out" / "case")
    again = parse_scenario(resolved, tmp_path / "out" / "case" / "f.yaml").scenario
    assert again.robot.urdf == "../../in/arm/arm.urdf"
    assert again.robot.srdf == "/abs/arm.srdf"
    assert again.world.name == "../../in/worlds/my.yaml"
    assert again.objects[0].mesh.file == "../../in/a.stl"
    added = again.steps[0].steps[0].objects[0]
    assert added.mesh.file == "../../in/parts/b.stl"


def test_the_folders_of_a_worlds_models_are_written_as_from_the_new_folder(tmp_path):
    text = "scenario: x\nrobot: {urdf: a.urdf, packages: [.]}\n"
    text += "world: {name: w.sdf, model_path: [models, /abs]}\nsteps: [settle]\n"
    loaded = parse_scenario(text, tmp_path / "in" / "f.yaml")
    resolved = resolved_text(loaded, folder=tmp_path / "out")
    again = parse_scenario(resolved, tmp_path / "out" / "f.yaml").scenario
    assert again.world.name == "../in/w.sdf"
    assert again.world.model_path == ("../in/models", "/abs")
    assert again.robot.packages == ("../in",)


def test_resolving_a_scene_takes_memory_in_proportion_to_its_objects(tmp_path):
    """Once every value was printed with all lines of its file: 270 MB for 300 objects."""
    import tracemalloc

    def peak(count):
        path = tmp_path / "many.scenario.yaml"
        objects = "".join(
            f"  - {{name: box{index}, box: {{size: [5 cm, 5 cm, 5 cm]}}}}\n"
            for index in range(count)
        )
        head = "scenario: many\nrobot: open_manipulator_x\nobjects:\n"
        path.write_text(f"{head}{objects}steps: [{{wait: 1 s}}]\n", encoding="utf-8")
        loaded = load_scenario(path)
        tracemalloc.start()
        resolved_text(loaded, folder=tmp_path / "elsewhere")
        _, most = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        return most

    peak(1)  # what is imported when it is first needed
    assert peak(200) < 5 * peak(50)
