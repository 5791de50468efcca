"""What a column's name says: its words, in the sense that test stands use them in.

A name is cut into words (``PTC1``: PT, C; ``P_N2O_FLOW``: P, N2O, FLOW; ``BrennkammerDruck``), each of which says what
is measured, where, or of which fluid. What they say together is :func:`read`.
"""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass
from functools import lru_cache

QUANTITIES: dict[str, str] = {
    **dict.fromkeys(
        ("p", "pt", "pts", "pr", "pres", "press", "pressure", "ptran", "transducer", "druck", "presion", "pression",
         "pressione"), "pressure"),
    **dict.fromkeys(
        ("t", "tc", "temp", "temps", "temperature", "therm", "thermo", "thermocouple", "thermistor", "rtd",
         "temperatur", "temperatura"), "temperature"),
    **dict.fromkeys(("l", "lc", "load", "cell", "loadcell", "hx711"), "cell"),
    **dict.fromkeys(("f", "thrust", "force", "axial", "schub", "kraft", "poussee", "empuje", "spinta", "thr"), "force"),
    **dict.fromkeys(("m", "mass", "weight", "masse", "masa", "massa", "peso", "gewicht", "wt"), "mass"),
    **dict.fromkeys(("valve", "mv", "mov", "sv", "bv", "solenoid", "servo", "ventil", "vanne", "valvula"), "valve"),
    **dict.fromkeys(("flow", "mdot", "mfc", "mfm", "massflow", "flowrate", "flowmeter", "durchfluss"), "flow"),
    **dict.fromkeys(("volt", "volts", "voltage", "adc", "counts", "vbat", "battery", "current"), "electric"),
    **dict.fromkeys(
        ("mode", "state", "status", "command", "commands", "cmd", "relay", "igniter", "ign", "armed", "arm", "comment",
         "setpoint", "abort", "flag", "ind", "index", "event", "zerocheck"), "state"),
    **dict.fromkeys(
        ("altitude", "acceleration", "accel", "gyro", "velocity", "humidity", "latitude", "longitude", "vibration",
         "dp", "delta", "diff", "differential"),
        "other"),
}  # fmt: skip
"""Word -> what is measured; a ``cell`` weighs or pushes. Source: tags of the logs and P&IDs that student teams and
stands publish (PT pressure transducer, TC thermocouple, LC load cell; ISA-5.1 has P, T, F as first letters)."""

PLACES: dict[str, str] = {
    **dict.fromkeys(
        ("tank", "tnk", "reservoir", "vessel", "ullage", "behaelter", "serbatoio", "deposito", "oxtank"), "tank"),
    **dict.fromkeys(
        ("run", "feed", "line", "feedline", "inj", "injector", "injektor", "injecteur", "inyector", "iniettore", "man",
         "mani", "manifold", "plenum", "leitung", "upstream"), "run"),
    **dict.fromkeys(
        ("chamber", "cham", "chm", "chmbr", "chmb", "chbr", "chb", "comb", "combustion", "cc", "kammer", "brennkammer",
         "chambre", "camara", "camera", "precomb", "postcomb", "prechamber", "postchamber", "engine", "motor", "moteur",
         "triebwerk"), "chamber"),
    **dict.fromkeys(("purge", "spuel", "spuelung"), "purge"),
    **dict.fromkeys(("ambient", "amb", "atm", "atmospheric", "baro", "barometric", "outside"), "ambient"),
    **dict.fromkeys(("fill", "supply", "bottle", "cylinder", "dewar", "gse", "filling", "flasche"), "fill"),
}  # fmt: skip
"""Word -> where it is measured; CC combustion chamber, INJ injector, MAN manifold. Source: as above."""

FLUIDS: dict[str, str] = {
    **dict.fromkeys(("ox", "oxidizer", "oxidiser", "oxid", "n2o", "nos", "nox", "nitrous", "lox"), "oxidizer"),
    **dict.fromkeys(("n2", "gn2", "nitrogen", "stickstoff", "azote", "pressurant", "pressurization", "helium", "he",
                     "pressurisation", "pressurizing"), "gas"),
    **dict.fromkeys(("fuel", "fu", "ipa", "ethanol", "kerosene", "rp1", "methanol"), "fuel"),
}  # fmt: skip
"""Word -> of which fluid; N2O is not N2."""

MAIN = ("main", "mov", "mv", "run", "ox", "ball")
"""Words that single out the valve whose opening is the firing."""
LETTERS = {"c": "chamber", "i": "run", "o": "tank", "r": "run tank"}
"""Last letters of a tag that say where, if no word does: PTC1, P_i, P_o; R is the run tank or its line."""
_PREFIXES = ("pt", "tc", "lc", "p", "t", "l", "f", "m")
_KNOWN = {**QUANTITIES, **PLACES, **FLUIDS}
_PIECES = re.compile(
    r"(?<![A-Za-z])[dD][pP](?![a-z])|(?i:(?:hp|lp|pt?|t)(?=n2)|n2o|gn2|n2(?!o)|hx711|rp-?1)|[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+",
    re.ASCII,
)
_LONG = 4
"""Letters [letters] that a word needs for being looked for within a longer one. Evidence: "man" is in "command", "comb"
stands alone."""


