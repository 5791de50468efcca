"""Products of two versions of the code, number by number.

python -m benchmarks.compare_products BEFORE AFTER [--moves] [--numbers-only]

BEFORE and AFTER are folders `processed/` (or folders in them) of the same tests. A number may differ by 1 % of its own
standard deviation, by 1e-6 of itself where it has none, by 1e-6 of the largest of its history; with `--moves`, for code
that was moved only, by 1e-9 throughout. Words must be the same, and a key that only one side has is a difference.
What says where a product comes from is not compared. Exit status 1 where anything differs by more.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import numpy.typing as npt

SHARE_OF_STD = 1e-2
RELATIVE = 1e-6
MOVED = 1e-9
OF_95 = 2 * 1.959964
ORIGIN = {
    "provenance",
    "hfanalysis",
    "version",
    "code",
    "libraries",
    "hashes",
    "sha256",
    "timings",
    "seconds",
    "machine",
}
# What HDF5 keeps for its own bookkeeping.
BOOKKEEPING = {"DIMENSION_LIST", "REFERENCE_LIST", "CLASS", "NAME", "_Netcdf4Dimid", "_Netcdf4Coordinates"}
NAMES = ("name", "test", "id", "quantity")

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Leaf:
    """What stands at one key: numbers with the standard deviations they have, or something else."""

    numbers: Array | None = None
    std: Array | None = None
    other: Any = None

    @property
    def said(self) -> str:
        """For the list of differences."""
        if self.numbers is None:
            return json.dumps(self.other, ensure_ascii=False, default=str)[:60]
        return f"{self.numbers.flat[0]:.10g}" if self.numbers.size == 1 else f"{self.numbers.shape} numbers"


@dataclass(frozen=True)
class Difference:
    """How far apart both sides are at a key: in standard deviations or relative; infinite for what is no number."""

    key: str
    size: float
    bound: float
    of_std: bool
    said: str

    @property
    def too_large(self) -> bool:
        """Whether it exceeds what is allowed."""
        return not self.size <= self.bound


def _numbers(value: Any) -> Array | None:
    """A number or a list of numbers, nulls among them, as an array; None for anything else."""
    values = value if isinstance(value, list) else [value]
    if not values or any(isinstance(x, bool) or not isinstance(x, int | float | None) for x in values):
        return None
    if all(x is None for x in values):
        return None
    return np.array([np.nan if x is None else x for x in values], float)


def _of_json(value: Any, key: str, std: Any = None) -> Iterator[tuple[str, Leaf]]:
    """Every leaf of a JSON product by its path; value, std and ci95 of a quantity come with its std."""
    numbers = _numbers(value)
    if numbers is not None:
        yield key, Leaf(numbers, None if std is None else _numbers(std))
    elif isinstance(value, Mapping):
        for name, part in value.items():
            if name not in ORIGIN:
                own = value.get("std") if name in ("value", "std", "ci95") else None
                yield from _of_json(part, f"{key}/{name}", own)
    elif isinstance(value, list) and any(isinstance(x, Mapping | list) for x in value):
        for name, part in _named(value):
            yield from _of_json(part, f"{key}/{name}")
    else:
        yield key, Leaf(other=value)


def _named(parts: list[Any]) -> Iterator[tuple[str, Any]]:
    """The parts of a list by their names, where each has one of its own, else by their places."""
    for key in NAMES:
        names = [p.get(key) if isinstance(p, Mapping) else None for p in parts]
        if all(isinstance(n, str) for n in names) and len(set(names)) == len(names):
            return zip([str(n) for n in names], parts, strict=True)
    return ((str(i), part) for i, part in enumerate(parts))


def _of_hdf5(path: Path) -> Iterator[tuple[str, Leaf]]:
    """Every dataset of a file, with the standard deviation that its band tells, and every number of its attributes."""
    with h5py.File(path) as file:
        found: list[tuple[str, Any]] = [("", file)]
        file.visititems(lambda name, item: found.append((f"/{name}", item)))
        for key, item in found:
            for name, value in item.attrs.items():
                if name not in ORIGIN | BOOKKEEPING and np.asarray(value).dtype.kind in "fiu":
                    yield f"{key}@{name}", Leaf(np.asarray(value, float))
            if isinstance(item, h5py.Dataset):
                yield key, _dataset(item)


def _dataset(item: Any) -> Leaf:
    if item.dtype.kind not in "fiub":
        return Leaf(other=[str(x) for x in np.atleast_1d(item[()])])
    low, high = (item.parent.get(f"{item.name}_{side}95") for side in ("low", "high"))
    std = None if low is None or high is None else (high[()] - low[()]) / OF_95
    return Leaf(np.asarray(item[()], float), std)


def leaves(path: Path) -> dict[str, Leaf]:
    """What a product holds, by path of keys; of a file that is neither JSON nor HDF5 nothing."""
    if path.suffix == ".json":
        return dict(_of_json(json.loads(path.read_text(encoding="utf-8")), ""))
    return dict(_of_hdf5(path))


def _differ(key: str, a: Leaf, b: Leaf, moves: bool) -> Difference:
    said = f"{a.said} -> {b.said}"
    if a.numbers is None or b.numbers is None or a.numbers.shape != b.numbers.shape:
        equal = a.numbers is None and b.numbers is None and a.other == b.other
        return Difference(key, 0.0 if equal else np.inf, 0.0, False, said)
    same = (a.numbers == b.numbers) | np.isnan(a.numbers) & np.isnan(b.numbers)
    apart = np.where(same, 0.0, np.abs(b.numbers - a.numbers))
    scale = max(float(np.nanmax(np.abs(x), initial=0.0)) for x in (a.numbers, b.numbers))
    relative = Difference(key, _largest(apart, scale), MOVED if moves else RELATIVE, False, said)
    if moves or a.std is None or a.std.shape not in {(1,), a.numbers.shape} or not np.all(a.std > 0.0):
        return relative
    return Difference(key, _largest(apart, a.std), SHARE_OF_STD, True, said)


def _largest(apart: Array, scale: Array | float) -> float:
    """The largest difference in units of a scale; infinite where one side is no number."""
    shares = np.divide(apart, scale, out=np.zeros_like(apart), where=apart != 0.0)
    return float(np.max(np.where(np.isnan(shares), np.inf, shares), initial=0.0))


def compare(before: Path, after: Path, *, moves: bool = False, words: bool = True) -> list[Difference]:
    """All keys of a product in two versions, those of one side only included."""
    a, b = leaves(before), leaves(after)
    both = [_differ(key, a[key], b[key], moves) for key in a if key in b]
    told = [d for d, leaf in zip(both, (a[d.key] for d in both), strict=True) if words or leaf.numbers is not None]
    alone = [(key, a[key], "only before") for key in a.keys() - b.keys()]
    alone += [(key, b[key], "only after") for key in b.keys() - a.keys()]
    return told + [Difference(k, np.inf, 0.0, False, f"{side}: {leaf.said}") for k, leaf, side in sorted(alone)]


def products(folder: Path) -> set[Path]:
    """JSON and HDF5 files below a folder but for hidden ones."""
    paths = (p.relative_to(folder) for kind in ("*.json", "*.h5") for p in folder.rglob(kind))
    return {p for p in paths if not any(part.startswith(".") for part in p.parts)}


def _largest_of(found: list[Difference], of_std: bool) -> str:
    kind = [d for d in found if d.of_std is of_std and np.isfinite(d.size)]
    worst = max(kind, key=lambda d: d.size, default=None)
    what = "of a standard deviation" if of_std else "relative"
    return f"{worst.size:.2g} {what}" + (f" ({worst.key})" if worst.size > 0.0 else "") if worst else ""


def report(product: Path, found: list[Difference]) -> int:
    """Print a product's largest differences and each that is too large; returns how many are."""
    largest = "; ".join(filter(None, (_largest_of(found, False), _largest_of(found, True))))
    wrong = sorted((d for d in found if d.too_large), key=lambda d: -d.size)
    print(f"{product}: {len(found)} keys, largest difference {largest or 'none'}; {len(wrong)} too large")
    for d in wrong:
        size = f"{d.size:.2g} {'std' if d.of_std else 'relative'}, " if np.isfinite(d.size) else ""
        print(f"    {d.key}: {size}{d.said}")
    return len(wrong)


def main(arguments: list[str] | None = None) -> int:
    """Compare two folders of products; 1 where anything differs by more than is allowed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before", type=Path)
    parser.add_argument("after", type=Path)
    parser.add_argument("--moves", action="store_true", help="code was moved only: 1e-9 relative throughout")
    parser.add_argument("--numbers-only", action="store_true", help="words may differ")
    asked = parser.parse_args(arguments)
    a, b = products(asked.before), products(asked.after)
    if not a | b:
        print(f"no products in {asked.before} and {asked.after}")
        return 1
    wrong = 0
    for product in sorted(a & b):
        found = compare(asked.before / product, asked.after / product, moves=asked.moves, words=not asked.numbers_only)
        wrong += report(product, found)
    for product in sorted(a ^ b):
        print(f"{product}: only {'before' if product in a else 'after'}")
    return int(wrong > 0 or a != b)


if __name__ == "__main__":
    sys.exit(main())
