"""A first test.toml from the logs of a stand that nobody has described yet.

:mod:`columns` reads the logs; :mod:`words` asks what a column's name says, :mod:`shapes` what its numbers do and
:mod:`sizes` in which unit they are possible; :mod:`guesses` adds that up, :mod:`document` writes it down.
"""
