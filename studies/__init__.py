"""Questions that were answered once, a folder each. Nothing of the product imports them.

``study.py`` measures: its ``rows()`` yields the rows of ``result.csv`` one by one, so that a test
can ask for the first. ``physics`` has models that they share; ``docs/studies`` has studies that
are not measured again.
"""
