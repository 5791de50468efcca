"""The ways in which logs and test.toml files go wrong, each drawn at random over its range of sizes.

``ON_VALUES`` change the numbers before they are written, ``ON_TEXT`` the lines, ``ON_BYTES`` the file, ``ON_TOML`` what
is stated. Each takes a case and a generator, changes the case, and notes in ``hit`` what a message has to name.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from benchmarks.fuzz.table import CHANNELS, Array, Case

Rng = np.random.Generator
Mutator = Callable[[Case, Rng], None]

WHOLE = {"row", "sample", "clock", "stamp", "rate", "step", "repeated", "held", "firing", "the log"}
"""Words of messages about the log as a whole."""


def _extent(x: Array) -> float:
    """From the least to the largest reading; cells without a number do not count."""
    return float(np.nanmax(x) - np.nanmin(x))


def _channel(case: Case, rng: Rng) -> str:
    name = str(rng.choice(list(case.log.channels)))
    case.hit.add(name)
    return name


def _span(case: Case, rng: Rng, least: int = 3, most: float = 0.2) -> slice:
    """Some rows in a row."""
    size = len(case.log.time)
    length = int(np.exp(rng.uniform(np.log(least), np.log(max(most * size, least + 1.0)))))
    start = int(rng.integers(0, max(size - length, 1)))
    return slice(start, start + length)


def _numbers(case: Case, name: str, numbers: Array) -> None:
    case.log = case.log.put(**{name: numbers})


def _of_one(change: Callable[[Array, Case, Rng], Array]) -> Mutator:
    """A mutator of one channel's numbers."""

    def mutate(case: Case, rng: Rng) -> None:
        name = _channel(case, rng)
        _numbers(case, name, change(case.log.channels[name].copy(), case, rng))

    return mutate


def _factor(rng: Rng) -> float:
    return float(np.exp(rng.choice([-1.0, 1.0]) * rng.uniform(0.02, 7.0)))


def _offset(x: Array, case: Case, rng: Rng) -> Array:
    return x + rng.choice([-1.0, 1.0]) * np.exp(rng.uniform(-6.0, 0.5)) * _extent(x)


def _frozen(x: Array, case: Case, rng: Rng) -> Array:
    where = _span(case, rng, most=0.6)
    x[where] = x[where.start]
    return x


def _frozen_for_good(x: Array, case: Case, rng: Rng) -> Array:
    start = int(rng.integers(0, len(x)))
    x[start:] = x[start]
    return x


def _noise_for_good(x: Array, case: Case, rng: Rng) -> Array:
    start = int(rng.integers(0, len(x)))
    x[start:] = rng.normal(rng.uniform(np.nanmin(x), np.nanmax(x)), _extent(x) * rng.uniform(0.01, 1.0), len(x) - start)
    return x


def _coded(x: Array, case: Case, rng: Rng) -> Array:
    where = rng.random(len(x)) < np.exp(rng.uniform(-7.0, -1.0))
    x[where] = rng.choice([0.0, -1.0, -10.0, 999.0, -999.25, 9999.0, 65535.0, 1e30, -1e6])
    return x


def _coded_stretch(x: Array, case: Case, rng: Rng) -> Array:
    x[_span(case, rng, most=0.5)] = rng.choice([0.0, -10.0, 999.0, -999.25, np.nan])
    return x


def _spikes(x: Array, case: Case, rng: Rng) -> Array:
    where = rng.integers(0, len(x), int(rng.integers(1, 12)))
    x[where] += rng.normal(0.0, np.exp(rng.uniform(-2.0, 4.0)) * _extent(x), where.size)
    return x


def _railed(x: Array, case: Case, rng: Rng) -> Array:
    share = rng.uniform(0.3, 0.98)
    rail = np.nanmin(x) + share * _extent(x)
    return np.minimum(x, rail) if rng.random() < 0.7 else np.maximum(x, np.nanmin(x) + 0.3 * (1.0 - share) * _extent(x))


def _lagged(x: Array, case: Case, rng: Rng) -> Array:
    tau = np.exp(rng.uniform(-4.0, 1.0))
    share = 1.0 - np.exp(-0.02 / tau)
    out = x.copy()
    for i in range(1, len(x)):
        out[i] = out[i - 1] + share * (x[i] - out[i - 1])
    return out


