"""What is changed in MyHDL 0.11, so that it makes of a block what tactus says a block is.

Speed: MyHDL asks for the call stack with its source lines at every instance, and for the source of
a generator whenever it is instantiated. That takes most of the time of an export. Here the same
files are not read again and again.

Order: MyHDL declares signals in the order in which a frame lists its names. Python 3.11 first lists
parameters and other locals in the order in which the code meets them, and then, by alphabet, those
that an inner function or a comprehension uses. Names that are bound between two looks come last. An
operation of ``hdl.common.ops`` counts as an inner function, since it stands for a process.
Python 3.12 runs a comprehension in the frame around it, and Python 3.13 keeps no order between
looks, so both would declare signals in another order. Here all of them do as 3.11 does, so that
every Python exports the same bytes.

Ports: MyHDL makes ports only of positional parameters. It names a signal of a group after the
parameter and the attribute, even if the parameter ends in an underscore, and it puts the signals of
all groups behind the other ports. Here every parameter can be a port, ``in_valid`` is made of
``in_`` and ``valid``, and the signals of a ``Stream`` stand where the twin puts them.

Conditions: MyHDL converts both branches of an ``if`` inside a process. Here a condition on Python
numbers alone is decided, so that the variants of a block share one process.

Literals: MyHDL takes the ceiling of a logarithm for the size of a large literal. For a word of ones
that logarithm is within a rounding error of a whole number, so the ceiling depends on how the
machine rounds. Here bits are counted.
"""

import ast
import inspect
import sys
import textwrap
from collections.abc import Iterable, Iterator
from functools import cache
from types import CodeType, FrameType, FunctionType, SimpleNamespace
from typing import Any

from myhdl import _block, _instance, _misc, _resolverefs, _util
from myhdl._Signal import _Signal
from myhdl.conversion import _toVerilog, _toVHDL

from hdl.common import ops
from hdl.common.signals import Group, Stream, Words


def _once(function):
    """``function``, whose answer for a Python function holds for all closures of the same code."""
    answers = {}

    def remembered(subject):
        code = inspect.unwrap(subject).__code__
        if code not in answers:
            answers[code] = function(subject)
        return answers[code]

    return remembered


def _stack():
    """The callers and the names of their functions, in the same places as in ``inspect.stack``."""
    frames = []
    frame = sys._getframe(1)
    while frame is not None:
        frames.append(frame)
        frame = frame.f_back
    forget(frames)
    return [
        (Caller(frame), frame.f_code.co_filename, frame.f_lineno, frame.f_code.co_name)
        for frame in frames
    ]


# For every function that is running: its names in the order in which they were seen.
_seen: dict[FrameType, list[str]] = {}


class Caller:
    """The part of a frame that MyHDL reads."""

    def __init__(self, frame: FrameType) -> None:
        self._frame = frame
        self.f_globals = frame.f_globals

    @property
    def f_locals(self) -> dict[str, object]:
        found = dict(self._frame.f_locals)
        code = self._frame.f_code
        inner = _used_inside(code)
        parameters = code.co_varnames[: code.co_argcount + code.co_kwonlyargcount]
        order = _seen.setdefault(self._frame, [])
        fresh = [name for name in found if name not in order]
        plain = [name for name in fresh if name in parameters or name not in inner]
        order += plain + sorted(set(fresh) - set(plain))
        return {name: found[name] for name in order if name in found}


def forget(running: Iterable[FrameType]) -> None:
    """Forget the order of all frames but these."""
    for frame in _seen.keys() - set(running):
        del _seen[frame]


class _Apart(ast.NodeTransformer):
    """Gives each comprehension a scope of its own, as Python 3.11 does, and each operation."""

    def visit_ListComp(self, node: ast.ListComp) -> ast.AST:
        self.generic_visit(node)
        return ast.GeneratorExp(node.elt, node.generators)

    def visit_SetComp(self, node: ast.SetComp) -> ast.AST:
        self.generic_visit(node)
        return ast.GeneratorExp(node.elt, node.generators)

    def visit_DictComp(self, node: ast.DictComp) -> ast.AST:
        self.generic_visit(node)
        return ast.GeneratorExp(ast.Tuple([node.key, node.value], ast.Load()), node.generators)

    def visit_Call(self, node: ast.Call) -> ast.AST:
        self.generic_visit(node)
        if not ast.unparse(node.func).startswith("ops."):
            return node
        return ast.Lambda(ast.arguments([], [], None, [], [], None, []), node)


@cache
def _used_inside(code: CodeType) -> frozenset[str]:
    """Local names of a function that are used by functions and comprehensions inside it."""
    try:
        source = textwrap.dedent(inspect.getsource(code))
    except OSError:
        source = ""
    if not source.startswith(("@", "def ")):
        return frozenset()
    apart = ast.fix_missing_locations(_Apart().visit(ast.parse(source)))
    compiled = compile(apart, code.co_filename, "exec").co_consts
    codes = [c for c in compiled if isinstance(c, CodeType) and c.co_name == code.co_name]
    return frozenset(*(function.co_cellvars for function in codes))


_suffixer = _resolverefs._suffixer


def member_name(group: str, member: str) -> str:
    """The name of a signal in a group: ``in_valid`` for the member ``valid`` of ``in_``."""
    return f"{group.rstrip('_')}_{member}"


