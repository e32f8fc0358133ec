"""The page by Chromium's accessibility tree, as a screen reader gets it, and by keys alone."""

import re

import pytest

from tests.reporting.browser import visits, wait_for, wait_for_frame

LANDMARKS = {
    "banner": "",
    "navigation": "Steps",
    "main": "Replay",
    "complementary": "Details",
    "region": "Plots",
    "tablist": "",
    "slider": "Time",
}
SPOKEN = re.compile(r"\w")  # a sign alone is no name
FOCUS = """(() => {
    const { outlineStyle, outlineWidth } = getComputedStyle(document.activeElement)
    const parts = '#steps, #view, #timeline, #tabs, #panels, #plots, header'
    const place = document.activeElement.closest(parts)
    return [document.activeElement.tagName, place?.id || place?.tagName || '',
            outlineStyle !== 'none' && parseFloat(outlineWidth) >= 2]
})()"""


@pytest.fixture(scope="module")
def opened(browser, failed_run):
    with visits(browser) as visit:
        yield visit(failed_run / "report.html", has_scene=True)


@pytest.fixture(scope="module")
def nodes(opened):
    """Role, name and properties of all that is not hidden from assistive technology."""
    wait_for(opened.page, "document.querySelectorAll('.plot').length > 0")
    wait_for_frame(opened.page)
    tree = opened.page.context.new_cdp_session(opened.page).send("Accessibility.getFullAXTree")
    return [
        (
            node["role"]["value"],
            node.get("name", {}).get("value", ""),
            {each["name"]: each["value"].get("value") for each in node.get("properties", [])},
        )
        for node in tree["nodes"]
        if not node["ignored"]
    ]


def test_landmarks_have_their_roles_and_names(nodes):
    found = {(role, name) for role, name, _ in nodes}
    for role, name in LANDMARKS.items():
        assert any(each == role and (not name or name == called) for each, called in found), role


def test_what_takes_the_focus_has_a_spoken_name_of_its_own(nodes):
    names = [(role, name) for role, name, known in nodes if known.get("focusable")]
    assert len(names) > 20
    assert [each for each in names if each[0] != "RootWebArea" and not SPOKEN.search(each[1])] == []
    saves = [name for _, name in names if name.startswith("Save the plot")]
    assert len(saves) > 2
    assert len(set(saves)) == len(saves)


def test_a_step_and_a_verdict_say_how_they_ended(nodes):
    buttons = [name for role, name, _ in nodes if role == "button"]
    assert any(name.startswith("passed ") and "move_to" in name for name in buttons)
    assert any(name.startswith("failed ") for name in buttons)


def test_the_whole_page_is_used_by_keys_with_a_focus_that_is_seen(opened):
    """Tab reaches every part once round; Enter, arrows and Escape do what a click does."""
    page = opened.page
    wait_for(page, "document.querySelectorAll('.plot').length > 0")
    page.evaluate("document.activeElement.blur()")
    places, unseen = [], []
    for _ in range(150):
        page.keyboard.press("Tab")
        tag, place, is_seen = page.evaluate(FOCUS)
        if tag == "BODY":
            break
        places.append(place)
        unseen += [] if is_seen else [(tag, place)]
    assert unseen == []
    order = list(dict.fromkeys(filter(None, places)))
    assert order[:3] == ["HEADER", "steps", "view"]
    assert {"timeline", "tabs", "panels", "plots"} <= set(order)
    page.focus("#help-button")
    page.keyboard.press("Enter")
    wait_for(page, "document.querySelector('#help').open")
    page.keyboard.press("Escape")
    wait_for(page, "!document.querySelector('#help').open")
    assert page.evaluate("document.activeElement.id") == "help-button"
    page.focus("#tabs [aria-selected=true]")
    before = page.evaluate("document.activeElement.id")
    page.keyboard.press("ArrowRight")
    assert page.evaluate("document.activeElement.id") != before
    page.focus("#steps .step >> nth=1")
    page.keyboard.press("Enter")
    assert page.locator("#steps .step >> nth=1").get_attribute("aria-current") == "step"
