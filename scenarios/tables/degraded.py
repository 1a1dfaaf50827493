"""Cost of preview errors: `mpc_preview` with an erroneous oracle against `mpc_reactive`.

`foreride table degraded`, on the reporting set. The oracle states the size of its errors, like a
perception with consistent uncertainty: a position sigma equal to the bias, a height sigma equal to the height
error.
"""

from collections.abc import Mapping, Sequence

from foreride.files.writing.targets import check_files
from foreride.scenarios.definition.sets import load_all
from foreride.scenarios.tables.options import parse_words, selected_overrides, shared_parser, whole_numbers
from foreride.scenarios.tables.runs import Variant, mean_over_events, metric, run_all, shown, write

SIGMA_M = 0.05
"""Stated position sigma for errors other than position, m."""
LIMIT, LIMIT_FALSE = 1.02, 1.05


def errors() -> dict[str, Mapping[str, float]]:
    """Oracle errors of each line."""
    lines: dict[str, Mapping[str, float]] = {"true": {}}
    for bias in (0.1, -0.1, 0.2, -0.2, 0.5, -0.5):
        lines[f"bias {bias:+g} m"] = {"bias_m": bias, "position_sigma_m": abs(bias)}
    for gain in (1.3, 0.7):
        lines[f"height {gain - 1:+.0%}"] = {"height_gain": gain, "height_sigma": 0.3}
    for latency in (0.05, 0.1, 0.15):
        lines[f"latency {1e3 * latency:.0f} ms"] = {"latency_s": latency}
    lines["20 % missed"] = {"miss_probability": 0.2}
    lines["1 false per 100 m"] = {"false_per_100m": 1.0, "existence": 0.7}
    return {name: {"position_sigma_m": SIGMA_M, **line} if line else line for name, line in lines.items()}


def main(arguments: Sequence[str] | None = None) -> None:
    """Simulate, print the table, and write JSON if requested. Raises InputError."""
    parser = shared_parser("degraded", "mpc_preview with preview errors", seeds="0")
    parser.add_argument("--lines", help="names of the lines, separated by commas (default all)")
    asked = parser.parse_args(arguments)
    check_files(asked.json)
    plain = load_all(asked.events, selected_overrides(asked))
    variants = [Variant("mpc_reactive", "mpc_reactive", "none", plain)]
    lines = errors()
    wanted = parse_words("--lines", asked.lines, list(lines)) if asked.lines else list(lines)
    for name, line in lines.items():
        if name in wanted:
            degraded = load_all(asked.events, selected_overrides(asked, {"oracle": line}))
            variants.append(Variant(name, "mpc_preview", "oracle", degraded))
    done = run_all(variants, whole_numbers("--seeds", asked.seeds), asked.read)
    reactive = metric(done["mpc_reactive"], "objective")
    print(f"\n{asked.vehicle} car, {reactive.shape[1]} events, seeds {asked.seeds}\n")
    print("| preview | J / mpc_reactive | worst event | at most |\n|---|---|---|---|")
    for name in list(done)[1:]:
        ratio = metric(done[name], "objective") / reactive
        worst = ratio.mean(axis=0)
        limit = LIMIT_FALSE if "false" in name else LIMIT
        where = variants[0].scenarios[int(worst.argmax())].name
        mean = mean_over_events(ratio)
        verdict = "" if mean.mean <= limit else " **over**"
        print(f"| {name} | {shown(mean)}{verdict} | {worst.max():.3f} ({where}) | {limit:.2f} |")
    write(asked.json, done)
