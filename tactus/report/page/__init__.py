"""The page of a report, and what commands write into the pages of the documentation."""
