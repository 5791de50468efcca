"""Tables of quantities on a terminal, as wide as there is room for."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from rich.console import Console
from rich.table import Table
from rich.text import Text

from hfanalysis.cli.exit_status import nobody_reads
from hfanalysis.health.reasons import Doubt, marked
from hfanalysis.products.health import TRUSTED
from hfanalysis.quantity import DOUBTED, IDENTIFIED, UNPHYSICAL, Quantity
from hfanalysis.wording.numbers import in_words, shown

_NARROWEST = 140
"""Columns assumed where nobody says (a pipe), so that tables do not break."""

_WIDE = 116
"""Columns from which on the quantities' names in words fit."""

_ROOMY = 100
"""Columns from which on the intervals fit beside the deviations."""

_MAY_WRAP = ("", "effect", "what it is", "flags", "column", "closest rivals")
"""Columns that give way where the terminal is narrow; numbers and symbols never do."""

_NUMBERS = (
    "value", "± std", "samples", "rate", "least", "largest", "rms", "bias", "noise", "stands out by", "typical size",
    "seen from",
)  # fmt: skip

_WORDS = {"of_ratio": "O/F"}
"""What an engine's quantities are called, where that is not plain from their names."""

_STYLES = {IDENTIFIED: "green", UNPHYSICAL: "red"}


class _Paper(Console):
    """A console whose reader may go away (``hfa … | head``)."""

    def on_broken_pipe(self) -> None:
        self.quiet = True
        nobody_reads()


def paper() -> Console:
    """Standard output, wide enough for tables that do not break where nobody says how wide it is."""
    console = _Paper(highlight=False)
    if not console.is_terminal:
        console.width = max(console.width, _NARROWEST)
    return console


def soft(console: Console) -> bool:
    """Whether lines are left whole, for what reads a pipe; a terminal wraps them at words."""
    return not console.is_terminal


def new_table(*columns: str, title: str) -> Table:
    """An empty table; columns of numbers stand to the right."""
    table = Table(title=title, title_justify="left", title_style="", box=None, pad_edge=False, header_style="dim")
    for column in columns:
        right = column in _NUMBERS
        table.add_column(column, overflow="fold", justify="right" if right else "left", no_wrap=column not in _MAY_WRAP)
    return table


def _quantities(found: Mapping[str, Quantity], title: str, console: Console, known: Sequence[Doubt]) -> Table:
    """The quantities in as many columns as the terminal has room for: columns go before digits do."""
    kept = ["value", "± std", *["95 % interval"] * (console.width >= _ROOMY), "unit", "verdict"]
    wide = console.width >= _WIDE
    table = _of_columns(found, title, wide, kept, known)
    for name in ("", "95 % interval", "verdict", "± std"):
        if _too_wide(table, console) and (name in kept or (not name and wide)):
            kept = [column for column in kept if column != name]
            table = _of_columns(found, title, False, kept, known)
    if _too_wide(table, console):
        table.columns[0].no_wrap = False
    return table


def _too_wide(table: Table, console: Console) -> bool:
    """Whether a table has to break a word or a number to fit."""
    return console.measure(table, options=console.options.update(width=10 * _WIDE)).maximum > console.width


def _of_columns(
    found: Mapping[str, Quantity], title: str, wide: bool, columns: Sequence[str], known: Sequence[Doubt]
) -> Table:
    table = new_table("symbol", *[""] * wide, *columns, title=title)
    for name, quantity in found.items():
        text = shown(quantity)
        told = f"{text.verdict} {marks(marked(quantity, known)[0])}".strip()
        cells: dict[str, str | Text] = {
            "value": text.value,
            "± std": text.std,
            "95 % interval": text.interval,
            "unit": text.unit,
            "verdict": Text(told, style=_STYLES.get(text.verdict, "yellow")),
        }
        table.add_row(name, *[in_words(name)] * wide, *(cells[column] for column in columns))
    return table


def marks(numbers: Iterable[int]) -> str:
    """The numbers of the reasons for a doubt; the warnings say them, each once."""
    return " ".join(f"[{number}]" for number in numbers)


def _notes(found: Mapping[str, Quantity], known: Sequence[Doubt]) -> Iterator[str]:
    """Why quantities are missing, or judged as they are, where that is not plain: what is said of several, once."""
    told: dict[str, list[str]] = {}
    for name, quantity in found.items():
        verdict, (_, why) = shown(quantity).verdict, marked(quantity, known)
        if why and verdict not in (IDENTIFIED, ""):
            told.setdefault(f"{verdict}: {why}", []).append(name)
    return (f"{', '.join(names)}: {words}" for words, names in told.items())


def print_quantities(console: Console, found: Mapping[str, Quantity], title: str, known: Sequence[Doubt] = ()) -> None:
    console.print(_quantities(found, title, console, known))
    from hfanalysis.report.names import plain

    for note in map(plain, _notes(found, known)):
        console.print(Text(f"  {note}"), soft_wrap=soft(console))


def print_values(console: Console, found: Mapping[str, Quantity], title: str, known: Sequence[Doubt] = ()) -> None:
    """A table of values, with intervals where any has one, and below it what cannot be had, by reason."""
    spread = any(quantity.std for quantity in found.values())
    table = new_table("", "value", *(["± std", "95 % interval"] if spread else []), "unit", "", title=title)
    absent: dict[str, list[str]] = {}
    for name, quantity in found.items():
        text = shown(quantity)
        if quantity.value is None:
            absent.setdefault(text.why, []).append(in_words(name))
        else:
            extra = [text.std, text.interval] if spread else []
            table.add_row(_WORDS.get(name, in_words(name)), text.value, *extra, text.unit, doubted(quantity, known))
    if table.row_count:
        console.print(table)
    for reason, names in absent.items():
        console.print(Text(f"  without {', '.join(names)}: {reason}"))


def doubted(quantity: Quantity, known: Sequence[Doubt]) -> Text:
    """In a table without verdicts: that a number is doubted, or rests on a channel that is trusted, and the numbers of
    the reasons, or for which channel; the warnings say more."""
    told, numbers = (quantity.why or "").partition(": ")[0], marks(marked(quantity, known)[0])
    trusted = TRUSTED in told and quantity.value is not None
    doubted = quantity.verdict == DOUBTED and quantity.value is not None
    return Text(f"doubted {numbers or told}" if doubted else f"{told} {numbers}" if trusted else "", style="yellow")
