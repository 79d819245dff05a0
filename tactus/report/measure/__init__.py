"""The tables of ``make figures``, and how each is measured."""
