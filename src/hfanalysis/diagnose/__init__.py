"""Where simulation and measurement disagree, which effect the model lacks, and the proof.

``observations`` reduce a log to what is compared, ``fitting`` fits the engine to it, ``naming`` tries effects and
unknown sources, ``answer`` says what is likely, how large and how well proved; ``weak_form`` asks the equations without
a model. ``diagnosis`` leads through all of it.
"""
