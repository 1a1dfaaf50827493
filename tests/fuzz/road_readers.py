"""Readers of roads, maps and YAML files, each with a small valid file."""

from collections.abc import Callable
from pathlib import Path

import numpy as np

from tests.fuzz.reader import Reader, copy_file, text_file

CSV = "x_m,left_m,right_m\n0.0,0.0,0.0\n0.5,0.01,0.02\n1.0,0.0,0.01\n1.5,0.0,0.0\n"
MAP = (
    "x_m,left_m,right_m,height_sigma_m,position_sigma_m,existence\n"
    "0.0,0.0,0.0,0.004,0.05,1\n0.5,0.01,0.02,0.004,0.05,1\n1.0,0.0,0.01,0.004,0.05,0.9\n"
)
CRG = """$CT
a hand-written road
$
$ROAD_CRG
reference_line_start_u = 0.0
reference_line_end_u = 1.0
reference_line_increment = 0.5
long_section_v_right = -1.0
long_section_v_left = 1.0
long_section_v_increment = 2.0
$
$KD_DEFINITION
#:LRFI
U:reference line u,m,0.0,0.5
D:long section 1,m
D:long section 2,m
$
$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$$
 0.0000000 0.0000000
 0.0100000-0.0200000
 0.0300000 0.0400000
"""


ERD = """ERDFILEV2.00
   2,     4,     -1,      1,      5,   0.500,     -1,
SHORTNAMLElev.  RElev.
UNITSNAMmm      mm
XUNITS  m
END
 0.0 0.0
 10.0 20.0
 0.0 10.0
 0.0 0.0
"""
TEXT = "section 1\n0.0 0.0 0.0\n0.5 0.01 0.02\n1.0 0.0 0.01\n"
XODR = """<OpenDRIVE><road name="r" length="3" id="1"><elevationProfile>
<elevation s="0" a="0" b="0.01" c="0" d="0"/></elevationProfile><lateralProfile>
<superelevation s="0" a="0.01" b="0" c="0" d="0"/></lateralProfile></road></OpenDRIVE>
"""


def _columns() -> dict[str, np.ndarray]:
    return {"x_m": np.arange(4.0), "left_m": np.zeros(4), "right_m": np.full(4, 0.01)}


def _matlab_5(folder: Path) -> Path:
    from scipy.io import savemat

    savemat(folder / "road.mat", _columns())
    return folder / "road.mat"


def _matlab_7(folder: Path) -> Path:
    import h5py

    with h5py.File(folder / "road.mat", "w") as file:
        for name, values in _columns().items():
            file[name] = values
    return folder / "road.mat"


def _parquet(folder: Path) -> Path:
    import pyarrow as pa
    import pyarrow.parquet as pq

    pq.write_table(pa.table(_columns()), folder / "road.parquet")
    return folder / "road.parquet"


def _cloud(ending: str) -> Callable[[Path], Path]:
    def place(folder: Path) -> Path:
        from tests.road.io.readers.clouds import save_cloud

        u, v = np.meshgrid(np.arange(0.0, 2.0, 0.05), np.arange(-0.5, 0.5, 0.1))
        points = np.stack([u.ravel(), v.ravel(), 0.01 * np.sin(u).ravel()], axis=1)
        return save_cloud(folder / f"road.{ending}", points)

    return place


def _road(path: Path) -> object:
    from foreride.road.io.surface_file import read_surface

    return read_surface(path)


def _map(path: Path) -> object:
    from foreride.preview.prior_drives.road_map import read

    return read(path)


RECIPE = "nodes: {kind: ssh, hosts: [node1, node2], workers: 8, port: 2222, wait_s: 30, username: me}\n"
STUDY = """
scenarios: [bump_8x40_30]
controllers: [passive]
seeds: [0, 1]
set: {vehicle.model: quarter}
vary: {speed_kmh: [20, 30]}
"""


def _scenario(path: Path) -> object:
    from foreride.scenarios.definition.loading import load

    return load(str(path))


def _vehicle(path: Path) -> object:
    from foreride.vehicle.load import load_vehicle

    return load_vehicle(path)


def _memory_file(folder: Path) -> Path:
    from foreride.preview.prior_drives.memory_file import (
        TEMPLATE_BY_NAME,
        Memory,
        Mounting,
        RememberedObject,
        RowBias,
        write,
    )

    mounting = Mounting(0.01, 0.02, 1e-4, 0.0, 1e-4)
    bump = RememberedObject(
        next(iter(TEMPLATE_BY_NAME)), 20.0, 0.1, 0.4, 0.1, 0.08, 0.02, -1.5, 1.5, 0.2, 0.9
    )
    rows = RowBias((1.0, -1.0), (0.5, 0.5), 0.0, (0.0, 0.0), (0.0, 0.0))
    write(folder / "memory.yaml", Memory(mounting, (bump,), rows))
    return folder / "memory.yaml"


def _memory(path: Path) -> object:
    from foreride.preview.prior_drives.memory_file import read

    return read(path)


def _recipe(path: Path) -> object:
    from foreride.scenarios.studies.recipes import read_recipe

    return read_recipe(str(path))


def _study(path: Path) -> object:
    from foreride.scenarios.studies.study import read

    return read(path)


def _settings(path: Path) -> object:
    from foreride.scenarios.commands.options import settings_overrides

    return settings_overrides(path)


ROAD_READERS: dict[str, Reader] = {
    "road.csv": Reader(text_file("road.csv", CSV), _road),
    "road.crg": Reader(text_file("road.crg", CRG), _road),
    "road.erd": Reader(text_file("road.erd", ERD), _road),
    "road.txt": Reader(text_file("road.txt", TEXT), _road),
    "road.xodr": Reader(text_file("road.xodr", XODR), _road),
    "road.mat": Reader(_matlab_5, _road, places=4),
    "road.mat 7.3": Reader(_matlab_7, _road, places=4),
    "road.parquet": Reader(_parquet, _road),
    "road.laz": Reader(_cloud("laz"), _road, places=4),
    "road.ply": Reader(_cloud("ply"), _road),
    "road.pcd": Reader(_cloud("pcd"), _road),
    "map.csv": Reader(text_file("map.csv", MAP), _map),
    "scenario": Reader(copy_file("scenario.yaml", "scenarios/library/bump_8x40_30.yaml"), _scenario),
    "vehicle": Reader(copy_file("vehicle.yaml", "vehicle/parameters/half_car.yaml"), _vehicle),
    "memory": Reader(_memory_file, _memory),
    "study": Reader(text_file("study.yaml", STUDY), _study),
    "cluster recipe": Reader(text_file("clusters.yaml", RECIPE), _recipe),
    "settings": Reader(text_file("settings.yaml", "mpc: {horizon_s: 0.8}\n"), _settings),
}