def _drift(x: Array, case: Case, rng: Rng) -> Array:
    return x + np.linspace(0.0, rng.choice([-1.0, 1.0]) * np.exp(rng.uniform(-5.0, 0.5)) * _extent(x), len(x))


def _coarse(x: Array, case: Case, rng: Rng) -> Array:
    step = np.exp(rng.uniform(-7.0, -0.7)) * _extent(x)
    return np.round(x / step) * step


def _blank(x: Array, case: Case, rng: Rng) -> Array:
    x[rng.random(len(x)) < rng.uniform(0.001, 0.95)] = np.nan
    return x


def _swapped(case: Case, rng: Rng) -> None:
    one, other = rng.choice(list(case.log.channels), 2, replace=False)
    case.hit |= {str(one), str(other)}
    case.log = case.log.put(**{one: case.log.channels[other], other: case.log.channels[one]})


def _edge(case: Case, rng: Rng) -> None:
    size = int(rng.integers(1, 30))
    at = slice(0, size) if rng.random() < 0.5 else slice(-size, None)
    name = _channel(case, rng)
    x = case.log.channels[name].copy()
    x[at] = rng.normal(np.nanmean(x), 10.0 * _extent(x), size)
    _numbers(case, name, x)


def _all_frozen(case: Case, rng: Rng) -> None:
    where = _span(case, rng)
    case.hit |= WHOLE
    case.log = case.log.put(**{k: _held(v, where) for k, v in case.log.channels.items()})


def _held(x: Array, where: slice) -> Array:
    x = x.copy()
    x[where] = x[where.start]
    return x


VALUES: dict[str, Mutator] = {
    "scale": _of_one(lambda x, case, rng: x * _factor(rng)),
    "offset": _of_one(_offset),
    "sign": _of_one(lambda x, case, rng: -x),
    "frozen": _of_one(_frozen),
    "frozen for good": _of_one(_frozen_for_good),
    "noise for good": _of_one(_noise_for_good),
    "coded drop-outs": _of_one(_coded),
    "coded stretch": _of_one(_coded_stretch),
    "spikes": _of_one(_spikes),
    "railed": _of_one(_railed),
    "lag": _of_one(_lagged),
    "drift": _of_one(_drift),
    "coarse": _of_one(_coarse),
    "blanks": _of_one(_blank),
    "constant": _of_one(
        lambda x, case, rng: np.full(len(x), rng.choice([0.0, 1.0, np.nanmean(x), np.nanmin(x), np.nanmax(x)]))
    ),
    "only noise": _of_one(lambda x, case, rng: rng.normal(0.0, _extent(x) * rng.uniform(1e-4, 1.0), len(x))),
    "white noise": _of_one(lambda x, case, rng: x + rng.normal(0.0, np.exp(rng.uniform(-6, -1)) * _extent(x), len(x))),
    "swapped": _swapped,
    "edge": _edge,
    "all frozen": _all_frozen,
}


def _on_rows(index: Callable[[int, Case, Rng], np.ndarray[Any, Any]]) -> Mutator:
    def mutate(case: Case, rng: Rng) -> None:
        case.hit |= WHOLE
        case.log = case.log.rows(index(len(case.log.time), case, rng))

    return mutate


def _doubled(size: int, case: Case, rng: Rng) -> np.ndarray[Any, Any]:
    """A buffer written twice."""
    where = _span(case, rng)
    block = np.arange(size)[where]
    return np.concatenate([np.arange(where.stop), block, np.arange(where.stop, size)])


def _doubled_in_place(case: Case, rng: Rng) -> None:
    """A buffer written twice, on a clock that goes on."""
    where = _span(case, rng)
    case.hit |= WHOLE
    index = np.arange(len(case.log.time))
    after = slice(where.stop, min(2 * where.stop - where.start, index.size))
    index[after] = np.arange(where.start, where.start + after.stop - after.start)
    case.log = replace(case.log.rows(index), time=case.log.time)


def _shuffled(size: int, case: Case, rng: Rng) -> np.ndarray[Any, Any]:
    index = np.arange(size)
    where = _span(case, rng)
    index[where] = rng.permutation(index[where])
    return index


