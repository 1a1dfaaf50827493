"""Documents of a comparison: schema 1 of the JSON file, and flat rows for Parquet."""

import io
import json
from collections.abc import Mapping, Sequence
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from foreride.scenarios.comparison.statistics import Row, Variant


def document(
    rows: Sequence[Row], variants: Sequence[Variant], baseline: str | None, manifest: Mapping[str, Any]
) -> dict[str, Any]:
    """Comparison as a JSON document of schema 1: manifest (versions and platform), rows and summary."""
    summary = [variant.plain() for variant in variants]
    return {
        "schema": 1, "manifest": manifest, "rows": list(rows), "baseline": baseline, "summary": summary,
    }  # fmt: skip


def parquet(rows: Sequence[Row]) -> bytes:
    """Rows as a Parquet file: metrics under their own names, the rest under dotted ones."""
    sink = io.BytesIO()
    pq.write_table(pa.Table.from_pylist([flat(row) for row in rows]), sink, compression="zstd")
    return sink.getvalue()


def flat(row: Row) -> dict[str, Any]:
    """Row without nesting: metrics under their own names, deeper mappings as JSON text."""
    line: dict[str, Any] = {}
    for name, value in row.items():
        if not isinstance(value, dict):
            line[name] = value
            continue
        prefix = "" if name == "metrics" else f"{name}."
        for inner, part in value.items():
            line[prefix + inner] = json.dumps(part, sort_keys=True) if isinstance(part, dict | list) else part
    return line
