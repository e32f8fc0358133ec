"""Who may use a studio: strangers, other sites and other hosts are refused."""

import http.client
import json
import resource
import signal

import pytest
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from harness.core.errors import HarnessError, SpecError
from tests.waiting import HANG

pytest.importorskip("django_static_ace_builds")


def status(served, path="/", **headers):
    connection = http.client.HTTPConnection("127.0.0.1", served.port, timeout=HANG)
    named = {name.replace("_", "-"): value for name, value in headers.items()}
    connection.request("GET", path, headers=named)
    response = connection.getresponse()
    response.read()
    connection.close()
    return response.status, response.headers


def socket_status(served, path="/studio/ws", origin=None, **headers):
    address = f"ws://127.0.0.1:{served.port}{path}"
    try:
        with connect(address, origin=origin, additional_headers=headers):
            return 101
    except InvalidStatus as refused:
        return refused.response.status_code


@pytest.fixture(scope="module")
def served(serve):
    return serve()


@pytest.fixture(scope="module")
def shared(serve):
    return serve(is_open=True)


def test_the_page_has_a_strict_policy_and_is_not_kept(served):
    code, headers = status(served)
    assert code == 200
    policy = headers["Content-Security-Policy"]
    assert "script-src 'self';" in policy
    assert "default-src 'none'" in policy
    assert headers["Cache-Control"] == "no-store"
    assert "unsafe-eval" not in policy
    assert "frame-ancestors 'none'" in policy


def test_another_sites_page_cannot_open_a_socket(served):
    own = f"http://127.0.0.1:{served.port}"
    assert socket_status(served, origin="http://evil.example") == 403
    assert socket_status(served, origin=f"http://127.0.0.1:{served.port + 1}") == 403
    assert socket_status(served, "/studio/ws", origin=own) == 101


def test_a_name_that_was_bound_to_this_machine_is_refused(served):
    assert status(served, Host=f"evil.example:{served.port}")[0] == 403
    assert status(served, Host="127.0.0.1:1")[0] == 403
    assert status(served, Host=f"localhost:{served.port}")[0] == 200


@pytest.mark.parametrize(
    "path",
    [
        "/../pyproject.toml",
        "/studio/../../studio.py",
        "/%2e%2e/x",
        "/studio/main.py",
        "/view/page.html",
        "/x",
    ],
)
def test_nothing_but_the_page_is_served(served, path):
    assert status(served, path)[0] == 404


def test_other_machines_need_the_token(shared):
    token = shared.guard.token
    assert len(token) > 20
    assert status(shared)[0] == 403
    assert status(shared, "/?token=wrong")[0] == 403
    code, headers = status(shared, f"/?token={token}")
    assert code == 200
    cookie = headers["Set-Cookie"]
    assert "HttpOnly; SameSite=Strict" in cookie
    assert status(shared, Cookie=cookie.partition(";")[0])[0] == 200
    assert socket_status(shared) == 403
    assert socket_status(shared, Cookie=f"harness_studio={token}x") == 403
    assert socket_status(shared, Cookie=cookie.partition(";")[0]) == 101


def test_files_outside_the_folder_are_neither_read_nor_written(served):
    reply = served.reply_to("save", name="../other.scenario.yaml")
    assert "outside the folder" in reply["error"]
    assert "ends in .scenario.yaml" in served.reply_to("save", name="x.py")["error"]
    text = served.studio.text.replace("robot: open_manipulator_x", "robot: {urdf: /etc/passwd}")
    [problem] = served.reply_to("edit", text=text)["document"]["problems"]
    assert "`/etc/passwd` is outside" in problem["text"]
    text = served.studio.saved.replace("world: empty", "world: ../../secret.yaml")
    [problem] = served.reply_to("edit", text=text)["document"]["problems"]
    assert (problem["line"], "is outside" in problem["text"]) == (3, True)
    served.reply_to("edit", text=served.studio.saved)


def test_a_page_does_not_learn_the_name_with_which_another_controls(served):
    address = f"ws://127.0.0.1:{served.port}/studio/ws"
    with connect(address) as first, connect(address) as second:
        first.send(json.dumps({"page": "secret-of-the-first"}))
        first.recv()
        second.send(json.dumps({"page": "second"}))
        second.send(json.dumps({"do": "control", "word": "request", "number": 1}))
        second.send(json.dumps({"do": "reset", "number": 2}))
        heard = ""
        while '"number": 2' not in heard:
            heard += str(second.recv())
    assert "secret-of-the-first" not in heard
    assert "another page controls the cell" in heard


def test_a_defect_in_an_action_does_not_end_the_session(served):
    served.studio.session.post(lambda: 1 / 0)
    assert served.reply_to("reset") == {}


def test_a_bad_request_is_answered_and_harms_nothing(served):
    assert "no action" in served.reply_to("shutdown")["error"]
    assert "bad request" in served.reply_to("jog", joint="joint1")["error"]
    assert "bad request" in served.reply_to("goal", xyz=["a"], rpy=[])["error"]
    hovered = {"text": "scenario: x\n", "line": 1}
    for column in (float("inf"), float("nan"), [], {}):
        assert "bad request" in served.reply_to("hover", column=column, **hovered)["error"]
    for text in ("\0", "a: \x07", "\ud800"):
        reply = served.reply_to("complete", text=text, line=0, column=1)
        assert {"error", "options"} & reply.keys(), reply
    assert "bad request" in served.reply_to("complete", text="a", line=-1, column=1)["error"]
    assert served.reply_to("reset") == {}


