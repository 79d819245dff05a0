"""The tables of reports and pages, and how each is measured."""
