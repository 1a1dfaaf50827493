"""The report in headless Chromium, at two widths and in two themes: what it shows, and the keyboard."""

import base64
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from foreride.scenarios.cases import cases
from foreride.scenarios.definition.loading import load
from foreride.scenarios.report import html
from foreride.scenarios.report.film import video
from foreride.scenarios.report.frames import with_frames
from foreride.scenarios.report.gather import ReportInput
from foreride.scenarios.report.palette import CONTROLLER_COLOURS, OTHER_COLOURS
from foreride.scenarios.runs.write import row
from foreride.scenarios.simulation.simulate import Run, simulate
from tests.scenarios.browser import Browser, browser, needs_chromium

pytestmark = needs_chromium
ROAD = ["vehicle.model=half", "road.length_m=16", "road.features.0.start_m=9", "camera.rate_hz=20"]
CONTROLLERS = ("skyhook", "mpc_preview", "passive", "add")
COLOURS = CONTROLLER_COLOURS | {"add": OTHER_COLOURS[0]}
THINNED = 12
VIEWS = [(width, dark) for width in (1440, 390) for dark in (False, True)]
CAMERA = """
const pen = CanvasRenderingContext2D.prototype, { clearRect, drawImage, strokeRect } = pen;
window.camera = {};
pen.clearRect = function (...given) {
  if (this.canvas.id === "camera") window.camera = { image: null, boxes: [] };
  return clearRect.apply(this, given);
};
pen.drawImage = function (picture, ...given) {
  if (this.canvas.id === "camera") camera.image = picture.src;
  return drawImage.call(this, picture, ...given);
};
pen.strokeRect = function (...given) {
  if (this.canvas.id === "camera") camera.boxes.push(given);
  return strokeRect.apply(this, given);
};
"""
OVERFLOWING = """[...document.querySelectorAll("body *")].filter((element) => {
  const box = element.getBoundingClientRect(), clipped = element.closest(".scroll, pre, .u-over");
  if (!box.width || (clipped && clipped !== element)) return false;
  const cut = !["SELECT", "OPTION", "PRE"].includes(element.tagName) && !element.classList.contains("scroll")
    && element.clientWidth && element.scrollWidth > element.clientWidth + 1;
  return box.left < -1 || box.right > innerWidth + 1 || cut;
}).map((element) => element.outerHTML.slice(0, 120))"""
SCROLLING = """[...document.querySelectorAll(".scroll")].map((box) => ({
  wide: box.scrollWidth > box.clientWidth + 1,
  told: box.classList.contains("wide") && box.tabIndex === 0
    && getComputedStyle(box.nextElementSibling).display !== "none",
}))"""
COLOURED = """(() => {
  const found = [], add = (name, ink) => found.push([name.replace(":", "").trim(), ink]);
  const names = [...document.querySelectorAll(".bars .name")];
  const ground = (at) => getComputedStyle(at).backgroundColor, find = (id) => document.getElementById(id);
  for (const name of names)
    add(name.textContent, ground(name.parentElement.querySelectorAll(".fill")[names.indexOf(name)]));
  for (const marker of document.querySelectorAll(".u-marker"))
    add(marker.nextSibling.textContent, ground(marker));
  for (const side of ["a", "b"])
    add(find("run-" + side).selectedOptions[0].label, ground(find("dot-" + side)));
  return found;
})()"""
INKS = """(selector) => {
  const inks = new Set();
  for (const canvas of document.querySelectorAll(selector)) {
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    for (let i = 0; i < data.length; i += 4)
      if (data[i + 3] === 255) inks.add((data[i] << 16) | (data[i + 1] << 8) | data[i + 2]);
  }
  return [...inks].map((ink) => "#" + ink.toString(16).padStart(6, "0"));
}"""


@pytest.fixture(scope="module")
def runs() -> list[Run]:
    scenarios = [load("hump_flat_30", ROAD)]
    return [with_frames(simulate(case)) for case in cases(scenarios, CONTROLLERS, ["oracle", "boxes"], [0])]


