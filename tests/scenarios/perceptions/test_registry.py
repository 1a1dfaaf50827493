"""Tests of the registry of perceptions: one entry reaches drive, file checks and hashes, and command line."""

import hashlib
from collections.abc import Iterator
from pathlib import Path

import pytest

from foreride.files.errors import InputError
from foreride.preview.road_preview import RoadPreview, oracle_preview
from foreride.scenarios.cases import Case
from foreride.scenarios.definition.loading import load
from foreride.scenarios.perceptions.interface import Drive, Perception, ReferencedFile
from foreride.scenarios.perceptions.registry import PERCEPTIONS, PerceptionEntry, perception_entry
from foreride.scenarios.simulation.referenced_files import check_case_files, hashes
from foreride.scenarios.simulation.simulate import simulate
from foreride.vehicle.state import VehicleState

SHORT = ["vehicle.model=quarter", "road.length_m=22", "road.features.0.start_m=10", "observer=truth"]


class TrueRoad(Perception):
    """The true road, as the oracle gives it, in a few lines."""

    def __init__(self, drive: Drive) -> None:
        super().__init__()
        self._drive = drive

    def preview(self, time_s: float, state: VehicleState) -> RoadPreview:
        return oracle_preview(self._drive.profiles, [float(state.x_m)], time_s)


@pytest.mark.parametrize("name", PERCEPTIONS.own)
def test_every_entry_has_a_label_and_distinct_hashes(name: str) -> None:
    entry = perception_entry(name)
    assert entry.label
    assert len({file.hash_name for file in entry.files}) == len(entry.files)


def test_unknown_names_are_refused_by_name() -> None:
    with pytest.raises(InputError, match=r"^perception must be one of none, oracle, .*, got 'radar'$"):
        Case(load("bump_8x40_30"), "passive", "radar", 0)


@pytest.fixture(autouse=True)
def _restored() -> Iterator[None]:
    yield
    PERCEPTIONS.unregister("lidar")


def test_one_entry_reaches_the_drive() -> None:
    PERCEPTIONS.register("lidar", PerceptionEntry(TrueRoad, "lidar"))
    scenario = load("bump_8x40_30", SHORT)
    lidar, oracle, blind = (
        simulate(Case(scenario, "mpc_preview", name, 0)).metrics["objective"]
        for name in ("lidar", "oracle", "none")
    )
    assert lidar == pytest.approx(
        oracle, rel=1e-3
    )  # the oracle is relative to the plane, which is level here
    assert abs(lidar - blind) > 5.0 * abs(lidar - oracle)


def test_one_entry_reaches_the_checks_and_hashes_of_files(tmp_path: Path) -> None:
    file = tmp_path / "scan.bin"

    def check(scenario: object) -> None:
        if not file.exists():
            raise InputError(f"{file} must exist")

    scan = ReferencedFile("scan_sha256", lambda scenario: file, check)
    PERCEPTIONS.register("lidar", PerceptionEntry(TrueRoad, "lidar", files=(scan,)))
    case = Case(load("bump_8x40_30", SHORT), "mpc_preview", "lidar", 0)
    with pytest.raises(InputError, match=r"scan\.bin must exist"):
        check_case_files(case)
    file.write_bytes(b"scan")
    check_case_files(case)
    assert hashes(case)["scan_sha256"] == hashlib.sha256(b"scan").hexdigest()
    assert hashes(case)["map_sha256"] is None
