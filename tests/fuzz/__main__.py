"""Damaged files to every reader, for as long as asked: `python -m tests.fuzz --minutes 60 --out DIR`."""

import argparse
import hashlib
import json
import sys
from pathlib import Path

from tests.fuzz.campaign import Tally, campaign, valid_inputs
from tests.fuzz.minimise import minimised
from tests.fuzz.mutations import mutation
from tests.fuzz.trial import ALL


def main() -> int:
    """Fuzz, write what was found as small files, print figures; 1 where anything was found."""
    arguments = _arguments()
    names = arguments.readers.split(",") if arguments.readers else list(ALL)
    valid = valid_inputs(names)
    tally = campaign(arguments.seed, valid, 60 * arguments.minutes, arguments.jobs, arguments.inputs)
    _write(arguments.out, arguments.seed, valid, tally)
    width = max(map(len, names))
    for name, count in tally.inputs.items():
        found = [key[1] for key in tally.found if key[0] == name]
        print(f"{name:{width}} {count:9} inputs  {', '.join(sorted(found))}")
    print(f"{sum(tally.inputs.values())} inputs, {len(tally.found)} findings, {tally.restarts} restarts")
    return int(bool(tally.found))


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__)
    parser.add_argument("--minutes", type=float, default=2.0)
    parser.add_argument("--inputs", type=int, default=2**60, help="for each reader (default: no limit)")
    parser.add_argument("--seed", type=int, default=0, help="the same seed tries the same inputs")
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    parser.add_argument("--readers", metavar="A,B,...", help=f"default: all of {', '.join(ALL)}")
    parser.add_argument("--out", type=Path, required=True, help="folder for findings.jsonl and the inputs")
    return parser.parse_args()


def _write(out: Path, seed: int, valid: dict[str, bytes], tally: Tally) -> None:
    """Each finding as a line of findings.jsonl and its input, minimised, as a file."""
    out.mkdir(parents=True, exist_ok=True)
    with (out / "findings.jsonl").open("w") as lines:
        for key, (finding, index) in tally.found.items():
            data = mutation(seed, finding.reader, index, valid[finding.reader], list(valid.values()))
            small = minimised(finding, data)
            name = f"{finding.reader}-{finding.kind}-{hashlib.sha256(repr(key).encode()).hexdigest()[:8]}"
            (out / name.replace(" ", "_").replace("'", "")).write_bytes(small)
            told = {"index": index, "times": tally.times[key], "bytes": len(small), "file": name}
            lines.write(json.dumps(vars(finding) | told) + "\n")
            lines.flush()


if __name__ == "__main__":
    sys.exit(main())
