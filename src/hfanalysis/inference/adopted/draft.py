"""A draft of an effect file of the form that a diagnosis hints at, for a team to make its own."""

from __future__ import annotations

from hfanalysis.effects.learnt import STATES
from hfanalysis.engine.sites import AT_CHAMBER, AT_FLOW, AT_TANK, HOOK_OF_SITE, RATES
from hfanalysis.products.diagnosis import Learnt

HOOKS = {AT_TANK: "AT_TANK", AT_CHAMBER: "AT_CHAMBER", AT_FLOW: "AT_FLOW", RATES: "RATES"}
"""What hooks are called in an effect file."""

IN_CODE = {"oxidizer_flux": ("env[OXIDIZER_FLOW] / (np.pi * env[PORT_RADIUS] ** 2)", ("OXIDIZER_FLOW", "PORT_RADIUS"))}
"""States that are no entry of the environment."""

_DRAFT = '''"""A draft by hfanalysis, to be finished: {hint}; a hint, not a name."""

import numpy as np

from hfanalysis.engine.effect import Effect, Parameter
from hfanalysis.engine.sites import {names}, term


@term
def _term(hook, t, env, c, p, x, site, dx):
    if hook == {hook} and t >= p[1]:
        site[{site}] += p[0] * {powers}


EFFECT = Effect(
    name="{name}",  # the name of this file, without .py
    equation="{equation}",
    meaning="not known yet: {hint}",
    reference="none yet: where the law is from",
    formula="{formula}",
    sites=("{site_name}",),
    parameters=(
        Parameter("strength", "-", "of the product of powers, all in SI", typical={factor:.6g}),
        Parameter("start", "s", "from when on it acts", typical=0.5, center={start:.3g}),
{exponents}
    ),
    phases=("liquid", "vapor"),
    term=_term,
)
'''


def draft(found: Learnt, name: str) -> str | None:
    """The text of an effect file called ``name``; None where no form is hinted at. Strengths are in SI."""
    hint = found.hint
    if hint is None:
        return None
    hook = HOOKS[HOOK_OF_SITE.get(found.site, RATES)]
    terms, exponents, used = [], [], {hook, found.site.upper()}
    for place, (state, power) in enumerate(hint.powers.items()):
        code, names = IN_CODE.get(state, (f"env[{state.upper()}]", (state.upper(),)))
        used.update(names)
        terms.append(f"({code}) ** p[{2 + place}]")
        exponents.append(
            f'        Parameter("power_of_{state}", "-", "of the {STATES[state][2]}", typical=0.3, center={power:.3g}),'
        )
    return _DRAFT.format(
        hint=hint.words, names=", ".join(sorted(used)), hook=hook, site=found.site.upper(), powers=" * ".join(terms),
        name=name, equation=found.equation, formula=" ".join(f"{s}^{p:.2g}" for s, p in hint.powers.items()),
        site_name=found.site, factor=abs(hint.factor), start=hint.start, exponents="\n".join(exponents),
    )  # fmt: skip
