"""Runs the commands of dcf-tools, which print what they have to say."""

from __future__ import annotations

import subprocess
import sys

ABOUT_THEMSELVES = ("-W", "ignore::DeprecationWarning", "-W", "ignore:pkg_resources:UserWarning")
"""The tools warn of their own use of pkg_resources, whatever the file."""


def run(module: str, *arguments: object) -> tuple[str, list[str]]:
    """What a command prints, and what it complains of: anything on its error stream, and its exit status."""
    command = [sys.executable, *ABOUT_THEMSELVES, "-m", module, *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
    complaints = done.stderr.splitlines()
    if done.returncode:
        complaints.append(f"exit status {done.returncode}")
    return done.stdout, complaints
