"""The channels' health: which can be believed, what was found, and what cures it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from markupsafe import Markup

from hfanalysis.health.reasons import Doubt
from hfanalysis.products.health import HEALTHY, KINDS, SUSPECT, Finding, Health
from hfanalysis.report import html
from hfanalysis.report.material import Material
from hfanalysis.report.names import called
from hfanalysis.report.sections import Block, Section
from hfanalysis.wording.numbers import listed

_MARKS: dict[str, str] = {HEALTHY: "good", SUSPECT: "doubt"}
_CAPTION = "What is unusable is left out of every number; numbers that rest on a suspect channel are doubted."
_COLUMNS = ("channels", "verdict", "what", "log time", "evidence", "line of test.toml that cures it")


def render(material: Material) -> Iterator[Block]:
    """The verdicts in a line, then a row for every finding."""
    health = material.need(Health)
    yield html.paragraph(_verdicts(health))
    if found := [*enumerate(material.reasons, 1), *((0, doubt) for doubt in _only_told(health))]:
        yield html.table("Findings", _CAPTION, _COLUMNS, (_row(number, doubt) for number, doubt in found))
    for name, channel in health.channels.items():
        if channel.trust:
            words = Markup("The engineer trusts <bdi>{}</bdi>, whatever was found: {}.")
            yield html.paragraph(words.format(name, channel.trust))
    if health.compared:
        yield html.paragraph(f"Compared with other tests of the stand: {listed(list(health.compared))}.")


def _verdicts(health: Health) -> Markup:
    badge = Markup('<span class="names"><bdi>{}</bdi> {}</span>')
    return Markup(" ").join(badge.format(name, _badge(found.verdict)) for name, found in health.channels.items())


def _badge(verdict: str) -> Markup:
    kind = _MARKS.get(verdict, "bad")
    badge = Markup('<span class="verdict {}"><span aria-hidden="true">{}</span> {}</span>')
    return badge.format(kind, html.MARKS[kind], verdict)


def _only_told(health: Health) -> Iterator[Doubt]:
    """What was found that makes no channel worse than healthy: it stands nowhere else."""
    found = dict.fromkeys(f for channel in health.channels.values() for f in channel.findings if f.verdict == HEALTHY)
    return (Doubt(finding, finding.channels) for finding in found)


def _row(number: int, doubt: Doubt) -> tuple[Any, ...]:
    """The evidence of a numbered reason is said in the verdict."""
    finding = doubt.finding
    cure = Markup("<code>{}</code>").format(finding.cure) if finding.cure else Markup("–")
    verdict = _badge(finding.verdict) + (Markup(" overruled") if finding.overruled else Markup())
    return (
        listed(list(map(called, doubt.channels))),
        verdict,
        KINDS.get(finding.kind, finding.kind),
        _when(finding),
        html.marks([number]) if number else html.switchable(finding.evidence),
        cure,
    )


def _when(finding: Finding) -> str:
    if finding.whole:
        return "throughout"
    ends = [f"{end:.2f}" if end is not None else "" for end in (finding.start, finding.end)]
    return f"{' … '.join(ends)} s".strip()


SECTION = Section("Health of the channels", 12, ("health",), render, folded=True)
