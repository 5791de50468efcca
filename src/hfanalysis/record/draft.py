"""A first test.toml, from what a log shows: its columns, the units its header states, its column of time stamps."""

from __future__ import annotations

import json
import re
import shutil
from dataclasses import dataclass
from pathlib import Path

from hfanalysis.errors import InputError
from hfanalysis.products.disk import atomic
from hfanalysis.record.channels import CANONICAL, LONG_NAMES
from hfanalysis.record.logspec import FileSpec
from hfanalysis.units import dimension_of, unit_factor

_ID = re.compile(r"\w[\w.+-]*")
_UNIT = re.compile(r"^(?P<name>.*?)\s*[\[({](?P<unit>[^\])}]*)[\])}]\s*$")

_LAST_WORD = re.compile(r"^(?P<name>.*[^\s_])[\s_]+(?P<unit>[^\s_\d][^\s_]*)$")
_IN_NAMES = ("pressure", "force", "mass", "temperature", "time")
"""Dimensions of units that a name may end in without brackets."""

_LETTERS = ("N", "s", "K")
"""Units of one letter that are taken for one at the end of a name."""

_STAMPS = (
    (
        "datetime",
        re.compile(r"\d{2,4}[-./]\d{1,2}[-./]\d{2,4}[ T]\d{1,2}:\d{2}(:\d{2}([.,]\d+)?)?(Z|[+-]\d{2}:?\d{2})?"),
    ),
    ("clock", re.compile(r"\d{1,2}:\d{2}(:\d{2}([.,]\d+)?)?( ?[AaPp][Mm])?")),
)
"""How stamps are written that are no numbers."""

_LOOKED_AT = 200
"""Lines of a log that are looked at for stamps."""

_HINTS: tuple[tuple[str, str], ...] = (
    ("p_fill", r"\bp.*fill"),
    ("p_purge", r"\bp.*(purge|n2|nitrogen|press?uri)"),
    ("p_chamber", r"\bp.*(chamber|comb|\bcc\b|(^|[^a-z])pc($|[^a-z]))|^p_?c$"),
    ("p_run", r"\bp.*(run|feed|inj|manifold)"),
    ("p_tank", r"\bp.*(tank|\box)"),
    ("thrust", r"thrust|^force$"),
    ("m_tank", r"(lc|load|mass|weight|^m\b).*(tank|ox|run)|tank.*(mass|weight)"),
    ("T_chamber", r"\bt(c|emp|herm)?[^a-z]?.*(chamber|comb|\bcc\b)"),
    ("T_run", r"\bt(c|emp|herm)?[^a-z]?.*(run|feed|line)"),
    ("T_tank", r"\bt(c|emp|herm)?[^a-z]?.*tank"),
    ("valve", r"valve"),
)
"""Canonical channel and what its column may be called; the first that fits and whose unit agrees is the guess."""

_MARKS = {"p": "pressure", "t": "temperature"}
"""What a unit says about a column whose name does not."""

_OFTEN = {
    "p_run": ('# zero = "ambient"   # if it is open to the air before ignition',),
    "p_chamber": ('# zero = "ambient"   # if it is open to the air before ignition',),
    "thrust": ('tare = "auto"   # zero from the quiet time before ignition and after the burn; none if already done',),
}
"""What is often needed for a channel, beside column and unit."""

_TIME = re.compile(r"^(t|time|seconds?|secs?|timestamp|zeit|temps|tiempo|elapsed.*|.*\btime)$", re.IGNORECASE)

