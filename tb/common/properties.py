"""Properties: what is proved of a block. They stand beside the block's bench."""

import re
from dataclasses import dataclass, field

# A signal of a part, as it is written in an expression. In Verilog a name with points is escaped.
INSIDE = re.compile(r"\bu_\w+(?:\.\w+)+")


@dataclass(frozen=True)
class Property:
    """A sentence about a block, and the same statement in Verilog.

    Expressions may use every signal of the block. A signal of a part is named by the part's
    instance, such as ``u_divider_0.remaining``. The expressions must hold in every clock after the
    first one. In that clock ``rst`` is high, and every register may hold anything. In a block
    without ``rst`` they must hold from the first clock on.

    name: A word or two, for lists.
    sentence: What is proved, in words.
    states: What is proved, as expressions.
    refuted_by: Broken copies of the block, each of which must refute the property: a pattern in the
        Verilog of the block or of its parts, and the text that takes its place.
    assumes: The assumptions: expressions, by the sentences that say the same.
    watch: Verilog that only watches: registers that remember what has happened.
    helps: Expressions that hold as well. They are proved together with the property, so that the
        induction closes.
    reached: Expressions that must be reachable. They show that the property does not hold merely
        because nothing happens.
    free: Signals that may have any value in any clock, whatever drives them. So the property holds
        whatever the data paths compute.
    clocks: A refutation, and what must be reachable, is searched in so many clocks from reset.
    induction: The induction assumes at most so many clocks in a row. With 0 there is no induction,
        and the property is proved only for ``clocks`` clocks from reset.
    arrays: Whether memories are arrays for the solver instead of one register for each word. That
        is far less work where the property is about any one word. It does not work for memories
        with given contents.
    whole: Whether it says, with the others of a part, all that the part does. Then the part is not
        mutated.
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
    whole: bool = False

    def verilog(self, flat: str, top: str, helped: bool = True) -> str:
        """The module ``top`` of the text ``flat`` with the property inside.

        Without ``helped`` only the property is asserted, and not the expressions that help to prove
        it.
        """
        clocked, with_reset = (
            re.search(rf"^\s*input {name}\b", flat, re.M) is not None for name in ("clk", "rst")
        )
        added = self.added(clocked, with_reset, helped)
        head, end, rest = _module(flat, top).partition("endmodule")
        return f"{head}\n{added}\n{end}{rest}"

    def added(self, clocked: bool, reset: bool, helped: bool = True) -> str:
        """The text that puts the property into a module; for ``helped`` see ``verilog``.

        clocked, reset: Whether the module has inputs ``clk`` and ``rst``.
        """
        lines = []
        if clocked:
            lines += ["reg after_reset = 0;", "always @(posedge clk) after_reset <= 1;"]
            if reset:
                lines.append("always @* if (!after_reset) assume (rst);")
        always = "always @* if (after_reset)" if clocked and reset else "always @*"
        lines.append(self.watch)
        lines += [f"always @* assume ({text});" for text in self.assumes.values()]
        lines += [f"{always} states_{n}: assert ({text});" for n, text in enumerate(self.states)]
        if helped:
            lines += [f"{always} helps_{n}: assert ({text});" for n, text in enumerate(self.helps)]
        lines += [f"{always} reached_{n}: cover ({text});" for n, text in enumerate(self.reached)]
        return INSIDE.sub(lambda name: f"\\{name.group()} ", "\n".join(lines))


def _module(flat: str, top: str) -> str:
    """The text of one module."""
    found = re.search(rf"^module {re.escape(top)}\b.*?^endmodule", flat, re.M | re.S)
    if not found:
        raise ValueError(f"got no module {top} in the flattened Verilog, expected one")
    return found.group()
