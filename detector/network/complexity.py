"""Model complexity: parameters and operations, compared with the paper: `foreride detector models`."""

import json
from collections.abc import Sequence

import torch
from torch.utils.flop_counter import FlopCounterMode

from foreride.detector.network.blocks import VoVGSCSPC
from foreride.detector.network.models import MODELS, Network, build
from foreride.files.command_line import Parser, notify, output_path
from foreride.files.errors import InputError
from foreride.files.writing.atomic import write_text
from foreride.files.writing.targets import check_files

PAPER_COMPLEXITY = {
    "yolo11n": (2.58, 6.3),
    "+p2": (2.67, 10.3),
    "+ledh": (2.37, 6.7),
    "+ghost": (2.09, 6.2),
    "+vovgscspc": (2.04, 5.8),
    "sbp-yolo": (2.04, 5.8),
    "sbp-yolo-s": (7.42, 20.6),
}
"""Parameters in millions and GFLOPs at 640 x 640 (arXiv 2508.01339, Table 1 and Table 3)."""


def parameters(model: Network) -> int:
    """Number of learned parameters."""
    return sum(p.numel() for p in model.parameters())


def dead_parameters(model: Network) -> int:
    """Parameters that only the paper's released code has: a 3×3 convolution with norm that is never executed.

    Every VoVGSCSPC block there holds one of half its channels.
    """
    halves = [m.direct.conv.out_channels for m in model.modules() if isinstance(m, VoVGSCSPC)]
    return sum(9 * c * c + 2 * c for c in halves)


def gflops(model: Network, size: int = 640) -> float:
    """Multiplications and additions of all convolutions and attention, boxes at every point, in 1e9."""
    model = model.eval()
    with torch.inference_mode(), FlopCounterMode(display=False) as counter:
        model(torch.zeros(1, 3, size, size)).all_box_logits()
    return counter.get_total_flops() / 1e9


def table(size: int = 640) -> list[dict]:
    """Complexity of every model by name."""
    rows = []
    for name in MODELS:
        model = build(name)
        count = parameters(model)
        rows.append(
            {
                "model": name,
                "parameters": count,
                "parameters_with_dead": count + dead_parameters(model),
                "paper_parameters": round(PAPER_COMPLEXITY[name][0] * 1e6),
                "gflops": round(gflops(model, size), 3),
                "paper_gflops": PAPER_COMPLEXITY[name][1],
            }
        )
    return rows


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line; exit code 0, or 2 on bad input."""
    p = Parser(prog="foreride detector models", description=__doc__)
    p.add_argument("--json", type=output_path, help="write the numbers here")
    args = p.parse_args(arguments)
    try:
        check_files(args.json)
    except InputError as error:
        notify(error)
        return 2
    rows = table()
    print(f"{'model':12} parameters M: ours, with the released code's dead ones, paper;  GFLOPs: ours, paper")
    for row in rows:
        millions = (row[k] / 1e6 for k in ("parameters", "parameters_with_dead", "paper_parameters"))
        numbers = "  ".join(f"{m:6.3f}" for m in millions)
        print(f"{row['model']:12} {numbers}   {row['gflops']:6.2f}  {row['paper_gflops']:5.1f}")
    if args.json:
        write_text(args.json, json.dumps(rows, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
