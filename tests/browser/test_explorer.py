"""The explorer in a browser: one slider moves all, and keys reach all."""

from __future__ import annotations

import pytest

from tests.browser.pages import EXPLORED, HOSTILE_LABEL, LOST


@pytest.mark.parametrize("name", [name for name in EXPLORED if name != "pair"])
def test_one_slider_moves_what_each_chain_shows(opened, name):
    own = opened(name)
    last = int(own.page.locator("#explorer-slider").get_attribute("max"))
    assert own.page.locator("#explorer-scene").is_visible()
    assert own.page.locator("#explorer-picture").is_visible() == (name != "absolute")
    own.page.locator("#explorer-slider").fill(str(last - 1))
    own.wait_for_place(last - 1)
    assert own.value("scene", "poses") == "true estimated"
    before = own.value("scene", "eye")
    own.page.locator("#explorer-scene canvas").press("ArrowLeft")
    assert own.value("scene", "eye") != before
    parts = own.value("scene", "parts").split()
    wanted = {"tumble": {"target", "Sun"}, "navigated": {"target", "Sun"},
              "unknown": {"cloud", "Sun"}, "absolute": {"Earth", "way", "senders"}}  # fmt: skip
    assert wanted[name] | {"true", "estimated"} <= set(parts)
    if name == "absolute":
        assert int(own.value("scene", "heard")) > 3
    assert own.page.locator("#explorer-orbit").is_visible() == (name == "navigated")
    if name == "navigated":
        assert {"Earth", "way", "true", "estimated"} == set(own.value("orbit", "parts").split())
    own.page.locator("#explorer-worst").click()
    own.wait_for_place(int(own.page.locator("#explorer-slider").input_value()))


def test_the_slider_moves_picture_plots_and_scene(opened):
    own = opened()
    slider = own.page.locator("#explorer-slider")
    before = own.pixels("picture"), own.pixels("scene")
    slider.focus()
    slider.press("ArrowRight")
    own.wait_for_place(1)
    assert "frame 1" in own.page.locator("#explorer-now").inner_text()
    assert "frame 1" in slider.get_attribute("aria-valuetext")
    slider.press("End")
    own.wait_for_place(5)
    after = own.pixels("picture"), own.pixels("scene")
    assert before[0] != after[0]
    assert before[1] != after[1]


def test_a_click_into_a_plot_opens_its_frame_and_the_worst_is_one_button(opened):
    own = opened()
    over = own.page.locator(".timeplot .u-over").first
    over.scroll_into_view_if_needed()
    box = over.bounding_box()
    over.click(position={"x": 0.75 * box["width"], "y": 0.3 * box["height"]})
    shown = own.page.locator("#explorer-slider").input_value()
    assert shown != "0"
    own.wait_for_place(int(shown))
    own.page.locator("#explorer-worst").click()
    worst = own.page.evaluate(
        """() => { const data = JSON.parse(document.getElementById('explorer-data').textContent);
          const line = data.plots[0].lines.find(x => x.pipeline === data.leading
            && x.kind === 'line');
          const sizes = line.values.map(x => Math.abs(x ?? -0));
          return sizes.indexOf(Math.max(...sizes)); }"""
    )
    own.wait_for_place(worst)


def test_what_is_drawn_is_chosen(opened):
    own = opened()
    choices = own.page.locator("#explorer-picture .choices")
    assert own.value("picture", "layers").split() == ["truth", "reprojections", "detections"]
    whole = own.pixels("picture")
    choices.get_by_label("truth").uncheck()
    assert own.value("picture", "layers").split() == ["reprojections", "detections"]
    assert own.pixels("picture") != whole
    choices.get_by_label("truth").check()
    assert own.pixels("picture") == whole
    choices.get_by_label("greys").select_option("linear")
    assert own.pixels("picture") != whole
    scene = own.pixels("scene")
    own.page.locator("#explorer-scene .choices").get_by_label("target", exact=True).uncheck()
    assert own.pixels("scene") != scene


