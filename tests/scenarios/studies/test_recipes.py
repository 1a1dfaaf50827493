"""Recipes of clusters: the example's three, what each hands to its library, and what is refused."""

import sys
from pathlib import Path
from types import SimpleNamespace

import distributed
import pytest

from foreride.files.errors import InputError
from foreride.scenarios.cli import main
from foreride.scenarios.studies.recipes import SlurmRecipe, SshRecipe, read_recipe
from foreride.scenarios.studies.recipes import start as start_recipe
from foreride.scenarios.studies.results import load_results

EXAMPLE = Path(__file__).resolve().parents[3] / "examples" / "sweep" / "clusters.yaml"
STUDY = """
scenarios: [short.yaml]
controllers: [passive]
sampling: grid
vary: {speed_kmh: [40, 50]}
"""
ROAD = "title: A short drive\nspeed_kmh: 40\nroad: {length_m: 10}\nvehicle: {model: quarter}\n"


class _Called:
    """Class of a library that takes keyword arguments."""

    def __init__(self, *given: object, **named: object) -> None:
        self.given, self.named = given, named


def test_ssh_starts_the_scheduler_on_the_first_host_and_workers_on_all(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "asyncssh", SimpleNamespace())
    monkeypatch.setattr(distributed, "SSHCluster", _Called)
    cluster = start_recipe(read_recipe(f"{EXAMPLE}:ssh"))
    assert cluster.given == (["node1", "node1", "node2", "node3"],)
    assert cluster.named["worker_options"] == {"nthreads": 1, "n_workers": 8}
    assert cluster.named["remote_python"] == "/home/me/foreride/.venv/bin/python"
    assert cluster.named["connect_options"] == {"port": 22}


def test_slurm_jobs_ask_for_what_the_recipe_says() -> None:
    recipe = read_recipe(f"{EXAMPLE}:slurm")
    assert isinstance(recipe, SlurmRecipe)
    with recipe.cluster() as cluster:
        script = cluster.job_script()
    assert "#SBATCH -p normal" in script
    assert "#SBATCH -t 02:00:00" in script
    assert "#SBATCH --cpus-per-task=16" in script
    assert "source ~/foreride/.venv/bin/activate" in script
    assert "--nthreads 1" in script
    assert "--nworkers 16" in script


def test_kubernetes_pods_have_one_thread_each(monkeypatch: pytest.MonkeyPatch) -> None:
    operator = SimpleNamespace(KubeCluster=_Called)
    monkeypatch.setitem(sys.modules, "dask_kubernetes", SimpleNamespace(operator=operator))
    monkeypatch.setitem(sys.modules, "dask_kubernetes.operator", operator)
    asked = start_recipe(read_recipe(f"{EXAMPLE}:kubernetes")).named
    assert (asked["n_workers"], asked["namespace"]) == (32, "studies")
    assert asked["worker_command"] == ["dask-worker", "--nthreads", "1"]
    assert asked["resources"]["limits"] == {"cpu": "1", "memory": "2Gi"}


@pytest.mark.parametrize(
    ("text", "name", "expected"),
    [
        ("a: {kind: ssh, hosts: []}", "", "a: hosts must name one or more machines"),
        ("a: {kind: pbs}", "", "a: kind must be one of ssh, slurm, kubernetes"),
        ("a: {kind: ssh, hosts: [x], workers: 0}", "", "workers must lie in 1 ... 10000"),
        ("a: {kind: ssh, hosts: [x]}\nb: {kind: ssh, hosts: [x]}", "", "holds 2 recipes; name one"),
        ("a: {kind: ssh, hosts: [x]}", ":b", "holds a, not 'b'"),
        ("a: {kind: ssh, hosts: [x]}\nb: {kind: ssh, hosts: [x]}", ":", "holds 2 recipes; name one"),
        ("[]", "", "must be a mapping of names to recipes"),
    ],
)
def test_a_wrong_recipe_is_refused(tmp_path: Path, text: str, name: str, expected: str) -> None:
    path = tmp_path / "clusters.yaml"
    path.write_text(text)
    with pytest.raises(InputError, match=r".*") as refused:
        read_recipe(f"{path}{name}")
    assert expected in str(refused.value)
    assert "clusters.yaml" in str(refused.value)


@pytest.fixture
def asked(tmp_path: Path) -> list[str]:
    """Command line of a sweep by a recipe."""
    for name, text in (("short.yaml", ROAD), ("study.yaml", STUDY), ("c.yaml", "a: {kind: ssh, hosts: [x]}")):
        (tmp_path / name).write_text(text)
    return ["sweep", f"{tmp_path}/study.yaml", "--out", f"{tmp_path}/out", "--jobs", f"{tmp_path}/c.yaml:a"]


def test_a_sweep_runs_on_the_workers_of_a_recipe(
    asked: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    local = {"n_workers": 1, "processes": False, "dashboard_address": None}
    monkeypatch.setattr(SshRecipe, "start", lambda _: distributed.LocalCluster(**local))
    assert main(asked) == 0
    assert load_results(tmp_path / "out").num_rows == 2


def test_a_cluster_without_workers_ends_the_sweep_with_the_way_on(
    asked: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    local = {"n_workers": 0, "processes": False, "dashboard_address": None}
    monkeypatch.setattr(SshRecipe, "start", lambda _: distributed.LocalCluster(**local))
    file = Path(asked[-1].removesuffix(":a"))
    file.write_text("a: {kind: ssh, hosts: [x], wait_s: 1}")
    code = main(asked)
    told = capsys.readouterr().err
    assert code == 1
    assert "no worker of the ssh cluster came within" in told
    assert "--jobs" in told


def test_a_cluster_that_cannot_start_is_told_in_one_line(
    asked: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def refused(_: object) -> None:
        raise OSError("no route\nto host")

    monkeypatch.setattr(SshRecipe, "start", refused)
    assert main(asked) == 2
    assert "--jobs: the ssh cluster cannot be started (no route to host)" in capsys.readouterr().err
    assert main([*asked, "--scheduler", "tcp://127.0.0.1:9"]) == 2
    assert "give one of the two" in capsys.readouterr().err


def test_slurm_without_its_command_is_told_in_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "")
    with pytest.raises(InputError, match=r"the slurm cluster cannot be started \(sbatch is not found"):
        start_recipe(read_recipe(f"{EXAMPLE}:slurm"))