ROWS: dict[str, Mutator] = {
    "rows lost": _on_rows(lambda size, case, rng: np.delete(np.arange(size), _span(case, rng))),
    "rows doubled": _on_rows(_doubled),
    "buffer twice": _doubled_in_place,
    "rows shuffled": _on_rows(_shuffled),
    "rows backwards": _on_rows(lambda size, case, rng: np.arange(size)[::-1].copy()),
    "begins late": _on_rows(lambda size, case, rng: np.arange(int(rng.uniform(0.05, 0.95) * size), size)),
    "ends early": _on_rows(lambda size, case, rng: np.arange(max(int(rng.uniform(0.05, 0.95) * size), 1))),
    "every nth": _on_rows(lambda size, case, rng: np.arange(0, size, int(rng.integers(2, 40)))),
    "few rows": _on_rows(lambda size, case, rng: np.arange(int(rng.integers(0, 12)))),
    "two firings": _on_rows(lambda size, case, rng: np.concatenate([np.arange(size), np.arange(size)])),
}


def _on_clock(change: Callable[[Array, Case, Rng], Array]) -> Mutator:
    def mutate(case: Case, rng: Rng) -> None:
        case.hit |= WHOLE
        case.log = replace(case.log, time=change(case.log.time.copy(), case, rng))

    return mutate


def _jump(t: Array, case: Case, rng: Rng) -> Array:
    t[int(rng.integers(1, len(t))) :] += rng.choice([-1.0, 1.0]) * np.exp(rng.uniform(-4.0, 10.0))
    return t


def _restart(t: Array, case: Case, rng: Rng) -> Array:
    start = int(rng.integers(1, len(t)))
    t[start:] += t[0] - t[start]
    return t


def _stood_still(t: Array, case: Case, rng: Rng) -> Array:
    return _held(t, _span(case, rng))


def _wild_stamps(t: Array, case: Case, rng: Rng) -> Array:
    where = rng.integers(0, len(t), int(rng.integers(1, 9)))
    t[where] = rng.choice([np.nan, 0.0, -1e9, 1e18, 4.3e9])
    return t


CLOCK: dict[str, Mutator] = {
    "jump": _on_clock(_jump),
    "restart": _on_clock(_restart),
    "stands still": _on_clock(_stood_still),
    "wild stamps": _on_clock(_wild_stamps),
    "other pace": _on_clock(lambda t, case, rng: t * rng.choice([0.5, 2.0, 0.9, 1.1, 1e-3, 60.0])),
    "milliseconds": _on_clock(lambda t, case, rng: np.round(1e3 * t)),
    "wraps": _on_clock(lambda t, case, rng: np.mod(t - t[0] + rng.uniform(0.0, 9.0), 65.536 / rng.choice([1.0, 8.0]))),
    "backwards": _on_clock(lambda t, case, rng: -t),
    "jitter": _on_clock(lambda t, case, rng: t + rng.normal(0.0, np.exp(rng.uniform(-7.0, -2.0)), len(t))),
    "epoch": _on_clock(lambda t, case, rng: t + 1.65e9),
    "zeros": _on_clock(lambda t, case, rng: np.zeros(len(t))),
}


def _renamed(case: Case, rng: Rng) -> None:
    name = str(rng.choice(["time", *CHANNELS]))
    case.hit |= {name, case.log.names[name]}
    new = str(rng.choice(["", " ", "p_tank", "P_TANK", "x" * 300, "Zünddruck [bar]", "a,b", '"', "1", "nan", "=1+1"]))
    case.log = replace(case.log, names={**case.log.names, name: new})


def _dropped(case: Case, rng: Rng) -> None:
    name = _channel(case, rng)
    case.log = replace(case.log, channels={k: v for k, v in case.log.channels.items() if k != name})


def _reordered(case: Case, rng: Rng) -> None:
    order = rng.permutation(list(case.log.channels))
    case.log = replace(case.log, channels={str(k): case.log.channels[str(k)] for k in order})


def _names_swapped(case: Case, rng: Rng) -> None:
    one, other = (str(name) for name in rng.choice(list(case.log.channels), 2, replace=False))
    case.hit |= {one, other}
    case.log = replace(case.log, names={**case.log.names, one: other, other: one})


COLUMNS: dict[str, Mutator] = {
    "name": _renamed,
    "column lost": _dropped,
    "reordered": _reordered,
    "names swapped": _names_swapped,
}