_TEMPLATE = """\
# What is known about test {id}. Drafted from {log}; complete it and remove what does not apply.
# Every physical value is a string with its unit, optionally with one standard deviation: "8.35 +/- 0.05 kg".
schema = 1

[test]
id = {id_text}
kind = "hot_fire"               # hot_fire | cold_flow: check
source = "measured"             # measured | replica | synthetic
# description = "what was tested, and how it went"
# date = 2022-04-03
# stand = "name of the test stand"

[log]
files = [{log_text}]
{time}

# Optional for every channel: accuracy = "2 psi", one standard deviation of its bias (else a class default is used and
# marked), scale and offset (applied before the unit), gauge = true; see docs/test-toml.md.
{channels}
# What is known about the engine. What is not stated is not assumed: results that need it are given as absent.
# [tank]
# volume = "16.5 L"                    # tank and feed line
# oxidizer_mass = "8.35 +/- 0.05 kg"   # loaded before the valve opens
# [injector]
# holes = 22
# hole_diameter = "2 mm"               # or hole_area
# [purge]
# cracking_pressure = "4.27 bar"       # check valve between purge line and tank
# [grain]
# mass = "1594 g"
# length = "610 mm"
# density = "900 kg/m^3"
# outer_radius = "39.5 mm"
# [nozzle]
# throat_radius = "23.3 mm"
# exit_radius = "38.1 mm"
# [site]
# altitude = "30 m"                    # or ambient_pressure
"""


@dataclass(frozen=True)
class LogColumn:
    """A column of a log: its full name, the name without its unit, and the unit ("" where the header states none)."""

    label: str
    name: str
    unit: str


def new_test(root: Path, test_id: str, log: Path) -> Path:
    """Draft ``raw_tests/ID/test.toml`` from a log, which is copied there unless it is there already.

    Args:
        root: folder that holds ``raw_tests/``.
        test_id: name of the new test.
        log: its log file.

    Returns:
        The path of the draft.

    Raises:
        InputError: the name cannot be a test's, the log cannot be read, or a file is already there.
    """
    if not _ID.fullmatch(test_id) or ".." in test_id:
        raise InputError(f"{test_id!r} cannot name a test; expected letters, digits, '.', '_', '+' and '-'")
    if not log.is_file():
        raise InputError(f"{log}: no such file; expected the test's log")
    folder = root / "raw_tests" / test_id
    target, copy = folder / "test.toml", folder / log.name
    is_there = copy.exists() and copy.samefile(log)
    if target.exists() or (copy.exists() and not is_there):
        raise InputError(f"{target if target.exists() else copy}: is there already, and is never overwritten")
    text = draft(test_id, log)
    _place(text, target, None if is_there else log)
    return target


def _place(text: str, target: Path, log: Path | None) -> None:
    try:
        if log is not None:
            with atomic(target.with_name(log.name)) as scratch:
                shutil.copyfile(log, scratch)
        with atomic(target) as scratch:
            scratch.write_text(text, encoding="utf-8")
    except OSError as error:
        raise InputError(f"{target.parent}: cannot be written to ({error.strerror})") from None


def draft(test_id: str, log: Path) -> str:
    """The text of a commented test.toml for ``log``."""
    columns = read_columns(log)
    time = _time_column(columns)
    channels = _channels([column for column in columns if column is not time])
    return _TEMPLATE.format(
        id=test_id,
        log=log.name,
        id_text=_quoted(test_id),
        log_text=_quoted(log.name),
        time=_time_line(time, columns, _written_stamps(log)),
        channels=channels,
    )


def _time_column(columns: list[LogColumn]) -> LogColumn | None:
    """The column of the time stamps, by its name; one that states its unit is preferred."""
    named = [column for column in columns if _TIME.match(column.name)]
    return next((column for column in named if _fits(column.unit, "time")), named[0] if named else None)


def read_columns(log: Path) -> list[LogColumn]:
    """The columns that the log's header names; numbered where it has no header. Raises InputError."""
    from hfanalysis.record.readers import open_log

    source = open_log(log, FileSpec(log.name))
    return [
        _column(label or f"column {number}", unit)
        for number, (label, unit) in enumerate(zip(source.columns, source.units, strict=False), start=1)
    ]


