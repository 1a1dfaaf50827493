"""Caches where the home, the installation or both cannot be written."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import foreride.files.compiled as compiled
from foreride.files.cache import cache_folder, cached, temporary_folder, writable

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ("comfort", "controller", "detector", "files", "preview", "road", "scenarios", "vehicle")


@pytest.fixture(autouse=True)
def fresh(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    temporary_folder.cache_clear()
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "temporary"))
    (tmp_path / "temporary").mkdir()
    for name in ("FORERIDE_CACHE", "XDG_CACHE_HOME", "NUMBA_CACHE_DIR", "MPLCONFIGDIR"):
        monkeypatch.setenv(name, "")
        monkeypatch.delenv(name)


def test_a_home_that_cannot_be_written_is_replaced_and_that_is_said_once(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("FORERIDE_CACHE", "/dev/null/cache")
    place = cached("bounds/a.npz")
    assert place.parent.parent == temporary_folder()
    assert cached("bounds/b.npz").parent == place.parent
    (said,) = capsys.readouterr().err.splitlines()
    assert said.startswith("foreride: /dev/null/cache cannot be written, so caches are in ")


def test_what_is_kept_in_a_cache_that_is_only_readable_is_still_found(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FORERIDE_CACHE", str(tmp_path / "kept"))
    (tmp_path / "kept" / "bounds").mkdir(parents=True)
    (tmp_path / "kept" / "bounds" / "a.npz").touch()
    monkeypatch.setattr("foreride.files.cache.writable", lambda folder: folder != tmp_path / "kept")
    assert cached("bounds/a.npz") == tmp_path / "kept" / "bounds" / "a.npz"
    assert cached("bounds/b.npz").parent.parent == temporary_folder()


def test_no_home_at_all(monkeypatch: pytest.MonkeyPatch) -> None:
    def homeless() -> Path:
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.setattr(Path, "home", homeless)
    assert cache_folder() is None
    assert writable(cached("bounds/a.npz").parent)


def test_a_temporary_folder_that_others_can_write_to_is_not_used(tmp_path: Path) -> None:
    planted = tmp_path / "temporary" / f"foreride-{os.getuid()}"
    planted.mkdir(mode=0o777)
    planted.chmod(0o777)
    assert temporary_folder() not in (None, planted)


def test_a_link_in_place_of_the_temporary_folder_is_not_followed(tmp_path: Path) -> None:
    (tmp_path / "elsewhere").mkdir(mode=0o700)
    planted = tmp_path / "temporary" / f"foreride-{os.getuid()}"
    planted.symlink_to(tmp_path / "elsewhere")
    assert temporary_folder() != planted


def test_machine_code_has_no_place_where_nothing_can_be_written(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compiled, "writable", lambda folder: False)
    monkeypatch.setattr(compiled, "temporary_folder", lambda: None)
    assert compiled._prepare() is None


def test_packages_with_compiled_functions_are_known() -> None:
    sources = [source for package in PACKAGES for source in (ROOT / package).rglob("*.py")]
    compiling = {source for source in sources if "import njit" in source.read_text(encoding="utf-8")}
    assert {source.relative_to(ROOT).parts[0] for source in compiling} == set(compiled.PACKAGES)


def test_the_sources_of_all_compiled_functions_count() -> None:
    """Machine code of a function that they call would otherwise outlive its change."""
    compiling = {
        package
        for package in PACKAGES
        for path in (ROOT / package).rglob("*.py")
        if "from foreride.files.jit import njit" in path.read_text()
    }
    assert compiling <= set(compiled.PACKAGES)


@pytest.fixture(scope="module")
def installation(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Copy as a wheel lays it, in which no folder `__pycache__` can be created, for any user."""
    folder = tmp_path_factory.mktemp("installation") / "foreride"
    shutil.copytree(ROOT / "foreride", folder, ignore=shutil.ignore_patterns("__pycache__"))
    for package in PACKAGES:
        shutil.copytree(ROOT / package, folder / package, ignore=shutil.ignore_patterns("__pycache__"))
    for package in compiled.PACKAGES:
        for inner in {source.parent for source in (folder / package).rglob("*.py")}:
            (inner / "__pycache__").touch()
    return folder.parent


def test_a_read_only_installation_without_a_home_works(installation: Path, tmp_path: Path) -> None:
    environment = {
        "PYTHONPATH": str(installation),
        "HOME": "/dev/null",
        "TMPDIR": str(tmp_path / "temporary"),
    }
    compiling = (
        "import foreride.files.interpolation as module, numpy as np; print(module.__file__); "
        "module.cell(np.arange(3.0), 1.5, 0)"
    )
    for asked, answer in (
        (["-m", "foreride.scenarios.cli", "--help"], "usage: foreride"),
        (["-c", compiling], str(installation)),
    ):
        found = subprocess.run(
            [sys.executable, *asked],
            cwd=tmp_path,
            env=environment,
            capture_output=True,
            text=True,
            timeout=300,
        )
        assert found.returncode == 0, found.stderr
        assert found.stdout.startswith(answer)
        (said,) = [line for line in found.stderr.splitlines() if "onnxruntime" not in line]
        assert "/dev/null/.cache/foreride cannot be written, so caches are in " in said
    assert list((tmp_path / "temporary").rglob("*.nbi"))
