"""How far the figures of the table are from their bounds."""

from dataclasses import dataclass

from tactus.report.measure.table import Cell, Table

# A figure so near to its bound must reach it. For example, a saturated code is the largest code.
REACHED = 0.999


@dataclass(frozen=True)
class Case:
    """A row of the table as an object."""

    model: str
    case: str
    must: str
    figure: str
    value: float
    bound: float
    holds: bool

    @property
    def models(self) -> list[str]:
        """The names of its models."""
        return self.model.split(", ")

    @property
    def label(self) -> str:
        """Its first model, and how many more."""
        first, *others = self.models
        return f"{first} and {len(others)} more" if others else first

    @property
    def part(self) -> float | None:
        """The figure as a part of its bound, or None if the bound is 0."""
        return self.value / self.bound if self.bound else None

    @property
    def reached(self) -> bool:
        """Whether the figure reaches its bound."""
        return self.part is not None and self.part >= REACHED


def cases(table: Table) -> list[Case]:
    """The rows of table ``stability``. A value that is not finite counts as infinite."""
    return [_case(list(row)) for row in table.rows]


def nearest_first(found: list[Case]) -> list[Case]:
    """The cases with a bound above 0 that do not reach it, the nearest to the bound first."""
    hanging = [case for case in found if case.part is not None and not case.reached]
    return sorted(hanging, key=lambda case: -(case.part or 0.0))


def closest(found: list[Case], count: int) -> list[Case]:
    """The cases nearest to their bounds, one for each model and figure."""
    chosen: dict[tuple[str, str], Case] = {}
    for case in nearest_first(found):
        chosen.setdefault((case.model, case.figure), case)
    return list(chosen.values())[:count]


def _case(row: list[Cell]) -> Case:
    model, case, must, figure, value, bound, holds = row
    return Case(
        str(model),
        str(case),
        str(must),
        str(figure),
        float("inf") if value is None else float(value),
        float(bound or 0),
        holds == "yes",
    )