def _on_lines(change: Callable[[list[str], Rng], list[str]]) -> Mutator:
    """A mutator of lines of text; it keeps away from the first but where it is meant."""

    def mutate(case: Case, rng: Rng) -> None:
        case.hit |= {*WHOLE, "line", "cell", "header", "text", "column"}
        lines = case.content.decode("utf-8", "replace").split("\n")
        case.content = "\n".join(change(lines, rng)).encode()

    return mutate


def _at(lines: list[str], rng: Rng) -> int:
    return int(rng.integers(min(2, len(lines) - 1), len(lines)))


def _into(text: Callable[[list[str], Rng], str]) -> Callable[[list[str], Rng], list[str]]:
    def change(lines: list[str], rng: Rng) -> list[str]:
        for _ in range(int(rng.integers(1, 6))):
            lines.insert(_at(lines, rng), text(lines, rng))
        return lines

    return change


def _cut_line(lines: list[str], rng: Rng) -> list[str]:
    at = _at(lines, rng)
    lines[at] = lines[at][: int(rng.integers(0, len(lines[at]) + 1))]
    return lines


def _broken_line(lines: list[str], rng: Rng) -> list[str]:
    at = _at(lines, rng)
    cut = int(rng.integers(0, len(lines[at]) + 1))
    return [*lines[:at], lines[at][:cut], lines[at][cut:], *lines[at + 1 :]]


def _cells(words: list[str]) -> Callable[[list[str], Rng], list[str]]:
    def change(lines: list[str], rng: Rng) -> list[str]:
        for _ in range(int(rng.integers(1, 40))):
            at = _at(lines, rng)
            for mark in (";", "\t", ","):
                if mark in lines[at]:
                    row = lines[at].split(mark)
                    row[int(rng.integers(0, len(row)))] = str(rng.choice(words))
                    lines[at] = mark.join(row)
                    break
        return lines

    return change


def _every_line(change: Callable[[str, Rng], str]) -> Callable[[list[str], Rng], list[str]]:
    def changed(lines: list[str], rng: Rng) -> list[str]:
        return [lines[0], *(change(line, rng) if line.strip() else line for line in lines[1:])]

    return changed


WORDS = ["ERR", "NaN", "inf", "-inf", "1e400", "", " ", "--", "1,062", "1.062,5", "0x1F", "1e", "−3.5", "\x00", "#N/A",
         "12:30:00", "TRUE", "9" * 40, "١٢", "1_000"]  # fmt: skip

TEXT: dict[str, Mutator] = {
    "comment lines": _on_lines(_into(lambda lines, rng: str(rng.choice(["# remark", "%", "// x", "--- overrun ---"])))),
    "blank lines": _on_lines(_into(lambda lines, rng: str(rng.choice(["", "  ", "\t", ",,,,,,"])))),
    "header again": _on_lines(_into(lambda lines, rng: lines[0])),
    "line cut": _on_lines(_cut_line),
    "line broken": _on_lines(_broken_line),
    "words in cells": _on_lines(_cells(WORDS)),
    "header lost": _on_lines(lambda lines, rng: lines[1:]),
    "preamble": _on_lines(lambda lines, rng: [*["Logger 7, 12:30", "", "By: x;y,z"] * int(rng.integers(1, 9)), *lines]),
    "header shorter": _on_lines(lambda lines, rng: [lines[0][: int(rng.integers(0, len(lines[0]) + 1))], *lines[1:]]),
    "a cell more": _on_lines(_every_line(lambda line, rng: line.rstrip("\r") + ",7")),
    "trailing mark": _on_lines(_every_line(lambda line, rng: line.rstrip("\r") + ",")),
    "units row": _on_lines(lambda lines, rng: [lines[0], "s,psi,psi,psi,psi,lbf,kg", *lines[1:]]),
    "quoted": _on_lines(_every_line(lambda line, rng: '"' + line.rstrip("\r").replace(",", '","') + '"')),
    "footer": _on_lines(lambda lines, rng: [*lines, "End of log", "mean,1,2,3"]),
}


def _on_bytes(change: Callable[[bytearray, Rng], bytearray | bytes]) -> Mutator:
    def mutate(case: Case, rng: Rng) -> None:
        case.hit |= {*WHOLE, "line", "cell", "header", "text", "column", "read", "file", "byte", *case.log.channels}
        case.content = bytes(change(bytearray(case.content), rng))

    return mutate


def _flipped(raw: bytearray, rng: Rng) -> bytearray:
    for at in rng.integers(0, max(len(raw), 1), int(np.exp(rng.uniform(0.0, 5.0)))):
        raw[at] = int(rng.integers(0, 256))
    return raw