def members(name: str, value: Any) -> Iterator[tuple[str, Any]]:
    """Every signal of an argument or a local variable, by the name that it has as a port."""
    if isinstance(value, _Signal):
        yield name, value
    elif isinstance(value, Words | Group):
        for member, inner in vars(value).items():
            yield from members(member_name(name, member), inner)


def _infer_ports(instance: _block._Block) -> None:
    """Leave in a block instance the signals of its ports by name, in the order of its header.

    Ports stand in the twin's order, numbered ones and those of a ``Group`` behind the others. What
    else its streams hold is not the block's.
    """
    signature = inspect.signature(instance.func, eval_str=True)
    arguments = signature.bind(*instance.args, **instance.kwargs).arguments
    spec = arguments.pop("spec")
    published = {port.name: port for port in spec.ports}
    placed: dict[str, Any] = {}
    behind: dict[str, Any] = {}
    others = []
    for name, value in arguments.items():
        kind = signature.parameters[name].annotation
        apart = isinstance(value, Words | Group) and kind is not Stream
        for port, signal in members(name, value):
            if port not in published:
                others.append(port)
                continue
            numbered = published[port].number is not None
            (behind if apart or numbered else placed)[port] = signal
            # Whatever the local variable is called that holds it.
            signal._name = port
    instance.argdict = {port: placed[port] for port in published if port in placed} | behind
    instance.argnames = list(instance.argdict)
    missing = [port for port in published if port not in instance.argdict]
    if missing:
        raise ValueError(
            f"{spec.entity}: got signals {others}, expected {missing}, which the twin publishes"
        )


_update_namespaces = _block._Block._updateNamespaces


def _name_operands(instance: _block._Block) -> None:
    """Also name what an operation takes or gives, as MyHDL names what a process does.

    For blocks, MyHDL only knows the variables that were bound before the first of them.
    """
    _update_namespaces(instance)
    for sub in instance.subs:
        if isinstance(sub, _block._Block) and sub.func.__module__ == ops.__name__:
            for name, value in sub.callinfo.symdict.items():
                if isinstance(value, _Signal) and any(value is operand for operand in sub.args):
                    instance.symdict.setdefault(name, value)
                    instance.sigdict.setdefault(name, value)


class _Decide(ast.NodeTransformer):
    """Replaces each condition on Python numbers by the branch that it takes."""

    def __init__(self, function: FunctionType) -> None:
        self._function, self._tested = function, False

    def visit_If(self, node: ast.If) -> ast.AST | list[ast.stmt]:
        self._visit_parts(node)
        known = self._known(node.test)
        return node if known is None else node.body if known else node.orelse

    def visit_IfExp(self, node: ast.IfExp) -> ast.AST:
        self._visit_parts(node)
        known = self._known(node.test)
        return node if known is None else node.body if known else node.orelse

    def _visit_parts(self, node: ast.If | ast.IfExp) -> None:
        self._tested, before = True, self._tested
        node.test = self.visit(node.test)
        self._tested = before
        self.generic_visit(node)

    def visit_BoolOp(self, node: ast.BoolOp) -> ast.AST:
        """Leaves out what is known of a condition, or all, if that decides. Elsewhere a value may
        be a number other than 0 and 1."""
        self.generic_visit(node)
        if not self._tested:
            return node
        decisive = isinstance(node.op, ast.Or)
        known = [self._known(value) for value in node.values]
        rest = [value for value, fact in zip(node.values, known, strict=True) if fact is None]
        if decisive in known or not rest:
            result = decisive if decisive in known else not decisive
            return ast.copy_location(ast.Constant(result), node)
        node.values = rest
        return node if len(rest) > 1 else rest[0]

    def _known(self, test: ast.expr) -> bool | None:
        variables = inspect.getclosurevars(self._function)
        values = {**variables.globals, **variables.nonlocals}
        names = [node.id for node in ast.walk(test) if isinstance(node, ast.Name)]
        if not all(name in values and isinstance(values[name], int | None) for name in names):
            return None
        return bool(eval(compile(ast.Expression(test), "<condition>", "eval"), values))


_make_ast = _util._makeAST


def decided_ast(function: FunctionType) -> ast.AST:
    """The source of a process, as MyHDL reads it."""
    return _Decide(function).visit(_make_ast(function))


def _log(value: int, base: int) -> int:
    """The ceiling of a logarithm to the base 2."""
    if base != 2:
        raise ValueError(f"base: got {base}, expected 2, the only one that MyHDL 0.11 asks for")
    return (value - 1).bit_length()


def install() -> None:
    """Put these functions in the place of MyHDL's own."""
    quick = SimpleNamespace(**vars(inspect))
    quick.stack = _stack
    for name in ("getsource", "getsourcefile", "getsourcelines"):
        setattr(quick, name, _once(getattr(inspect, name)))
    # The function ``instances`` only looks at its caller.
    quick.getouterframes = lambda frame: [(frame,), (frame.f_back,)]
    for module in (_block, _instance, _misc, _util):
        module.inspect = quick
    _util._dedent = cache(_util._dedent)
    _block._Block._inferInterface = _infer_ports
    _block._Block._updateNamespaces = _name_operands
    _instance._makeAST = decided_ast
    # The attribute of a parameter that ends in an underscore has two of them in a row.
    _resolverefs._suffixer = lambda name, used: _suffixer(name.replace("__", "_"), used)
    for module in (_toVerilog, _toVHDL):
        module.math = SimpleNamespace(ceil=int, log=_log)
