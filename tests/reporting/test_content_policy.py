"""Pages run nothing but their own scripts, even where somebody has put another into the file."""

import pytest

from harness.reporting.suite.write import write_suite
from tests.reporting.browser import NO_WEBGL, Visit, new_context, wait_for
from tests.reporting.suites import small_suite
from tests.reporting.test_hostile_names import page_of

INTRUDERS = {
    "a script": "<script>document.title = 'taken'</script>",
    "a handler": '<img src="data:," onerror="document.title = \'taken\'">',
    "a style": "<style>body { background-image: url(https://example.org/x) }</style>",
    "a remote picture": '<img src="https://example.org/x.png">',
    "a frame": '<iframe src="data:text/html,x"></iframe>',
    "a base": '<base href="https://example.org/">',
    "an object": '<object data="data:text/html,x"></object>',
}


@pytest.fixture(scope="module", params=["run", "suite"])
def page_file(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp(request.param)
    if request.param == "run":
        return page_of("plain", folder)
    return write_suite(folder, small_suite(), 3)[0]


@pytest.mark.nightly(but=["run-a script", "suite-a handler"])
@pytest.mark.parametrize("intruder", INTRUDERS.values(), ids=INTRUDERS)
def test_what_is_put_into_a_page_neither_runs_nor_loads(browser, page_file, tmp_path, intruder):
    text = page_file.read_text(encoding="utf-8")
    changed = tmp_path / "changed.html"
    changed.write_text(text.replace("<body>", f"<body>{intruder}", 1), encoding="utf-8")
    context = new_context(browser, offline=True)
    seen = Visit(context.new_page())
    seen.page.add_init_script(NO_WEBGL)
    seen.page.goto(changed.as_uri())
    wait_for(seen.page, "document.documentElement.dataset.ready === 'yes'")
    assert seen.page.title() != "taken"
    assert any("Content Security Policy" in each for each in seen.complaints), seen.complaints
    context.close()


def test_a_page_itself_breaks_none_of_its_rules(visit, page_file):
    seen = visit(page_file, has_scene=True)  # at the end, nothing may stand in the console
    rules = seen.page.get_attribute("meta[http-equiv=Content-Security-Policy]", "content")
    assert rules.startswith("default-src 'none'; script-src 'sha256-")
    assert "unsafe-inline'" not in rules.split("style-src-attr")[0]
    assert "unsafe-eval" not in rules