def _flipped_head(raw: bytearray, rng: Rng) -> bytearray:
    for at in rng.integers(0, min(len(raw), 2048), int(rng.integers(1, 9))):
        raw[at] ^= 1 << int(rng.integers(0, 8))
    return raw


def _block(raw: bytearray, rng: Rng) -> slice:
    start = int(rng.integers(0, len(raw)))
    return slice(start, start + int(np.exp(rng.uniform(0.0, 9.0))))


def _overwritten(raw: bytearray, rng: Rng) -> bytearray:
    where = _block(raw, rng)
    size = len(raw[where])
    raw[where] = bytes(size) if rng.random() < 0.5 else rng.bytes(size)
    return raw


def _removed(raw: bytearray, rng: Rng) -> bytearray:
    del raw[_block(raw, rng)]
    return raw


def _repeated(raw: bytearray, rng: Rng) -> bytearray:
    where = _block(raw, rng)
    return raw[: where.stop] + raw[where] + raw[where.stop :]


def _recoded(raw: bytearray, rng: Rng) -> bytes:
    text = bytes(raw).decode("utf-8", "replace")
    code = str(rng.choice(["utf-16", "utf-16-le", "utf-8-sig", "utf-32", "cp500"]))
    return text.encode(code, "replace")


BYTES: dict[str, Mutator] = {
    "bytes changed": _on_bytes(_flipped),
    "bits of the head": _on_bytes(_flipped_head),
    "cut": _on_bytes(lambda raw, rng: raw[: int(rng.integers(0, len(raw)))]),
    "block overwritten": _on_bytes(_overwritten),
    "block lost": _on_bytes(_removed),
    "block twice": _on_bytes(_repeated),
    "junk at the end": _on_bytes(lambda raw, rng: bytes(raw) + rng.bytes(int(rng.integers(1, 4000)))),
    "junk before": _on_bytes(lambda raw, rng: rng.bytes(int(rng.integers(1, 600))) + bytes(raw)),
    "other encoding": _on_bytes(_recoded),
    "something else": _on_bytes(
        lambda raw, rng: [b"", b"\0" * 999, b"<html><body>no</body></html>", b"version https://git-lfs.github.com/spec/v1\n",
                          b"\x89PNG\r\n\x1a\n" + bytes(99), rng.bytes(5000)][int(rng.integers(0, 6))]
    ),
}  # fmt: skip


