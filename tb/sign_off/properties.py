"""What a block is proved to do: properties, which stand beside its bench."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

# A signal of a part, as it is written in an expression; a name with points is escaped in Verilog.
INSIDE = re.compile(r"\bu_\w+(?:\.\w+)+")


@dataclass(frozen=True)
class Property:
    """A sentence about a block, and the same in Verilog.

    Expressions may use every signal of the block; one of a part by the part's instance, as
    ``u_divider_0.remaining``. They must hold in every clock after the first with ``rst`` high,
    which is the first clock of all; before it every register may hold anything. In a block
    without ``rst`` they hold from the first clock on.

    Parameters
    ----------
    name : str
        A word or two, for lists.
    sentence : str
        What is proved, in words.
    states : tuple of str
        What is proved, as expressions.
    refuted_by : tuple of (str, str)
        Broken copies of the block, each of which must refute it: a pattern in the Verilog of the
        block or of its parts, and the text that takes its place.
    assumes : dict
        What is taken for granted, by the sentence that says it.
    watch : str
        Verilog that only watches: registers that remember what has happened.
    helps : tuple of str
        Expressions that hold as well, are proved along, and make the induction close.
    reached : tuple of str
        What must be reachable, so that the property does not hold merely because nothing happens.
    free : tuple of str
        Signals that may have any value in any clock, whatever drives them. The property then
        holds for more than the block does: what data paths compute takes no part in it.
    clocks : int
        So many clocks from reset are searched for a refutation, and for what must be reachable.
    induction : int
        At most so many clocks in a row does the induction assume; 0: there is none, and the
        property is proved for ``clocks`` clocks from reset alone.
    arrays : bool
        Memories are arrays for the solver, and not a register for each word: far less to reckon
        with where the property is about any one word. Not for memories with given contents.
    """

    name: str
    sentence: str
    states: tuple[str, ...]
    refuted_by: tuple[tuple[str, str], ...]
    assumes: dict[str, str] = field(default_factory=dict)
    watch: str = ""
    helps: tuple[str, ...] = ()
    reached: tuple[str, ...] = ()
    free: tuple[str, ...] = ()
    clocks: int = 20
    induction: int = 3
    arrays: bool = False

    def verilog(self, flat: str, top: str, helped: bool = True) -> str:
        """The module ``top`` of the text ``flat`` with the property inside.

        Without ``helped`` the property alone is asserted, and not what helps to prove it.
        """
        clocked = re.search(r"^\s*input clk\b", flat, re.M) is not None
        with_reset = re.search(r"^\s*input rst\b", flat, re.M) is not None
        lines = []
        if clocked:
            lines += ["reg after_reset = 0;", "always @(posedge clk) after_reset <= 1;"]
            if with_reset:
                lines.append("always @* if (!after_reset) assume (rst);")
        always = "always @* if (after_reset)" if clocked and with_reset else "always @*"
        lines.append(self.watch)
        lines += [f"always @* assume ({text});" for text in self.assumes.values()]
        lines += [f"{always} states_{n}: assert ({text});" for n, text in enumerate(self.states)]
        if helped:
            lines += [f"{always} helps_{n}: assert ({text});" for n, text in enumerate(self.helps)]
        lines += [f"{always} reached_{n}: cover ({text});" for n, text in enumerate(self.reached)]
        added = INSIDE.sub(lambda name: f"\\{name.group()} ", "\n".join(lines))
        head, end, rest = _module(flat, top).partition("endmodule")
        return f"{head}\n{added}\n{end}{rest}"


def _module(flat: str, top: str) -> str:
    """The text of one module."""
    found = re.search(rf"^module {re.escape(top)}\b.*?^endmodule", flat, re.M | re.S)
    if not found:
        raise ValueError(f"no module {top} in the flattened Verilog")
    return found.group()