@pytest.fixture(scope="module")
def report(runs: list[Run], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Report of the runs, with fewer images than exposures."""
    path = tmp_path_factory.mktemp("report") / "report.html"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(html, "MAX_FRAMES", THINNED)
        path.write_text(html.page(ReportInput(tuple(runs), tuple(map(row, runs)))))
    return path


@pytest.fixture(scope="module")
def tab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    with browser(tmp_path_factory.mktemp("profile")) as opened:
        opened.call("Page.addScriptToEvaluateOnNewDocument", source=CAMERA)
        yield opened


def data_of(report: Path) -> dict[str, Any]:
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', report.read_text(), re.S)
    assert found
    return json.loads(found[1])["scenes"][0]


def rgb(colour: str) -> str:
    return f"rgb({', '.join(str(int(colour[at : at + 2], 16)) for at in (1, 3, 5))})"


def show(tab: Browser, report: Path, width: int = 1440, dark: bool = False) -> None:
    tab.show(report, width, 900, dark)
    tab.wait("'ready' in document.documentElement.dataset && camera.image")


def test_image_and_boxes_of_the_data_belong_to_one_exposure(runs: list[Run], report: Path) -> None:
    seeing = runs[CONTROLLERS.index("mpc_preview") + 1]
    looks = data_of(report)["runs"][2]["looks"]
    assert 4 < len(looks) <= THINNED < len(seeing.looks)
    by_time = {look.tick / 1000: look for look in seeing.looks}
    for shown in looks:
        look = by_time[shown["t"]]
        assert np.allclose(np.reshape(shown["boxes"], (-1, 4)), look.detections.boxes, atol=0.051)
        packed = np.frombuffer(base64.b64decode(shown["image"].partition(",")[2]), np.uint8)
        image = cv2.imdecode(packed, cv2.IMREAD_COLOR)[..., ::-1].astype(float)
        difference = {
            tick: np.abs(
                image - cv2.resize(other.image, image.shape[1::-1], interpolation=cv2.INTER_AREA)
            ).mean()
            for tick, other in by_time.items()
        }
        assert min(difference, key=difference.__getitem__) == shown["t"]


@pytest.mark.parametrize("width", [1440, 390])
def test_image_and_boxes_on_the_screen_belong_to_one_exposure(report: Path, tab: Browser, width: int) -> None:
    show(tab, report, width)
    scene = data_of(report)
    looks = {look["image"]: look for look in scene["runs"][2]["looks"]}
    count = 0
    for _ in range(12):
        tab.press("ArrowRight", shift=True)
        camera = tab.tell("camera")
        look = looks[camera["image"]]
        scale = tab.tell("document.getElementById('camera').clientWidth") / scene["image"][0]
        wanted = [[x0, y0, x1 - x0, y1 - y0] for x0, y0, x1, y1 in look["boxes"]]
        drawn, wanted = (np.reshape(boxes, (-1, 4)) for boxes in (camera["boxes"], wanted))
        assert drawn.shape == wanted.shape
        assert np.allclose(drawn, wanted * scale, atol=1e-6)
        assert look["t"] <= float(tab.tell("document.getElementById('clock').textContent").split()[0]) + 1e-6
        count += len(wanted)
    assert count


@pytest.mark.parametrize(("width", "dark"), VIEWS)
def test_nothing_overflows_and_the_picture_is_whole(
    report: Path, tab: Browser, tmp_path: Path, width: int, dark: bool
) -> None:
    show(tab, report, width, dark)
    assert tab.tell("errors") == []
    assert tab.tell(OVERFLOWING) == []
    assert tab.tell("document.documentElement.scrollWidth") <= width
    for box in tab.tell(SCROLLING):
        assert box["told"] == box["wide"]
        assert width == 390 or not box["wide"]
    tab.screenshot(tmp_path / "page.png")
    picture = cv2.imread(str(tmp_path / "page.png"))
    assert width - 20 < picture.shape[1] <= width  # less a scroll bar
    assert (np.median(picture) < 60) == dark
    assert len(np.unique(picture.reshape(-1, 3), axis=0)) > 1000


@pytest.mark.parametrize("dark", [False, True])
def test_every_controller_has_its_one_colour_in_every_chart(report: Path, tab: Browser, dark: bool) -> None:
    show(tab, report, 1440, dark)
    found = [(name, ink) for name, ink in tab.tell(COLOURED) if name.split(" ")[0] in COLOURS]
    assert len(found) == 5 + 5 + 3 * 2 + 2  # bars, spectrum, charts over time, pickers
    for name, ink in found:
        assert ink == rgb(COLOURS[name.split(" ")[0]]), name
    for place in ("#cars", "#charts canvas"):
        inks = tab.tell(f"({INKS})('{place}')")
        assert COLOURS["mpc_preview"] in inks, place
        assert not {COLOURS["skyhook"], COLOURS["add"]} & set(inks)
    assert {COLOURS[name] for name in CONTROLLERS} <= set(tab.tell(f"({INKS})('#spectrum canvas')"))


def test_controllers_stand_in_the_order_asked_for(report: Path, tab: Browser) -> None:
    show(tab, report)
    labels = ["skyhook", "mpc_preview (oracle)", "mpc_preview (boxes)", "passive", "add"]
    assert tab.tell("[...document.getElementById('run-b').options].map((option) => option.label)") == labels
    assert tab.tell("[...document.querySelectorAll('.bars .name')].map((name) => name.textContent)") == labels
    first = (
        "[...document.querySelector('.scroll table').tBodies[0].rows].map((row) => row.cells[0].textContent)"
    )
    assert tab.tell(first) == [label.split(" ")[0] for label in labels]


def test_it_opens_at_the_event_and_obeys_the_keyboard(report: Path, tab: Browser) -> None:
    show(tab, report)
    clock = "document.getElementById('clock').textContent"
    start = tab.tell(clock)
    assert start == f"{data_of(report)['start']:.2f} s"
    for key, told in (("Home", "0.00 s"), ("ArrowRight", "0.01 s"), ("ArrowLeft", "0.00 s"), ("e", start)):
        tab.press(key)
        assert tab.tell(clock) == told
    tab.press("End")
    assert float(tab.tell(clock).split()[0]) > 1.0
    speed = "document.getElementById('speed').value"
    slow = float(tab.tell(speed))
    tab.press("+")
    assert float(tab.tell(speed)) > slow
    tab.press("-")
    assert float(tab.tell(speed)) == slow
    tab.press("e")
    tab.press(" ")
    tab.wait(f"{clock} !== '{start}'")
    tab.press(" ")
    stopped = tab.tell(clock)
    tab.press("ArrowRight", shift=True)
    assert float(tab.tell(clock).split()[0]) == pytest.approx(float(stopped.split()[0]) + 0.1, abs=0.011)


def test_every_control_is_reached_by_the_tabulator(report: Path, tab: Browser) -> None:
    show(tab, report, 390)
    reached = []
    for _ in range(40):
        tab.press("Tab")
        reached.append(tab.tell("document.activeElement.id || document.activeElement.className"))
    replay = ["scene", "run-a", "run-b", "back", "play", "on", "scrub", "speed", "zoom"]
    assert reached[: len(replay)] == replay
    assert "scroll wide" in reached


def test_scrubbing_leaves_the_charts_crisp_and_shows_no_negative_zero(report: Path, tab: Browser) -> None:
    show(tab, report)
    pictures = "[...document.querySelectorAll('#charts canvas')].map((canvas) => canvas.toDataURL())"
    before = tab.tell(pictures)
    tab.press("Home")
    for _ in range(15):
        tab.press("ArrowRight", shift=True)
        assert not re.search(r"-0\.?0*(?![\d.])", tab.tell("document.querySelector('main').innerText"))
    assert tab.tell(pictures) == before
    assert tab.tell("[...document.querySelectorAll('.now')].filter((line) => !line.hidden).length") == 3


def test_charts_have_titles_with_units(report: Path, tab: Browser) -> None:
    show(tab, report)
    titles = tab.tell("[...document.querySelectorAll('#charts h3, #spectrum h3')].map((h) => h.textContent)")
    assert titles == [
        "acceleration at the front seat (m/s²)",
        "front damping (kN·s/m)",
        "front damper force (kN)",
        "acceleration at the front seat: power spectral density ((m/s²)²/Hz)",
    ]


def test_a_drive_without_a_camera_has_no_place_for_its_images(
    runs: list[Run], tab: Browser, tmp_path: Path
) -> None:
    blind = [run for run in runs if not run.looks]
    path = tmp_path / "blind.html"
    path.write_text(html.page(ReportInput(tuple(blind), tuple(map(row, blind)))))
    for width in (1440, 390):
        tab.show(path, width)
        tab.wait("'ready' in document.documentElement.dataset")
        assert tab.tell("document.getElementById('camera').getBoundingClientRect().width") == 0
        assert tab.tell(OVERFLOWING) == []


@pytest.mark.parametrize("suffix", video.CODECS)
def test_the_film_plays_for_a_second(
    suffix: str, runs: list[Run], tab: Browser, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(video, "event_window", lambda run, **given: (700, 1100))  # ticks: 1.2 s of film
    passive, seeing = runs[CONTROLLERS.index("passive") + 1], runs[CONTROLLERS.index("mpc_preview") + 1]
    video.write_video(tmp_path / f"film{suffix}", [(passive, seeing)])
    page = tmp_path / "film.html"
    page.write_text(f"<!doctype html><body><video src='film{suffix}' muted autoplay></video>")
    tab.show(page)
    film = "document.querySelector('video')"
    tab.wait(f"{film}.error || {film}.currentTime >= 1")
    assert tab.tell(f"{film}.error && {film}.error.message") is None
    assert tab.tell(f"[{film}.videoWidth, {film}.videoHeight]") == list(video.FILM_SIZE)
    tab.screenshot(tmp_path / "playing.png", whole=False)
    playing = cv2.imread(str(tmp_path / "playing.png")).astype(int)
    blue = np.array([int(COLOURS["mpc_preview"][at : at + 2], 16) for at in (5, 3, 1)])
    assert (np.abs(playing - blue).max(axis=-1) < 12).sum() > 2000  # the car
