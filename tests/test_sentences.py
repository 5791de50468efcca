"""Sentences know their quantities, through models, errors and files."""

from __future__ import annotations

import copy
import json
import pickle

from tests.products.filled import filled

from hfanalysis.errors import AbsentError
from hfanalysis.products.diagnosis import Diagnosis
from hfanalysis.products.disk import to_json
from hfanalysis.products.validation import Validation
from hfanalysis.quantity import Quantity
from hfanalysis.sentences import Quoted, Text, capitalised, joined, quoted_in, said, text

REST = said(72.43e5, "bar", ".1f")
WORDS = text("the tank stands at {rest} for {time:.1f} s", rest=REST, time=2.04)


def test_a_sentence_is_text_and_knows_its_quantities() -> None:
    assert WORDS == "the tank stands at 72.4 bar for 2.0 s"
    assert WORDS.quoted == {"72.4 bar": Quoted(72.43e5, "Pa")}
    flow = said(0.0215, "g/s", ".3g", 0.004, ".1g")
    assert (flow, flow.quoted[flow]) == ("21.5 ± 4 g/s", Quoted(0.0215, "kg/s", 0.004))


def test_a_sentence_of_sentences_knows_those_of_all() -> None:
    drift = said(-76.0, "N", "+.0f")
    for made in (
        joined("; ", [WORDS, drift]),
        text("{a}: {b}", a=WORDS, b=drift),
        capitalised(joined("", [WORDS, drift])),
    ):
        assert set(made.quoted) == {"72.4 bar", "-76 N"}


def test_an_error_a_copy_and_another_process_keep_them() -> None:
    for kept in (str(AbsentError(WORDS)), copy.deepcopy(WORDS), pickle.loads(pickle.dumps(WORDS))):
        assert isinstance(kept, Text)
        assert kept.quoted == WORDS.quoted


def test_a_product_has_them_beside_its_texts_and_gives_them_back() -> None:
    rest = Quantity.absent(text("{words}: too much", words=WORDS))
    made = filled(Validation, {"absent": {"full": WORDS}, "notes": ["plain"], "closure": {"fuel_burned": rest}})
    data = json.loads(to_json(made.but(provenance={"code": ""})))
    assert list(data)[-2:] == ["quoted", "provenance"]
    assert data["quoted"] == {"72.4 bar": {"value": 72.43e5, "unit": "Pa", "std": None}}
    assert data["absent"] == {"full": "the tank stands at 72.4 bar for 2.0 s"}
    again = Validation.from_json(data)
    assert quoted_in([again.absent["full"]]) == WORDS.quoted
    assert again.closure.fuel_burned is not None
    assert quoted_in([again.closure.fuel_burned.reason]) == WORDS.quoted
    assert to_json(again) == to_json(made.but(provenance={"code": ""}))
    found = filled(Diagnosis, {"leftover": 1.0, "sentences": [WORDS], "unknown_elsewhere": 2.0}).to_json()
    assert set(found["quoted"]) == {"72.4 bar"}
    assert "quoted" not in filled(Validation, {"notes": ["plain"]}).to_json()
