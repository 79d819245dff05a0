"""The pictures and plots of the report and of the pages."""