def test_unsaved_work_survives_a_crash(serve):
    from harness.plugins.studio.studio import Studio

    first = serve()
    text = first.studio.text.replace("steps: []", "steps:\n  - wait: 1 s")
    first.reply_to("edit", text=text)
    assert first.files.restored() == text  # the process may end here
    again = Studio.opened(first.files, first.studio.saved, first.files.restored(), "found")
    assert again.text == text
    assert again.cell.document.step_count == 1
    first.reply_to("save")
    assert first.files.restored() is None


def test_a_scenario_is_saved_where_it_was_and_elsewhere_only_if_it_still_compiles(tmp_path):
    from harness.plugins.studio.files import StudioFiles
    from harness.plugins.studio.studio import Studio

    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "w.yaml").write_text("world: w\n")
    text = "scenario: x\nrobot: open_manipulator_x\nworld: w.yaml\nsteps: [wait: 1 s]\n"
    files = StudioFiles(tmp_path, tmp_path / "sub" / "x.scenario.yaml")
    studio = Studio.opened(files, text, None, "")
    assert studio.document_message()["file"] == "sub/x.scenario.yaml"
    assert studio.do("save", {"name": "sub/x.scenario.yaml"})["file"] == "sub/x.scenario.yaml"
    with pytest.raises(SpecError, match=r"w\.yaml"):
        studio.do("save", {"name": "x.scenario.yaml"})
    assert sorted(each.name for each in tmp_path.iterdir()) == ["sub"]
    assert files.path.read_text() == text


def test_a_full_disk_leaves_the_file_as_it_was_and_no_half(tmp_path):
    from harness.plugins.studio.files import StudioFiles

    files = StudioFiles(tmp_path, tmp_path / "x.scenario.yaml")
    files.save(files.path, "before")
    limit = resource.getrlimit(resource.RLIMIT_FSIZE)
    ignored = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, limit[1]))
    try:
        with pytest.raises(HarnessError, match=r"x.scenario.yaml' cannot be written: File too"):
            files.save(files.path, "after" * 1000)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limit)
        signal.signal(signal.SIGXFSZ, ignored)
    assert [each.name for each in tmp_path.iterdir()] == ["x.scenario.yaml"]
    assert files.path.read_text() == "before"


def test_a_file_that_cannot_be_written_is_said_and_nothing_is_lost(serve):
    served = serve()
    (served.files.root / "taken.scenario.yaml").mkdir()
    said = served.reply_to("save", name="taken.scenario.yaml")["error"]
    assert said == "'taken.scenario.yaml' cannot be written: Is a directory"
    served.files.unsaved.mkdir()
    notes = []
    served.studio.session.broadcast = lambda message, **_: notes.append(message)
    for number in range(2):
        served.reply_to("edit", text=f"{served.studio.saved}# {number}\n")
    warned = [each["text"] for each in notes if each["type"] == "note"]
    assert len(warned) == 1
    assert "a crash would lose this work" in warned[0]


def test_a_robot_of_the_command_line_may_be_anywhere(tmp_path):
    from harness.plugins.studio.document import Document
    from harness.plugins.studio.files import StudioFiles

    robot = tmp_path / "elsewhere" / "arm.urdf"
    written = Document(f"robot: {{urdf: {robot}}}\n").root
    folder = tmp_path / "here"
    StudioFiles(folder, folder / "x.scenario.yaml", [robot]).refuse_outside(written)
    with pytest.raises(SpecError, match="is outside"):
        StudioFiles(folder, folder / "x.scenario.yaml").refuse_outside(written)


MESH = "{name: m, mesh: {file: '%s'}}"
WAYS_OUT = {
    "a mesh": f"objects: [{MESH % '../secret.stl'}]",
    "a parameter": f"params: {{text: ../secret.stl}}\nobjects: [{MESH % '${text}'}]",
    "two parts": f"params: {{a: ., b: ./secret.stl}}\nobjects: [{MESH % '${a}${b}'}]",
    "a link of the file system": f"objects: [{MESH % 'link/secret.stl'}]",
    "a world with a name": "world: {name: ../secret.yaml}",
    "a world's mesh": "world: w.yaml",
}


@pytest.mark.parametrize("way", WAYS_OUT)
def test_no_value_leads_out_of_the_folder(tmp_path, way):
    from harness.plugins.studio.document import Document
    from harness.plugins.studio.files import StudioFiles
    from harness.plugins.studio.live_cell import LiveCell

    folder = tmp_path / "here"
    folder.mkdir()
    (folder / "link").symlink_to(tmp_path)
    (folder / "w.yaml").write_text(f"world: w\nobjects: [{MESH % '../secret.stl'}]\n")
    (tmp_path / "secret.stl").write_text("solid x")
    (tmp_path / "secret.yaml").write_text("world: secret\n")
    files = StudioFiles(folder, folder / "x.scenario.yaml")
    text = f"scenario: x\nrobot: open_manipulator_x\n{WAYS_OUT[way]}\nsteps: [wait: 1 s]\n"
    with pytest.raises(SpecError, match="is outside"):
        LiveCell(files, Document(text, str(files.path)))
    assert LiveCell(files, Document(text.replace(WAYS_OUT[way], ""), str(files.path)))
