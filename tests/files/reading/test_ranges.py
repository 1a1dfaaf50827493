from dataclasses import dataclass, field
from typing import Annotated, Any

import numpy as np
import pytest
from annotated_types import Interval

from foreride.files.errors import InputError
from foreride.files.reading.ranges import Checked, Number, Share, numbers_in
from foreride.files.reading.strict import structure

Mass = Annotated[float, Interval(ge=1.0, le=50.0), "kg"]


@dataclass(frozen=True)
class Wheel(Checked):
    mass_kg: Mass
    share: Share = 0.0
    chance: Annotated[float, Interval(gt=0.0, lt=1.0), "1"] = 0.5
    bolts: Annotated[int, Interval(ge=1, le=8), "bolts"] = 4
    pair: tuple[Mass, Mass] = (1.0, 2.0)
    row: tuple[Mass, ...] = ()
    spare: Mass | None = None
    named: dict[str, Mass] = field(default_factory=dict)
    name: str = "x"


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"mass_kg": 0.0}, "mass_kg must lie in 1 ... 50 kg, got 0.0"),
        ({"mass_kg": 1e300}, "mass_kg must lie in 1 ... 50 kg, got 1e+300"),
        ({"mass_kg": float("nan")}, "mass_kg must lie in 1 ... 50 kg, got nan"),
        ({"mass_kg": float("-inf")}, "mass_kg must lie in 1 ... 50 kg, got -inf"),
        ({"mass_kg": 10**400}, "mass_kg must lie in 1 ... 50 kg, got a whole number of about 400 digits"),
        ({"mass_kg": True}, "mass_kg must be a number, and lie in 1 ... 50 kg, got True"),
        ({"mass_kg": None}, "mass_kg must be a number, and lie in 1 ... 50 kg, got nothing"),
        ({"share": 1e-300}, "share must lie in 0 ... 1, and be 0 or at least 1e-15, got 1e-300"),
        ({"chance": 0.0}, "chance must be > 0 and < 1, got 0.0"),
        ({"chance": 1.0}, "chance must be > 0 and < 1, got 1.0"),
        ({"bolts": 9}, "bolts must lie in 1 ... 8 bolts, got 9"),
        ({"bolts": 4.0}, "bolts must be a whole number, and lie in 1 ... 8 bolts, got 4.0"),
        ({"pair": (1.0, 0.5)}, "pair[1] must lie in 1 ... 50 kg, got 0.5"),
        ({"pair": (1.0,)}, "pair must hold 2 values, got 1"),
        ({"row": (1.0, 2.0, 99.0)}, "row[2] must lie in 1 ... 50 kg, got 99.0"),
        ({"spare": 51.0}, "spare must lie in 1 ... 50 kg, got 51.0"),
        ({"named": {"a": 0.0}}, "named.a must lie in 1 ... 50 kg, got 0.0"),
    ],
)
def test_what_lies_outside_is_refused_in_code(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError) as caught:
        Wheel(**{"mass_kg": 10.0} | changes)
    assert str(caught.value) == message


def test_what_lies_outside_is_refused_in_files() -> None:
    with pytest.raises(InputError, match=r"^s: pair\[1\] must lie in 1 \.\.\. 50 kg, got 99"):
        structure(Wheel, {"mass_kg": 2, "pair": [3, 99]}, "s")


def test_what_lies_inside_passes() -> None:
    assert structure(Wheel, {"mass_kg": 1, "spare": None, "row": [50]}, "s") == Wheel(1.0, row=(50.0,))
    assert Wheel(np.float32(2.0), bolts=np.int64(3)).bolts == 3  # type: ignore[arg-type]


def test_ranges_are_told_with_their_units() -> None:
    found = list(numbers_in(tuple[Mass, Share] | None))
    assert [number.text() for number in found] == ["1 ... 50 kg", "0 ... 1"]
    assert Number(False, Interval(gt=0.0, le=2.0), "m").text() == "> 0 and <= 2 m"