def test_the_other_image_of_a_pair_is_chosen(opened):
    own = opened()
    assert own.value("picture", "image") == "850 nm"
    lit = own.pixels("picture")
    images = own.page.locator("#explorer-picture .choices").get_by_label("image")
    images.select_option(label="800 nm")
    canvas = "document.querySelector('#explorer-picture canvas')"
    own.wait_for(f"() => {canvas}.dataset.image === '800 nm'")
    assert own.pixels("picture") != lit


def test_another_run_has_its_own_errors_poses_and_reasons(opened):
    own = opened()
    own.page.locator("#explorer-pipeline").select_option(HOSTILE_LABEL)
    verdict, scene = own.page.locator("#explorer-verdict"), own.pixels("scene")
    own.page.locator("#explorer-scene .choices").get_by_label("difference").select_option("100")
    far = own.pixels("scene")
    assert far != scene
    first = verdict.inner_text()
    own.page.locator("#explorer-run").select_option("1")
    assert verdict.inner_text() != first
    assert own.pixels("scene") != far
    plot = own.page.locator(".timeplot", has_text="position error of every run")
    assert plot.locator("label", has_text="least to most of 2 runs").count() == 3


def test_zoom_goes_to_the_pixel_and_back(opened):
    own = opened()
    fit = float(own.value("picture", "zoom"))
    canvas = own.page.locator("#explorer-picture canvas")
    canvas.focus()
    for _ in range(30):
        canvas.press("+")
    assert float(own.value("picture", "zoom")) == 64.0
    canvas.press("0")
    assert float(own.value("picture", "zoom")) == fit


def test_a_drag_and_the_arrow_keys_turn_the_scene(opened):
    own = opened()
    canvas = own.page.locator("#explorer-scene canvas")
    canvas.scroll_into_view_if_needed()
    start = own.value("scene", "eye")
    box = canvas.bounding_box()
    x, y = box["x"] + 0.5 * box["width"], box["y"] + 0.6 * box["height"]
    own.page.mouse.move(x, y)
    own.page.mouse.down()
    own.page.mouse.move(x + 60.0, y + 10.0, steps=4)
    own.page.mouse.up()
    dragged = own.value("scene", "eye")
    assert dragged != start
    canvas.focus()
    canvas.press("ArrowLeft")
    assert own.value("scene", "eye") != dragged


def test_a_pipeline_is_chosen_and_a_lost_frame_says_why(opened):
    own = opened()
    own.page.locator("#explorer-slider").fill(str(LOST))
    own.wait_for_place(LOST)
    verdict = own.page.locator("#explorer-verdict")
    assert verdict.inner_text().startswith("no pose")
    assert own.value("scene", "poses") == "true"
    own.page.locator("#explorer-pipeline").select_option("paper")
    assert verdict.inner_text().startswith("position error")
    assert own.value("scene", "poses") == "true estimated"


def test_keys_reach_every_control_and_every_explanation(opened):
    own = opened()
    reached, wanted = own.page.evaluate(
        """() => {
          const can = [...document.querySelectorAll(
            '#explorer-section button, #explorer-section input, #explorer-section select, '
            + '#explorer-section canvas[tabindex], summary, .scroll, .strip input')]
            .filter(x => x.offsetParent !== null || x.closest('.strip'));
          const visited = new Set();
          globalThis.walked = visited;
          document.addEventListener('focusin', e => visited.add(e.target));
          globalThis.wanted = can;
          return [visited.size, can.length];
        }"""
    )
    assert (reached, wanted > 40) == (0, True)
    for _ in range(wanted + 20):
        own.page.keyboard.press("Tab")
    missed = own.page.evaluate(
        "() => wanted.filter(x => !walked.has(x)).map(x => x.outerHTML.slice(0, 80))"
    )
    assert missed == []
    term = own.page.locator("details.term summary").first
    term.focus()
    term.press("Enter")
    assert own.page.locator("details.term p").first.is_visible()
