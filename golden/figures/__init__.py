"""Every measured figure of the project as tables: ``make figures``."""
