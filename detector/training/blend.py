"""Blend of two weights files: `foreride detector blend BEFORE AFTER --share 0.3 --out FILE`.

AFTER was trained on from BEFORE, for instance on own photographs. Their weighted mean keeps most of what each
of them knows: Wortsman et al., Robust fine-tuning of zero-shot models, CVPR 2022, eq. 1 (WiSE-FT). The mean
of two networks that were not trained on from one another knows nothing.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

from foreride.detector.network.checkpoint import load_network, save_weights
from foreride.detector.network.models import Network
from foreride.detector.training.options import weights_file
from foreride.files.command_line import Parser, notify
from foreride.files.errors import InputError, shown
from foreride.files.reading.numbers import within
from foreride.files.writing.targets import check_files

MAX_SHIFT = 5.0


def blend(before: Path, after: Path, share: float, score_shift: float = 0.0) -> tuple[Network, dict]:
    """Network of weights (1 - share) · before + share · after; metadata with the calibration of `before`.

    score_shift: added to the class logits of all points. A negative one lowers all scores, so that a
    threshold can keep its meaning. Raises InputError for numbers out of range and for different models.
    """
    within("--share", share, 0.0, 1.0)
    within("--score-shift", score_shift, -MAX_SHIFT, MAX_SHIFT)
    (first, metadata), (second, later) = load_network(before), load_network(after)
    if first.layout != second.layout:
        raise InputError(
            f"{after}: must be of the same model as {before}, {shown(metadata.get('model'))}, "
            f"got {shown(later.get('model'))}"
        )
    mixed, other = first.state_dict(), second.state_dict()
    for name, value in mixed.items():
        if value.is_floating_point():
            value.lerp_(other[name].to(value), share)
            if name.startswith("head.label.") and name.endswith(".bias"):
                value += score_shift
    first.load_state_dict(mixed)
    stages = f"{metadata.get('stages')}; then {later.get('stages')}, blended in by a share of {share:g}"
    return first, metadata | {"passes": later.get("passes", 0), "stages": stages}


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line; exit code 0, or 2 on bad input."""
    args = _parser().parse_args(arguments)
    try:
        check_files(args.out, inputs=(args.before, args.after))
        network, metadata = blend(args.before, args.after, args.share, args.score_shift)
        save_weights(args.out, network, metadata)
    except InputError as error:
        notify(error)
        return 2
    print(f"{args.out}: {1 - args.share:g} of {args.before}, {args.share:g} of {args.after}")
    return 0


def _parser() -> argparse.ArgumentParser:
    p = Parser(prog="foreride detector blend", description=__doc__)
    p.add_argument("before", type=weights_file, help="weights to start from, or `shipped`")
    p.add_argument("after", type=weights_file, help="weights or checkpoint trained on from them")
    p.add_argument("--share", type=float, default=0.3, help="of the weights after, 0 to 1 (default 0.3)")
    p.add_argument("--score-shift", type=float, default=0.0, help="added to class logits (default 0)")
    p.add_argument("--out", type=Path, required=True, help="weights file to write")
    return p


if __name__ == "__main__":
    raise SystemExit(main())
