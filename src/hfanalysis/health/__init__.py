"""Whether what a channel says can be believed, asked before anything else is.

``kinds/`` judges every channel by itself, ``ties/`` what channels say about each other, ``stand/`` this test against
others of its stand: one file per kind of finding, found by its being there.
"""
