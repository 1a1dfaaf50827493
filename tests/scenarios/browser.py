"""Headless Chromium for tests of pages, if installed."""

import re
import shutil
import subprocess
from html import unescape
from pathlib import Path

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
PROBE = """<script>
const errors = []; addEventListener("error", (event) => errors.push(event.message));
</script>"""


def told_by(page: str, script: str, folder: Path, width: int = 1280) -> str:
    """Output of `script` between TOLD and END in the title after the page has run; it may read `errors`."""
    probed = folder / "probed.html"
    tail = f"<script>{script}</script>"
    head, body = page.replace("<body>", "<body>" + PROBE, 1).rsplit("</body>", 1)
    probed.write_text(f"{head}{tail}</body>{body}", encoding="utf-8")
    flags = [
        "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
        "--disable-background-networking", "--disable-component-update", "--disable-sync",
        f"--user-data-dir={folder / 'profile'}", f"--window-size={width},900", "--virtual-time-budget=3000",
    ]  # fmt: skip
    command = [str(CHROMIUM), *flags, "--dump-dom", probed.as_uri()]
    dom = subprocess.run(command, capture_output=True, timeout=300).stdout.decode("utf-8", "replace")
    found = re.search(r"TOLD(.*?)END", dom, re.S)
    assert found, dom[-2000:]
    return unescape(found[1])
