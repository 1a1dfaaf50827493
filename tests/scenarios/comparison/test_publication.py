"""Tests of tables for publications: chosen columns, captions and notes."""

import re

import pytest

from foreride.comfort import METRICS
from foreride.files.errors import InputError
from foreride.scenarios.cases import Case, cases
from foreride.scenarios.comparison.columns import check_keys, columns_of, default_keys
from foreride.scenarios.comparison.publication import caption, cells, latex, markdown
from foreride.scenarios.comparison.statistics import summarise
from foreride.scenarios.definition.loading import load


def row(controller: str, perception: str, seed: int, noise: float = 0.0) -> dict:
    metrics = {name: (1.0 + noise * seed) / (1 + len(controller)) for name in METRICS.own}
    return {
        "scenario": "hump_flat_30", "vehicle": "half", "controller": controller, "perception": perception,
        "seed": seed, "metrics": metrics, "solver": {"fallbacks": 2 * seed},
    }  # fmt: skip


ROWS = [
    *(row("passive", "none", seed) for seed in range(3)),
    *(row("mpc_preview", "camera", seed, 0.1) for seed in range(3)),
]
VARIANTS = summarise(ROWS, "passive")


def selected(**overrides: object) -> list[Case]:
    scenario = load("hump_flat_30", overrides)
    return cases([scenario], ["passive", "mpc_preview"], ["camera"], [0, 1, 2, 5])


def test_columns_are_those_chosen_in_their_order() -> None:
    heads, rows = cells(VARIANTS, "passive", ["seeds", "vdv", "J", "wk_rms/baseline", "fallbacks"])
    assert heads == [
        "scenario", "controller", "preview", "seeds", "VDV (m/s^1.75)", "J / passive", "Wk RMS / passive",
        "fallbacks",
    ]  # fmt: skip
    assert rows[1][:4] == ["hump_flat_30", "mpc_preview", "camera", "3"]
    assert rows[1][-1] == "6"
    ratio = 1.1 * 8 / 12
    assert rows[1][6].startswith(f"{ratio:.3f} [")


def test_every_metric_can_be_a_column() -> None:
    keys = [key for name in METRICS.own for key in (name, f"{name}/baseline")]
    check_keys(keys)
    assert all(cell != "-" for cell in cells(VARIANTS, "passive", keys)[1][1])
    assert default_keys(VARIANTS)[0] == "J"
    assert columns_of(VARIANTS, None, ["J"])[0].head == "J ((m/s²)²)"


@pytest.mark.parametrize("key", ["wk_rm", "seeds/baseline", "", "wk_rms/passive"])
def test_an_unknown_column_is_refused_with_what_is_allowed(key: str) -> None:
    with pytest.raises(InputError, match=r"--columns must be J, captured, seeds, fallbacks, or a metric"):
        check_keys([key])


def test_the_caption_tells_the_conditions_and_the_brackets() -> None:
    text = caption(selected(), "passive")
    for part in (
        "half car (half)", "Kalman observer", "camera (camera and detector)", "seeds 0–2, 5",
        "In brackets: 95 % bootstrap", "to passive with the same seed",
    ):  # fmt: skip
        assert part in text
    true = caption(selected(observer="truth")[:1])
    assert "true state" in true
    assert "Seed 0." in true
    assert "brackets" not in true
    assert "Preview" not in true


def test_a_value_that_no_seed_changes_is_marked_and_explained() -> None:
    for table in (markdown(VARIANTS, "passive", ["wk_rms"]), latex(VARIANTS, "passive", ["wk_rms"])):
        assert table.count("[=]") == 2  # in the row of the passive car and in the note
        assert "every seed gives the same value" in table
    alone = summarise(ROWS[3:])
    assert "[=]" not in markdown(alone, None, ["wk_rms"])


def test_latex_raises_exponents_and_is_a_float_with_a_caption() -> None:
    table = latex(VARIANTS, "passive", ["vdv", "wk_rms"], caption(selected()))
    assert "m/s$^{1.75}$" in table
    assert "m/s$^2$" in table
    assert re.search(r"\\begin\{table\}\n\\centering\n\\caption\{Vehicle: half car \(half\)\.", table)
    assert table.count(r"\toprule") == table.count(r"\bottomrule") == 1
    assert r"95 \% bootstrap" in table


def test_markdown_stands_under_its_caption() -> None:
    lines = markdown(VARIANTS, "passive", ["J"], "Vehicle: a | b.").splitlines()
    assert lines[0] == "Vehicle: a \\| b."
    assert lines[1] == ""
    assert lines[2] == "| scenario | controller | preview | J / passive |"
