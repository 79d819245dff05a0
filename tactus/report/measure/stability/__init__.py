"""Stiff and extreme cases: what must happen and what did happen, with a file for each field."""

from tactus.report.measure.stability.table import NOTES as NOTES
from tactus.report.measure.stability.table import stability as stability
