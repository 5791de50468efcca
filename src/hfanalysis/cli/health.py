"""hfa health --apply: the cures of what was found, written into test.toml after asking."""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Iterator

from hfanalysis.cli.exit_status import tell
from hfanalysis.cli.perform import stage
from hfanalysis.cli.request import Request
from hfanalysis.errors import InputError
from hfanalysis.products.health import Finding, Health
from hfanalysis.record.amend import amended, write
from hfanalysis.stages.base import Context


def apply(request: Request, yes: bool) -> None:
    """Judge, show the cures, ask, and write them. Raises InputError where nobody can be asked."""
    context = stage("health", request)
    path = context.definition.path
    found = list(cures(context.read(Health)))
    if not found:
        tell("nothing that was found has a cure to write")
        return
    text = _as_judged(context)
    for channel, lines in found:
        text = amended(text, channel, lines)
    for channel, lines in found:
        tell(f"{path}, for {channel}: {lines}".replace("\n", "\n    "))
    if not yes and not _agreed(str(path)):
        return
    write(path, text)
    tell(f"{path}: written; hfa health {request.test} judges it anew")


def _as_judged(context: Context) -> str:
    """The text of test.toml, if it is the one that was judged."""
    content = context.definition.path.read_bytes()
    if hashlib.sha256(content).hexdigest() != context.definition.sha256:
        raise InputError(f"{context.definition.path}: changed meanwhile; nothing was written: run again")
    return content.decode("utf-8-sig")


def cures(health: Health) -> Iterator[tuple[str, str]]:
    """Channel and lines of every cure, each once; those of what the engineer overruled are left out."""
    told: set[str] = set()
    for finding in _findings(health):
        if finding.cure and not finding.overruled and finding.cure not in told:
            # keys without a table are another line in every channel's own
            told |= {finding.cure} if finding.cure.startswith("[") else set()
            yield finding.channels[0], finding.cure


def _findings(health: Health) -> Iterator[Finding]:
    seen: list[Finding] = []
    for channel in health.channels.values():
        for finding in channel.findings:
            if finding not in seen:
                seen.append(finding)
                yield finding


def _agreed(path: str) -> bool:
    if not sys.stdin.isatty():
        raise InputError(f"{path}: nobody can be asked whether to write this; --yes writes it without asking")
    print(f"hfa: write these lines into {path}? [y/N] ", end="", file=sys.stderr, flush=True)
    return sys.stdin.readline().strip().lower() in ("y", "yes")
