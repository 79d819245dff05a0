"""MyHDL expressions that simulate correctly but convert to wrong hardware are forbidden in hdl/.

Each rule is for an expression that has failed without a warning in VHDL, in Verilog or in the
synthesised netlist. docs/new-block.md lists what to write instead.
"""

import ast
import textwrap
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FILES = sorted((ROOT / "hdl").rglob("*.py"))
# Beside clock and reset.
BY_POSITION = 4
PROCESS = {"always", "always_comb", "always_seq"}


def decorators(function: ast.FunctionDef) -> set[str]:
    names = set()
    for decorator in function.decorator_list:
        target = decorator.func if isinstance(decorator, ast.Call) else decorator
        names.add(target.id if isinstance(target, ast.Name) else "")
    return names


def constant(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) or (
        isinstance(node, ast.UnaryOp) and isinstance(node.operand, ast.Constant)
    )


def computed(node: ast.expr) -> bool:
    """Whether an expression has a width that the languages choose differently."""
    return isinstance(node, ast.UnaryOp | ast.BinOp) and not constant(node)


def faults(process: ast.FunctionDef, names: set[str]) -> Iterator[tuple[int, str]]:
    alone = {id(n.value) for n in ast.walk(process) if isinstance(n, ast.Assign)}
    for node in ast.walk(process):
        if isinstance(node, ast.expr | ast.stmt | ast.pattern):
            for broken, text in judge(node, names, alone):
                if broken:
                    yield node.lineno, text


def judge(node: ast.AST, names: set[str], alone: set[int]) -> Iterator[tuple[bool, str]]:
    """Every rule for this kind of node, and whether the node breaks it."""
    match node:
        case ast.BinOp(left=left, op=ast.LShift() | ast.RShift()):
            yield computed(left) and not folds(left, names), "shift of an expression"
        case ast.BinOp(left=left, op=ast.Add() | ast.Sub() | ast.Mult(), right=right):
            nested = [s for s in (left, right) if isinstance(s, ast.BinOp)]
            yield any(not folds(s, names) for s in nested), "more than one operation"
            swapped = isinstance(node.op, ast.Sub) and folds(left, names)
            yield swapped and not folds(right, names), "constant minus signal"
        case ast.Compare(left=left, comparators=others):
            sides = [s for s in (left, *others) if isinstance(s, ast.BinOp)]
            yield any(not folds(s, names) for s in sides), "comparison of an expression"
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            yield not (folds(operand, names) or wide(operand)), "negation in the operand's width"
        case ast.Call(func=ast.Name(id=name)):
            yield name in {"abs", "min", "max", "sum"}, f"{name}() does not convert"
        case ast.Constant(value=int(value)):
            yield abs(value) >= 1 << 30, "constant of 2**30 or more"
        case ast.Subscript(value=ast.Name(id=name)):
            yield name in names and id(node) not in alone, "ROM read inside an expression"
        case ast.MatchOr() | ast.Raise() | ast.IfExp():
            yield True, f"{type(node).__name__} does not convert to what it says"


def folds(node: ast.expr, names: set[str]) -> bool:
    """Whether an expression only consists of elaboration constants."""
    return all(
        isinstance(
            n, ast.Constant | ast.operator | ast.BinOp | ast.UnaryOp | ast.unaryop | ast.Load
        )
        or (isinstance(n, ast.Name) and n.id in names)
        for n in ast.walk(node)
    )


# The rule on negation trusts these signals, which have one bit more than their drivers need.
WIDENED = {"wide", "positive"}


def wide(node: ast.expr) -> bool:
    return isinstance(node, ast.Name) and node.id in WIDENED


