"""A report in headless Chromium, without network: no error, every figure, hover, slider."""

import pytest

import rockshed
from tests.browser import PATIENCE, chromium

pytestmark = [pytest.mark.browser, pytest.mark.slow]


@pytest.fixture(scope="module")
def browser():
    with chromium() as driver:
        yield driver


@pytest.fixture(scope="module")
def shown(browser, tmp_path_factory):
    """The browser with the report of a short run."""
    from selenium.webdriver.support.ui import WebDriverWait

    folder = tmp_path_factory.mktemp("browser") / "run"
    rockshed.simulate(rockshed.case("lab-impact", in_process=True, stop_time=0.004), folder)
    (file,) = rockshed.report(folder, check=False)
    browser.set_window_size(1280, 1000)
    browser.get(file.as_uri())
    script = "return document.documentElement.dataset.ready === 'yes'"
    WebDriverWait(browser, PATIENCE).until(lambda page: page.execute_script(script))
    return browser


def test_nothing_is_said_on_the_console(shown):
    assert shown.get_log("browser") == []
    assert shown.execute_script("return document.getElementById('trouble').hidden")


def test_every_figure_is_there(shown):
    script = """return [...document.querySelectorAll('[data-chart]')].map(
        (place) => place.querySelectorAll('.scatterlayer .trace').length)"""
    drawn = shown.execute_script(script)
    assert len(drawn) >= 8
    assert all(drawn)
    colours = """const canvas = document.querySelector('canvas');
        const pixels = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
        const found = new Set();
        for (let i = 0; i < pixels.length; i += 4) found.add(pixels.slice(i, i + 3).join());
        return found.size"""
    assert shown.execute_script(colours) > 20


def test_hover_tells_the_values_of_all_curves(shown):
    script = """const chart = document.querySelector('[data-chart]');
        Plotly.Fx.hover(chart, {xval: 2});
        return chart.querySelector('.hoverlayer').textContent"""
    told = shown.execute_script(script)
    assert "transmitted to the base" in told
    assert "on the rock" in told


def test_a_real_mouse_over_a_chart_shows_values(shown):
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.support.ui import WebDriverWait

    place = shown.find_element("css selector", "[data-chart='1'] .nsewdrag")
    shown.execute_script("arguments[0].scrollIntoView({block: 'center'})", place)
    ActionChains(shown).move_to_element(place).move_by_offset(15, 5).perform()
    script = "return document.querySelector(\"[data-chart='1'] .hoverlayer\").textContent"
    assert WebDriverWait(shown, 30).until(lambda page: page.execute_script(script))


def test_the_slider_moves_the_sand(shown):
    script = """const place = document.querySelector('.film');
        const canvas = place.querySelector('canvas');
        const slider = place.querySelector('input');
        const seen = [];
        for (const frame of [0, slider.max]) {
          slider.value = frame;
          slider.dispatchEvent(new Event('input'));
          seen.push([canvas.toDataURL(), place.querySelector('output').textContent]);
        }
        return seen"""
    (first, begin), (last, end) = shown.execute_script(script)
    assert first != last
    assert begin.startswith("0 ms")
    assert end.startswith("4 ms")


def test_a_click_in_the_legend_hides_a_curve(shown):
    script = """const chart = document.querySelector('[data-chart]');
        chart.nextElementSibling.querySelector('button').click();
        const hidden = chart.data[0].visible;
        chart.nextElementSibling.querySelector('button').click();
        return [hidden, chart.data[0].visible]"""
    assert shown.execute_script(script) == [False, True]


@pytest.mark.parametrize("width", [1280, 400])
def test_nothing_is_wider_than_the_window(shown, width):
    from selenium.webdriver.support.ui import WebDriverWait

    shown.set_window_size(width, 900)
    script = "return document.documentElement.scrollWidth - document.documentElement.clientWidth"
    WebDriverWait(shown, 20).until(lambda page: page.execute_script(script) <= 0)


def test_code_in_a_result_is_not_run(shown, tmp_path):
    """A policy in the page would stop what was not escaped: it lets no script run but its own."""
    script = """const code = document.createElement('script');
        code.textContent = "document.title = 'owned'";
        document.body.append(code);
        return document.title"""
    assert shown.execute_script(script) != "owned"
    (entry,) = shown.get_log("browser")
    assert "Content Security Policy" in entry["message"]
