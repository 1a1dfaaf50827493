"""Optional dependencies: the command that installs those of an extra, however foreride was installed."""

import re
import shlex
from importlib.metadata import requires


def install_command(extra: str) -> str:
    """Command that installs the packages of an extra of foreride."""
    marked = re.compile(rf"""(.+?)\s*;\s*extra == ['"]{re.escape(extra)}['"]""")
    packages = [match[1] for match in map(marked.fullmatch, requires("foreride") or ()) if match]
    return shlex.join(["pip", "install", *packages])
