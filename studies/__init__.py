"""Questions that were answered once, a folder each. Nothing of the product imports them.

``study.py`` measures: its ``rows()`` yields the rows of ``result.csv`` one by one, so that a test
can ask for the first. Studies that are not measured again are pages of ``docs/studies``.
"""
