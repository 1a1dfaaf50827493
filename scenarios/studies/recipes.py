"""Recipes of Dask clusters for `foreride sweep --jobs`: SSH, SLURM and Kubernetes, in one file by name.

Every recipe starts a scheduler and workers of one thread each, and stops them when the sweep ends. foreride
must be installed where the workers run, and the study's files must be there under the same paths.
"""

import sys
from dataclasses import dataclass
from pathlib import Path
from shutil import which
from typing import Annotated, Any, ClassVar

from annotated_types import Interval

from foreride.files.errors import InputError, shown
from foreride.files.reading import strict
from foreride.files.reading.ranges import Checked
from foreride.files.reading.regular_file import read_text
from foreride.files.reading.yaml12 import parse

Count = Annotated[int, Interval(ge=1, le=10_000), "1"]
Wait = Annotated[float, Interval(ge=1.0, le=604_800.0), "s"]


@dataclass(frozen=True)
class SshRecipe(Checked):
    """Workers by SSH, with the keys and settings of `~/.ssh`, on every host; the scheduler on the first one.

    python: interpreter on the hosts; None for the path of this one. workers: processes on each host.
    known_hosts: file of the hosts' keys; None for the user's own. wait_s: time to wait for the first worker.
    """

    kind: ClassVar[str] = "ssh"
    hosts: tuple[str, ...]
    workers: Count = 1
    python: str | None = None
    username: str | None = None
    port: Annotated[int, Interval(ge=1, le=65535), "1"] = 22
    known_hosts: str | None = None
    wait_s: Wait = 60.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.hosts:
            raise InputError("hosts must name one or more machines")

    def start(self) -> Any:
        """Start the cluster."""
        import asyncssh  # noqa: F401  (Dask's own message on its absence does not name it)
        from distributed import SSHCluster

        options = {"username": self.username, "known_hosts": self.known_hosts}
        given = {name: value for name, value in options.items() if value is not None}
        return SSHCluster(
            [self.hosts[0], *self.hosts],
            connect_options={"port": self.port, **given},
            worker_options={"nthreads": 1, "n_workers": self.workers},
            scheduler_options={"port": 0, "dashboard": False},
            remote_python=self.python or sys.executable,
            silence_logs=50,
        )


@dataclass(frozen=True)
class SlurmRecipe(Checked):
    """Workers in SLURM jobs of `cores` processes each; the scheduler here, where `sbatch` must work.

    memory: of a job. options: further lines `#SBATCH`. setup: shell lines before the workers start. python:
    interpreter on the nodes; None for the path of this one. wait_s: time to wait for the first worker, which
    is that in the queue.
    """

    kind: ClassVar[str] = "slurm"
    jobs: Count
    cores: Count
    memory: str
    walltime: str
    queue: str | None = None
    account: str | None = None
    python: str | None = None
    options: tuple[str, ...] = ()
    setup: tuple[str, ...] = ()
    wait_s: Wait = 86_400.0

    def start(self) -> Any:
        """Start the cluster."""
        if which("sbatch") is None:  # Dask would ask for jobs again and again
            raise FileNotFoundError("sbatch is not found")
        cluster = self.cluster()
        cluster.scale(jobs=self.jobs)
        return cluster

    def cluster(self) -> Any:
        """Cluster without a job yet."""
        from dask_jobqueue import SLURMCluster

        return SLURMCluster(
            cores=self.cores,
            processes=self.cores,
            memory=self.memory,
            walltime=self.walltime,
            queue=self.queue,
            account=self.account,
            python=self.python,
            job_extra_directives=list(self.options),
            job_script_prologue=list(self.setup),
            scheduler_options={"dashboard": False},
        )


@dataclass(frozen=True)
class KubernetesRecipe(Checked):
    """Workers in pods, by Dask's operator, which must be installed in the Kubernetes cluster.

    image: holds foreride with its extra `sweep`, and the study's files. cpu, memory: of each worker's pod.
    """

    kind: ClassVar[str] = "kubernetes"
    image: str
    workers: Count
    name: str = "foreride-sweep"
    namespace: str | None = None
    cpu: str = "1"
    memory: str = "2Gi"
    wait_s: Wait = 3600.0

    def start(self) -> Any:
        """Start the cluster."""
        from dask_kubernetes.operator import KubeCluster

        share = {"cpu": self.cpu, "memory": self.memory}
        return KubeCluster(
            name=self.name,
            namespace=self.namespace,
            image=self.image,
            n_workers=self.workers,
            resources={"requests": share, "limits": share},
            worker_command=["dask-worker", "--nthreads", "1"],
        )


Recipe = SshRecipe | SlurmRecipe | KubernetesRecipe
PACKAGES = {"ssh": "asyncssh", "slurm": "dask-jobqueue", "kubernetes": "dask-kubernetes"}
"""Packages that the kinds of recipe need, beside the extra `sweep`."""


def read_recipe(target: str) -> Recipe:
    """Recipe of `FILE.yaml:NAME`, or the only one of `FILE.yaml`; InputError, in one line, for none."""
    file, colon, name = target.partition(".yaml:")
    path = Path(f"{file}.yaml" if colon else file)
    mapping = parse(read_text(path), str(path))
    if not isinstance(mapping, dict) or not mapping:
        raise InputError(f"{path}: must be a mapping of names to recipes, got {shown(mapping)}")
    if not name and len(mapping) > 1:
        raise InputError(
            f"--jobs {target}: holds {len(mapping)} recipes; name one, as {path}:{next(iter(mapping))}"
        )
    chosen = name or next(iter(mapping))
    if chosen not in mapping:
        raise InputError(f"--jobs {target}: {path} holds {', '.join(map(str, mapping))}, not {shown(chosen)}")
    recipe: Recipe = strict.structure(Recipe, mapping[chosen], f"{path}: {chosen}")
    return recipe


def start(recipe: Recipe) -> Any:
    """Start the cluster of a recipe; InputError, in one line, if it cannot be started."""
    try:
        return recipe.start()
    except ImportError:
        package = PACKAGES[recipe.kind]
        raise InputError(f"--jobs: a recipe of kind {recipe.kind} needs: pip install {package}") from None
    except Exception as error:  # of a network, a queue or an operator, through three libraries
        reason = " ".join(str(error).split()) or type(error).__name__
        raise InputError(f"--jobs: the {recipe.kind} cluster cannot be started ({reason})") from None
