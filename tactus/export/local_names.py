"""Puts the local names of a function in the same order whichever Python runs it.

MyHDL declares signals in the order in which a frame lists its names. Python 3.11 first lists
parameters and other locals in the order in which the code meets them, and then, by alphabet, those
that an inner function or a comprehension uses. Names that are bound between two looks come last.
Python 3.12 runs a comprehension in the frame around it, and Python 3.13 keeps no order between
looks, so both would declare signals in another order. Here all of them do as 3.11 does, so that
every Python exports the same bytes.
"""

import ast
import inspect
import textwrap
from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from types import CodeType, FrameType

_COMPREHENSIONS = (ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp)
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


@cache
def _used_inside(code: CodeType) -> frozenset[str]:
    """Names of a function that are used by functions and comprehensions inside it."""
    try:
        source = textwrap.dedent(inspect.getsource(code))
    except OSError:
        source = ""
    if not source.startswith(("@", "def ")):
        return frozenset()
    function = ast.parse(source).body[0]
    nodes = _nodes(ast.iter_child_nodes(function), skip=_handed(function))
    return frozenset().union(*(_taken(node) for node in nodes if _is_scope(node)))


def _taken(scope: ast.AST) -> set[str]:
    nodes = list(_nodes(ast.iter_child_nodes(scope), skip=_handed(scope)))
    names = [node for node in nodes if isinstance(node, ast.Name)]
    own = {node.arg for node in nodes if isinstance(node, ast.arg)}
    own |= {node.name for node in nodes if isinstance(node, ast.FunctionDef)}
    own |= {node.id for node in names if isinstance(node.ctx, ast.Store)}
    return {node.id for node in names}.union(*(_taken(n) for n in nodes if _is_scope(n))) - own


def _nodes(start: Iterable[ast.AST], skip: Sequence[ast.AST] = ()) -> Iterator[ast.AST]:
    """The nodes of one scope; for a scope inside it, only what is evaluated around that."""
    for node in start:
        if node not in skip:
            yield node
            yield from _nodes(
                _handed(node) if _is_scope(node) else ast.iter_child_nodes(node), skip
            )


def _is_scope(node: ast.AST) -> bool:
    return isinstance(node, (*_COMPREHENSIONS, ast.FunctionDef, ast.Lambda))


def _handed(scope: ast.AST) -> list[ast.AST]:
    """The parts of a scope that are evaluated around it: first iterable, decorators, defaults."""
    if isinstance(scope, _COMPREHENSIONS):
        return [scope.generators[0].iter]
    assert isinstance(scope, (ast.FunctionDef, ast.Lambda))
    defaults = [*scope.args.defaults, *filter(None, scope.args.kw_defaults)]
    return [*getattr(scope, "decorator_list", []), *defaults]
