"""Tests that no text of a scenario, run or budget can end an element of the report or start a script."""

import io
import json
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import pytest
from rich.console import Console

from foreride.files.errors import printable
from foreride.scenarios.cases import Case
from foreride.scenarios.comparison.publication import latex, markdown
from foreride.scenarios.comparison.statistics import summarise
from foreride.scenarios.comparison.table import comparison
from foreride.scenarios.definition.loading import load
from foreride.scenarios.report.figures.drive import drive_figure
from foreride.scenarios.report.figures.files import save
from foreride.scenarios.report.gather import ReportInput
from foreride.scenarios.report.html import page
from foreride.scenarios.runs.write import row
from foreride.scenarios.simulation.simulate import Run, simulate
from tests.scenarios.browser import browser, needs_chromium

HOSTILE = (
    "<!--<script>",
    "<!--",
    "-->",
    "</script>",
    "</ScRiPt ><script>document.title='owned'</script>",
    "</title><script>window.owned=1</script>",
    "<img src=x onerror=window.owned=1>",
    "]]>",
    "<![CDATA[",
    "line\u2028and\u2029paragraph",
    "\"quotes' and `ticks` ${window.owned=1}",
    "back\\slash \\u003c \\",
    "lone \ud800 and \udfff surrogates",
    "nul \x00 and escape \x1b[31m",
    "&lt;b&gt; &amp; &#60;",
    "{{data}} {{script}}",
    "[/red] [link=x] $\\frac{1$ | ~^_#%",
)
TOLD = """({
  errors, tame: window.owned === undefined, ready: "ready" in document.documentElement.dataset,
  titles: [...document.getElementById("scene").options].map((option) => option.label),
  scripts: document.scripts.length, images: document.images.length,
})"""


@pytest.fixture(scope="module")
def drive() -> Run:
    short = ["vehicle.model=quarter", "road.length_m=14", "road.features.0.start_m=8"]
    return simulate(Case(load("hump_flat_30", short), "passive", "none", 0))


def spoilt(run: Run, text: str) -> Run:
    """Run with the text in every place where a run holds user text."""
    vehicle = replace(run.case.scenario.vehicle, model=text)
    scenario = replace(run.case.scenario, title=text, vehicle=vehicle)
    object.__setattr__(scenario, "name", text)  # refused by the schema, which the report must not rely on
    counts = {"solves": text, "fallbacks": text, "reasons": {text: 3}, "active": {text: 1}}
    return replace(
        run,
        case=Case(scenario, f"own.py:{text}", "none", 0),
        solver=counts,
        perception_stats={"frames": text, "boxes": text},
        events=[{"time_s": 0.5, "event": "fallback", "reason": text}],
    )


def rows_of(runs: list[Run]) -> list[dict]:
    return [row(run) | {"solver": {"fallbacks": 0}} for run in runs]


def hostile_page(run: Run) -> str:
    runs = [spoilt(run, text) for text in HOSTILE]
    return page(ReportInput(tuple(runs), tuple(rows_of(runs)), HOSTILE))


class Tokens(HTMLParser):
    """Names of all elements, and the displayed text."""

    def __init__(self) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.shown: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        assert not {name for name, _ in attrs} & {"onerror", "onclick", "onload"}

    def handle_data(self, data: str) -> None:
        self.shown.append(data)


def test_embedded_data_hold_nothing_that_the_html_parser_looks_for(drive: Run) -> None:
    whole = hostile_page(drive)
    (raw,) = re.findall(r'<script type="application/json" id="data">(.*?)</script>', whole, re.S)
    assert raw.isascii()
    assert not set(raw) & set("<>&")
    data = json.loads(raw)
    assert [scene["title"] for scene in data["scenes"]] == [printable(text) for text in HOSTILE]
    json.dumps(data, ensure_ascii=False).encode()  # no lone surrogates


def test_texts_of_the_page_make_no_elements(drive: Run) -> None:
    tame, hostile = Tokens(), Tokens()
    runs = [spoilt(drive, f"harmless {index}") for index in range(len(HOSTILE))]
    tame.feed(
        page(ReportInput(tuple(runs), tuple(rows_of(runs)), tuple(f"text {i}" for i in range(len(runs)))))
    )
    whole = hostile_page(drive)
    whole.encode()  # no lone surrogates
    hostile.feed(whole)
    assert hostile.tags == tame.tags
    shown = "".join(hostile.shown)
    assert all(text in shown for text in HOSTILE if text.isprintable())


@needs_chromium
def test_a_browser_shows_the_texts_and_plays_the_drives(drive: Run, tmp_path: Path) -> None:
    (tmp_path / "page.html").write_text(hostile_page(drive))
    with browser(tmp_path / "profile") as tab:
        tab.show(tmp_path / "page.html")
        told = tab.tell(TOLD)
    assert told["errors"] == []
    assert told["ready"]
    assert told["tame"]
    assert told["scripts"] == 3  # data, uPlot and the report's own
    assert told["images"] == 0
    for text, title in zip(HOSTILE, told["titles"], strict=True):
        assert title.startswith(printable(text))


def test_terminal_markdown_latex_and_figures_take_any_text(drive: Run, tmp_path: Path) -> None:
    runs = [spoilt(drive, text) for text in HOSTILE]
    variants = summarise(rows_of(runs), None)
    terminal = Console(file=io.StringIO(), width=200, markup=False, emoji=False)
    terminal.print(comparison(variants, HOSTILE[-1], 200, None))
    assert "[/red] [link=x]" in terminal.file.getvalue()  # type: ignore[attr-defined]
    table = markdown(variants)
    assert {len(re.findall(r"(?<!\\)\|", line)) for line in table.splitlines()} == {
        table.split("\n")[0].count("|")
    }
    assert latex(variants).count(r" \\" + "\n") == len(HOSTILE) + 1
    for text in HOSTILE:
        save(drive_figure([spoilt(drive, text)]), tmp_path / "figure.png")
