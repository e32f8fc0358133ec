"""Files and folders that a command writes are tried before it begins."""

import pytest

from tests.running import exit_code

SCENARIO = "scenario: A\nrobot: open_manipulator_x\nsteps: [{wait: 0.1 s}]\n"
RUN = ["run", "a.scenario.yaml"]
FILES = [
    [*RUN, "--ctrf"],
    [*RUN, "--comment"],
    [*RUN, "--update-baseline", "--baseline"],
    ["gate", ".", "--ctrf"],
    ["compare", "a", "b", "--page"],
    ["results", ".", "--csv"],
    ["results", ".", "--parquet"],
    ["robot", "show", "open_manipulator_x", "--image"],
    ["robot", "check", "open_manipulator_x", "--write-srdf"],
    ["grade-class", "a", "b", "--one", "--gradescope"],
    ["grade-class", "a", "b", "--one", "--classroom50"],
    ["schema", "--write"],
]
FOLDERS = [
    [*RUN, "--report-dir"],
    ["film", ".", "--to"],
    ["merge", ".", "--report-dir"],
    ["bench", "a.scenario.yaml", "--report-dir"],
]
NEW = [
    ["new"],
    ["new", "--project"],
    ["course", "start", "1"],
    ["export", ".", "--urdf"],
    ["export", ".", "--bag"],
    ["import", "sdf", "a.sdf", "-o"],
]


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.scenario.yaml").write_text(SCENARIO)
    (tmp_path / "notes.txt").write_text("notes")
    (tmp_path / "taken").mkdir()
    return tmp_path


def refusal(arguments, capsys):
    """What a command prints that ends with exit code 2."""
    code, printed = exit_code(*arguments), capsys.readouterr()
    assert (code, printed.out) == (2, "")
    return printed.err.splitlines()[-1]


@pytest.mark.parametrize("command", [*FILES, *FOLDERS, *NEW], ids=" ".join)
def test_an_output_below_a_file_is_refused_before_anything_runs(command, folder, capsys):
    before = sorted(folder.rglob("*"))
    said = refusal([*command, "notes.txt/x/y"], capsys)
    assert "'notes.txt/x/y'" in said
    assert "notes.txt' is a file; choose another folder" in said
    assert not command[-1].startswith("-") or command[-1] in said
    assert sorted(folder.rglob("*")) == before


@pytest.mark.parametrize("command", FILES, ids=" ".join)
def test_a_folder_is_no_output_file(command, capsys):
    assert "'taken' is a folder; name a file" in refusal([*command, "taken"], capsys)


@pytest.mark.parametrize("command", FOLDERS, ids=" ".join)
def test_a_file_is_no_output_folder(command, capsys):
    said = refusal([*command, "notes.txt"], capsys)
    assert "nothing can be written into 'notes.txt', as 'notes.txt' is a file" in said


@pytest.mark.parametrize("command", [*FILES, *NEW, *FOLDERS], ids=" ".join)
def test_an_output_whose_name_is_too_long_is_refused(command, capsys):
    said = refusal([*command, "x" * 256], capsys)
    assert "a name has at most 255 bytes; choose a shorter one" in said


@pytest.mark.parametrize("command", [FILES[0], NEW[0], FOLDERS[1]], ids=" ".join)
def test_an_output_in_a_folder_that_takes_none_is_refused(command, capsys):
    assert "in '/proc'; choose another folder" in refusal([*command, "/proc/none/x"], capsys)


def test_a_device_is_an_output_file():
    assert exit_code("schema", "--write", "/dev/null") == 0


def test_a_damaged_baseline_is_refused_before_it_is_updated(folder, capsys):
    (folder / "margins.json").write_text("{}")
    said = refusal([*RUN, "--baseline", "margins.json", "--update-baseline"], capsys)
    assert "margins.json" in said
    assert not (folder / "reports").exists()