@dataclass(frozen=True)
class Said:
    """What a name says; "" where it does not say it.

    ``quantity``: pressure, temperature, force, mass, cell, valve, flow, electric, state or other; ``place``: tank, run,
    chamber, purge, fill, "run tank" (the one or the other), ambient or fuel; ``sure``: by a word, not by a letter;
    ``words``: those that say so, as a reason; ``silent``: how many say nothing.
    """

    quantity: str = ""
    place: str = ""
    fluid: str = ""
    sure: bool = True
    main: bool = False
    words: tuple[str, ...] = ()
    silent: int = 0


def read(name: str) -> Said:
    """What the words of a name say together.

    >>> read("P_RUN_TANK").place, read("P_N2O_FLOW").place, read("P_N2_FLOW").place, read("LCC1").quantity
    ('tank', 'run', 'purge', 'cell')
    """
    words = cut(name)
    fluid = next((FLUIDS[word] for word in words if word in FLUIDS), "")
    quantity = _quantity(words)
    place = _place(words, fluid, quantity)
    telling = tuple(word for word in words if word in _KNOWN or (word in LETTERS and place))
    by_letter = place in ("run tank", "tank", "run") and not fluid and not any(word in PLACES for word in words)
    main = any(word in MAIN for word in words)
    return Said(quantity, place, fluid, not by_letter, main, telling, len(words) - len(telling))


def _quantity(words: list[str]) -> str:
    """The most telling word wins: a "load cell" that is named after the thrust measures a force."""
    found = [QUANTITIES[word] for word in words if word in QUANTITIES]
    of_flow = next((kind for kind in found if kind in ("pressure", "temperature")), "")
    if "flow" in found and of_flow:
        return of_flow  # the pressure of a flow
    order = ("state", "other", "electric", "valve", "flow", "force", "mass", "cell", "temperature", "pressure")
    first = [kind for kind in order[:5] if kind in found]
    long = [QUANTITIES[word] for word in words if word in QUANTITIES and len(word) > 1]
    return next(iter([*first, *(kind for kind in order if kind in long), *found]), "")


def _place(words: list[str], fluid: str, quantity: str) -> str:
    """Fluids before places, "fill" before "tank", and "tank" before "run": a run tank is a tank."""
    found = [PLACES[word] for word in words if word in PLACES]
    if fluid == "fuel":
        return "fuel"
    if "purge" in found or (fluid == "gas" and "chamber" not in found):
        return "purge"
    stated = next((place for place in ("ambient", "fill", "chamber", "tank", "run") if place in found), "")
    if stated:
        return stated
    if fluid == "oxidizer" and quantity != "valve":
        return "run" if "flow" in words else "run tank"
    letters = [word for word in words[1:] if word in LETTERS] if quantity else []
    return LETTERS[letters[0]] if letters else ""


@lru_cache(maxsize=4096)
def _folded(name: str) -> str:
    """A name in plain letters: accents and what cannot be written without them taken off."""
    return unicodedata.normalize("NFKD", name.replace("ß", "ss")).encode("ascii", "ignore").decode()


def cut(name: str) -> list[str]:
    """The words of a name, in lower case.

    >>> cut("PTC1"), cut("2.NitrousHeatXger"), cut("nitroustank"), cut("Kammerdruck")
    (['pt', 'c'], ['nitrous', 'heat', 'xger'], ['nitrous', 'tank'], ['kammer', 'druck'])
    """
    pieces = [piece.casefold() for piece in _PIECES.findall(_folded(name))]
    return [word for piece in pieces for word in ([piece] if piece in FLUIDS else _split(piece)) if not word.isdigit()]


def _split(piece: str) -> list[str]:
    """A piece without gaps, in words: a tag (PT + C) or words run together; as it is where it is none."""
    if piece in _KNOWN or len(piece) < 2:
        return [piece]
    for first in (*_PREFIXES, *(word for word in _KNOWN if len(word) >= 2)):
        rest = piece.removeprefix(first)
        if rest != piece and (rest in _KNOWN or rest in LETTERS):
            return [first, rest]
    return _within(piece) or [piece]


def _within(piece: str) -> list[str]:
    """Long words of the lexicon inside a piece, in their order."""
    found = sorted((piece.find(word), -len(word), word) for word in _KNOWN if len(word) >= _LONG and word in piece)
    end, words = 0, []
    for start, length, word in found:
        if start >= end:
            words.append(word)
            end = start - length
    return words
