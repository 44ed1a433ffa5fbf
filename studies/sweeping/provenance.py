"""What a result was made with: versions, commit, machine, time."""

import hashlib
import importlib.metadata
import os
import platform
import subprocess
from datetime import UTC, datetime
from functools import cache
from pathlib import Path

PACKAGES = ("anet-lumped", "numpy", "numba", "scipy")


def provenance() -> dict:
    """Time, versions, commit ("+" behind it: with changes that are not committed) and machine, JSON-ready."""
    versions = {name: importlib.metadata.version(name) for name in PACKAGES}
    return {
        "made": datetime.now(UTC).isoformat(timespec="seconds"),
        "versions": versions | {"python": platform.python_version()},
        "commit": _commit(),
        "machine": {"system": platform.platform(), "processor": _processor(), "cores": os.cpu_count()},
    }


@cache
def library() -> dict[str, str]:
    """What numbers depend on: versions of packages, and a hash of the text of this library, JSON-ready."""
    home, text = Path(__file__).parents[2], hashlib.sha256()
    for path in sorted(path for name in ("anet_lumped", "integrators", "studies") for path in (home / name).rglob("*.py")):
        text.update(path.relative_to(home).as_posix().encode() + b"\0" + path.read_bytes())
    return {name: importlib.metadata.version(name) for name in PACKAGES} | {"source of anet-lumped": text.hexdigest()[:12]}


def _commit():
    home = Path(__file__).parents[2]
    if not (home / ".git").exists():
        return None
    try:
        answer = subprocess.run(
            ["git", "describe", "--always", "--dirty=+", "--abbrev=40", "--exclude=*"],
            cwd=home,
            capture_output=True,
            text=True,
            timeout=10,
        )
    except (OSError, subprocess.TimeoutExpired):
        return None
    return answer.stdout.strip() or None


def _processor():
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or None
