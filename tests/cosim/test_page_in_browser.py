"""The impact in headless Chromium, from a file, without network: the bits of native FMUs."""

import pytest

import rockshed
from tests.browser import chromium, wait_for

pytestmark = [pytest.mark.browser, pytest.mark.slow]

DONE = "document.documentElement.dataset.done === 'yes'"
ENDED = "document.documentElement.dataset.done !== 'no'"
PICTURED = "document.documentElement.dataset.ready === 'yes'"


@pytest.fixture(scope="module")
def browser():
    with chromium() as driver:
        yield driver


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    pytest.importorskip("ziglang")
    return rockshed.page("lab-impact", tmp_path_factory.mktemp("page") / "impact.html")


@pytest.fixture(scope="module")
def native():
    run = rockshed.simulate(rockshed.case("lab-impact", runtime="native"))
    return run.metrics["peak_transmitted_force"].value


def opened(browser, file, code=""):
    browser.get("about:blank")
    browser.get(file.as_uri() + (f"#code={code}" if code else ""))
    wait_for(browser, PICTURED)


def move(browser, **sliders):
    """Move sliders one after the other, as a hand does."""
    script = """const control = document.getElementById(arguments[0]);
        control.value = arguments[1];
        control.dispatchEvent(new Event("input"));
        control.dispatchEvent(new Event("change"));"""
    for name, value in sliders.items():
        browser.execute_script(script, name, value)
    wait_for(browser, ENDED)


def peaks(browser):
    return browser.execute_script("return window.peaks")


@pytest.mark.parametrize("code", ["", "simd", "plain"])
def test_the_page_has_the_peak_force_of_native_fmus_to_the_bit(browser, file, native, code):
    opened(browser, file, code)
    wait_for(browser, DONE)
    assert peaks(browser)["transmitted"] == native
    assert browser.get_log("browser") == []
    assert browser.execute_script("return document.getElementById('trouble').hidden")


def test_sand_and_curves_are_drawn_in_the_colours_of_the_pictures(browser, file):
    opened(browser, file)
    wait_for(browser, DONE)
    browser.execute_script(
        "const i = document.getElementById('instant'); i.value = 20; i.dispatchEvent(new Event('input'))"
    )
    colours = """const canvas = document.getElementById(arguments[0]);
        const pixels = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
        const found = new Set();
        for (let i = 0; i < pixels.length; i += 4) found.add([...pixels.slice(i, i + 3)].join());
        return [...found]"""
    assert {"244,236,220", "107,107,107"} <= set(browser.execute_script(colours, "sand"))
    assert {"31,90,148", "192,86,26"} <= set(browser.execute_script(colours, "forces"))
    assert "61,125,63" in browser.execute_script(colours, "deflection")


def test_a_moved_slider_computes_what_it_says_and_comes_back_to_the_bit(browser, file, native):
    opened(browser, file)
    move(browser, height=1, thickness=5)
    run = rockshed.simulate(
        rockshed.case(
            "lab-impact",
            in_process=True,
            sizes={"sand.discs": 740},
            values={"rock.velocity0.y": -8.0 * 2.0**0.5},
        )
    )
    assert peaks(browser)["transmitted"] == run.metrics["peak_transmitted_force"].value
    browser.execute_script("document.getElementById('reset').click()")
    wait_for(browser, DONE)
    assert peaks(browser)["transmitted"] == native
    assert browser.get_log("browser") == []


def test_what_is_out_of_date_is_not_waited_for(browser, file):
    opened(browser, file, "plain")
    script = """for (const value of [-1, 1, 2, 0.5]) {
        const control = document.getElementById("mass");
        control.value = value;
        control.dispatchEvent(new Event("change"));
    }"""
    browser.execute_script(script)
    wait_for(browser, DONE)
    move(browser, mass=0.5)
    assert 3966.0 < peaks(browser)["transmitted"] < 20_000.0
    assert browser.get_log("browser") == []


def test_an_unstable_sand_is_refused_in_words_and_the_next_one_computed(browser, file):
    opened(browser, file)
    move(browser, modulus=2)
    browser.execute_script(
        "document.getElementById('modulus').min = 0; document.getElementById('modulus').max = 12"
    )
    move(browser, modulus=12)
    words = browser.execute_script("return document.getElementById('trouble').textContent")
    assert "unstable" in words
    assert "sand" in words
    move(browser, modulus=0)
    assert browser.execute_script("return document.getElementById('trouble').hidden")


def test_a_small_window_needs_no_scrolling_sideways(browser, file):
    browser.set_window_size(500, 900)
    opened(browser, file)
    assert browser.execute_script("return document.documentElement.scrollWidth <= innerWidth")
    browser.set_window_size(1280, 1000)


def test_a_browser_without_webassembly_is_told_so_in_words(file):
    with chromium() as driver:
        without = {"source": "delete globalThis.WebAssembly"}
        driver.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", without)
        driver.get(file.as_uri())
        wait_for(driver, "!document.getElementById('trouble').hidden")
        words = driver.execute_script("return document.getElementById('trouble').textContent")
    assert "WebAssembly" in words


def test_a_browser_without_vectors_computes_the_same_bits_and_says_so(file, native):
    flags = "--no-enable-sse4-1 --no-enable-ssse3 --no-enable-avx"
    with chromium(f"js-flags={flags}") as driver:
        driver.get(file.as_uri())
        wait_for(driver, DONE)
        assert peaks(driver)["transmitted"] == native
        words = driver.execute_script("return document.getElementById('code').textContent")
        assert "without vectors" in words
        driver.get("about:blank")
        driver.get(file.as_uri() + "#code=simd")
        wait_for(driver, "!document.getElementById('trouble').hidden")
        words = driver.execute_script("return document.getElementById('trouble').textContent")
    assert "it can take plain" in words


def test_code_that_there_is_not_is_refused_in_words(browser, file):
    browser.get("about:blank")
    browser.get(file.as_uri() + "#code=fast")
    wait_for(browser, "!document.getElementById('trouble').hidden")
    words = browser.execute_script("return document.getElementById('trouble').textContent")
    assert 'the code "fast"' in words
    assert "plain, simd" in words
