"""Point clouds written by other libraries."""

from pathlib import Path

import laspy
import numpy as np
import trimesh
from pypcd4 import PointCloud


def save_cloud(path: Path, points: np.ndarray) -> Path:
    if path.suffix in (".las", ".laz"):
        header = laspy.LasHeader(point_format=0, version="1.2")
        header.scales, header.offsets = np.full(3, 1e-4), points.mean(axis=0)
        las = laspy.LasData(header)
        las.xyz = points
        las.write(path)
    elif path.suffix == ".ply":
        trimesh.PointCloud(points).export(path)
    else:
        local = (points - points.mean(axis=0)).astype(np.float32)
        PointCloud.from_xyz_points(local).save(path)
    return path