def _leaves(content: Any, above: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    for key, item in content.items():
        yield (*above, key)
        if isinstance(item, dict):
            yield from _leaves(item, (*above, key))


def _place(case: Case, rng: Rng, plain: bool = True) -> tuple[dict[str, Any], Any]:
    """A table of test.toml and a key in it; ``plain``: one that holds no table."""
    found = list(_leaves(case.toml))
    while True:
        *above, key = found[int(rng.integers(0, len(found)))]
        table: Any = case.toml
        for name in above:
            table = table[name]
        if plain and isinstance(table[key], dict):
            continue
        case.hit |= {str(key), *map(str, above)}
        return table, key


def _key_lost(case: Case, rng: Rng) -> None:
    table, key = _place(case, rng, plain=False)
    del table[key]


def _key_misspelt(case: Case, rng: Rng) -> None:
    table, key = _place(case, rng, plain=False)
    table[f"{key}s" if rng.random() < 0.5 else key[:-1] or "x"] = table.pop(key)


ODD_VALUES: list[Any] = [
    "", " ", "nan", "inf kg", "-1 bar", "0 m", "1e400 kg", "10^309 m", "5", 5, -5, 0, 0.0, 1e308, True, [], [1], {},
    "1 furlong", "1 +/- 1 kg", "1 +/- -1 kg", "1 +/- 500 % kg", "3 m", "3 mm", "300 kg", "1e-9 kg", "20 K", "2000 degC",
    "auto", "ambient", "../../x", "/etc/passwd", "a\nb", "\x00", "x" * 5000, "2022-13-45", "c_p/c_v", "٣ bar",
]  # fmt: skip


def _value_replaced(case: Case, rng: Rng) -> None:
    table, key = _place(case, rng)
    table[key] = ODD_VALUES[int(rng.integers(0, len(ODD_VALUES)))]


def _number_scaled(case: Case, rng: Rng) -> None:
    """A value in the wrong unit, or with the point in the wrong place."""
    for _ in range(40):
        table, key = _place(case, rng)
        words = str(table[key]).split(" ", 1)
        try:
            number = float(words[0])
        except ValueError:
            continue
        factor = rng.choice([1e-3, 1e-2, 0.1, 0.5, 2.0, 10.0, 100.0, 1e3, -1.0, 0.0, _factor(rng)])
        new = float(f"{number * factor:.6g}")
        table[key] = f"{new} {words[1]}" if isinstance(table[key], str) and words[1:] else new
        return


UNITS = ["bar", "psi", "Pa", "kPa", "psig", "kg", "lb", "g", "N", "kN", "lbf", "m", "mm", "cm", "in", "degC", "K", "s",
         "ms", "L", "%", "m^2", "kgf", "barg", "V", "mA", "xyz"]  # fmt: skip


def _unit_changed(case: Case, rng: Rng) -> None:
    for _ in range(40):
        table, key = _place(case, rng)
        words = str(table[key]).split(" ", 1)
        if key == "unit" or (isinstance(table[key], str) and words[1:] and words[0][:1].isdigit()):
            unit = str(rng.choice(UNITS))
            table[key] = unit if key == "unit" else f"{words[0]} {unit}"
            return


def _columns_mixed(case: Case, rng: Rng) -> None:
    channels: Any = case.toml["channels"]
    one, other = (str(name) for name in rng.choice(list(channels), 2, replace=False))
    case.hit |= {one, other}
    channels[one]["column"], channels[other]["column"] = channels[other]["column"], channels[one]["column"]


def _added(case: Case, rng: Rng) -> None:
    extra: list[tuple[str, Any]] = [
        ("segments", {"t_open": f"{rng.uniform(-9.0, 30.0):.2f} s"}),
        ("segments", {str(rng.choice(["t_v", "t_feed", "t_purge", "t_end"])): f"{rng.uniform(-1, 30):.2f} s"}),
        ("exclude", [{"start": f"{rng.uniform(-3, 20):.2f} s", "end": f"{rng.uniform(-3, 20):.2f} s", "reason": "x"}]),
        ("model", {"conventions": "corrected"}), ("model", {"properties": "coolprop"}),
        ("observed", {"fuel_mass_after": f"{np.exp(rng.uniform(-7, 3)):.4g} kg"}),
        ("test", {"kind": "cold_flow"}), ("test", {"kind": "x"}), ("schema", 2),
        ("feed", {"K_loss": "6.4e8 1/m^4"}), ("purge", {"cracking_pressure": f"{np.exp(rng.uniform(-3, 6)):.3g} bar"}),
        ("tank", {"temperature": f"{rng.uniform(-80, 60):.1f} degC"}), ("injector", {"C_i": float(rng.uniform(0, 2))}),
        ("grain", {"a": 1.3e-4, "n": 0.5}), ("site", {"altitude": f"{rng.uniform(-900, 9900):.0f} m"}),
    ]  # fmt: skip
    key, new = extra[int(rng.integers(0, len(extra)))]
    case.hit.add(key)
    if not isinstance(new, dict):
        case.toml[key] = new
        return
    case.hit |= set(new)
    case.toml[key] = {**dict(case.toml.get(key, {})), **new}  # type: ignore[call-overload]


def _text_damaged(case: Case, rng: Rng) -> None:
    """What an editor or a merge leaves."""
    raw = bytearray(case.text.encode())
    case.hit |= {"toml", "line", "TOML"}
    choice = int(rng.integers(0, 5))
    changed = [
        lambda: _flipped(raw, rng), lambda: raw[: int(rng.integers(0, len(raw)))], lambda: _repeated(raw, rng),
        lambda: b"\xef\xbb\xbf" + raw.replace(b"\n", b"\r\n"), lambda: raw.decode().encode("utf-16"),
    ][choice]()  # fmt: skip
    case.text = bytes(changed).decode("latin-1")


TOML: dict[str, Mutator] = {
    "key lost": _key_lost,
    "key misspelt": _key_misspelt,
    "odd value": _value_replaced,
    "number scaled": _number_scaled,
    "unit changed": _unit_changed,
    "columns mixed": _columns_mixed,
    "statement added": _added,
}
TOML_TEXT: dict[str, Mutator] = {"text damaged": _text_damaged}
