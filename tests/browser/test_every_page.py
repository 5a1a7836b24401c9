"""Every page asks for nothing, complains of nothing, runs no name, fits, and can be read by all."""

from __future__ import annotations

from importlib.resources import files

import pytest

from tests.browser.pages import EXPLORED, MAKERS, PLAIN

AXE = files("axe_playwright_python").joinpath("axe.min.js").read_text()
SERIOUS = {"serious", "critical"}
WIDTHS_PX = (400, 1000, 1900)
TOO_WIDE = """() => [...document.querySelectorAll('body *')].filter(x =>
  x.getBoundingClientRect().right > innerWidth + 1 && !x.closest('.scroll, .plot, .frame'))
  .slice(0, 3).map(x => x.outerHTML.slice(0, 120))"""
UNFOLD = "document.querySelectorAll('details').forEach(x => { x.open = true; })"


@pytest.mark.parametrize("name", MAKERS)
def test_nothing_is_asked_nothing_complains_no_name_runs(opened, name):
    own = opened(name)
    own.page.evaluate(UNFOLD)
    own.page.wait_for_timeout(200)
    assert own.faults() == []
    assert own.page.title() != "taken"
    assert own.page.locator("img:not([src^='data:'])").count() == 0


@pytest.mark.parametrize("name", MAKERS)
def test_it_fits_and_axe_core_finds_nothing_serious(opened, name):
    own = opened(name, bypass_csp=True)  # axe-core is a script of ours, not of the page
    own.page.evaluate(AXE)
    found = {}
    for scheme in ("light", "dark"):
        own.page.emulate_media(color_scheme=scheme)
        for width in WIDTHS_PX:
            own.page.set_viewport_size({"width": width, "height": 900})
            own.page.evaluate(UNFOLD)
            own.page.wait_for_timeout(300)
            wide = own.page.evaluate("document.documentElement.scrollWidth")
            if wide > width:
                found[scheme, width, "too wide"] = own.page.evaluate(TOO_WIDE)
            seen = own.page.evaluate("axe.run(document, { resultTypes: ['violations'] })")
            for fault in seen["violations"]:
                if fault["impact"] in SERIOUS:
                    where = [node["html"][:160] for node in fault["nodes"][:3]]
                    found[scheme, width, fault["id"]] = where
    assert found == {}


@pytest.mark.parametrize("name", MAKERS)
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_it_is_as_bright_as_asked(opened, name, scheme):
    own = opened(name, color_scheme=scheme, java_script_enabled=name in EXPLORED)
    ground = own.page.evaluate("getComputedStyle(document.body).backgroundColor")
    bright = sum(map(int, ground.removeprefix("rgb(").removesuffix(")").split(","))) / 3
    assert (bright < 64) == (scheme == "dark")


@pytest.mark.parametrize("name", MAKERS)
def test_without_scripts_tables_and_pictures_remain(opened, name):
    own = opened(name, java_script_enabled=False)
    assert not own.page.locator("#explorer-section").is_visible()
    assert own.page.locator("table").first.is_visible()
    assert own.page.locator("figure img").count() >= 1
    assert own.page.locator("img:not([alt]), img[alt='']").count() == 0


def test_a_frame_of_a_sweep_is_reached_from_its_tile_and_leads_back(opened):
    own = opened("sweep", viewport={"width": 1000, "height": 900})
    tiles = own.page.locator(".sunmap a")
    assert tiles.count() == 22 == own.page.locator(".frame").count()
    tiles.nth(3).focus()
    own.page.keyboard.press("Enter")
    frame = own.page.locator(".frame").nth(3)
    assert frame.is_visible()
    assert "no pose" in frame.inner_text()
    assert tiles.nth(3).get_attribute("aria-label").startswith("Sun at azimuth")
    frame.get_by_role("link", name="next").click()
    assert not frame.is_visible()
    assert own.page.locator(".frame").nth(4).is_visible()
    own.page.keyboard.press("Tab")
    own.page.locator(".frame").nth(4).get_by_role("link", name="back to the map").click()
    assert not own.page.locator(".frame").nth(4).is_visible()
    assert own.faults() == []


def globe_of(own):
    """Return the globe once it is drawn."""
    globe = own.page.locator(".globe canvas")
    globe.scroll_into_view_if_needed()
    own.wait_for("() => Number(document.querySelector('.globe canvas').dataset.seen) > 5")
    return globe


def test_a_drag_and_keys_turn_the_globe_of_a_sweep_and_lead_to_a_frame(opened):
    own = opened("sweep", viewport={"width": 1000, "height": 900})
    globe = globe_of(own)
    start, box = globe.get_attribute("data-view"), globe.bounding_box()
    x, y = box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"]
    own.page.mouse.move(x, y)
    own.page.mouse.down()
    own.page.mouse.move(x + 90.0, y + 20.0, steps=4)
    own.page.mouse.up()
    turned = "was => document.querySelector('.globe canvas').dataset.view !== was"
    own.wait_for(turned, start)
    assert own.page.locator(".frame:visible").count() == 0
    dragged = globe.get_attribute("data-view")
    globe.focus()
    globe.press("ArrowLeft")
    own.wait_for(turned, dragged)
    facing = int(globe.get_attribute("data-facing"))
    words = own.page.locator(".sunmap a").nth(facing).get_attribute("aria-label")
    assert words in globe.get_attribute("aria-label")
    globe.press("Enter")
    assert own.page.locator(".frame").nth(facing).is_visible()
    own.page.locator(".frame").nth(facing).get_by_role("link", name="back to the map").click()
    assert own.faults() == []


def test_a_click_on_the_globe_opens_the_frame_in_front(opened):
    own = opened("sweep", viewport={"width": 1000, "height": 900})
    globe = globe_of(own)
    for _ in range(13):
        globe.press("ArrowUp")
    own.wait_for("() => document.querySelector('.globe canvas').dataset.view.endsWith(' 90.0')")
    box = globe.bounding_box()
    globe.click(position={"x": 0.5 * box["width"], "y": 0.5 * box["height"]})
    shown = own.page.locator(".frame:visible")
    assert shown.count() == 1
    assert "elevation 90 deg" in shown.inner_text()


@pytest.mark.parametrize("scripts", [True, False])
def test_a_cell_of_a_suite_leads_to_its_runs_and_back(opened, scripts):
    own = opened("suite", java_script_enabled=scripts)
    cell = own.page.locator("a.of-runs").first
    cell.focus()
    own.page.keyboard.press("Enter")
    runs = own.page.locator(".runs:visible")
    assert runs.count() == 1
    assert runs.locator("tbody tr").count() >= 1
    assert "seed 0" in runs.inner_text()
    own.page.keyboard.press("Tab")
    own.page.keyboard.press("Enter")
    assert own.page.locator(".runs:visible").count() == 0
    assert own.faults() == []


def test_pages_without_an_explorer_have_no_script(made):
    for name in set(PLAIN) - {"sweep"}:
        assert "<script" not in made[name].read_text().replace("&lt;script", "")