def elaboration_constants(block: ast.FunctionDef) -> set[str]:
    """Names that a block computes without making a signal or an instance."""
    makers = {"signed", "unsigned", "fixed", "flag", "Signal", "ResetSignal"}
    makers |= {"Words", "Group", "Stream"}
    # Of what is handed over by name, signals have no annotation.
    names = {arg.arg for arg in block.args.kwonlyargs if arg.annotation}
    signals: set[str] = set()
    for node in block.body:
        if isinstance(node, ast.Assign):
            calls = {
                n.func.id
                for n in ast.walk(node.value)
                if isinstance(n, ast.Call) and isinstance(n.func, ast.Name)
            }
            made = {n.id for t in node.targets for n in ast.walk(t) if isinstance(n, ast.Name)}
            if calls & makers or one_of(node.value, signals):
                signals |= made
            else:
                names |= {t.id for t in node.targets if isinstance(t, ast.Name)}
    return names


def one_of(value: ast.expr, signals: set[str]) -> bool:
    """Whether a value is an element of several signals."""
    return isinstance(value, ast.Subscript) and ast.unparse(value.value) in signals


def check(source: str) -> list[tuple[int, str]]:
    found = []
    for block in ast.walk(ast.parse(source)):
        if isinstance(block, ast.FunctionDef) and "block" in decorators(block):
            names = elaboration_constants(block)
            for process in ast.walk(block):
                if isinstance(process, ast.FunctionDef) and decorators(process) & PROCESS:
                    found += list(faults(process, names))
    return found


def wiring(source: str) -> list[tuple[int, str]]:
    """Blocks that a caller could wire crosswise."""
    found = []
    for block in ast.walk(ast.parse(source)):
        if isinstance(block, ast.FunctionDef) and "block" in decorators(block):
            placed = [arg.arg for arg in block.args.args if arg.arg not in {"clk", "rst"}]
            if len(placed) > BY_POSITION:
                found.append((block.lineno, f"got {len(placed)} signals by position"))
            names = [*placed, *(arg.arg for arg in block.args.kwonlyargs)]
            for stream in (n.removesuffix("_valid") for n in names if n.endswith("_valid")):
                if sum(name.startswith(f"{stream}_") for name in names) > 1:
                    found.append((block.lineno, f"the signals of {stream} are no Stream"))
    return found


@pytest.mark.parametrize("path", FILES, ids=lambda p: str(p.relative_to(ROOT)))
def test_no_construct_that_converts_to_wrong_hardware(path: Path) -> None:
    found = [f"{path.name}:{line}: {text}" for line, text in check(path.read_text())]
    assert not found, "\n".join(found)


@pytest.mark.parametrize("path", FILES, ids=lambda p: str(p.relative_to(ROOT)))
def test_no_block_can_be_wired_crosswise(path: Path) -> None:
    found = [f"{path.name}:{line}: {text}" for line, text in wiring(path.read_text())]
    assert not found, "\n".join(found)


@pytest.mark.parametrize(
    ("parameters", "wrong"),
    [
        ("clk, rst, in_: Stream, out: Stream, *, frame_error, stop: int", False),
        ("clk, a, b, c, d", False),
        ("clk, a, b, c, d, e", True),
        ("clk, rst, in_valid, in_data", True),
        ("clk, rst, *, in_valid, in_data", True),
        ("clk, rst, in_valid, data", False),
    ],
)
def test_what_can_be_wired_crosswise_is_found(parameters: str, wrong: bool) -> None:
    assert bool(wiring(f"@block\ndef thing({parameters}):\n    return []\n")) is wrong


@pytest.mark.parametrize(
    "statement",
    [
        "r.next = (a * b) >> 3",
        "r.next = (a + b) > c",
        "r.next = -a",
        "r.next = 5 - a",
        "r.next = half - a",
        "r.next = abs(a)",
        "r.next = a * b + c",
        "r.next = table[a] + 1",
        "r.next = 1073741824",
        "r.next = a if b else c",
    ],
)
def test_the_rules_find_what_they_are_for(statement: str) -> None:
    source = textwrap.dedent(
        """
        @block
        def thing(a, b, c, r, *, table: tuple):
            half = 1 << 3
            @always_comb
            def work():
                STATEMENT
            return work
        """
    )
    assert check(source.replace("STATEMENT", statement))
    assert not check(source.replace("STATEMENT", "r.next = a + half"))