def _column(label: str, unit: str) -> LogColumn:
    bracketed = _UNIT.match(label)
    if bracketed:
        return LogColumn(label, bracketed["name"], unit or bracketed["unit"].strip())
    last = None if unit else _LAST_WORD.match(label.strip())
    if last and (len(last["unit"]) > 1 or last["unit"] in _LETTERS) and any(_fits(last["unit"], d) for d in _IN_NAMES):
        return LogColumn(label, last["name"], last["unit"])
    return LogColumn(label, label, unit)


def _written_stamps(log: Path) -> str:
    """ "datetime" or "clock" where a log of text has stamps that are written so; "" where it has none."""
    with log.open("rb") as file:
        head = b"".join(line for _, line in zip(range(_LOOKED_AT), file, strict=False))
    text = head.decode("utf-16" if head[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8", errors="replace")
    for name, form in _STAMPS:
        # a comma may be a column's end or a decimal point; one stamp alone may stand above the columns
        for ends in (r"[\n\t;|]", r"[\n\t;|,]"):
            if sum(form.fullmatch(cell.strip().strip('"')) is not None for cell in re.split(ends, text)) > 1:
                return name
    return ""


def _time_line(time: LogColumn | None, columns: list[LogColumn], written: str) -> str:
    if time is None:
        there = ", ".join(_quoted(column.label) for column in columns[:8])
        return f'# time = {{ column = "…", unit = "s" }}   # the column of time stamps; none recognized among {there}'
    unit = time.unit if _fits(time.unit, "time") else written or "s"
    sure = "" if unit in (time.unit, written) else "   # unit not stated in the log: check"
    return f"time = {{ column = {_quoted(time.label)}, unit = {_quoted(unit)} }}{sure}"


def _channels(columns: list[LogColumn]) -> str:
    taken: set[str] = set()
    blocks = []
    for column in columns:
        guess = guess_channel(column)
        blocks.append(_block(column, None if guess in taken else guess))
        taken |= {guess} if guess else set()
    return "\n".join(blocks)


def guess_channel(column: LogColumn) -> str | None:
    """The canonical channel that a column probably is, by its name and unit; None where nothing speaks for one.

    >>> guess_channel(LogColumn("PT-TANK (psia)", "PT-TANK", "psia")), guess_channel(LogColumn("mode", "mode", ""))
    ('p_tank', None)
    """
    said = next((mark for mark, dimension in _MARKS.items() if _fits(column.unit, dimension)), "")
    name = f"{said} {re.sub(r'[^0-9a-z]+', ' ', column.name.casefold())}".strip()
    for channel, hint in _HINTS:
        if re.search(hint, name) and (not column.unit or _fits(column.unit, CANONICAL[channel])):
            return channel
    return None


def _fits(unit: str, dimension: str) -> bool:
    if not unit:
        return False
    try:
        unit_factor(unit, dimension, "")
    except InputError:
        return False
    return True


def _block(column: LogColumn, channel: str | None) -> str:
    """One channel's table; commented out where the log does not say enough for it to be read."""
    known = channel is not None and _fits(column.unit, CANONICAL[channel])
    lines = [
        f"[channels.{channel or 'NAME'}]" + (f"   # {LONG_NAMES[channel]}: check" if channel else ""),
        f"column = {_quoted(column.label)}",
        f"unit = {_quoted(column.unit or '…')}" + _remark(column, channel),
        *_OFTEN.get(channel or "", ()),
    ]
    return "\n".join(lines if known else [f"# {line.removeprefix('# ')}" for line in lines]) + "\n"


def _remark(column: LogColumn, channel: str | None) -> str:
    if not column.unit:
        return "   # not stated in the log"
    if (channel or "").startswith("p_") and not re.search(r"[ag]\)?$", column.unit):
        return "   # absolute; add gauge = true where it is not"
    return "" if _is_unit(column.unit) else "   # not a unit known here"


def _is_unit(unit: str) -> bool:
    try:
        dimension_of(unit, "")
    except InputError:
        return False
    return True


def _quoted(text: str) -> str:
    """A TOML string: JSON's escapes are TOML's."""
    return json.dumps(text, ensure_ascii=False)
